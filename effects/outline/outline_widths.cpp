#include "effects/outline/outline_widths.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "chains/grid.h"
#include "chains/trace.h"

namespace umbrage {
namespace {

// Lengths in pixels, which scale with the picture's height.
constexpr float kTaper = 12.0f;        // length over which a free end becomes narrower
constexpr float kEven = 6.0f;          // number of points on either side over which widths are averaged
constexpr float kFadeDistance = 4.5f;  // distance to a more reliable line within which a line fades

constexpr float kMaxCrowd = 75.0f;          // number of points within 16 x 16 pixels above which lines are crowded
constexpr float kParallel = 0.85f;          // min cosine between two directions that count as parallel
constexpr float kMinRelativeWidth = 0.05f;  // min fraction of the full width at which a line is visible
constexpr float kMaxCover = 0.6f;           // max fraction of the distance to the next line that a line may cover

/// Returns the relative width of a line at a point, 0 to 1.
float weight_of(const ChainPoint& p, const OutlineConstants& c, bool orthographic) {
  float weight = p.kind == kOutlineDepth ? 1.0f - c.inner * c.inner_px / (p.drop + c.inner_px) : 1.0f;
  if (c.inner > 0.0f) weight *= std::min(p.strength, 1.0f);
  if (!orthographic && p.depth > c.recede_from) weight *= 1.0f - c.recede * (1.0f - std::sqrt(c.recede_from / p.depth));
  return weight;
}

/// Averages a chain's widths along it, and tapers its free ends.
void smooth_widths(const Chain& chain, const OutlineConstants& c, std::span<const std::uint8_t, 2> is_free,
                   std::vector<float>& width) {
  const int count = int(width.size()), around = int(std::lround(std::max(kEven * c.scale, c.width_px)));
  std::vector<double> sum(1, 0.0);
  for (const float w : width) sum.push_back(sum.back() + w);
  for (int k = 0; k < count; ++k) {
    const int first = std::max(0, k - around), end = std::min(count, k + around + 1);
    width[k] = float((sum[end] - sum[first]) / (end - first));
  }
  const float taper = kTaper * c.scale;
  for (int last = 0; last < 2 && c.inner > 0.0f; ++last) {
    if (!is_free[last]) continue;
    float along = 0.0f;
    for (int k = 0; k < count && along < taper; ++k) {
      const auto at = std::size_t(last ? count - 1 - k : k), before = last ? at + 1 : at - 1;
      if (k > 0)
        along += length_of(chain.points[at].x - chain.points[before].x, chain.points[at].y - chain.points[before].y);
      width[at] *= 1.0f - c.inner * (1.0f - std::sqrt(std::min(1.0f, along / taper)));
    }
  }
}

/// Returns the mean confidence of a chain. Edges between ids rank above depth discontinuities, and these above creases;
/// among equals, a longer chain ranks higher.
float mean_confidence(const Chain& chain) {
  float sum = 0.0f;
  for (const ChainPoint& p : chain.points)
    sum += p.kind == kOutlineId ? 5.0f * kOutlineMaxStrength : p.kind == kOutlineDepth ? 2.0f * p.strength : p.strength;
  const auto count = float(chain.points.size());
  return sum / count + 1e-3f * std::min(count, 500.0f);
}

/// Makes lines narrower where they have little room. Two lines side by side each cover at most the fraction kMaxCover
/// of the distance between them, so that some colour remains visible there, but each keeps at least half of its width.
/// The less reliable one fades as it gets closer, since it may be a duplicate of the other. Where lines are crowded,
/// all become thinner, so that they give a grey tone.
void narrow_where_crowded(const Tracing& t, float scale, std::vector<std::vector<float>>& widths) {
  const PointGrid grid(t.chains, t.graph.width(), t.graph.height());
  const float beside = kFadeDistance * std::max(scale, 1.0f);  // not below what the pixel grid resolves
  std::vector<float> confidence(t.chains.size());
  tbb::parallel_for(std::size_t(0), confidence.size(),
                    [&](std::size_t c) { confidence[c] = mean_confidence(t.chains[c]); });
  tbb::parallel_for(std::size_t(0), t.chains.size(), [&](std::size_t c) {
    const Chain& chain = t.chains[c];
    for (std::size_t k = 0; k < chain.points.size(); k += 2) {  // the next point gets the same factor
      const ChainPoint& p = chain.points[k];
      const float width = widths[c][k], reach = std::max(width / kMaxCover, beside);
      const auto way = chain_direction_at(chain, int(k));
      float nearest = reach, nearest_reliable = beside;
      grid.near(p.x, p.y, reach, [&](const PointGrid::Entry& e, float d2) {
        if (e.chain == int(c) && float(std::abs(e.point - int(k))) < 2.0f * reach) return;
        if (std::abs(way[0] * e.dx + way[1] * e.dy) < kParallel) return;
        const float across = std::abs((e.x - p.x) * way[1] - (e.y - p.y) * way[0]);
        if (across * across < 0.5f * d2) return;  // ahead or behind, not beside
        nearest = std::min(nearest, across);
        if (confidence[e.chain] > confidence[c]) nearest_reliable = std::min(nearest_reliable, across);
      });
      float room = std::clamp(kMaxCover * nearest / std::max(width, 1e-6f), 0.5f, 1.0f);
      if (p.kind != kOutlineId) room *= std::clamp(2.0f * nearest_reliable / beside - 1.0f, 0.0f, 1.0f);
      room *= std::min(1.0f, kMaxCrowd / float(grid.count_around(p.x, p.y)));
      for (std::size_t at = k; at < std::min(k + 2, chain.points.size()); ++at) widths[c][at] *= room;
    }
  });
}

/// Returns the most frequent kind of a chain's points.
StrokeKind kind_of(const Chain& chain) {
  std::array<int, 4> count{};
  for (const ChainPoint& p : chain.points) ++count[p.kind];
  const auto kind = std::max_element(count.begin() + 1, count.end()) - count.begin();
  return kind == kOutlineCrease  ? StrokeKind::kCrease
         : kind == kOutlineDepth ? StrokeKind::kFold
                                 : StrokeKind::kOutline;
}

}  // namespace

Strokes lines_of(const Tracing& t, std::span<const std::uint8_t> free_ends, const OutlineConstants& c,
                 bool orthographic) {
  Strokes all{t.graph.width(), t.graph.height(), std::vector<Stroke>(t.chains.size())};
  std::vector<std::vector<float>> widths(t.chains.size());
  for (std::size_t k = 0; k < t.chains.size(); ++k)
    for (const ChainPoint& p : t.chains[k].points)
      widths[k].push_back(c.width_px * t.chains[k].weight * weight_of(p, c, orthographic));
  narrow_where_crowded(t, c.scale, widths);
  tbb::parallel_for(std::size_t(0), t.chains.size(), [&](std::size_t k) {
    const Chain& chain = t.chains[k];
    Stroke& line = all.strokes[k];
    line.closed = chain.closed;
    line.kind = kind_of(chain);
    line.object = chain.points[chain.points.size() / 2].object;
    std::vector<float>& width = widths[k];
    smooth_widths(chain, c, free_ends.subspan(2 * k).first<2>(), width);
    if (*std::max_element(width.begin(), width.end()) < kMinRelativeWidth * c.width_px) return;
    std::vector<StrokePoint> points;
    for (std::size_t p = 0; p < width.size(); ++p) points.push_back({chain.points[p].x, chain.points[p].y, width[p]});
    line.points = simplified(points);
  });
  std::erase_if(all.strokes, [](const Stroke& line) { return line.points.empty(); });
  return all;
}

}  // namespace umbrage
