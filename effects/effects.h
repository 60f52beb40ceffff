// The registry: every effect there is.
#pragma once
#include <span>
#include <string_view>

#include "core/effect.h"

namespace umbrage {

/// All effects, in the order of their names.
std::span<const Effect* const> effects();

/// The effect of that name, or null.
const Effect* find_effect(std::string_view name);

}  // namespace umbrage
