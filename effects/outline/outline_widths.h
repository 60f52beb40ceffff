// Converts chains to lines and computes their widths.
#pragma once
#include <span>

#include "chains/chains.h"
#include "core/strokes.h"
#include "effects/outline/outline.h"

namespace umbrage {

/// Returns the lines of the chains, with their widths. The points must be at their final positions, and their `drop` in
/// pixel sizes. `free_ends` has one flag per end (2 * chain + last). Lines that are too thin to be visible are left
/// out.
Strokes lines_of(const Tracing& t, std::span<const std::uint8_t> free_ends, const OutlineConstants& c,
                 bool orthographic);

}  // namespace umbrage
