// Filtered texture lookup: mip levels, bilinear, several taps along the longer axis of a pixel's footprint.
#pragma once
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "scene/scene.h"

namespace umbrage {

/// One level of a texture.
struct MipLevel {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  ///< as in Texture
};

/// A texture with all its levels.
struct MipTexture {
  std::vector<MipLevel> levels;  ///< the first is the texture itself, the last is 1 x 1
  bool linear = false;           ///< as in Texture
};

/// Creates the mip levels. Averages in linear light, weighted by alpha, so that the colour of cut-out texels does not
/// bleed.
MipTexture make_mips(const Texture& texture);

/// Returns linear colour and alpha at `uv` (repeating), averaged over the footprint. `right` and `down` are the change
/// of uv from one pixel to the next one in that direction. Anisotropic filtering: footprint from [Heckbert 1989], taps
/// as on GPUs.
glm::vec4 sample_filtered(const MipTexture& texture, glm::vec2 uv, glm::vec2 right, glm::vec2 down);

/// Returns the alpha of the finest level at `uv`, bilinear.
float sample_alpha(const MipTexture& texture, glm::vec2 uv);

}  // namespace umbrage
