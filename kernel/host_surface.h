// Whether two pixels show the same surface, on the host: by the text of kernel/surface.kernel.h, which says what the
// functions of its names are.
#pragma once
#include "kernel/frame_constants.h"
#include "kernel/scalar.h"

namespace umbrage {

/// Of a picture: `frame` must have `orthographic` and the rays' scales and offsets. Positions and normals are in view
/// space; normals are unit.
struct HostSurface {
  FrameConstants frame{};

  /// Whether a pixel's depth is that of a surface.
  static bool is_surface(float depth);
  /// Of the centre of pixel (x, y) at a depth.
  scalar::Vec3 view_position(int x, int y, float depth) const;
  /// Scaled to length 1; towards the eye where it is 0 or no number.
  scalar::Vec3 unit_normal(scalar::Vec3 normal, scalar::Vec3 position) const;
  float plane_distance_px(scalar::Vec3 position, scalar::Vec3 normal, scalar::Vec3 there) const;
  float plane_distance(scalar::Vec3 position, scalar::Vec3 normal, scalar::Vec3 there, float tolerance_px) const;
};

}  // namespace umbrage
