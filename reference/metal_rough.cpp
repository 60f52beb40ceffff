#include "reference/metal_rough.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace umbrage {
namespace {

using glm::dvec3;

constexpr double kPi = 3.14159265358979;
constexpr double kDielectric = 0.04;  // reflectance at normal incidence
constexpr double kMinAlpha = 0.002;   // as effects/lighting
constexpr double kMinLobeCosine = 1e-4;

/// Returns the width of the lobe.
double alpha_of(const MetalRough& surface) {
  return std::max(double(surface.roughness) * double(surface.roughness), kMinAlpha);
}

/// Returns the GGX distribution of half vectors; `nh` is the cosine to the normal.
double distribution(double nh, double alpha) {
  const double a2 = alpha * alpha, d = nh * nh * (a2 - 1.0) + 1.0;
  return a2 / (kPi * d * d);
}

/// Returns the masking and shadowing of both directions over 4 (N.L) (N.V).
double visibility(double nl, double nv, double alpha) {
  const double a2 = alpha * alpha;
  return 0.5 / (nl * std::sqrt(nv * nv * (1.0 - a2) + a2) + nv * std::sqrt(nl * nl * (1.0 - a2) + a2));
}

dvec3 times_pi_cosine(const MetalRough& surface, const dvec3& to_light) {
  const dvec3 n(surface.normal), v(surface.to_eye);
  const double nl = glm::dot(n, to_light), nv = std::max(glm::dot(n, v), kMinLobeCosine);
  if (!(nl > 0.0)) return dvec3(0.0);
  const dvec3 half = glm::normalize(v + to_light);
  const double vh = std::max(glm::dot(v, half), 0.0), alpha = alpha_of(surface);
  const double specular = kPi * nl * visibility(nl, nv, alpha) * distribution(glm::dot(n, half), alpha);
  const double grazing = std::pow(1.0 - vh, 5.0);
  // A mixture of a metal and of a dielectric, whose Fresnel term divides light between the lobe and the diffuse base.
  const dvec3 base(surface.base);
  const dvec3 metal = (base + (1.0 - base) * grazing) * specular;
  const double fresnel = kDielectric + (1.0 - kDielectric) * grazing;
  const dvec3 dielectric = base * ((1.0 - fresnel) * nl) + fresnel * specular;
  return glm::mix(dielectric, metal, double(surface.metallic));
}

dvec3 direction_about(const dvec3& axis, double cosine, double angle) {
  const dvec3 other = std::abs(axis.x) < 0.7 ? dvec3(1.0, 0.0, 0.0) : dvec3(0.0, 1.0, 0.0);
  const dvec3 right = glm::normalize(glm::cross(other, axis)), up = glm::cross(axis, right);
  const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
  return axis * cosine + (right * std::cos(angle) + up * std::sin(angle)) * sine;
}

}  // namespace

glm::vec3 reflected_light(const MetalRough& surface, glm::vec3 to_light) {
  return glm::vec3(times_pi_cosine(surface, dvec3(to_light)));
}

glm::vec3 reflected_environment(const MetalRough& surface, const std::function<glm::vec3(glm::vec3)>& radiance,
                                const SampleTable& table, int samples, std::uint32_t seed) {
  const dvec3 n(surface.normal), v(surface.to_eye);
  const double alpha = alpha_of(surface), a2 = alpha * alpha;
  dvec3 sum(0.0);
  const auto add = [&](const dvec3& direction) {
    const double nl = glm::dot(n, direction);
    if (!(nl > 0.0)) return;
    const dvec3 half = glm::normalize(v + direction);
    const double vh = std::max(glm::dot(v, half), 1e-6), nh = std::max(glm::dot(n, half), 0.0);
    const double of_cosine = nl / kPi, of_lobe = distribution(nh, alpha) * nh / (4.0 * vh);
    sum += dvec3(radiance(glm::vec3(direction))) * times_pi_cosine(surface, direction) / (kPi * (of_cosine + of_lobe));
  };
  for (int k = 0; k < samples; ++k) {
    const dvec3 cosine_sample(sample_point(table, k, hash(seed, 11u)), 0.0),
        lobe_sample(sample_point(table, k, hash(seed, 12u)), 0.0);
    add(direction_about(n, std::sqrt(1.0 - cosine_sample.y), 2.0 * kPi * cosine_sample.x));
    const double cosine = std::sqrt((1.0 - lobe_sample.y) / (1.0 + (a2 - 1.0) * lobe_sample.y));
    const dvec3 half = direction_about(n, cosine, 2.0 * kPi * lobe_sample.x);
    if (glm::dot(v, half) > 0.0) add(2.0 * glm::dot(v, half) * half - v);
  }
  return glm::vec3(sum / double(samples));
}

}  // namespace umbrage
