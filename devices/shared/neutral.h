// Values of missing planes, on every device.
#pragma once
#include <optional>
#include <string_view>

namespace umbrage {

/// Returns the value that replaces a plane that a G-buffer lacks, or nullopt if the plane is required.
std::optional<float> neutral_value(std::string_view plane);

}  // namespace umbrage
