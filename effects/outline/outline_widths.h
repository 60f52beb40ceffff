// Computes the widths of lines.
#pragma once
#include <span>

#include "core/lines.h"
#include "effects/outline/outline.h"
#include "lines/chains.h"

namespace umbrage {

/// Returns the lines of chains, with their widths. The points of chains are already at their final positions; free_ends
/// has one flag per end (2 * chain + last). `drop` of points is in pixel sizes. Lines that are too thin to be visible
/// are left out.
Lines lines_of(const Tracing& t, std::span<const std::uint8_t> free_ends, const OutlineConstants& c, bool orthographic);

}  // namespace umbrage
