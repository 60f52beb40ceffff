// The lines of a picture as a drawing: a path for each line, of straight lines and circular arcs.
#pragma once
#include <map>
#include <optional>

#include "core/drawing.h"
#include "core/result.h"
#include "core/strokes.h"

namespace umbrage {

/// Style of lines.
struct LineStyle {
  DrawnColor color{};
  float opacity = 1.0f;  ///< of all lines as a group: overlaps are not darker
  std::optional<DrawnColor> background;
  std::map<int, int> caps = {};  ///< of sections: the cap that each object belongs to; its strips are two objects
  bool varies = true;  ///< lines of varying width are drawn as areas; else every line is a stroke of its mean width
};

/// Returns a drawing in pixels with a layer per kind of line and object, in that order, named "outline", "fold",
/// "crease", "hatch", "cross-hatch", "hidden" or "section". Lines and arcs are fitted within 0.1 pixels (fit_curve).
/// Lines but those of hatching are divided at corners, and ends that are near each other meet (join_ends). A path is a
/// stroke where the width is constant within 0.05 pixels or 2 %; else it is the outline of the stroke. Dashes begin and
/// end a line. Errors: kUsage for coordinates or widths that are not finite or above 1e9 in magnitude, and for negative
/// widths.
Result<Drawing> drawing_of(const Strokes& strokes, const LineStyle& style);

}  // namespace umbrage
