#include "rays/ray_packet.h"

#include <algorithm>

namespace umbrage {
namespace {

constexpr float kIdleNear = 1.0f, kIdleFar = 0.0f;

RayContext make_context(Coherence coherence, float min_opacity) {
  RayContext context = ray_context(min_opacity);
  context.embree.flags =
      coherence == Coherence::kCoherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  return context;
}

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
  RayContext context = make_context(coherence, min_opacity);
  rtcIntersect16(valid_.data(), traced.rtc, &context.embree, &rays_);
}

void RayPacket::find_blocked(const TracedScene& traced, Coherence coherence, float min_opacity) {
  if (!any()) return;
  RayContext context = make_context(coherence, min_opacity);
  rtcOccluded16(valid_.data(), traced.rtc, &context.embree, &rays_.ray);
}

}  // namespace umbrage
