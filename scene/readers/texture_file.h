// Reader for texture files: PNG, JPEG, TGA, BMP, GIF, HDR and others.
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "core/result.h"
#include "scene/environment.h"
#include "scene/scene.h"

namespace umbrage {

/// Max pixels of a texture: a gigabyte of RGBA. The header of a damaged file may contain any size.
inline constexpr std::int64_t kMaxTexturePixels = std::int64_t(1) << 28;

/// Decodes an image in memory; `name` is for messages. Errors: kFile if stb_image cannot decode the bytes, or if the
/// image is too large.
Result<Texture> decode_texture(std::span<const std::uint8_t> bytes, const std::string& name);

/// Reads and decodes a texture file. Errors: kFile.
Result<Texture> read_texture(const std::filesystem::path& file);

/// Upper limit for the pixels of a panorama: 16384 x 8192.
inline constexpr std::int64_t kMaxPanoramaPixels = std::int64_t(1) << 27;
/// Panoramas that are larger are reduced to this size when they are read.
inline constexpr int kMaxPanoramaWidth = 8192, kMaxPanoramaHeight = 4096;

/// Decodes a panorama in memory: HDR as linear light, other formats as sRGB; `name` is for messages. Errors: kFile.
Result<Panorama> decode_panorama(std::span<const std::uint8_t> bytes, const std::string& name);

/// Reads, decodes and reduces a panorama file. Errors: kFile.
Result<Panorama> read_panorama(const std::filesystem::path& file);

/// Returns whether `bytes` begin with the signature of a Radiance picture (.hdr, .pic): 8 bits per colour and one
/// common exponent.
bool is_radiance(std::span<const std::uint8_t> bytes);

/// Decodes a Radiance picture into radiance, divided by the exposure in its header; `name` is for messages. Errors:
/// kFile if it is damaged, truncated, in XYZ colours, or has more than `max_pixels` pixels.
Result<Panorama> decode_radiance(std::span<const std::uint8_t> bytes, const std::string& name, std::int64_t max_pixels);

}  // namespace umbrage
