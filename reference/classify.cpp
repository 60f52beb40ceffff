// classify(): silhouettes, thin objects and open surfaces from depth and normals.
//
// The basis is a test for a depth discontinuity between two neighbouring pixels. Each pixel has a tangent plane. On one
// smooth surface, however steep, each point is on the other point's plane. At a concave crease each point is in front
// of the other's plane, at a convex crease each is behind it: the planes meet between the pixels. There is a gap that
// neither plane explains only if the nearer point is in front of the plane of the farther point, and the farther point
// is behind the plane of the nearer point. At the silhouette of a round object the last pixel's plane may be so steep
// that it explains any gap. Therefore the pixel before the last one is tested, too.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "kernel/host_surface.h"
#include "reference/metrics.h"

namespace umbrage {
namespace {

// Tolerance of a point's distance from a plane, in pixel sizes (kernel/surface.kernel.h) per pixel between the two
// points. 1 allows for a round object: where it turns edge-on within n pixels of the picture, it falls behind its
// tangent plane by n pixel sizes.
constexpr float kTolerancePx = 1.0f;

// Silhouettes extend 2 pixels to either side of a discontinuity in a picture 1024 pixels high: the width over which a
// screen-space technique mixes both sides when it filters or lacks a neighbour.
constexpr double kSilhouetteFraction = 2.0 / 1024.0;
constexpr int kSilhouetteMin = 1;

// Thin objects are at most as wide as a tenth of a typical radius, which is a tenth of the height: samples step over
// them or treat them as thick.
constexpr double kThinFraction = 0.01;
constexpr int kThinMin = 2;

// The picture's border is about as wide as the inner half of a typical radius, where the samples with the largest
// weight lie.
constexpr double kBorderFraction = 0.04;
constexpr int kBorderMin = 1;

int scaled_size(int size, double fraction, int min) { return std::max(min, int(std::lround(size * fraction))); }

/// The visible surface point of a pixel, view space.
struct Surfel {
  bool covered = false;
  scalar::Vec3 point{}, normal{};
};

/// Computes the surfels of a G-buffer row by row.
class SurfelRows {
 public:
  explicit SurfelRows(const GBuffer& gbuffer) : depth_(gbuffer.layers[0].plane("depth")) {
    constexpr std::array<const char*, 3> kNames = {"normal.x", "normal.y", "normal.z"};
    for (int i = 0; i < 3; ++i) normal_[i] = gbuffer.layers[0].find(kNames[i]);
    const Camera& camera = gbuffer.info.camera;
    surface_.frame.orthographic = camera.projection == Projection::kOrthographic ? 1 : 0;
    surface_.frame.ray_scale_x = float((double(camera.right) - camera.left) / depth_.width);
    surface_.frame.ray_offset_x = camera.left;
    surface_.frame.ray_scale_y = float((double(camera.bottom) - camera.top) / depth_.height);
    surface_.frame.ray_offset_y = camera.top;
  }

  bool is_surface(int x, int y) const { return HostSurface::is_surface(depth_.at(x, y)); }

  void read(int y, Surfel* out) const {
    for (int x = 0; x < depth_.width; ++x) out[x] = at(x, y);
  }

  /// Returns whether the next pixel's point is in front of the surfel's plane by more than an error of the normal
  /// explains.
  bool is_in_front(const Surfel& surfel, const Surfel& point) const {
    return surface_.plane_distance(surfel.point, surfel.normal, point.point, kTolerancePx) > 1.0f;
  }

  /// Returns whether a point `pixels` pixels away is behind the surfel's plane. The normal is taken as exact: with an
  /// allowance for its error, the steep plane at a silhouette would explain any gap.
  bool is_behind(const Surfel& surfel, const Surfel& point, int pixels) const {
    return surface_.plane_distance_px(surfel.point, surfel.normal, point.point) < -kTolerancePx * float(pixels);
  }

 private:
  Surfel at(int x, int y) const {
    const float depth = depth_.at(x, y);
    if (!HostSurface::is_surface(depth)) return {};
    const scalar::Vec3 point = surface_.view_position(x, y, depth);
    scalar::Vec3 normal{};
    if (normal_[0] && normal_[1] && normal_[2])
      normal = {normal_[0]->at(x, y), normal_[1]->at(x, y), normal_[2]->at(x, y)};
    return {true, point, surface_.unit_normal(normal, point)};
  }

