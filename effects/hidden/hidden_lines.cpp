// Implements the tracing and drawing of hidden lines.
#include "effects/hidden/hidden_lines.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "chains/trace.h"

namespace umbrage {
namespace {

// Lengths in pixels, which scale with the picture's height.
constexpr float kHiddenMaxGap = 16.0f;    // max gap over which ends are joined
constexpr float kCrossing = 12.0f;        // pixels: min of that gap, not scaled, for lines that cross a visible one
constexpr float kHiddenMinLoose = 16.0f;  // min length of a line with two free ends
constexpr float kHiddenMinBranch = 6.0f;  // min length of a line with one free end

/// Returns the object of the nearest surface behind the visible one at a point, else that of the visible one.
int object_at(const HostFrame& frame, const StrokePoint& p) {
  const int x = std::clamp(int(p.x), 0, frame.frame.width - 1), y = std::clamp(int(p.y), 0, frame.frame.height - 1);
  for (const char* plane : {"layer1.object_id", "object_id"})
    if (const float id = frame.input(plane).row(y)[x]; id >= 0.0f && id < 1e9f) return int(id);
  return -1;
}

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

std::vector<Stroke> dashes_of(const Stroke& line, float dash_px, float gap_px) {
  if (line.points.size() < 2 || !(gap_px > 0.0f)) return {line};
  std::vector<float> along = {0.0f};
  for (std::size_t k = 1; k < line.points.size(); ++k)
    along.push_back(along.back() +
                    length_of(line.points[k].x - line.points[k - 1].x, line.points[k].y - line.points[k - 1].y));
  const float length = along.back(), missing = line.closed ? 0.0f : gap_px;  // an open line has one gap less
  const float count = std::max(std::round((length + missing) / (dash_px + gap_px)), 1.0f);
  const float stretch = length / (count * (dash_px + gap_px) - missing);
  const float dash = dash_px * stretch, period = (dash_px + gap_px) * stretch;
  std::vector<Stroke> dashes;
  for (int k = 0; k < int(count); ++k) {
    const float from = float(k) * period;
    Stroke& part = dashes.emplace_back(Stroke{line.kind, line.object, false, {}});
    append_part(line.points, along, std::min(from, length), std::min(from + dash, length), part.points);
  }
  return dashes;
}

Strokes hidden_lines(const HostFrame& frame) {
  const auto& c = *static_cast<const HiddenConstants*>(frame.constants);
  const int width = frame.frame.width, height = frame.frame.height;
  Strokes all{width, height, {}};
  std::vector<Edge> edges = hidden_edges(frame, c);
  if (edges.empty()) return all;
  Tracing t{EdgeGraph(std::move(edges), width, height)};
  find_chains(t);
  join_at_junctions(t);
  bridge_gaps(t, std::max(kHiddenMaxGap * c.scale, kCrossing), PixelSize());
  drop_short(t, [&](const Chain& chain, int free_ends) {
    return (free_ends == 2 || chain.closed ? kHiddenMinLoose : free_ends == 1 ? kHiddenMinBranch : 0.0f) * c.scale;
  });
  smooth_chains(t);
  connect_ends(t);
  std::vector<std::vector<Stroke>> dashes(t.chains.size());
  tbb::parallel_for(std::size_t(0), t.chains.size(), [&](std::size_t k) {
    Stroke line{.kind = StrokeKind::kHidden, .closed = t.chains[k].closed};
    for (const ChainPoint& p : t.chains[k].points) line.points.push_back({p.x, p.y, c.width_px});
    line.points = simplified(line.points);
    line.object = object_at(frame, line.points[line.points.size() / 2]);
    dashes[k] = dashes_of(line, c.dash_px, c.gap_px);
  });
  for (std::vector<Stroke>& lines : dashes)
    for (Stroke& line : lines) all.strokes.push_back(std::move(line));
  return all;
}

}  // namespace umbrage
