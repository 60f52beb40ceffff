// Decoder for Radiance pictures (.hdr, .pic): 8 bits per colour and one common exponent.
#pragma once
#include <cstdint>
#include <span>
#include <string>

#include "core/result.h"
#include "scene/environment.h"

namespace umbrage {

/// Returns whether `bytes` begin with the signature of a Radiance picture.
bool is_radiance(std::span<const std::uint8_t> bytes);

/// Decodes a Radiance picture into radiance, divided by the exposure in its header; `name` is for messages. Errors:
/// kFile if it is damaged, truncated, in XYZ colours, or has more than `max_pixels` pixels.
Result<Panorama> decode_radiance(std::span<const std::uint8_t> bytes, const std::string& name, std::int64_t max_pixels);

}  // namespace umbrage
