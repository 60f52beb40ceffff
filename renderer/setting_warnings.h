// Warnings about settings of a request: those that do not affect its picture, and former names of parameters.
#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/recipe.h"
#include "renderer/request.h"

namespace umbrage {

/// Returns one sentence for each of them. `scene`: null for a G-buffer. `is_reported`: whether to report that this
/// "effect.parameter=value" has no effect; settings for other looks may be intended.
std::vector<std::string> setting_warnings(const Request& request, const Recipe& recipe, const Scene* scene,
                                          const std::function<bool(std::string_view setting)>& is_reported);

}  // namespace umbrage
