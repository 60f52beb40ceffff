// Filtered texture lookup: mip levels, bilinear, several taps along the longer axis of a pixel's footprint.
#pragma once
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <span>
#include <vector>

#include "scene/scene.h"

namespace umbrage {

/// One level of a texture.
struct MipLevel {
  int width = 0, height = 0;
  std::span<const std::uint8_t> rgba;  ///< as in Texture
  bool nearest = false;                ///< the first level of a Texture that is
  bool clamped = false;                ///< as in Texture
};

/// The smallest and the largest alpha of some texels, in 255ths.
struct AlphaRange {
  std::uint8_t min = 255, max = 0;
};

/// A texture with all its levels.
struct MipTexture {
  std::vector<MipLevel> levels;                         ///< the first is the texture itself, the last is 1 x 1
  bool linear = false;                                  ///< as in Texture
  std::vector<std::unique_ptr<std::uint8_t[]>> rgba{};  ///< of all levels but the first
  std::vector<AlphaRange> alpha_ranges{};               ///< by add_alpha_ranges; empty: none
};

/// Creates the mip levels with all threads. Averages in linear light, weighted by alpha, so that the colour of cut-out
/// texels does not bleed. The texture must outlive the result.
MipTexture make_mips(const Texture& texture);

/// The texels of a texture that sample_filtered averages.
struct MipFootprint {
  int width = 0, height = 0;  ///< of the textures that have this footprint
  glm::vec2 uv{0.0f}, axis{0.0f};
  int taps = 1, finer_level = 0, level_count = 1;
  float blend = 0.0f;  ///< weight of the coarser level
};

/// Returns the footprint at `uv` on all textures of the size of `texture`; the arguments are those of sample_filtered.
MipFootprint footprint_of(const MipTexture& texture, glm::vec2 uv, glm::vec2 right, glm::vec2 down);

/// Returns linear colour and alpha, averaged over a footprint on a texture of its size.
glm::vec4 sample_filtered(const MipTexture& texture, const MipFootprint& footprint);

/// Returns linear colour and alpha at `uv`, averaged over the footprint. `right` and `down` are the change
/// of uv from one pixel to the next one in that direction. Anisotropic filtering: footprint from [Heckbert 1989], taps
/// as on GPUs.
glm::vec4 sample_filtered(const MipTexture& texture, glm::vec2 uv, glm::vec2 right, glm::vec2 down);

/// Returns the alpha of the finest level at `uv`, bilinear.
float sample_alpha(const MipTexture& texture, glm::vec2 uv);

/// Finds the ranges of alpha that alpha_reaches reads, of squares of texels of the finest level.
void add_alpha_ranges(MipTexture& texture);
/// Returns the range of alpha of the whole texture. It must have alpha ranges.
AlphaRange whole_range(const MipTexture& texture);
/// Returns whether sample_alpha(texture, uv) * opacity >= bound. Reads texels only where the range of those around `uv`
/// contains the bound. The texture must have alpha ranges; `opacity` >= 0.
bool alpha_reaches(const MipTexture& texture, glm::vec2 uv, float opacity, float bound);

}  // namespace umbrage
