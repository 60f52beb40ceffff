// The page that `umbrage view` serves.
#pragma once
#include <string_view>

namespace umbrage::view {

/// Returns the page: one HTML file with its style sheet and script, UTF-8. It requests nothing from anywhere else.
std::string_view page();

}  // namespace umbrage::view
