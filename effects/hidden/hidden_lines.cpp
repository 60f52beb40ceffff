// Implements the tracing and drawing of hidden lines.
#include "effects/hidden/hidden_lines.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "chains/grid.h"
#include "chains/trace.h"

namespace umbrage {
namespace {

// Lengths in pixels, which scale with the picture's height.
constexpr float kHiddenMaxGap = 16.0f;    // max gap over which ends are joined
constexpr float kCrossing = 12.0f;        // pixels: min of that gap, not scaled, for lines that cross a visible one
constexpr float kHiddenMinLoose = 16.0f;  // min length of a line with two free ends
constexpr float kHiddenMinBranch = 6.0f;  // min length of a line with one free end
constexpr float kSpeckle = 6.0f;          // max length of a line of a speckle, dashes with their gaps
constexpr float kCrowd = 2.0f;            // dashes: distance of the lines around a point of a speckle
constexpr float kOneLine = 1.5f;  // pixels: distance, not scaled, up to which the pixel grid draws one line as two

/// Returns the object of the nearest surface behind the visible one at a point, else that of the visible one.
int object_at(const HostFrame& frame, const StrokePoint& p) {
  const int x = std::clamp(int(p.x), 0, frame.frame.width - 1), y = std::clamp(int(p.y), 0, frame.frame.height - 1);
  for (const char* plane : {"layer1.object_id", "object_id"})
    if (const float id = frame.input(plane).row(y)[x]; id >= 0.0f && id < 1e9f) return int(id);
  return -1;
}

/// Calls use(first, last) for each run of points whose flag is `value`.
template <class Use>
void for_runs(const std::vector<std::uint8_t>& flags, std::uint8_t value, const Use& use) {
  for (std::size_t first = 0, end = 0; first < flags.size(); first = end + (end == first)) {
    for (end = first; end < flags.size() && flags[end] == value;) ++end;
    if (end > first) use(first, end - 1);
  }
}

/// The points of lines that are drawn, per chain.
using Drawn = std::vector<std::vector<std::uint8_t>>;

/// Returns which points of a chain lie on drawn lines, or on the chain where it came by before: within `reach` pixels,
/// and in their direction unless the whole chain is as near. So lines that cross remain.
std::vector<std::uint8_t> points_on_drawn(const Tracing& t, std::size_t number, const PointGrid& grid,
                                          const Drawn& drawn, float reach) {
  const Chain& chain = t.chains[number];
  const std::vector<float> along = distances_along(chain.points);
  constexpr float kTurned = 4.0f;  // min way, in units of `reach`, from a point to where the chain comes by again
  const auto was_here = [&](std::size_t now, std::size_t then) {
    const float way = along[now] - along[then];
    return then < now && (chain.closed ? std::min(way, along.back() - way) : way) > kTurned * reach;
  };
  std::vector<std::uint8_t> on(along.size(), 0);
  std::size_t beside = 0;
  for (std::size_t k = 0; k < on.size(); ++k) {
    const auto [dx, dy] = chain_direction_at(chain, int(k));
    bool near = false;
    grid.near(chain.points[k].x, chain.points[k].y, reach, [&](const PointGrid::Entry& e, float) {
      const auto other = std::size_t(e.chain), point = std::size_t(e.point);
      if (other == number ? !was_here(k, point) || on[point] : !drawn[other][point]) return;
      near = true;
      on[k] = on[k] || std::abs(e.dx * dx + e.dy * dy) >= kMinStraightCosine;
    });
    beside += near;
  }
  if (beside == on.size()) std::fill(on.begin(), on.end(), std::uint8_t(1));
  return on;
}

/// Removes what lies within `reach` pixels of a longer line, so that lines that coincide are drawn once: their dashes
/// would fill each other's gaps. Parts up to `min_px` long that remain are removed, too, and dots. Ends that face each
/// other within `max_gap` pixels are joined, so that dashes are measured along all of a line.
void draw_once(Tracing& t, float reach, float min_px, float max_gap) {
  std::vector<float> length;
  Drawn drawn;
  for (const Chain& chain : t.chains) length.push_back(length_of(chain)), drawn.emplace_back(chain.points.size(), 0);
  std::vector<std::size_t> order(t.chains.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return length[a] > length[b]; });
  const PointGrid grid(t.chains, t.graph.width(), t.graph.height());
  std::vector<Chain> kept;
  for (const std::size_t k : order) {
    const std::vector<ChainPoint>& points = t.chains[k].points;
    const std::vector<std::uint8_t> on = points_on_drawn(t, k, grid, drawn, reach);
    for (auto first = on.begin(), end = first; first != on.end(); first = end) {
      end = std::find(first, on.end(), std::uint8_t(!*first));
      if (*first) continue;
      const auto from = first - on.begin(), to = end - on.begin();
      const bool whole = to - from == std::ptrdiff_t(on.size());
      Chain part{.points = {points.begin() + from, points.begin() + to}, .closed = t.chains[k].closed && whole};
      if (length_of(part) <= (whole ? reach : min_px)) continue;
      if (part.closed) part.points.pop_back();  // connect_ends repeats the first; bridge_gaps expects it once
      std::fill(drawn[k].begin() + from, drawn[k].begin() + to, std::uint8_t(1));
      for (ChainPoint& p : part.points) p.edge = p.node = -1;  // ends are joined to ends alone
      kept.push_back(std::move(part));
    }
  }
  t.chains = std::move(kept);
  bridge_gaps(t, max_gap, PixelSize());
  for (Chain& chain : t.chains)
    if (chain.closed) chain.points.push_back(ChainPoint(chain.points.front()));
}

/// Removes lines up to `max_px` long most points of which have other lines around them, within `reach` pixels as many
/// as two lines through the point. Lines that short and dense are a speckle without shape.
void drop_speckle(Tracing& t, float max_px, float reach) {
  const PointGrid grid(t.chains, t.graph.width(), t.graph.height());
  std::vector<Chain> kept;
  for (const Chain& chain : t.chains) {
    const auto number = int(&chain - t.chains.data());
    const auto is_crowded = [&](const ChainPoint& p) {
      int others = 0;
      grid.near(p.x, p.y, reach, [&](const PointGrid::Entry& e, float) { others += e.chain != number; });
      return float(others) > 4.0f * reach;  // a line has about a point per pixel
    };
    if (length_of(chain) > max_px ||
        2 * std::count_if(chain.points.begin(), chain.points.end(), is_crowded) <= std::ptrdiff_t(chain.points.size()))
      kept.push_back(chain);
  }
  t.chains = std::move(kept);
}

}  // namespace

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
  draw_once(t, std::max(c.width_px, kOneLine), kHiddenMinBranch * c.scale, kHiddenMaxGap * c.scale);
  drop_speckle(t, kSpeckle * (c.dash_px + c.gap_px), kCrowd * c.dash_px);
  all.strokes.resize(t.chains.size());
  tbb::parallel_for(std::size_t(0), t.chains.size(), [&](std::size_t k) {
    Stroke& line = all.strokes[k];
    line = {.kind = StrokeKind::kHidden, .closed = t.chains[k].closed, .dash = c.dash_px, .gap = c.gap_px};
    for (const ChainPoint& p : t.chains[k].points) line.points.push_back({p.x, p.y, c.width_px});
    line.points = simplified(line.points);
    line.object = object_at(frame, line.points[line.points.size() / 2]);
  });
  return all;
}

}  // namespace umbrage
