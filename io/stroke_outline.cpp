#include "io/stroke_outline.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace umbrage {
namespace {

using glm::dvec2;

constexpr double kOutlineTolerance = 0.03;  // pixels
constexpr double kSpineStep = 1.5;          // pixels between the points of a spine
constexpr double kMaxRibs = 10000.0;        // of a piece
constexpr double kJoinTurn = 0.1;           // radians: a smaller turn needs no join
constexpr double kMinRoundEnd = 0.05;       // pixels: a narrower end is pointed

/// A point of a spine.
struct Rib {
  dvec2 at, along;
  double half;            // of the width
  double radius = 0.0;    // of the curve, signed as its angle; 0: straight
  bool is_break = false;  // the direction changes between the rib before and this one
};

dvec2 left_normal(dvec2 d) { return {-d.y, d.x}; }
dvec2 rotated(dvec2 d, double angle) { return d * std::cos(angle) + left_normal(d) * std::sin(angle); }
double signed_angle(dvec2 a, dvec2 b) { return std::atan2(a.x * b.y - a.y * b.x, glm::dot(a, b)); }

double width_at(const std::vector<float>& widths, double fraction) {
  const double at = fraction * double(widths.size() - 1);
  const auto k = std::min(std::size_t(at), widths.size() - 1), next = std::min(k + 1, widths.size() - 1);
  return widths[k] + (at - double(k)) * (double(widths[next]) - widths[k]);
}

std::vector<Rib> ribs_of(const SpinePieces& pieces) {
  std::vector<Rib> ribs;
  for (const auto& [piece, widths] : pieces) {
    const double length = piece.length(), angle = piece.angle();
    const int steps = std::max(1, int(std::ceil(std::min(length / kSpineStep, kMaxRibs))));
    const double radius = std::abs(angle) < 1e-6 ? 0.0 : length / angle;
    for (int k = 0; k <= steps; ++k) {
      const double f = double(k) / steps;
      const dvec2 along = rotated(piece.direction_at(0), f * angle);
      ribs.push_back({piece.at(f), along, 0.5 * width_at(widths, f), radius, k == 0 && !ribs.empty()});
    }
  }
  return ribs;
}

/// Returns the points `side` (1: left, -1: right) of the spine. On the inner side of a turn they pass through the
/// spine, so that all that the outline encloses has a positive winding number.
std::vector<dvec2> side_of(const std::vector<Rib>& ribs, double side, bool closed) {
  std::vector<dvec2> points;
  const auto join = [&](const Rib& before, const Rib& rib) {
    const double turn = signed_angle(before.along, rib.along);
    if (std::abs(turn) < kJoinTurn) return;
    if (turn * side > 0.0) {
      points.push_back(rib.at);
      return;
    }
    const double step = 2.0 * std::acos(1.0 - std::min(kOutlineTolerance / std::max(rib.half, kOutlineTolerance), 1.0));
    const int parts = std::max(1, int(std::ceil(std::abs(turn) / std::max(step, 0.05))));
    for (int k = 1; k < parts; ++k)
      points.push_back(rib.at + side * rib.half * rotated(left_normal(before.along), turn * k / parts));
  };
  for (std::size_t k = 0; k < ribs.size(); ++k) {
    const Rib& rib = ribs[k];
    if (rib.is_break) join(ribs[k - 1], rib);
    // Beyond the centre of a turn the side would run back.
    const bool is_inner = rib.radius * side > 0.0;
    const double half = is_inner ? std::min(rib.half, std::abs(rib.radius)) : rib.half;
    points.push_back(rib.at + side * half * left_normal(rib.along));
  }
  if (closed) join(ribs.back(), ribs.front());
  return points;
}

/// Returns the points without those that are not needed within the tolerance. The first and last remain.
std::vector<dvec2> thinned(const std::vector<dvec2>& points) {
  std::vector<dvec2> kept;
  const auto can_skip = [&](std::size_t first, std::size_t last) {
    const dvec2 a = points[first], d = points[last] - a;
    const double length = glm::length(d);
    for (std::size_t k = first + 1; k < last; ++k) {
      const dvec2 to = points[k] - a;
      const double along = length > 0.0 ? glm::dot(to, d) / length : 0.0;
      if (along < 0.0 || along > length || std::abs(to.x * d.y - to.y * d.x) > kOutlineTolerance * length) return false;
    }
    return length > 0.0;
  };
  for (std::size_t k = 0; k < points.size();) {
    kept.push_back(points[k]);
    std::size_t step = 1;
    while (k + 2 * step < points.size() && can_skip(k, k + 2 * step)) step *= 2;
    for (std::size_t more = step / 2; more > 0; more /= 2)
      if (k + step + more < points.size() && can_skip(k, k + step + more)) step += more;
    k += step;
  }
  return kept;
}

void append_lines(const std::vector<dvec2>& points, DrawnPath& path) {
  for (const dvec2 p : points) path.segments.push_back({.x = float(p.x), .y = float(p.y)});
}

DrawnPath loop_of(const std::vector<dvec2>& points) {
  DrawnPath path{.x = float(points[0].x), .y = float(points[0].y), .closed = true};
  append_lines({points.begin() + 1, points.end()}, path);
  path.segments.push_back({.x = path.x, .y = path.y});
  return path;
}

/// Appends half a circle around the end of a spine to the point `to`, or a line where it is narrow.
void append_end(const Rib& rib, dvec2 to, DrawnPath& path) {
  const bool is_round = rib.half > kMinRoundEnd;
  path.segments.push_back(
      {.x = float(to.x), .y = float(to.y), .radius = is_round ? float(rib.half) : 0.0f, .clockwise = false});
}

}  // namespace

float width_tolerance(float width) { return std::max(0.05f, 0.02f * width); }

DrawnPath path_of(const SpinePieces& pieces) {
  DrawnPath path{.x = float(pieces[0].piece.from.x), .y = float(pieces[0].piece.from.y)};
  for (const auto& [piece, widths] : pieces) {
    const double angle = piece.angle(), length = piece.length();
    const double chord = glm::distance(piece.from, piece.to);
    DrawnSegment& segment = path.segments.emplace_back(DrawnSegment{.x = float(piece.to.x), .y = float(piece.to.y)});
    if (std::abs(angle) < 1e-6 || length < 1e-6) continue;
    segment.radius = float(chord / (2.0 * std::sin(0.5 * std::abs(angle))));
    segment.large_arc = std::abs(angle) > std::numbers::pi;
    segment.clockwise = angle > 0.0;
  }
  return path;
}

DrawnPath stroke_outline(const SpinePieces& pieces, bool closed) {
  const std::vector<Rib> ribs = ribs_of(pieces);
  const std::vector<dvec2> left = thinned(side_of(ribs, 1.0, closed));
  std::vector<dvec2> right = thinned(side_of(ribs, -1.0, closed));
  std::reverse(right.begin(), right.end());
  if (closed) {
    DrawnPath path = loop_of(left);
    path.holes.push_back(loop_of(right));
    return path;
  }
  DrawnPath path{.x = float(left[0].x), .y = float(left[0].y), .closed = true};
  append_lines({left.begin() + 1, left.end()}, path);
  append_end(ribs.back(), right.front(), path);
  append_lines({right.begin() + 1, right.end()}, path);
  append_end(ribs.front(), left.front(), path);
  return path;
}

}  // namespace umbrage
