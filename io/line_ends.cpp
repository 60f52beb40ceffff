#include "io/line_ends.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <utility>

namespace umbrage {
namespace {

using glm::dvec2;

constexpr double kMeetingReach = 1.5;  // pixels: max distance of ends that meet
constexpr double kEndReach = 4.0;      // pixels by which a line may become longer or shorter to meet an end
constexpr double kHiddenReach = 6.0;   // pixels, the same for a hidden line: visible ones cover its ends
constexpr double kSideReach = 1.5;     // pixels, likewise to meet the side of another
constexpr double kMaxShorter = 1.0;    // pixels by which a line may become shorter to meet an end
constexpr double kMaxSide = 10000.0;   // pixels: length of a line that others are joined to all along
constexpr double kMinBeside = 0.2;     // pixels: by which an end of any line may move across it
constexpr double kMaxBeside = 0.5;     // pixels, the same for a line that is a hundred times as long

/// Things near a position.
template <class Thing>
class NearbyGrid {
 public:
  explicit NearbyGrid(double cell) : cell_(cell) {}

  void add(dvec2 p, const Thing& thing) { cells_[cell_of(p)].push_back(thing); }
  /// Calls use(thing) for all things at most a cell away, and others.
  template <class Use>
  void near(dvec2 p, const Use& use) const {
    const auto [column, row] = cell_of(p);
    for (long y = row - 1; y <= row + 1; ++y)
      for (long x = column - 1; x <= column + 1; ++x)
        if (const auto cell = cells_.find({x, y}); cell != cells_.end())
          for (const Thing& thing : cell->second) use(thing);
  }

 private:
  std::pair<long, long> cell_of(dvec2 p) const {
    return {long(std::floor(p.x / cell_)), long(std::floor(p.y / cell_))};
  }

  double cell_;
  std::map<std::pair<long, long>, std::vector<Thing>> cells_;
};

/// The end of a line that may meet others.
struct LineEnd {
  Line* line;
  bool last;

  CurvePiece& piece() const { return last ? line->pieces.back().piece : line->pieces.front().piece; }
  dvec2& at() const { return last ? piece().to : piece().from; }
  bool& joined() const { return line->joined[std::size_t(last)]; }

  double max_beside() const { return std::clamp(0.01 * piece().length(), kMinBeside, kMaxBeside); }

  /// Returns whether the line would become much shorter if it ended there.
  bool is_behind(dvec2 p) const {
    const dvec2 outward = last ? piece().direction_at(1) : -piece().direction_at(0);
    return glm::dot(outward, p - at()) < -kMaxShorter;
  }
  /// Moves the end, unless that would move it across its line, or turn a line around that is as short.
  bool move_to(dvec2 p) const {
    if (std::abs(piece().curve.distance(p)) > max_beside() || piece().length() < 2.0 * glm::distance(at(), p))
      return false;
    at() = p;
    joined() = true;
    return true;
  }
};

/// Joins ends that are near each other.
void join_groups(const std::vector<LineEnd>& ends) {
  NearbyGrid<std::size_t> grid(kMeetingReach);
  for (std::size_t k = 0; k < ends.size(); ++k) grid.add(ends[k].at(), k);
  std::vector<bool> is_done(ends.size(), false);  // those of a group at once, so that others have not moved
  for (std::size_t k = 0; k < ends.size(); ++k) {
    if (is_done[k]) continue;
    std::vector<std::size_t> group;
    grid.near(ends[k].at(), [&](std::size_t other) {
      if (!is_done[other] && glm::distance(ends[other].at(), ends[k].at()) <= kMeetingReach) group.push_back(other);
    });
    if (group.size() < 2) continue;
    std::vector<FittedCurve> curves;
    dvec2 mean(0.0);
    for (const std::size_t each : group) {
      curves.push_back(ends[each].piece().curve);
      mean += ends[each].at() / double(group.size());
    }
    const dvec2 meeting = meeting_point(curves, mean, kMeetingReach);
    for (const std::size_t each : group) {
      is_done[each] = true;
      ends[each].move_to(meeting);
    }
  }
}

/// Joins an end to the nearest end of another line that it would reach.
void join_to_end(const LineEnd& end, const NearbyGrid<LineEnd>& grid) {
  dvec2 best(0.0);
  const double reach = end.line->stroke->kind == StrokeKind::kHidden ? kHiddenReach : kEndReach;
  double nearest = reach;
  grid.near(end.at(), [&](const LineEnd& other) {
    const double distance = glm::distance(other.at(), end.at());
    if (other.line == end.line || distance > nearest) return;
    if (end.is_behind(other.at())) return;
    if (std::abs(end.piece().curve.distance(other.at())) <= end.max_beside()) nearest = distance, best = other.at();
  });
  if (nearest < reach) end.move_to(best);
}

/// A place on the side of a line.
struct SidePlace {
  const Line* line;
  const CurvePiece* piece;
  dvec2 at;
};

/// Joins an end to the nearest line that it would reach.
void join_to_side(const LineEnd& end, const NearbyGrid<SidePlace>& grid) {
  dvec2 best(0.0);
  double nearest = kSideReach;
  grid.near(end.at(), [&](const SidePlace& place) {
    if (place.line == end.line || glm::distance(place.at, end.at()) > kSideReach) return;
    const FittedCurve both[] = {end.piece().curve, place.piece->curve};
    const dvec2 p = meeting_point(both, end.at(), kSideReach);
    const double distance = glm::distance(p, end.at());
    if (distance < nearest && !end.is_behind(p) && glm::distance(p, place.at) <= 1.0 &&
        std::abs(both[0].distance(p)) < 0.1 && std::abs(both[1].distance(p)) < 0.1)
      nearest = distance, best = p;
  });
  if (nearest < kSideReach) end.move_to(best);
}

}  // namespace

void join_ends(std::vector<Line>& lines) {
  std::vector<LineEnd> ends;
  NearbyGrid<SidePlace> sides(kSideReach);
  for (Line& line : lines) {
    if (is_hatching(line.stroke->kind)) continue;
    for (const bool last : {false, true})
      if (!line.closed) ends.push_back({&line, last});
    for (const SpinePiece& each : line.pieces) {
      const int steps = std::max(1, int(std::ceil(std::min(each.piece.length(), kMaxSide) / 1.5)));
      for (int k = 0; k <= steps; ++k) {
        const dvec2 at = each.piece.at(double(k) / steps);
        sides.add(at, {&line, &each.piece, at});
      }
    }
  }
  join_groups(ends);
  NearbyGrid<LineEnd> others(kHiddenReach);
  for (const LineEnd& end : ends) others.add(end.at(), end);
  for (const LineEnd& end : ends)
    if (!end.joined()) join_to_end(end, others);
  for (const LineEnd& end : ends)
    if (!end.joined()) join_to_side(end, sides);
}

}  // namespace umbrage
