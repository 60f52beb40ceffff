#include "core/reflection_map.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>

#include "core/basis.h"

namespace umbrage {
namespace {

constexpr int kSamples = 256;  // per texel: the noise of a smooth sky is below that of 9 bits

/// Returns point k of a Hammersley set of kSamples points.
glm::vec2 sample_point(int k) {
  float reversed = 0.0f, fraction = 0.5f;
  for (int rest = k; rest > 0; rest /= 2, fraction *= 0.5f) reversed += rest % 2 ? fraction : 0.0f;
  return {(float(k) + 0.5f) / float(kSamples), reversed};
}

/// Returns the half vector about +z of a sample of the GGX distribution of width `alpha` [Walter et al. 2007].
glm::vec3 half_vector(glm::vec2 sample, float alpha) {
  const float cosine = std::sqrt((1.0f - sample.y) / (1.0f + (alpha * alpha - 1.0f) * sample.y));
  const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)), angle = glm::two_pi<float>() * sample.x;
  return {sine * std::cos(angle), sine * std::sin(angle), cosine};
}

/// Returns the direction of the point (x, y) of an octahedral map from -1 to 1, continued beyond its border.
glm::vec3 direction_at(float x, float y) {
  if (std::abs(x) > 1.0f) x = std::copysign(2.0f, x) - x, y = -y;
  if (std::abs(y) > 1.0f) y = std::copysign(2.0f, y) - y, x = -x;
  glm::vec3 d(x, y, 1.0f - std::abs(x) - std::abs(y));
  if (d.z < 0.0f)
    d = {(1.0f - std::abs(y)) * std::copysign(1.0f, x), (1.0f - std::abs(x)) * std::copysign(1.0f, y), d.z};
  return glm::normalize(d);
}

std::uint32_t packed(glm::vec3 color) {
  constexpr int kBits = 9, kMaxExponent = 31, kBias = 24;
  constexpr float kMaxMantissa = float((1 << kBits) - 1);
  constexpr float kMaxColor = 65408.0f;  // kMaxMantissa 2^(kMaxExponent - kBias)
  for (int c = 0; c < 3; ++c) color[c] = color[c] > 0.0f ? std::min(color[c], kMaxColor) : 0.0f;
  const float max = std::max({color.r, color.g, color.b});
  int exponent = 0;
  while (exponent < kMaxExponent && std::round(std::ldexp(max, kBias - exponent)) > kMaxMantissa) ++exponent;
  std::uint32_t bits = std::uint32_t(exponent) << 27;
  for (int c = 0; c < 3; ++c) bits |= std::uint32_t(std::round(std::ldexp(color[c], kBias - exponent))) << (kBits * c);
  return bits;
}

template <class Average>
ReflectionMap map_of(const Average& average) {
  ReflectionMap map{};
  for (int level = 0; level < kReflectionLevels; ++level) {
    const int side = kReflectionSides[std::size_t(level)];
    const auto coordinate = [&](int k) { return (float(k) - 0.5f) * 2.0f / float(side) - 1.0f; };
    for (int y = 0; y < side + 2; ++y)
      for (int x = 0; x < side + 2; ++x)
        map[std::size_t(first_reflection_texel(level) + y * (side + 2) + x)] =
            packed(average(level, direction_at(coordinate(x), coordinate(y))));
  }
  return map;
}

/// Returns the width of the GGX distribution of a level.
float alpha_of(int level) {
  const float roughness = float(level) / float(kReflectionLevels - 1);
  return roughness * roughness;
}

}  // namespace

ReflectionMap reflection_map(const std::function<glm::vec3(glm::vec3)>& radiance) {
  return map_of([&](int level, glm::vec3 axis) {
    const glm::vec3 right = glm::normalize(glm::cross(axis_beside(axis), axis));
    const glm::mat3 basis(right, glm::cross(axis, right), axis);
    glm::vec3 sum(0.0f);
    float weights = 0.0f;
    // The view along the normal: the mirror direction of a half vector, weighted by its cosine [Karis 2013].
    for (int k = 0; k < (level == 0 ? 1 : kSamples); ++k) {
      const glm::vec3 half = level == 0 ? glm::vec3(0.0f, 0.0f, 1.0f) : half_vector(sample_point(k), alpha_of(level));
      const glm::vec3 local = 2.0f * half.z * half - glm::vec3(0.0f, 0.0f, 1.0f);
      if (!(local.z > 0.0f)) continue;
      sum += radiance(basis * local) * local.z;
      weights += local.z;
    }
    return sum / weights;
  });
}

