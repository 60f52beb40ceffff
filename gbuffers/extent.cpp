#include "gbuffers/extent.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/lists.h"

namespace umbrage {
namespace {

constexpr int kSamples = 1 << 16;          // pixels to sample: more do not improve the estimate
constexpr double kOutlierFraction = 0.01;  // fraction of the pixels to ignore, on either side

}  // namespace

ExtentOfDepth::ExtentOfDepth(const PictureInfo& info)
    : info_(info),
      step_(std::max(1, int(std::sqrt(double(info.width) * info.height / kSamples)))),
      nearest_(std::numeric_limits<float>::infinity()) {}

void ExtentOfDepth::add(const float* depths, int y) {
  for (int x = 0; x < info_.width; ++x)
    if (std::isfinite(depths[x])) add_range(depths[x], depths[x]);
  add_sample(depths, y);
}

void ExtentOfDepth::add_range(float nearest, float farthest) {
  nearest_ = std::min(nearest_, nearest);
  farthest_ = std::max(farthest_, farthest);
}

void ExtentOfDepth::add_sample(const float* depths, int y) {
  if (y % step_ != 0) return;
  const Camera& camera = info_.camera;
  for (int x = 0; x < info_.width; x += step_) {
    const float d = depths[x];
    if (!std::isfinite(d)) continue;
    const float scale = camera.projection == Projection::kOrthographic ? 1.0f : d;
    along_[0].push_back(scale * (camera.left + (camera.right - camera.left) * float(x) / float(info_.width)));
    along_[1].push_back(scale * (camera.top + (camera.bottom - camera.top) * float(y) / float(info_.height)));
    along_[2].push_back(d);
  }
}

void ExtentOfDepth::finish(float scene_radius, PictureInfo& info) {
  if (scene_radius > 0.0f) info.scene_radius = scene_radius;
  if (nearest_ > farthest_) return;  // no surface is visible: the defaults remain
  info.depth_min = nearest_;
  info.depth_max = farthest_;
  if (scene_radius > 0.0f) return;
  std::array<float, 3> squares{};
  tbb::parallel_for(std::size_t(0), along_.size(), [&](std::size_t axis) {
    std::vector<float>& values = along_[axis];
    if (values.empty()) return;
    const float size =
        quantile_of_reordered(values, 1.0 - kOutlierFraction) - quantile_of_reordered(values, kOutlierFraction);
    squares[axis] = size * size;
  });
  const float square = squares[0] + squares[1] + squares[2];
  // If all samples coincide, for example because there is only one pixel, use the distance as the radius.
  info.scene_radius = square > 0.0f ? 0.5f * std::sqrt(square) : farthest_;
}

}  // namespace umbrage
