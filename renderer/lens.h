// What requests that bring a G-buffer say of its depth and camera, in fields of the same names. For renderer/ alone.
#pragma once
#include <cmath>

#include "core/gbuffer.h"
#include "core/result.h"
#include "renderer/options.h"

namespace umbrage {

/// Whether depth of that kind lies between two planes.
inline bool has_planes(DepthKind kind) { return kind == DepthKind::kWindow || kind == DepthKind::kReversed; }

/// Errors: kUsage.
template <class Request>
Result<void> check_lens(const Request& r) {
  for (const int side : {r.width, r.height})
    if (side < 1 || side > kLargestSide)
      return usage_error("a G-buffer cannot be {} pixels wide or high: 1 to {} can", side, kLargestSide);
  const bool planes = has_planes(r.depth_kind);
  if (planes && !(r.near_plane > 0.0f && std::isfinite(r.near_plane) && r.far_plane > r.near_plane))
    return usage_error("near_plane {} and far_plane {} cannot be: 0 < near_plane < far_plane can", r.near_plane,
                       r.far_plane);
  if (planes && r.orthographic && !std::isfinite(r.far_plane))
    return usage_error("an orthographic G-buffer needs a far_plane that is not at infinity");
  const bool sound = std::isfinite(r.left) && std::isfinite(r.right) && std::isfinite(r.bottom) &&
                     std::isfinite(r.top) && r.right != r.left && r.top != r.bottom;
  if (!sound)
    return usage_error("the camera's window cannot be {} to {} and {} to {}: it has a size", r.left, r.right, r.bottom,
                       r.top);
  if (!std::isfinite(r.scene_radius)) return usage_error("scene_radius cannot be {}", r.scene_radius);
  return {};
}

/// The picture's size and camera.
template <class Request>
void set_lens(const Request& r, PictureInfo& info) {
  info.width = r.width;
  info.height = r.height;
  info.camera.projection = r.orthographic ? Projection::kOrthographic : Projection::kPerspective;
  info.camera.left = r.left;
  info.camera.right = r.right;
  info.camera.bottom = r.bottom;
  info.camera.top = r.top;
}

}  // namespace umbrage
