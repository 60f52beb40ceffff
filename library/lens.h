// Lens: the meaning of depth in another renderer's G-buffer, and the window of its camera. Used by renderer/ and
// library/.
#pragma once
#include "core/gbuffer.h"
#include "core/result.h"
#include "renderer/request.h"

namespace umbrage {

struct Lens {
  int width = 0, height = 0;
  DepthMeaning depth_kind = DepthMeaning::kPlanar;
  float near_plane = 0.1f, far_plane = 0.0f;  ///< for kWindow and kReversed
  bool orthographic = false;
  float left = -1.0f, right = 1.0f, bottom = -1.0f, top = 1.0f;  ///< see GBufferSettings::window
  float scene_radius = 0.0f;
};

/// Returns the lens of a request that check_request has accepted.
Lens lens_of(const Request& request);

/// Returns whether depth of this kind is defined by a near and a far plane.
inline bool has_depth_planes(DepthMeaning kind) {
  return kind == DepthMeaning::kWindow || kind == DepthMeaning::kReversed;
}

/// Errors: kUsage.
Result<void> check_lens(const Lens& lens);

/// Sets the picture's size and camera.
void set_lens(const Lens& lens, PictureInfo& info);

}  // namespace umbrage
