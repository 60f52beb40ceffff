// Decoders of textures, which reduce an image while they decode it.
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "core/result.h"
#include "scene/scene.h"

namespace umbrage {

/// What an image is decoded for.
struct ImageUse {
  /// Width of the smallest area that a picture averages, in texture coordinates. Texels are averaged within blocks that
  /// are not wider. 0: the image keeps its size.
  float footprint = 0.0f;
  bool linear = false;  ///< the colours are linear values, else sRGB, which is averaged as linear light
};

/// Returns the sides of the blocks of texels that are averaged: a power of two up to 8 that divides the image.
int block_side(int width, int height, float footprint);

/// Decodes an image in memory: JPEG, PNG, WebP and what decode_texture reads; `name` is for messages. Errors: kFile.
Result<Texture> decode_texture_image(std::span<const std::uint8_t> bytes, const std::string& name,
                                     const ImageUse& use = {});

}  // namespace umbrage
