#include "gbuffers/steps.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_set>

namespace umbrage {
namespace {

constexpr std::size_t kMinLevels = 32, kMaxLevels = 65536;  // fewer may be plateaus of a model; 16 bits have no more

/// Distances to the pairs that are averaged, in pixels, and how often at each. kStepsMargin is their sum.
constexpr std::array<int, 6> kReaches = {16, 8, 4, 2, 1, 1};
constexpr int kRoundsPerReach = 3;

constexpr int kNoLevel = std::numeric_limits<int>::min() / 4;  // sums of four do not overflow

/// Returns a value that is linear on planes.
float linear(float depth, bool orthographic) { return orthographic ? depth : 1.0f / depth; }

/// Returns the index of the nearest level; kNoLevel where there is no surface.
int level_of(float depth, const std::vector<float>& levels) {
  if (!std::isfinite(depth)) return kNoLevel;
  const auto above = std::lower_bound(levels.begin(), levels.end(), depth);
  if (above == levels.begin()) return 0;
  if (above == levels.end()) return int(levels.size()) - 1;
  const int index = int(above - levels.begin());
  return *above - depth < depth - levels[std::size_t(index - 1)] ? index : index - 1;
}

/// Returns the different finite depths, ascending; empty if there are too many.
std::vector<float> different_depths(std::span<const Plane> bands) {
  std::unordered_set<float> found;
  for (const Plane& band : bands)
    for (int y = 0; y < band.height; ++y)
      for (int x = 0; x < band.width; ++x) {
        if (!std::isfinite(band.at(x, y))) continue;
        found.insert(band.at(x, y));
        if (found.size() > kMaxLevels) return {};
      }
  std::vector<float> levels(found.begin(), found.end());
  std::sort(levels.begin(), levels.end());
  return levels;
}

/// What three pixels in a row or column tell about the levels.
struct NeighbourCounts {
  long differing = 0;         ///< triples that are not all on one level
  long stepped = 0;           ///< of these: those that bend by about the difference of few levels, as steps do
  std::vector<float> slopes;  ///< differences of adjacent pixels in these, in pixels' widths at that depth
};

void count_triple(const std::array<float, 3>& depth, const std::vector<float>& levels, float pixel_size,
                  bool orthographic, NeighbourCounts& counts) {
  constexpr int kFewLevels = 2;
  constexpr float kMinBend = 0.5f;  // of the difference to a neighbour; surfaces that are not in steps bend less
  const float a = depth[0], b = depth[1], c = depth[2];
  if ((a == b && b == c) || !std::isfinite(a) || !std::isfinite(b) || !std::isfinite(c)) return;
  ++counts.differing;
  const int first = level_of(b, levels) - level_of(a, levels), second = level_of(c, levels) - level_of(b, levels);
  if (std::max(std::abs(first), std::abs(second)) > kFewLevels) return;
  const float before = linear(b, orthographic) - linear(a, orthographic),
              after = linear(c, orthographic) - linear(b, orthographic);
  if (std::abs(after - before) < kMinBend * std::max(std::abs(before), std::abs(after))) return;
  ++counts.stepped;
  counts.slopes.push_back(std::max(std::abs(b - a), std::abs(c - b)) / (pixel_size * (orthographic ? 1.0f : b)));
}

NeighbourCounts count_neighbours(std::span<const Plane> bands, const std::vector<float>& levels, float pixel_size,
                                 bool orthographic) {
  NeighbourCounts counts;
  for (const Plane& band : bands)
    for (int y = 1; y + 1 < band.height; ++y)
      for (int x = 1; x + 1 < band.width; ++x) {
        const float own = band.at(x, y);
        count_triple({band.at(x - 1, y), own, band.at(x + 1, y)}, levels, pixel_size, orthographic, counts);
        count_triple({band.at(x, y - 1), own, band.at(x, y + 1)}, levels, pixel_size, orthographic, counts);
      }
  return counts;
}

/// The intervals of the values of linear().
struct Intervals {
  std::vector<float> low, high;  ///< by level
};

Intervals intervals_of(const std::vector<float>& levels, bool orthographic, float unit) {
  Intervals intervals;
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const float limit = unit > 0.0f ? unit : std::numeric_limits<float>::infinity();
    const float below = std::max(levels[k > 0 ? k - 1 : 0], levels[k] - limit),
                above = std::min(levels[std::min(k + 1, levels.size() - 1)], levels[k] + limit);
    const float a = linear(below, orthographic), b = linear(above, orthographic);
    intervals.low.push_back(std::min(a, b));
    intervals.high.push_back(std::max(a, b));
  }
  return intervals;
}

/// The state of the smoothing: levels as stored, and values that are smoothed.
struct Smoothing {
  int width, height;
  std::vector<int> level;
  Plane value, next;

  int level_at(int x, int y) const { return level[std::size_t(y) * std::size_t(width) + std::size_t(x)]; }
  /// Adds what a pair tells about the value of a pixel, if both continue its surface: the pixels at the positions
  /// `near` and `far` on the line through it, in units of (dx, dy), on either side, or both on one side.
  void add_pair(int x, int y, int dx, int dy, int near, int far, float& sum, int& count) const {
    constexpr int kMaxBend = 2;  // levels of the pair about the pixel
    const int ax = x + near * dx, ay = y + near * dy, bx = x + far * dx, by = y + far * dy;
    const int own = level_at(x, y), a = level_at(ax, ay), b = level_at(bx, by);
    if (a == kNoLevel || b == kNoLevel) return;
    const bool opposite = near < 0;
    if (std::abs(opposite ? a + b - 2 * own : own + b - 2 * a) > kMaxBend) return;
    sum += opposite ? 0.5f * (value.at(ax, ay) + value.at(bx, by)) : 2.0f * value.at(ax, ay) - value.at(bx, by);
    ++count;
  }

