// Lens: what the depth of another renderer's G-buffer means, and the window of its camera. For renderer/ and library/.
#pragma once
#include "core/gbuffer.h"
#include "core/result.h"
#include "renderer/request.h"

namespace umbrage {

struct Lens {
  int width = 0, height = 0;
  DepthMeaning depth_kind = DepthMeaning::kView;
  float near_plane = 0.1f, far_plane = 0.0f;  ///< of kWindow and kReversed
  bool orthographic = false;
  float left = -1.0f, right = 1.0f, bottom = -1.0f, top = 1.0f;  ///< see GBufferSettings::window
  float scene_radius = 0.0f;
};

/// Of a request that check_request has found good.
Lens lens_of(const Request& request);

/// Whether depth of that kind lies between two planes.
inline bool has_planes(DepthMeaning kind) { return kind == DepthMeaning::kWindow || kind == DepthMeaning::kReversed; }

/// Errors: kUsage.
Result<void> check_lens(const Lens& lens);

/// The picture's size and camera.
void set_lens(const Lens& lens, PictureInfo& info);

}  // namespace umbrage