  HostSurface surface_;
  const Plane& depth_;
  std::array<const Plane*, 3> normal_{};
};

/// The direction of a depth discontinuity from a pixel to its neighbour, or none.
enum class Discontinuity : std::int8_t { kNone, kDown, kUp };  // kDown: the neighbour is farther

/// Returns the discontinuity between the middle two of four surfels in a line.
Discontinuity discontinuity_between(const SurfelRows& rows, const Surfel& before, const Surfel& pixel,
                                    const Surfel& neighbour, const Surfel& beyond) {
  if (!pixel.covered && !neighbour.covered) return Discontinuity::kNone;
  const bool down = !neighbour.covered || (pixel.covered && pixel.point.z >= neighbour.point.z);
  if (pixel.covered && neighbour.covered) {
    const Surfel &near = down ? pixel : neighbour, &far = down ? neighbour : pixel;
    const Surfel& next_to_near = down ? before : beyond;
    if (!rows.is_in_front(far, near)) return Discontinuity::kNone;
    if (!rows.is_behind(near, far, 1) && !(next_to_near.covered && rows.is_behind(next_to_near, far, 2)))
      return Discontinuity::kNone;
  }
  return down ? Discontinuity::kDown : Discontinuity::kUp;
}

/// The steps to the neighbours with which each pixel is compared. The neighbours on the opposite sides are compared
/// from there.
struct Step {
  int x, y;
};
constexpr std::array<Step, 4> kSteps = {{{1, 0}, {0, 1}, {1, 1}, {-1, 1}}};
constexpr int kStraightSteps = 2;  // the steps along the axes come first
constexpr int kMargin = 2;         // columns beyond the picture that lines of four surfels reach

/// The discontinuities between each pixel and its neighbours.
struct DiscontinuityMap {
  int width, height;
  std::array<std::vector<Discontinuity>, kSteps.size()> discontinuities;  ///< kNone beyond the picture

  bool inside(int x, int y) const { return x >= 0 && x < width && y >= 0 && y < height; }
  Discontinuity at(int step, int x, int y) const { return discontinuities[step][std::size_t(y) * width + x]; }
};

DiscontinuityMap find_discontinuities(const SurfelRows& surfels, int width, int height) {
  DiscontinuityMap map{width, height, {}};
  for (auto& discontinuities : map.discontinuities)
    discontinuities.assign(std::size_t(width) * height, Discontinuity::kNone);
  constexpr int kRowsPerTask = 32;  // rows per task: enough to outweigh the extra rows read above and below
  tbb::parallel_for(tbb::blocked_range<int>(0, height, kRowsPerTask), [&](const tbb::blocked_range<int>& rows) {
    // Rows y - 1 to y + 2; row r is stored at index r mod 4.
    std::array<std::vector<Surfel>, 4> window;
    const auto row = [&](int r) -> std::vector<Surfel>& { return window[(r + 4) % 4]; };
    const auto read = [&](int r) {
      row(r).assign(width + 2 * kMargin, {});
      if (r >= 0 && r < height) surfels.read(r, row(r).data() + kMargin);
    };
    for (int r = rows.begin() - 1; r <= rows.begin() + 1; ++r) read(r);
    for (int y = rows.begin(); y < rows.end(); ++y) {
      read(y + 2);
      for (int s = 0; s < int(kSteps.size()); ++s) {
        const auto [dx, dy] = kSteps[s];
        const auto at = [&, x0 = kMargin, dx = dx, dy = dy](int x, int n) -> const Surfel& {
          return row(y + n * dy)[x0 + x + n * dx];
        };
        for (int x = 0; x < width; ++x)
          if (map.inside(x + dx, y + dy))
            map.discontinuities[s][std::size_t(y) * width + x] =
                discontinuity_between(surfels, at(x, -1), at(x, 0), at(x, 1), at(x, 2));
      }
    }
  });
  return map;
}

/// Marks the pixels that are at most `reach` pixels from a discontinuity, along the axes; 1: only the pixels beside it.
std::vector<char> mark_silhouettes(const DiscontinuityMap& map, int reach) {
  const int width = map.width, height = map.height;
  const std::size_t size = std::size_t(width) * height;
  std::vector<char> beside(size, 0), along(size, 0), marked(size, 0);
  for (int s = 0; s < kStraightSteps; ++s)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        if (map.at(s, x, y) == Discontinuity::kNone) continue;
        beside[std::size_t(y) * width + x] = 1;
        beside[std::size_t(y + kSteps[s].y) * width + x + kSteps[s].x] = 1;
      }
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (!beside[std::size_t(y) * width + x]) continue;
      const int first = std::max(x - reach + 1, 0), last = std::min(x + reach - 1, width - 1);
      for (int i = first; i <= last; ++i) along[std::size_t(y) * width + i] = 1;
    }
  for (int y = 0; y < height; ++y) {
    const int first = std::max(y - reach + 1, 0), last = std::min(y + reach - 1, height - 1);
    for (int x = 0; x < width; ++x) {
      if (!along[std::size_t(y) * width + x]) continue;
      for (int j = first; j <= last; ++j) marked[std::size_t(j) * width + x] = 1;
    }
  }
  return marked;
}

