// How wide lines are.
#pragma once
#include <span>

#include "core/lines.h"
#include "effects/outline/outline.h"
#include "lines/chains.h"

namespace umbrage {

/// Lines of chains whose points lie where they are drawn, and the ends of which (2 * chain + last) are free. `drop` of
/// points counts in pixel sizes. Lines that are too thin to be seen are left out.
Lines lines_of(const Tracing& t, std::span<const std::uint8_t> free_ends, const OutlineConstants& c, bool orthographic);

}  // namespace umbrage
