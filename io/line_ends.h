// Joins the ends of the lines of a drawing.
#pragma once
#include <array>
#include <vector>

#include "core/strokes.h"
#include "io/stroke_outline.h"

namespace umbrage {

/// A line of a drawing: a stroke, or the part of one between two corners.
struct Line {
  const Stroke* stroke = nullptr;
  SpinePieces pieces;
  bool closed = false;
  std::array<bool, 2> joined = {false, false};  ///< whether its start and its end meet other lines
};

inline bool is_hatching(StrokeKind kind) { return kind == StrokeKind::kHatch || kind == StrokeKind::kCrossHatch; }

/// Moves ends of lines, but for hatching, to where they meet: ends that are within 1.5 pixels of each other; then ends
/// that would reach another end, or the side of another line, if they were up to 4 or 1.5 pixels longer, or a little
/// shorter; hidden lines reach ends 6 pixels away. No end moves across its line by more than 0.2 pixels, or a hundredth
/// of its piece's length up to 0.5.
void join_ends(std::vector<Line>& lines);

}  // namespace umbrage
