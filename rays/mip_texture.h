// Filtered reads of a texture: mip levels, bilinear, several taps along the longer axis of a pixel's footprint.
#pragma once
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "scene/scene.h"

namespace umbrage {

struct MipLevel {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  ///< sRGB colour, linear alpha, row 0 at the top
};

struct MipTexture {
  std::vector<MipLevel> levels;  ///< the first is the texture itself, the last is 1 x 1
};

/// Averages in linear light, weighted by alpha so that the colour of cut-away texels does not bleed.
MipTexture make_mips(const Texture& texture);

/// Linear colour and alpha at uv (repeating), averaged over the footprint spanned by uv's change from one pixel to the
/// next, right and down. Anisotropic filtering as [Heckbert 1989] describes the footprint; taps as GPUs take them.
glm::vec4 sample_filtered(const MipTexture& texture, glm::vec2 uv, glm::vec2 right, glm::vec2 down);

/// Alpha of the finest level at uv, bilinear.
float sample_alpha(const MipTexture& texture, glm::vec2 uv);

}  // namespace umbrage
