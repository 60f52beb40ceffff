// The version of Umbrage.
#pragma once
#include <string_view>

namespace umbrage {

/// Returns the version of the project, such as "0.2.0".
std::string_view project_version();

}  // namespace umbrage
