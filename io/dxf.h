// Drawings as DXF files of AutoCAD Release 12, which every CAD program reads: lines and polylines on layers.
// Source: [Autodesk 1992], AutoCAD Customization Manual, chapter 11.
#pragma once
#include <string>

#include "core/drawing.h"
#include "core/result.h"

namespace umbrage {

/// Returns the file's text. Coordinates are those of the drawing times mm_per_unit, y up, from its lower left corner.
/// A straight path is a LINE, a circle of two arcs a CIRCLE, others are a POLYLINE with bulges; areas are their closed
/// outlines, without fill. Layers: `visible` (outline, fold, crease), `hidden`, `section`, `hatch` (also cross-hatch),
/// and those of other names. Dashed paths have the line type DASHED. Texts are TEXT, with characters
/// beyond ASCII as \U+XXXX. Pictures in the drawing are left out. Errors:
/// kUsage for numbers that are not finite or above 1e9 in magnitude.
Result<std::string> dxf_text(const Drawing& drawing);

}  // namespace umbrage
