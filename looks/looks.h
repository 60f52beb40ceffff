// The registry of looks.
#pragma once
#include <span>
#include <string_view>
#include <vector>

#include "core/look.h"
#include "looks/settings.h"

namespace umbrage {

/// Returns all looks, sorted by name.
std::span<const Look* const> looks();

/// Returns the looks that can draw a scene: all but those that need a finished picture, sorted by name.
std::span<const Look* const> scene_looks();

/// Returns the look of that name, or null.
const Look* find_look(std::string_view name);

/// Name of "no occlusion": `ao` is 1 everywhere.
inline constexpr std::string_view kNoOcclusion = "none";

/// Returns the valid values of `occlusion`: the names of all occlusion techniques, including external ones, and `none`.
std::vector<std::string_view> occlusion_names(std::span<const Effect* const> external_effects = {});

}  // namespace umbrage
