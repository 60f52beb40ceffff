// Decides on the host whether two pixels show the same surface, by functions of kernel/surface.kernel.h, which
// documents them.
#pragma once
#include "kernel/frame_constants.h"
#include "kernel/scalar.h"

namespace umbrage {

/// The functions for one picture. Of `frame`, `orthographic`, ray_scale_* and ray_offset_* must be set. Positions and
/// normals are in view space; normals are unit vectors.
struct HostSurface {
  FrameConstants frame{};

  /// Returns whether a pixel's depth is that of a surface.
  static bool is_surface(float depth);
  /// Returns the position of the centre of pixel (x, y) at a depth.
  scalar::Vec3 view_position(int x, int y, float depth) const;
  /// Returns the normal scaled to length 1, or the direction to the camera where it is 0 or NaN.
  scalar::Vec3 unit_normal(scalar::Vec3 normal, scalar::Vec3 position) const;
  float plane_distance_px(scalar::Vec3 position, scalar::Vec3 normal, scalar::Vec3 there) const;
  float plane_distance(scalar::Vec3 position, scalar::Vec3 normal, scalar::Vec3 there, float tolerance_px) const;
};

}  // namespace umbrage
