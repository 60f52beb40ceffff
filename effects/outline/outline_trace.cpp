// Implements trace_lines: decodes the edges of a picture and decides which of them become lines.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "chains/trace.h"
#include "effects/outline/outline_draw.h"
#include "effects/outline/outline_widths.h"

namespace umbrage {
namespace {

// Thresholds of a line's mean strength (Clarity). kFull is strength 1, the detection threshold, less a margin for
// rounding.
constexpr float kFaint = 0.6f, kClear = 0.8f, kFull = 0.97f;
// Lengths in pixels, which scale with the picture's height.
constexpr float kMeanRadius = 4.0f;  // distance on either side of a point over which its mean strength is computed
constexpr float kMaxGap = 16.0f;     // max gap over which ends are joined
constexpr float kMinLoose = 24.0f;   // min length of a line with two free ends
constexpr float kMinBranch = 6.0f;   // min length of a line with one free end

/// Returns the edge that a code at a pixel means, or nothing if it means none or one outside the picture.
std::optional<Edge> decoded(float value, int x, int y, bool below, int width, int height) {
  const auto code = std::uint32_t(value);
  const auto kind = std::uint8_t(code & 3);
  Edge e{.x = x,
         .y = y,
         .below = below,
         .kind = kind,
         .step_kind = std::uint8_t(kind == kOutlineId ? kOutlineCrease : kind),
         .strength = float(code >> 2 & 127) / 31.0f,
         .place = float(code >> 9 & 127) / 127.0f};
  (below ? e.y : e.x) += int(code >> 16) - kOutlineMaxWindow;
  const bool inside = e.x >= 0 && e.y >= 0 && e.x + !below < width && e.y + below < height;
  return inside && kind != 0 ? std::optional(e) : std::nullopt;
}

/// Returns the edges that outline_edges has written, except in blocks that contain noise.
std::vector<Edge> read_edges(const HostPlane& right, const HostPlane& below, int width, int height) {
  constexpr int kRows = 32;  // of a block
  std::vector<std::vector<Edge>> found;
  found.resize(std::size_t((height + kRows - 1) / kRows));
  tbb::parallel_for(std::size_t(0), found.size(), [&](std::size_t block) {
    const int first = int(block) * kRows;
    std::vector<Edge> edges;
    for (int y = first; y < std::min(first + kRows, height); ++y)
      for (const bool is_below : {false, true}) {
        const float* row = (is_below ? below : right).row(y);
        for (int x = 0; x < width; ++x)
          if (row[x] > 0.0f)
            if (const auto e = decoded(row[x], x, y, is_below, width, height)) edges.push_back(*e);
      }
    found[block] = without_noise(std::move(edges), width);
  });
  std::vector<Edge> all;
  for (const std::vector<Edge>& block : found) all.insert(all.end(), block.begin(), block.end());
  return all;
}

float surface_depth(float depth) { return depth > 0.0f && depth <= 3.4e38f ? depth : 0.0f; }

/// Sets the surfaces at a point: depth and object of the nearer one, and the distance in depth of the other one behind
/// it, in pixel sizes, or infinity if that is another object.
void set_surfaces(const Edge& e, const HostPlane& depth, const HostPlane& object, const PixelSize& pixel,
                  ChainPoint& p) {
  const int x2 = e.x + !e.below, y2 = e.y + e.below;
  const float z1 = surface_depth(depth.row(e.y)[e.x]), z2 = surface_depth(depth.row(y2)[x2]);
  const float id1 = object.row(e.y)[e.x], id2 = object.row(y2)[x2];
  const bool first = z2 == 0.0f || (z1 > 0.0f && z1 <= z2);
  p.depth = first ? z1 : z2;
  const float id = first ? id1 : id2;
  p.object = std::abs(id) < 1e9f ? int(id) : 0;
  const bool within = e.kind == kOutlineCrease || (e.kind == kOutlineDepth && id1 == id2);
  p.drop = within ? std::abs(z1 - z2) / std::max(pixel.at(p.depth), 1e-30f) : std::numeric_limits<float>::infinity();
}

/// Returns the min length of a line in pixels. A line between objects may be short, unless both its ends are free or it
/// is closed.
float min_length(const Chain& chain, int free_ends, float scale) {
  const bool alone = free_ends == 2 || chain.closed;
  if (std::any_of(chain.points.begin(), chain.points.end(), [](const auto& p) { return p.kind == kOutlineId; }))
    return alone ? 2.0f * kMinBranch * scale : 0.0f;
  if (free_ends == 0 && !chain.closed)
    return 0.5f * kMinBranch * std::max(scale, 1.0f);  // shorter ones are artefacts of the pixel grid
  return (alone ? kMinLoose : kMinBranch) * scale;
}

}  // namespace

Strokes trace_lines(const HostFrame& frame) {
  const auto& c = *static_cast<const OutlineConstants*>(frame.constants);
  const int width = frame.frame.width, height = frame.frame.height;
  const HostPlane &depth = frame.input("depth"), &object = frame.input("object_id");
  const PixelSize pixel{frame.frame.ray_scale_x, frame.frame.orthographic == 0};
  Tracing t{EdgeGraph(read_edges(frame.input("outline_edge_right"), frame.input("outline_edge_below"), width, height),
                      width, height)};
  find_chains(t);
  tbb::parallel_for(std::size_t(0), t.chains.size(), [&](std::size_t k) {
    for (ChainPoint& p : t.chains[k].points) set_surfaces(t.graph[p.edge], depth, object, pixel, p);
  });
  join_at_junctions(t);
  keep_clear_parts(t, {kFaint, kClear, kFull, std::max(1, int(std::lround(kMeanRadius * c.scale)))});
  bridge_gaps(t, kMaxGap * c.scale, pixel);
  drop_short(t, [&](const Chain& chain, int free_ends) { return min_length(chain, free_ends, c.scale); });
  const std::vector<std::uint8_t> free_ends = t.free_ends();
  smooth_chains(t);
  connect_ends(t);
  return lines_of(t, free_ends, c, !pixel.perspective);
}

}  // namespace umbrage
