// Settings of a request that do not change its picture.
#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/recipe.h"
#include "renderer/request.h"

namespace umbrage {

/// One sentence for each of them. `scene`: null for a G-buffer. `is_told`: of which "effect.parameter=value" to speak;
/// others may be meant for other looks.
std::vector<std::string> unused_settings(const Request& request, const Recipe& recipe, const Scene* scene,
                                         const std::function<bool(std::string_view setting)>& is_told);

}  // namespace umbrage
