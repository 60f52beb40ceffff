#include "importer/material_rules.h"

namespace umbrage {
namespace {

/// A texture is a cut-out if at least kBinaryFraction of its texels are nearly transparent or nearly opaque, and at
/// least kClearFraction are nearly transparent.
constexpr double kBinaryFraction = 0.9, kClearFraction = 0.001;
constexpr std::uint8_t kNearlyClear = 16, kNearlyOpaque = 239;

}  // namespace

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
