// What planes are that nobody made, on every device.
#pragma once
#include <optional>
#include <string_view>

namespace umbrage {

/// What a plane of a bare G-buffer is when it does not have it, or nothing where no value would do.
std::optional<float> neutral_value(std::string_view plane);

}  // namespace umbrage
