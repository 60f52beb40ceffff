// Reads textures of all formats: WebP through libwebp, the others through stb_image.
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "core/result.h"
#include "scene/scene.h"

namespace umbrage {

/// Decodes an image in memory; `name` is for messages. Errors: kFile.
Result<Texture> decode_texture_image(std::span<const std::uint8_t> bytes, const std::string& name);

/// Reads and decodes an image file. Errors: kFile.
Result<Texture> read_texture_image(const std::filesystem::path& file);

}  // namespace umbrage
