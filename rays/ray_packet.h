// Ray packets: up to 16 rays that are traced together. All code that traces more than one ray uses them. The size is
// always 16; Embree gets 8 or 4 rays at a time (rays/embree.h), which is faster.
#pragma once
#include <array>
#include <glm/vec3.hpp>

#include "rays/traced_scene.h"

namespace umbrage {

/// Rays in unit space, one for each lane that has been set; the other lanes are idle. All lanes always contain valid
/// numbers, since Embree reads idle lanes, too: where it has no kernels for a packet, its stream filter ignores the
/// mask and treats a lane as idle only if tnear > tfar (RenderKit/embree issues 301 and 520).
class alignas(64) RayPacket {
 public:
  RayPacket();

  /// Sets lane k to the ray origin + t direction, with t from `near` to `far`. The lane stays idle if the ray is
  /// invalid: components that are NaN or beyond kRayLimit, or `far` is NaN.
  void set(int k, glm::vec3 origin, glm::vec3 direction, float near, float far) {
    if (!within_ray_limit(origin) || !within_ray_limit(direction) || std::isnan(far)) return set_idle(k);
    for (int axis = 0; axis < 3; ++axis) {
      origins(axis)[k] = origin[axis];
      directions(axis)[k] = direction[axis];
    }
    set_range(k, near, far);
  }
  /// Sets only the range of t; the lane keeps its origin and direction.
  void set_range(int k, float near, float far) {
    rays_.ray.tnear[k] = near;
    rays_.ray.tfar[k] = far;
    rays_.ray.mask[k] = ~0u;
    rays_.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
    valid_[std::size_t(k)] = -1;
  }
  void set_idle(int k);

  /// One component of the origins and directions of all lanes, for vectorized loops.
  float* origins(int axis) { return axis == 0 ? rays_.ray.org_x : axis == 1 ? rays_.ray.org_y : rays_.ray.org_z; }
  float* directions(int axis) { return axis == 0 ? rays_.ray.dir_x : axis == 1 ? rays_.ray.dir_y : rays_.ray.dir_z; }

  bool is_set(int k) const { return valid_[std::size_t(k)] != 0; }
  bool any() const;  ///< whether any lane is set

  /// Finds the nearest hit of each ray. Rays pass through blended surfaces with less than `min_opacity`.
  void find_hits(const TracedScene& traced, Coherence coherence, float min_opacity = kOpaque);
  /// Finds for each ray whether anything blocks it.
  void find_blocked(const TracedScene& traced, Coherence coherence, float min_opacity = kOpaque);

  /// Returns whether ray k hit a surface. Valid after find_hits.
  bool hit(int k) const { return is_set(k) && rays_.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID; }
  float hit_distance(int k) const { return rays_.ray.tfar[k]; }  ///< t of the hit, after find_hits
  Surface surface(const TracedScene& traced, int k) const {
    return surface_at(traced, rays_.hit.geomID[k], rays_.hit.primID[k], rays_.hit.u[k], rays_.hit.v[k], origin(k),
                      direction(k), {rays_.hit.Ng_x[k], rays_.hit.Ng_y[k], rays_.hit.Ng_z[k]}, rays_.ray.tfar[k]);
  }
  /// Returns whether nothing blocked ray k. Valid after find_blocked.
  bool arrives(int k) const { return is_set(k) && !(rays_.ray.tfar[k] < 0.0f); }

  glm::vec3 origin(int k) const { return {rays_.ray.org_x[k], rays_.ray.org_y[k], rays_.ray.org_z[k]}; }
  glm::vec3 direction(int k) const { return {rays_.ray.dir_x[k], rays_.ray.dir_y[k], rays_.ray.dir_z[k]}; }

 private:
  RTCRayHit16 rays_;
  alignas(64) std::array<int, kPacket> valid_{};
};

}  // namespace umbrage
