// The registry of all effects.
#pragma once
#include <span>
#include <string_view>

#include "core/effect.h"

namespace umbrage {

/// Returns all effects, sorted by name.
std::span<const Effect* const> effects();

/// Returns the effect called `name`, or null.
const Effect* find_effect(std::string_view name);

}  // namespace umbrage
