// Implements trace_hatching: evenly spaced streamlines [Jobard and Lefer 1997].
//
// Differs: there are three ranks, each with half the distance of the one before, so that the lines of a light tone are
// among those of a darker one, as in [Praun et al. 2001]. Where lines of a rank come too near, one of them goes on with
// a higher one: it would end there in a light tone only.
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>

#include "effects/hatching/hatching_points.h"

namespace umbrage {
namespace {

using Point = HatchingLine::Point;

constexpr float kStepFraction = 1.0f / 6.0f;  // length of a step, in spacings
constexpr float kStopFraction = 0.55f;        // of the distance of a rank that its lines keep
constexpr float kSeedFraction = 0.75f;        // of the distance that a seed keeps
constexpr float kAhead = 0.5f;                // of two lines that meet end to end, in spacings
constexpr float kMinLength = 1.5f;            // of a line, in the distance of its rank, and that of rank 1
constexpr float kMinTurnCosine = 0.7f;        // between two steps: a line does not turn by 45 degrees at once
constexpr int kMaxSteps = 20000;
constexpr std::size_t kRoomSteps = 3;  // steps from one point to the next whose room is found
constexpr float kMaxGap = 2.2f;        // between two lines, in spacings: a wider one is an edge of the surface

using Vector = HatchingLine::Point;

/// The directions of a picture, and where one can go.
class Directions {
 public:
  explicit Directions(const HatchingField& field) : field_(field) {}

  /// Returns the unit direction at a point that is nearest to `before`; 0 outside of surfaces.
  Vector at(Point p, Vector before) const {
    const float px = p.x - 0.5f, py = p.y - 0.5f;
    const int x = int(std::floor(px)), y = int(std::floor(py));
    const float fx = px - float(x), fy = py - float(y);
    float sum_x = 0.0f, sum_y = 0.0f;
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 2; ++i) {
        const int u = std::clamp(x + i, 0, field_.width - 1), v = std::clamp(y + j, 0, field_.height - 1);
        const float weight = (i ? fx : 1.0f - fx) * (j ? fy : 1.0f - fy);
        sum_x += weight * field_.x.row(v)[u], sum_y += weight * field_.y.row(v)[u];
      }
    const float length = std::hypot(sum_x, sum_y);
    if (!(length > 0.01f)) return {0.0f, 0.0f};
    const float cosine = std::sqrt(std::max(0.5f + 0.5f * sum_x / length, 0.0f));
    const float sine = std::copysign(std::sqrt(std::max(0.5f - 0.5f * sum_x / length, 0.0f)), sum_y);
    const Vector d = {cosine, sine};
    return dot(d, before) < 0.0f ? Vector{-d.x, -d.y} : d;
  }

  bool is_surface(Point p) const {
    const int x = int(std::floor(p.x)), y = int(std::floor(p.y));
    if (x < 0 || y < 0 || x >= field_.width || y >= field_.height) return false;
    return field_.x.row(y)[x] != 0.0f || field_.y.row(y)[x] != 0.0f;
  }

  /// Returns whether one surface contains both points, which are at most a few pixels apart.
  bool connects(Point a, Point b) const {
    int x = int(std::floor(a.x)), y = int(std::floor(a.y));
    const int end_x = int(std::floor(b.x)), end_y = int(std::floor(b.y));
    while (x != end_x || y != end_y) {
      if (x != end_x) {
        const int to = x + (end_x > x ? 1 : -1);
        if (breaks(std::min(x, to), y) & kHatchingBreakRight) return false;
        x = to;
      }
      if (y != end_y) {
        const int to = y + (end_y > y ? 1 : -1);
        if (breaks(x, std::min(y, to)) & kHatchingBreakBelow) return false;
        y = to;
      }
    }
    return true;
  }

 private:
  int breaks(int x, int y) const { return int(field_.breaks.row(y)[x]); }

  const HatchingField& field_;
};

class Tracer {
 public:
  explicit Tracer(const HatchingField& field)
      : directions_(field),
        points_(field.width, field.height, field.spacing_px),
        spacing_(field.spacing_px),
        step_(field.spacing_px * kStepFraction) {}

  /// Adds lines of one rank, beside the existing ones and from seeds.
  void fill(int rank, const std::vector<Point>& seeds) {
    distance_ = spacing_ * float(1 << (kHatchingRanks - 1 - rank));
    std::deque<std::size_t> queue;
    for (const Point& seed : seeds) add(seed, kSeedFraction, rank, queue);
    queue.clear();
    for (std::size_t k = 0; k < lines_.size(); ++k) queue.push_back(k);
    for (; !queue.empty(); queue.pop_front()) add_beside(queue.front(), rank, queue);
  }

  std::vector<HatchingLine> take() {
    for (std::size_t k = 0; k < lines_.size(); ++k) look_beside(int(k), lines_[k]);
    return std::move(lines_);
  }

