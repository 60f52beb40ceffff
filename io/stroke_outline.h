// Outlines of strokes: a line of varying width as an area.
#pragma once
#include <vector>

#include "core/drawing.h"
#include "io/curve_fit.h"

namespace umbrage {

/// A piece of a line and the widths along it, evenly spaced; at least one.
struct SpinePiece {
  CurvePiece piece;
  std::vector<float> widths;
};
using SpinePieces = std::vector<SpinePiece>;

/// Returns the max deviation of a width that is not seen, in pixels.
float width_tolerance(float width);

/// Returns the line without its widths: an open path.
DrawnPath path_of(const SpinePieces& pieces);

/// Returns the outline of the stroke, with round ends and joins, within 0.03 pixels. That of a closed line has a hole.
/// Where a line turns within its own width the outline crosses itself: the non-zero rule fills it.
DrawnPath stroke_outline(const SpinePieces& pieces, bool closed);

}  // namespace umbrage
