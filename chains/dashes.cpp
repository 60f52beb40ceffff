// Implements dashes_of and with_dashes.
#include <algorithm>
#include <cmath>
#include <utility>

#include "chains/trace.h"

namespace umbrage {
namespace {

/// Appends the part of a polyline between two distances along it. `along` holds the distance of each point.
void append_part(const std::vector<StrokePoint>& points, const std::vector<float>& along, float from, float to,
                 std::vector<StrokePoint>& part) {
  const auto at = [&](float distance) {
    const auto next = std::upper_bound(along.begin(), along.end(), distance);
    const auto k = std::size_t(std::clamp<std::ptrdiff_t>(next - along.begin(), 1, std::ptrdiff_t(along.size()) - 1));
    const StrokePoint &a = points[k - 1], &b = points[k];
    const float f = std::clamp((distance - along[k - 1]) / std::max(along[k] - along[k - 1], 1e-6f), 0.0f, 1.0f);
    return StrokePoint{a.x + f * (b.x - a.x), a.y + f * (b.y - a.y), a.width + f * (b.width - a.width)};
  };
  part.push_back(at(from));
  for (std::size_t k = 0; k < points.size(); ++k)
    if (along[k] > from && along[k] < to) part.push_back(points[k]);
  part.push_back(at(to));
}

}  // namespace

std::vector<Stroke> dashes_of(const Stroke& line) {
  if (line.points.size() < 2 || !(line.dash > 0.0f && line.gap > 0.0f)) {
    Stroke solid = line;
    solid.dash = solid.gap = 0.0f;
    return {solid};
  }
  const std::vector<float> along = distances_along(line.points);
  const float length = along.back(), missing = line.closed ? 0.0f : line.gap;  // an open line has one gap less
  const float count = std::max(std::round((length + missing) / (line.dash + line.gap)), 1.0f);
  const float stretch = length / (count * (line.dash + line.gap) - missing);
  const float dash = line.dash * stretch, period = (line.dash + line.gap) * stretch;
  std::vector<Stroke> dashes;
  for (int k = 0; k < int(count); ++k) {
    const float from = float(k) * period;
    Stroke& part = dashes.emplace_back(Stroke{line.kind, line.object, false, {}});
    append_part(line.points, along, std::min(from, length), std::min(from + dash, length), part.points);
  }
  return dashes;
}

Strokes with_dashes(const Strokes& lines) {
  Strokes all{lines.width, lines.height, {}};
  for (const Stroke& line : lines.strokes)
    for (Stroke& dash : dashes_of(line)) all.strokes.push_back(std::move(dash));
  return all;
}

}  // namespace umbrage
