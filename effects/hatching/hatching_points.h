// The points of hatching lines on a picture, for searches near a place. Internal to effects/hatching.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "effects/hatching/hatching_strokes.h"

namespace umbrage {

inline float dot(HatchingLine::Point a, HatchingLine::Point b) { return a.x * b.x + a.y * b.y; }

/// The points of all lines, by cells of one spacing.
class HatchingPoints {
 public:
  using Point = HatchingLine::Point;

  HatchingPoints(int width, int height, float cell_px)
      : cell_(cell_px),
        columns_(int(float(width) / cell_px) + 1),
        rows_(int(float(height) / cell_px) + 1),
        cells_(std::size_t(columns_) * std::size_t(rows_)) {}

  void add(Point p, int line, int step) { cells_[index(column(p.x), row(p.y))].push_back({p, line, step}); }
  /// Removes the point that was added last among those of its cell.
  void remove_last(Point p) { cells_[index(column(p.x), row(p.y))].pop_back(); }

  /// Returns whether a point is nearer than `distance`, and along the direction nearer than `ahead`, except those of
  /// the line itself near the step.
  bool is_near(Point p, float distance, Point direction, float ahead, int line, int step) const {
    const int left = column(p.x - distance), right = column(p.x + distance);
    const int top = row(p.y - distance), bottom = row(p.y + distance);
    for (int r = top; r <= bottom; ++r)
      for (int c = left; c <= right; ++c)
        for (const Entry& e : cells_[index(c, r)]) {
          if (e.line == line && std::abs(e.step - step) < kOwnSteps) continue;
          const float dx = e.at.x - p.x, dy = e.at.y - p.y;
          if (dx * dx + dy * dy < distance * distance && std::abs(dot({dx, dy}, direction)) < ahead) return true;
        }
    return false;
  }

  /// Calls `visit(line, step, side)` with points of other lines beside a point; `side` is their distance to the right
  /// of the direction. Those within `max` are among them.
  template <class Visit>
  void for_points_beside(Point p, float max, Point direction, float ahead, int line, const Visit& visit) const {
    for (int r = row(p.y - max); r <= row(p.y + max); ++r)
      for (int c = column(p.x - max); c <= column(p.x + max); ++c)
        for (const Entry& e : cells_[index(c, r)]) {
          const Point way = {e.at.x - p.x, e.at.y - p.y};
          if (e.line != line && std::abs(dot(way, direction)) <= ahead)
            visit(e.line, e.step, dot(way, {-direction.y, direction.x}));
        }
  }

 private:
  /// Nearby points of the same line that are no obstacle: three spacings.
  static constexpr int kOwnSteps = 18;
  struct Entry {
    Point at;
    int line, step;
  };
  int column(float x) const { return std::clamp(int(x / cell_), 0, columns_ - 1); }
  int row(float y) const { return std::clamp(int(y / cell_), 0, rows_ - 1); }
  std::size_t index(int c, int r) const { return std::size_t(r) * std::size_t(columns_) + std::size_t(c); }

  float cell_;
  int columns_, rows_;
  std::vector<std::vector<Entry>> cells_;
};

}  // namespace umbrage
