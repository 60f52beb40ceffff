// The extent of a scene of which only depth is known: range of depth, and bounding-sphere radius.
#pragma once
#include <array>
#include <vector>

#include "core/gbuffer.h"

namespace umbrage {

/// Collects rows of view depth, from top to bottom, and derives the extent.
class ExtentOfDepth {
 public:
  /// `info`: size and camera of the picture.
  explicit ExtentOfDepth(const PictureInfo& info);
  /// Adds row y; infinity means no surface.
  void add(const float* depths, int y);
  /// The two parts of add, for callers that know the range: a range of finite depths, which may be empty, and row y of
  /// the sample that the radius is estimated from.
  void add_range(float nearest, float farthest);
  void add_sample(const float* depths, int y);
  /// Sets depth_min, depth_max and, unless `scene_radius` is above 0, scene_radius: half the diagonal of the
  /// view-aligned box that contains nearly all visible points.
  void finish(float scene_radius, PictureInfo& info);

 private:
  PictureInfo info_;
  int step_;
  float nearest_, farthest_ = 0.0f;
  std::array<std::vector<float>, 3> along_;
};

}  // namespace umbrage
