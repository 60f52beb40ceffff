#include "effects/outline/outline_draw.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "chains/chains.h"
#include "chains/trace.h"

namespace umbrage {
namespace {

/// Draws the segment from a to b into rows [first, end) of `cover`.
void draw_segment(const StrokePoint& a, const StrokePoint& b, float opacity, const HostPlane& cover, int columns,
                  int first, int end) {
  const float reach = 0.5f * std::max({a.width, b.width, 1.0f}) + 0.5f;
  const int y0 = std::max(first, int(std::floor(std::min(a.y, b.y) - reach)));
  const int y1 = std::min(end - 1, int(std::floor(std::max(a.y, b.y) + reach)));
  const int x0 = std::max(0, int(std::floor(std::min(a.x, b.x) - reach)));
  const int x1 = std::min(columns - 1, int(std::floor(std::max(a.x, b.x) + reach)));
  const float dx = b.x - a.x, dy = b.y - a.y, inverse = 1.0f / std::max(dx * dx + dy * dy, 1e-12f);
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const float px = float(x) + 0.5f - a.x, py = float(y) + 0.5f - a.y;
      const float f = std::clamp((px * dx + py * dy) * inverse, 0.0f, 1.0f);
      const float off = length_of(px - f * dx, py - f * dy), width = a.width + f * (b.width - a.width);
      const float inside = std::clamp(0.5f * std::max(width, 1.0f) + 0.5f - off, 0.0f, 1.0f) * std::min(width, 1.0f);
      float& at = cover.row(y)[x];
      at = std::max(at, inside * opacity);
    }
}

}  // namespace

void draw_lines(const Strokes& lines, float opacity, const HostPlane& cover) {
  constexpr int kRows = 32;  // rows per task
  struct Part {
    const StrokePoint *first, *last;
  };
  std::vector<std::vector<Part>> parts(std::size_t((lines.height + kRows - 1) / kRows));
  for (const Stroke& line : lines.strokes)
    for (std::size_t k = 0; k < line.points.size(); ++k) {
      const StrokePoint *a = &line.points[k], *b = a + (k + 1 < line.points.size());
      if (a == b && k > 0) continue;
      const float reach = 0.5f * std::max({a->width, b->width, 1.0f}) + 1.0f;
      const int top = int(std::min(a->y, b->y) - reach) / kRows, bottom = int(std::max(a->y, b->y) + reach) / kRows;
      for (int block = std::max(top, 0); block <= std::min(bottom, int(parts.size()) - 1); ++block)
        parts[block].push_back({a, b});
    }
  tbb::parallel_for(std::size_t(0), parts.size(), [&](std::size_t block) {
    const int first = int(block) * kRows, end = std::min(first + kRows, lines.height);
    for (int y = first; y < end; ++y) std::fill_n(cover.row(y), lines.width, 0.0f);
    for (const Part& part : parts[block])
      draw_segment(*part.first, *part.last, opacity, cover, lines.width, first, end);
  });
}

void add_lines(const Strokes& lines, const HostFrame& frame) {
  const HostPlane &before = frame.input("outline"), &cover = frame.output("outline");
  draw_lines(with_dashes(lines), 1.0f, cover);
  tbb::parallel_for(0, frame.frame.height, [&](int y) {
    for (int x = 0; x < frame.frame.width; ++x) cover.row(y)[x] = std::max(cover.row(y)[x], before.row(y)[x]);
  });
}

void run_host_outline(const HostFrame& frame) {
  draw_lines(trace_lines(frame), static_cast<const OutlineConstants*>(frame.constants)->opacity,
             frame.output("outline"));
}

}  // namespace umbrage
