// Implements smooth_chains, which fits parabolas to runs of points, and simplified.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "chains/trace.h"

namespace umbrage {
namespace {

constexpr float kMaxDeviation = 0.6f;  // max distance of points from the parabola fitted to them, pixels
constexpr float kMaxBend = 0.4f;       // max ratio of a parabola's quadratic coefficient to its linear one
constexpr int kMaxRun = 256;           // max number of points per parabola
constexpr int kRunsPerPoint = 16;      // approximate number of runs that contain a point

/// A parabola over u in [-1, 1], as coefficients of the polynomials 1, u and u^2 - mean_u2, which are orthogonal on
/// evenly spaced points.
struct Curve {
  float x0 = 0, x1 = 0, x2 = 0, y0 = 0, y1 = 0, y2 = 0;
  float step = 0, mean_u2 = 0;

  float u_of(int k) const { return float(k) * step - 1.0f; }
  std::array<float, 2> at(float u) const {
    const float q = u * u - mean_u2;
    return {x0 + x1 * u + x2 * q, y0 + y1 * u + y2 * q};
  }
};

using Positions = std::vector<std::array<float, 2>>;

/// Returns the least-squares parabola of points first to last; for at most six points a straight line.
Curve fitted(const Positions& p, int first, int last) {
  const int count = last - first + 1;
  Curve c{.step = 2.0f / float(count - 1), .mean_u2 = float(count + 1) / (3.0f * float(count - 1))};
  float u2 = 0.0f, q2 = 0.0f;
  const auto [ox, oy] = p[first];
  for (int k = 0; k < count; ++k) {
    const float u = c.u_of(k), q = u * u - c.mean_u2;
    const float x = p[first + k][0] - ox, y = p[first + k][1] - oy;
    c.x0 += x, c.x1 += u * x, c.x2 += q * x;
    c.y0 += y, c.y1 += u * y, c.y2 += q * y;
    u2 += u * u, q2 += q * q;
  }
  c.x0 = c.x0 / float(count) + ox, c.y0 = c.y0 / float(count) + oy;
  c.x1 /= u2, c.y1 /= u2;
  const float bend = count > 6 ? 1.0f / q2 : 0.0f;
  c.x2 *= bend, c.y2 *= bend;
  return c;
}

/// Returns whether all points of a run are within kMaxDeviation of their parabola, and the run does not turn back.
bool fits(const Positions& p, int first, int last) {
  if (last - first < 2) return true;
  const Curve c = fitted(p, first, last);
  const float length = length_of(c.x1, c.y1);
  constexpr float kMinAdvance = 0.4f;  // pixels per point; a run that advances less turns back
  if (length_of(c.x2, c.y2) > kMaxBend * length || length * c.step < kMinAdvance) return false;
  for (int k = first; k <= last; ++k) {
    const float u = c.u_of(k - first);
    const auto [x, y] = c.at(u);
    const float dx = c.x1 + 2.0f * c.x2 * u, dy = c.y1 + 2.0f * c.y2 * u;
    const float off = (p[k][0] - x) * dy - (p[k][1] - y) * dx;
    if (off * off > kMaxDeviation * kMaxDeviation * (dx * dx + dy * dy)) return false;
  }
  return true;
}

/// Moves each point to the weighted mean of the parabolas whose runs contain it. Runs are as long as a parabola fits
/// them. The weight of a parabola is larger the longer its run is and the nearer the point is to the run's middle.
void smooth_positions(Positions& p) {
  const int count = int(p.size());
  if (count < 3) return;
  std::vector<std::array<float, 3>> sum(p.size(), {0.0f, 0.0f, 0.0f});
  int last = 0, before = -1;
  for (int first = 0; first < count && before < count - 1; first += std::max(1, (last - first) / kRunsPerPoint)) {
    last = std::max(last, first);
    for (int by = 1; by > 0;) {
      const bool longer = last + by < count && last + by - first <= kMaxRun && fits(p, first, last + by);
      if (longer) last += by;
      by = longer ? 2 * by : by / 2;
    }
    if (last == before || last - first < 2) continue;
    before = last;
    const Curve c = fitted(p, first, last);
    const auto run = float(last - first + 1);
    for (int k = first; k <= last; ++k) {
      const float f = (float(k - first) + 0.5f) / run, weight = f * (1.0f - f) * run * run;
      const auto [x, y] = c.at(c.u_of(k - first));
      auto& s = sum[k];
      s[0] += weight * x, s[1] += weight * y, s[2] += weight;
    }
  }
  for (std::size_t k = 0; k < p.size(); ++k)
    if (sum[k][2] > 0.0f) p[k] = {sum[k][0] / sum[k][2], sum[k][1] / sum[k][2]};
}

void smooth(Chain& chain) {
  // A closed chain is extended at both ends by its own points, so that it is smooth there too.
  const int count = int(chain.points.size()), extra = chain.closed ? std::min(count, 100) : 0;
  Positions p;
  for (int k = -extra; k < count + extra; ++k) {
    const ChainPoint& point = chain.points[(k + count) % count];
    p.push_back({point.x, point.y});
  }
  smooth_positions(p);
  for (int k = 0; k < count; ++k) {
    chain.points[k].x = p[k + extra][0];
    chain.points[k].y = p[k + extra][1];
  }
}

}  // namespace

void smooth_chains(Tracing& t) {
  tbb::parallel_for(std::size_t(0), t.chains.size(), [&](std::size_t k) { smooth(t.chains[k]); });
}

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
