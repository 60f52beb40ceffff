#include "kernel/host_surface.h"

#include "kernel/scalar_surface.h"

namespace umbrage {

using scalar::SurfaceText;
using scalar::Vec3;

bool HostSurface::is_surface(float depth) { return SurfaceText{}.is_surface(depth); }

Vec3 HostSurface::view_position(int x, int y, float depth) const {
  return SurfaceText{frame}.view_position(x, y, depth);
}

Vec3 HostSurface::unit_normal(Vec3 normal, Vec3 position) const {
  return SurfaceText{frame}.unit_normal(normal, position);
}

float HostSurface::plane_distance_px(Vec3 position, Vec3 normal, Vec3 there) const {
  return SurfaceText{frame}.plane_distance_px(position, normal, there);
}

float HostSurface::plane_distance(Vec3 position, Vec3 normal, Vec3 there, float tolerance_px) const {
  return SurfaceText{frame}.plane_distance(position, normal, there, tolerance_px);
}

}  // namespace umbrage
