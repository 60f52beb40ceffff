// Texture files: PNG, JPEG, TGA, BMP, GIF, HDR and others become a Texture.
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "core/result.h"
#include "scene/scene.h"

namespace umbrage {

/// Decodes an image that lies in memory; `name` is for messages.
/// Errors: kFile where the bytes are no image that stb_image reads, or one too large to keep.
Result<Texture> decode_texture(std::span<const std::uint8_t> bytes, const std::string& name);

/// Reads and decodes a file. Errors: kFile.
Result<Texture> read_texture(const std::filesystem::path& file);

}  // namespace umbrage
