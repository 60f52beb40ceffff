// Warnings about settings of a request that do not affect its picture, and about former names of parameters.
#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/recipe.h"
#include "renderer/request.h"

namespace umbrage {

/// Returns the warnings, one sentence each. `scene`: null for a G-buffer. `is_reported`: returns whether to warn that
/// this "effect.parameter=value" does nothing; settings for other looks may be intended. `word` precedes settings.
std::vector<std::string> setting_warnings(const Request& request, const Recipe& recipe, const Scene* scene,
                                          const std::function<bool(std::string_view setting)>& is_reported,
                                          std::string_view word = "`settings` ");

}  // namespace umbrage