ReflectionMap reflection_map(glm::vec3 ambient, const AmbientShape& shape) {
  // A diffuse surface averages degree 1 to 2/3 and degree 2 to 1/4 [Ramamoorthi and Hanrahan 2001]; a lobe averages
  // them to its mean Legendre polynomials.
  std::array<glm::vec2, std::size_t(kReflectionLevels)> kept;
  for (int level = 0; level < kReflectionLevels; ++level) {
    glm::vec2 sum(0.0f);
    float weights = 0.0f;
    for (int k = 0; k < kSamples; ++k) {
      const float cosine = half_vector(sample_point(k), alpha_of(level)).z, z = 2.0f * cosine * cosine - 1.0f;
      if (!(z > 0.0f)) continue;
      sum += glm::vec2(z, 1.5f * z * z - 0.5f) * z;
      weights += z;
    }
    kept[std::size_t(level)] = sum / weights * glm::vec2(1.5f, 4.0f);
  }
  return map_of([&](int level, glm::vec3 d) {
    const glm::vec3 there = shape.at(d), opposite = shape.at(-d);
    const glm::vec2 factor = kept[std::size_t(level)];
    return glm::max(ambient + 0.5f * factor.x * (there - opposite) + 0.5f * factor.y * (there + opposite),
                    glm::vec3(0.0f));
  });
}

namespace {

EnvironmentBrdf make_environment_brdf() {
  EnvironmentBrdf out;
  constexpr int kSide = EnvironmentBrdf::kSide;
  constexpr float kMin = 1e-3f;  // of the roughness and the cosine, where the limit is not finite
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const float roughness = std::max(float(x) / float(kSide - 1), kMin),
                  nv = std::max(float(y) / float(kSide - 1), kMin);
      const float alpha = roughness * roughness, a2 = alpha * alpha;
      const glm::vec3 view(std::sqrt(1.0f - nv * nv), 0.0f, nv);
      float scale = 0.0f, bias = 0.0f;
      for (int k = 0; k < kSamples; ++k) {
        const glm::vec3 half = half_vector(sample_point(k), alpha);
        const float vh = glm::dot(view, half), nl = 2.0f * vh * half.z - nv;
        if (!(nl > 0.0f) || !(vh > 0.0f)) continue;
        const float visibility =
            0.5f / (nl * std::sqrt(nv * nv * (1.0f - a2) + a2) + nv * std::sqrt(nl * nl * (1.0f - a2) + a2));
        const float weight = visibility * 4.0f * vh * nl / half.z, grazing = std::pow(1.0f - vh, 5.0f);
        scale += weight * (1.0f - grazing) / float(kSamples);
        bias += weight * grazing / float(kSamples);
      }
      out.scale[std::size_t(y * kSide + x)] = scale;
      out.bias[std::size_t(y * kSide + x)] = bias;
    }
  return out;
}

}  // namespace

const EnvironmentBrdf& environment_brdf() {
  static const EnvironmentBrdf brdf = make_environment_brdf();
  return brdf;
}

std::shared_ptr<const ReflectionMap> studio_reflections(const glm::vec3& up) {
  // Relative to white under the key light. The backdrop is lit separately, as usual, and brighter than ambient light.
  constexpr glm::vec3 kCeiling(0.13f, 0.145f, 0.165f), kBackdrop(0.62f, 0.62f, 0.62f), kFloor(0.21f, 0.2f, 0.185f);
  constexpr float kCeilingHeight = 0.7f, kFloorDepth = 0.45f;  // sine of the elevation from which on the colour is even
  const glm::vec3 vertical = glm::normalize(up);
  return std::make_shared<const ReflectionMap>(reflection_map([&](glm::vec3 direction) {
    const float height = glm::dot(direction, vertical);
    return height > 0.0f ? glm::mix(kBackdrop, kCeiling, glm::smoothstep(0.0f, kCeilingHeight, height))
                         : glm::mix(kBackdrop, kFloor, glm::smoothstep(0.0f, kFloorDepth, -height));
  }));
}

}  // namespace umbrage
