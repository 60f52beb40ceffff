#include "rays/short_rays.h"

#include <algorithm>

namespace umbrage {
// Lanes beyond the last ray repeat old numbers, or 0, and are idle: Embree reads them too (see RayPacket).
template <class Rays>
void ShortRays::load(int first, float length, Rays& rays, std::array<int, kWidth>& valid) const {
  const auto copy = [&](const std::array<float, kCapacity>& from, float* to) {
    std::copy_n(from.data() + first, kWidth, to);
  };
  copy(origins_[0], rays.org_x);
  copy(origins_[1], rays.org_y);
  copy(origins_[2], rays.org_z);
  copy(directions_[0], rays.dir_x);
  copy(directions_[1], rays.dir_y);
  copy(directions_[2], rays.dir_z);
  for (int k = 0; k < kWidth; ++k) {
    const bool set = first + k < size_;
    valid[std::size_t(k)] = set ? -1 : 0;
    rays.tnear[k] = set ? 0.0f : 1.0f;
    rays.tfar[k] = set ? length : 0.0f;
    rays.time[k] = 0.0f;
    rays.mask[k] = ~0u;
    rays.id[k] = 0;
    rays.flags[k] = 0;
  }
}

void ShortRays::find_blocked(const TracedScene& traced, float length) {
  RayContext context(Coherence::kIncoherent, kOpaque);
  for (int first = 0; first < size_; first += kWidth) {
    alignas(32) RTCRay8 rays;
    alignas(32) std::array<int, kWidth> valid;
    load(first, length, rays, valid);
    occluded(valid.data(), traced.rtc, traced.width, context, rays);
    std::copy_n(rays.tfar, kWidth, distances_.data() + first);
  }
}

void ShortRays::find_distances(const TracedScene& traced, float length) {
  RayContext context(Coherence::kIncoherent, kOpaque);
  for (int first = 0; first < size_; first += kWidth) {
    alignas(32) RTCRayHit8 rays{};
    alignas(32) std::array<int, kWidth> valid;
    load(first, length, rays.ray, valid);
    std::fill_n(rays.hit.geomID, kWidth, RTC_INVALID_GEOMETRY_ID);
    intersect(valid.data(), traced.rtc, traced.width, context, rays);
    std::copy_n(rays.ray.tfar, kWidth, distances_.data() + first);
  }
}

}  // namespace umbrage