  /// Adds the pair along an axis at a distance, or as far as the picture goes; on its border, a pair on one side.
  void add_axis(int x, int y, bool across, int reach, float& sum, int& count) const {
    const int at = across ? x : y, size = across ? width : height;
    const int room = std::min(at, size - 1 - at), dx = across ? 1 : 0, dy = across ? 0 : 1;
    if (room > 0) return add_pair(x, y, dx, dy, -std::min(reach, room), std::min(reach, room), sum, count);
    const int inwards = at == 0 ? 1 : -1, step = std::min(reach, (size - 1) / 2);
    if (step > 0) add_pair(x, y, inwards * dx, inwards * dy, step, 2 * step, sum, count);
  }

  /// Averages each pixel with the pairs at a distance, within its interval.
  void round(int reach, const Intervals& intervals) {
    tbb::parallel_for(0, height, [&](int y) {
      for (int x = 0; x < width; ++x) {
        const float own = value.at(x, y);
        const int of = level_at(x, y);
        next.at(x, y) = own;
        if (of == kNoLevel) continue;
        float sum = 0.0f;
        int count = 0;
        add_axis(x, y, true, reach, sum, count);
        add_axis(x, y, false, reach, sum, count);
        if (count == 0) continue;
        const float mean = 0.5f * (own + sum / float(count));  // with the pixel: pairs alone would leave a chequerboard
        next.at(x, y) = std::clamp(mean, intervals.low[std::size_t(of)], intervals.high[std::size_t(of)]);
      }
    });
    std::swap(value, next);
  }
};

}  // namespace

std::vector<float> depth_steps(std::span<const Plane> bands, float pixel_size, bool orthographic, float& unit) {
  constexpr double kMinStepped = 0.2;    // fraction of the differing triples
  constexpr double kMinPerLevel = 20.0;  // of them: a step shows at many pixels, a depth of a surface at few
  constexpr float kMinSlope = 0.02f;     // one step from pixel to pixel tilts the surface by more than a degree
  constexpr float kMinUnitSlope = 0.1f;  // of the unit: more than five degrees
  std::vector<float> levels = different_depths(bands);
  if (levels.size() < kMinLevels) return {};
  NeighbourCounts counts = count_neighbours(bands, levels, pixel_size, orthographic);
  const double needed = std::max(kMinStepped * double(counts.differing), kMinPerLevel * double(levels.size()));
  if (counts.slopes.empty()) return {};
  const auto median = counts.slopes.begin() + long(counts.slopes.size() / 2);
  std::nth_element(counts.slopes.begin(), median, counts.slopes.end());
  const bool are_seen = double(counts.stepped) >= needed && *median > kMinSlope;
  const float pixel = pixel_size * (orthographic ? 1.0f : levels[levels.size() / 2]);
  if (!are_seen && !(unit > kMinUnitSlope * pixel)) return {};
  if (are_seen) unit = 0.0f;
  return levels;
}

void add_levels(const Plane& depth, std::vector<float>& levels) {
  std::vector<float> missing;
  float last = levels.front();
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      const float d = depth.at(x, y);
      if (d == last || !std::isfinite(d)) continue;
      last = d;
      if (!std::binary_search(levels.begin(), levels.end(), d)) missing.push_back(d);
    }
  std::sort(missing.begin(), missing.end());
  missing.erase(std::unique(missing.begin(), missing.end()), missing.end());
  const auto middle = levels.insert(levels.end(), missing.begin(), missing.end());
  std::inplace_merge(levels.begin(), middle, levels.end());
}

Plane smoothed_steps(const Plane& depth, const Rows& own, const std::vector<float>& levels, bool orthographic,
                     float unit) {
  Smoothing state{depth.width, depth.height, std::vector<int>(std::size_t(depth.width) * std::size_t(depth.height)),
                  Plane(depth.width, depth.height), Plane(depth.width, depth.height)};
  tbb::parallel_for(0, depth.height, [&](int y) {
    for (int x = 0; x < depth.width; ++x) {
      state.level[std::size_t(y) * std::size_t(depth.width) + std::size_t(x)] = level_of(depth.at(x, y), levels);
      state.value.at(x, y) = std::isfinite(depth.at(x, y)) ? linear(depth.at(x, y), orthographic) : 0.0f;
    }
  });
  const Intervals intervals = intervals_of(levels, orthographic, unit);
  for (const int reach : kReaches)
    for (int round = 0; round < kRoundsPerReach; ++round) state.round(reach, intervals);
  Plane smooth(depth.width, own.count());
  for (int y = 0; y < own.count(); ++y)
    for (int x = 0; x < depth.width; ++x) {
      const int row = own.begin + y;
      smooth.at(x, y) =
          state.level_at(x, row) == kNoLevel ? depth.at(x, row) : linear(state.value.at(x, row), orthographic);
    }
  return smooth;
}

}  // namespace umbrage
