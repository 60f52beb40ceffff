// Radiance pictures (.hdr, .pic): 8 bits for each colour and an exponent for all three.
#pragma once
#include <cstdint>
#include <span>
#include <string>

#include "core/result.h"
#include "scene/environment.h"

namespace umbrage {

/// Whether bytes begin as such a picture does.
bool is_radiance(std::span<const std::uint8_t> bytes);

/// Its radiance, over the exposure that its header names; `name` is for messages. Errors: kFile where it is damaged,
/// cut short, of XYZ colours, or has more than `most_pixels`.
Result<Panorama> decode_radiance(std::span<const std::uint8_t> bytes, const std::string& name,
                                 std::int64_t most_pixels);

}  // namespace umbrage
