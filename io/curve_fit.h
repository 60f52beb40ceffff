// Fits straight lines and circular arcs to a polyline: the fewest pieces, found greedily, that stay within a tolerance
// of it. Pieces meet where their curves intersect, so that corners are sharp. Source: ours.
#pragma once
#include <cstddef>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "core/strokes.h"

namespace umbrage {

/// A line or circle of infinite extent.
struct FittedCurve {
  glm::dvec2 center{0.0};   ///< of the circle; else a point of the line
  glm::dvec2 along{0.0};    ///< unit direction of the line
  double radius = 0.0;      ///< 0: a line
  bool turns_right = true;  ///< of a circle: it runs from +x to +y

  /// Returns the signed distance of a point.
  double distance(glm::dvec2 p) const;
  /// Returns the unit direction in which the distance of a point grows.
  glm::dvec2 normal(glm::dvec2 p) const;
  /// Returns the unit direction of the curve beside a point.
  glm::dvec2 direction(glm::dvec2 p) const;
};

/// A straight line or an arc between two points.
struct CurvePiece {
  FittedCurve curve;
  std::size_t first = 0, last = 0;  ///< samples that it fits, inclusive
  glm::dvec2 from{0.0}, to{0.0};    ///< its ends

  /// Makes it the straight line between its ends.
  void make_straight();
  /// Returns the signed angle of the arc, in radians, positive from +x to +y; 0 for a line.
  double angle() const;
  /// Returns its length.
  double length() const;
  /// Returns the unit direction at an end: 0 its start, 1 its end.
  glm::dvec2 direction_at(int end) const;
  /// Returns the point at a fraction of its length.
  glm::dvec2 at(double fraction) const;
};

struct CurveSample {
  glm::dvec2 at{0.0};
  double width = 0.0;
};

struct CurveFit {
  std::vector<CurveSample> samples;  ///< of the polyline, at most a pixel apart
  std::vector<CurvePiece> pieces;    ///< in order; each starts where the one before it ends
};

/// Returns where curves meet near a point: the point that is nearest to all of them, or `near` moved to their mean if
/// that would be farther than `reach` from it.
glm::dvec2 meeting_point(std::span<const FittedCurve> curves, glm::dvec2 near, double reach);

/// Fits a stroke. All samples of a piece are within `tolerance` pixels of its curve, and within a sixth of that on the
/// root mean square. If `sharpens`, tracing is corrected: corners that it has rounded are sharp, 0.3 pixels away from
/// the samples at most, and 1 pixel between lines longer than 30 pixels. Samples of these and of circles may be four
/// tolerances away, and hooks at their ends 1.5 pixels. The first and last piece of a closed stroke meet. A circle has
/// two pieces. Returns no pieces if all points coincide.
CurveFit fit_curve(const Stroke& stroke, double tolerance, bool sharpens);

}  // namespace umbrage
