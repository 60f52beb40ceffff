#include "rays/ray_packet.h"

#include <algorithm>

namespace umbrage {
namespace {

constexpr float kIdleNear = 1.0f, kIdleFar = 0.0f;

}  // namespace

RayPacket::RayPacket() : rays_{} {
  std::fill_n(rays_.ray.tnear, kPacket, kIdleNear);
  std::fill_n(rays_.hit.geomID, kPacket, RTC_INVALID_GEOMETRY_ID);
}

void RayPacket::set_idle(int k) {
  rays_.ray.tnear[k] = kIdleNear;
  rays_.ray.tfar[k] = kIdleFar;
  valid_[std::size_t(k)] = 0;
}

bool RayPacket::any() const {
  return std::any_of(valid_.begin(), valid_.end(), [](int lane) { return lane != 0; });
}

void RayPacket::find_hits(const TracedScene& traced, Coherence coherence, float min_opacity) {
  if (!any()) return;
  RayContext context(coherence, min_opacity);
  intersect(valid_.data(), traced.rtc, traced.width, context, rays_);
}

void RayPacket::find_blocked(const TracedScene& traced, Coherence coherence, float min_opacity) {
  if (!any()) return;
  RayContext context(coherence, min_opacity);
  occluded(valid_.data(), traced.rtc, traced.width, context, rays_.ray);
}

}  // namespace umbrage
