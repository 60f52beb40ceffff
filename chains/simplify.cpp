#include "chains/simplify.h"

#include <cmath>

namespace umbrage {
namespace {

constexpr float kTolerance = 0.05f;  // max distance of a removed point from the line, pixels; twice that for widths
constexpr int kMaxSkip = 8;          // max number of points that one segment replaces

/// Returns whether all points between `first` and `last` can be removed within the tolerance.
bool can_skip(const std::vector<StrokePoint>& p, std::size_t first, std::size_t last) {
  const StrokePoint &a = p[first], &b = p[last];
  const float dx = b.x - a.x, dy = b.y - a.y, length = std::hypot(dx, dy);
  if (length < 0.1f) return false;
  for (std::size_t k = first + 1; k < last; ++k) {
    const float f = float(k - first) / float(last - first);
    if (std::abs((p[k].y - a.y) * dx - (p[k].x - a.x) * dy) >= kTolerance * length) return false;
    if (std::abs(a.width + f * (b.width - a.width) - p[k].width) >= 2.0f * kTolerance) return false;
  }
  return true;
}

}  // namespace

std::vector<StrokePoint> simplified(const std::vector<StrokePoint>& p) {
  std::vector<StrokePoint> kept;
  for (std::size_t k = 0; k < p.size();) {
    kept.push_back(p[k]);
    std::size_t next = k + 1;
    while (next + 1 < p.size() && next < k + kMaxSkip && can_skip(p, k, next + 1)) ++next;
    k = next;
  }
  return kept;
}

}  // namespace umbrage