 private:
  /// Finds room and level of a line from the lines beside it. The levels of those before it are known.
  void look_beside(int index, HatchingLine& line) const {
    const float max = kMaxGap * spacing_, widest = kStopFraction * spacing_ * float(1 << (kHatchingRanks - 1));
    for (std::size_t k = 0; k < line.points.size(); ++k) {
      if (k % kRoomSteps != 0) {
        line.room.push_back(line.room.back()), line.level.push_back(line.level.back());
        continue;
      }
      const Vector d = directions_.at(line.points[k], {1.0f, 0.0f});
      std::array<float, 2> gaps = {max, max};
      auto level = float(line.rank);
      points_.for_points_beside(line.points[k], max, d, 0.5f * spacing_, index, [&](int other, int step, float side) {
        float& gap = gaps[side > 0.0f ? 1 : 0];
        gap = std::min(gap, std::abs(side));
        if (other > index || std::abs(side) * std::exp2(level) >= widest) return;
        if (lines_[std::size_t(other)].level[std::size_t(step + seeds_[std::size_t(other)])] <= level)
          level = std::min(std::log2(widest / std::max(std::abs(side), 1e-3f)), float(kHatchingRanks - 1));
      });
      float room = 0.0f;
      for (const float gap : gaps) room += 0.5f * (gap < max ? gap : spacing_);
      line.room.push_back(room), line.level.push_back(level);
    }
  }

  void add_beside(std::size_t line, int rank, std::deque<std::size_t>& queue) {
    for (std::size_t k = 0; k < lines_[line].points.size(); k += 2) {
      const Point p = lines_[line].points[k];
      const Vector d = directions_.at(p, {1.0f, 0.0f});
      for (const float side : {-distance_, distance_}) {
        const Point seed = {p.x - side * d.y, p.y + side * d.x};
        add(seed, 0.99f, rank, queue);
      }
    }
  }

  void add(Point seed, float fraction, int rank, std::deque<std::size_t>& queue) {
    const int line = int(lines_.size());
    if (!directions_.is_surface(seed) || points_.is_near(seed, distance_ * fraction, {1.0f, 0.0f}, distance_, line, 0))
      return;
    points_.add(seed, line, 0);
    const Vector forward = directions_.at(seed, {1.0f, 0.0f});
    const auto [after, free_end] = half_line(seed, forward, line, 1);
    const auto [before, free_start] = half_line(seed, {-forward.x, -forward.y}, line, -1);
    if (float(after.size() + before.size()) * step_ < kMinLength * std::max(distance_, 2.0f * spacing_)) {
      for (auto p = before.rbegin(); p != before.rend(); ++p) points_.remove_last(*p);
      for (auto p = after.rbegin(); p != after.rend(); ++p) points_.remove_last(*p);
      points_.remove_last(seed);
      return;
    }
    HatchingLine added{rank, free_start, free_end, {before.rbegin(), before.rend()}, {}, {}, {}, {}};
    seeds_.push_back(int(before.size()));
    added.points.push_back(seed);
    added.points.insert(added.points.end(), after.begin(), after.end());
    queue.push_back(lines_.size());
    lines_.push_back(std::move(added));
  }

  /// Follows the directions by the midpoint rule, and adds the points to the grid. `sign` is that of their steps.
  /// Returns them, and whether the line ends beside another one.
  std::pair<std::vector<Point>, bool> half_line(Point p, Vector d, int line, int sign) {
    std::vector<Point> points;
    for (int k = 1; k < kMaxSteps; ++k) {
      const Vector start = directions_.at(p, d);
      const Point middle = {p.x + 0.5f * step_ * start.x, p.y + 0.5f * step_ * start.y};
      const Vector along = directions_.at(middle, start);
      const Point next = {p.x + step_ * along.x, p.y + step_ * along.y};
      if (dot(along, d) < kMinTurnCosine || !directions_.is_surface(next) || !directions_.connects(p, next)) break;
      if (points_.is_near(next, spacing_ * kStopFraction, along, kAhead * spacing_, line, sign * k))
        return {points, true};
      points_.add(next, line, sign * k);
      points.push_back(next);
      p = next;
      d = along;
    }
    return {points, false};
  }

  Directions directions_;
  HatchingPoints points_;
  float spacing_, step_, distance_ = 0.0f;
  std::vector<HatchingLine> lines_;
  std::vector<int> seeds_;  // of each line, the index of the point from which it was traced
};

}  // namespace

std::vector<HatchingLine> trace_hatching(const HatchingField& field, const HatchingSeeds& seeds) {
  Tracer tracer(field);
  for (int rank = 0; rank < kHatchingRanks; ++rank) tracer.fill(rank, seeds[std::size_t(rank)]);
  return tracer.take();
}

}  // namespace umbrage