/// Marks runs of at most `max` pixels along the step that begin after a kUp and end at a kDown.
void mark_runs(const DiscontinuityMap& map, int step, int max, std::vector<char>& marked) {
  const auto [dx, dy] = kSteps[step];
  for (int y0 = 0; y0 < map.height; ++y0)
    for (int x0 = 0; x0 < map.width; ++x0) {
      if (map.inside(x0 - dx, y0 - dy)) continue;
      constexpr int kNoRun = -1;
      int begin = kNoRun;
      for (int i = 0; map.inside(x0 + i * dx, y0 + i * dy); ++i) {
        const Discontinuity discontinuity = map.at(step, x0 + i * dx, y0 + i * dy);
        if (discontinuity == Discontinuity::kNone) continue;
        if (discontinuity == Discontinuity::kDown && begin != kNoRun && i - begin < max)
          for (int j = begin; j <= i; ++j) marked[std::size_t(y0 + j * dy) * map.width + x0 + j * dx] = 1;
        begin = discontinuity == Discontinuity::kUp ? i + 1 : kNoRun;
      }
    }
}

std::vector<char> mark_thin(const DiscontinuityMap& map, int width) {
  std::vector<char> marked(std::size_t(map.width) * map.height, 0);
  const int diagonal = std::max(1, int(width / std::numbers::sqrt2));
  for (int s = 0; s < int(kSteps.size()); ++s) mark_runs(map, s, s < kStraightSteps ? width : diagonal, marked);
  return marked;
}

}  // namespace

ClassMap classify(const GBuffer& gbuffer) {
  ClassMap map{gbuffer.info.width, gbuffer.info.height, {}};
  const Plane* depth = gbuffer.layers.empty() ? nullptr : gbuffer.layers[0].find("depth");
  if (depth) map.width = depth->width, map.height = depth->height;
  const int width = map.width, height = map.height;
  map.classes.assign(std::size_t(width) * height, PixelClass::kBackground);
  if (!depth) return map;

  const SurfelRows surfels(gbuffer);
  const DiscontinuityMap discontinuities = find_discontinuities(surfels, width, height);
  const auto silhouette = mark_silhouettes(discontinuities, scaled_size(height, kSilhouetteFraction, kSilhouetteMin));
  const auto thin = mark_thin(discontinuities, scaled_size(height, kThinFraction, kThinMin));
  const int border = scaled_size(std::min(width, height), kBorderFraction, kBorderMin);
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      if (!surfels.is_surface(x, y)) continue;
      const std::size_t i = std::size_t(y) * width + x;
      const bool near_border = std::min({x, y, width - 1 - x, height - 1 - y}) < border;
      map.classes[i] = near_border     ? PixelClass::kBorder
                       : thin[i]       ? PixelClass::kThin
                       : silhouette[i] ? PixelClass::kSilhouette
                                       : PixelClass::kOpen;
    }
  });
  return map;
}

}  // namespace umbrage
