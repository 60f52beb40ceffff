#include "library/lens.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gbuffers/camera_guess.h"
#include "gbuffers/depth_guess.h"
#include "renderer/recipe.h"

namespace umbrage {
namespace {

DepthMeaning meaning_in_memory(DepthMeaning given) {
  return given == DepthMeaning::kAuto ? DepthMeaning::kPlanar : given;
}

}  // namespace

Lens lens_of(const Request& request) {
  const GBufferSettings& g = request.gbuffer;
  std::vector<float> window = g.window;
  if (window.empty()) {
    const auto given = camera_of_intrinsics(g.focal_length_px, request.width, request.height);
    const Camera camera =
        given.value_or(assumed_camera(g.orthographic, double(request.width) / std::max(request.height, 1)));
    window = {camera.left, camera.right, camera.bottom, camera.top};
  }
  return {.width = request.width,
          .height = request.height,
          .depth_kind = meaning_in_memory(DepthMeaning(choice_index("depth_kind", g.depth_kind))),
          .near_plane = g.near_plane,
          .far_plane = g.far_plane != 0.0f ? g.far_plane : std::numeric_limits<float>::infinity(),
          .orthographic = g.orthographic,
          .left = window[0],
          .right = window[1],
          .bottom = window[2],
          .top = window[3],
          .scene_radius = g.scene_radius};
}

Result<void> check_lens(const Lens& lens) {
  for (const int side : {lens.width, lens.height})
    if (side < 1 || side > kMaxSide)
      return usage_error("a G-buffer cannot be {} pixels wide or high: it takes 1 to {}", side, kMaxSide);
  const bool planes = has_depth_planes(lens.depth_kind);
  if (planes && !(lens.near_plane > 0.0f && std::isfinite(lens.near_plane) && lens.far_plane > lens.near_plane))
    return with_field(
        field_error("near_plane", lens.near_plane,
                    "`{}` {} and `far_plane` {} are not valid: 0 < near_plane < far_plane is required", lens.far_plane),
        "far_plane");
  if (planes && lens.orthographic && !std::isfinite(lens.far_plane))
    return field_error("far_plane", "", "an orthographic G-buffer needs a `{}` that is not at infinity");
  const bool sound = std::isfinite(lens.left) && std::isfinite(lens.right) && std::isfinite(lens.bottom) &&
                     std::isfinite(lens.top) && lens.right != lens.left && lens.top != lens.bottom;
  if (!sound)
    return usage_error(
        "the camera's window cannot be {} to {} and {} to {}: they must be finite, right must differ from left, and "
        "top from bottom",
        lens.left, lens.right, lens.bottom, lens.top);
  if (!std::isfinite(lens.scene_radius))
    return field_error("scene_radius", lens.scene_radius, "`{}` cannot be '{}': it takes a finite number");
  return {};
}

void set_lens(const Lens& lens, PictureInfo& info) {
  info.width = lens.width;
  info.height = lens.height;
  info.camera.projection = lens.orthographic ? Projection::kOrthographic : Projection::kPerspective;
  info.camera.left = lens.left;
  info.camera.right = lens.right;
  info.camera.bottom = lens.bottom;
  info.camera.top = lens.top;
}

}  // namespace umbrage
