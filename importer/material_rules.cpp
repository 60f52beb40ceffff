#include "importer/material_rules.h"

#include <algorithm>
#include <glm/common.hpp>

namespace umbrage {
namespace {

constexpr float kDielectricReflectance = 0.04f;

/// A texture is a cut-out if at least kBinaryFraction of its texels are nearly transparent or nearly opaque, and at
/// least kClearFraction are nearly transparent.
constexpr double kBinaryFraction = 0.9, kClearFraction = 0.001;
constexpr std::uint8_t kNearlyClear = 16, kNearlyOpaque = 239;

}  // namespace

void set_highlight_of_roughness(float metallic, float roughness, Material& material) {
  const float rough = std::max(roughness, 0.01f);
  const float brightest = std::max({material.albedo.x, material.albedo.y, material.albedo.z});
  const float reflectance = glm::mix(kDielectricReflectance, brightest, metallic);
  const float exponent = std::clamp(2.0f / (rough * rough * rough * rough) - 2.0f, 0.0f, kMaxExponent);
  constexpr float kPeakPerExponent = 1.0f / 8.0f;
  material.specular_strength = std::clamp(reflectance * exponent * kPeakPerExponent, 0.0f, 1.0f);
  material.specular_exponent = std::max(exponent, kMinExponent);
}

bool is_cut_out(const Texture& texture) {
  std::size_t clear = 0, opaque = 0;
  for (std::size_t i = 3; i < texture.rgba.size(); i += 4) {
    clear += texture.rgba[i] < kNearlyClear;
    opaque += texture.rgba[i] > kNearlyOpaque;
  }
  const double count = double(texture.rgba.size() / 4);
  return double(clear + opaque) >= kBinaryFraction * count && double(clear) >= kClearFraction * count;
}

bool has_transparent_texels(const Texture& texture) {
  for (std::size_t i = 3; i < texture.rgba.size(); i += 4)
    if (texture.rgba[i] < 255) return true;
  return false;
}

}  // namespace umbrage
