// Embree 3 or 4. The only header that knows which: other code has the types that both share, and the context and the
// calls below.
#pragma once
#if UMBRAGE_EMBREE >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <cstddef>
#include <cstring>

namespace umbrage {

/// Whether the rays of a packet have similar paths, such as those of neighbouring pixels from one camera.
enum class Coherence { kCoherent, kIncoherent };

#if UMBRAGE_EMBREE >= 4
using EmbreeContext = RTCRayQueryContext;
#else
using EmbreeContext = RTCIntersectContext;
#endif

/// The context of a query: its rays pass through blended surfaces with less than `min_opacity`.
struct RayContext {
  EmbreeContext embree{};  ///< first member: Embree passes its address to filter functions
  float min_opacity;
  Coherence coherence;

  RayContext(Coherence rays, float opacity) : min_opacity(opacity), coherence(rays) {
#if UMBRAGE_EMBREE >= 4
    rtcInitRayQueryContext(&embree);
#else
    rtcInitIntersectContext(&embree);
    embree.flags =
        rays == Coherence::kCoherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
#endif
  }
};

/// Returns how many rays of a packet to pass to Embree at a time: 16, 8 or 4. Embree 3 splits packets for which it has
/// no kernels itself; Embree 4 traces them ray by ray, which takes up to 2.75 times as long.
inline int packet_width(RTCDevice device) {
#if UMBRAGE_EMBREE >= 4
  if (rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED)) return 16;
  return rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) ? 8 : 4;
#else
  static_cast<void>(device);
  return 16;
#endif
}

#if UMBRAGE_EMBREE >= 4

/// Embree's arguments of a query, with its flags.
template <class Arguments>
Arguments embree_arguments(RayContext& context, void (*init)(Arguments*)) {
  Arguments arguments;
  init(&arguments);
  arguments.flags =
      context.coherence == Coherence::kCoherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
  arguments.context = &context.embree;
  return arguments;
}

using Intersect = RTCIntersectArguments;
using Occluded = RTCOccludedArguments;
inline void trace(const int* valid, RTCScene s, RTCRayHit4& rays, Intersect& a) { rtcIntersect4(valid, s, &rays, &a); }
inline void trace(const int* valid, RTCScene s, RTCRayHit8& rays, Intersect& a) { rtcIntersect8(valid, s, &rays, &a); }
inline void trace(const int* valid, RTCScene s, RTCRayHit16& rays, Intersect& a) {
  rtcIntersect16(valid, s, &rays, &a);
}
inline void trace(const int* valid, RTCScene s, RTCRay4& rays, Occluded& a) { rtcOccluded4(valid, s, &rays, &a); }
inline void trace(const int* valid, RTCScene s, RTCRay8& rays, Occluded& a) { rtcOccluded8(valid, s, &rays, &a); }
inline void trace(const int* valid, RTCScene s, RTCRay16& rays, Occluded& a) { rtcOccluded16(valid, s, &rays, &a); }

/// Traces a packet in parts of type Part. Each member of Embree's packets is an array with four bytes for each ray.
template <class Part, class Packet, class Arguments>
void trace_in_parts(const int* valid, RTCScene scene, Packet& packet, Arguments& arguments) {
  constexpr std::size_t kRay = 4, kWide = alignof(Packet) / kRay, kNarrow = alignof(Part) / kRay;
  constexpr std::size_t kMembers = sizeof(Packet) / (kWide * kRay);
  static_assert(sizeof(Part) == kMembers * kNarrow * kRay && kWide % kNarrow == 0);
  char* const rays = reinterpret_cast<char*>(&packet);
  for (std::size_t first = 0; first < kWide; first += kNarrow) {
    alignas(Part) int part_valid[kNarrow];
    std::copy_n(valid + first, kNarrow, part_valid);
    if (std::all_of(part_valid, part_valid + kNarrow, [](int v) { return v == 0; })) continue;
    Part part;
    char* const part_rays = reinterpret_cast<char*>(&part);
    for (std::size_t k = 0; k < kMembers; ++k)
      std::memcpy(part_rays + k * kNarrow * kRay, rays + (k * kWide + first) * kRay, kNarrow * kRay);
    trace(part_valid, scene, part, arguments);
    for (std::size_t k = 0; k < kMembers; ++k)
      std::memcpy(rays + (k * kWide + first) * kRay, part_rays + k * kNarrow * kRay, kNarrow * kRay);
  }
}

/// Finds the nearest hit of one ray.
inline void intersect(RTCScene scene, RayContext& context, RTCRayHit& ray) {
  auto arguments = embree_arguments(context, rtcInitIntersectArguments);
  rtcIntersect1(scene, &ray, &arguments);
}
/// Finds the nearest hit of each ray of a packet. `width`: packet_width of the device.
inline void intersect(const int* valid, RTCScene scene, int width, RayContext& context, RTCRayHit8& rays) {
  auto arguments = embree_arguments(context, rtcInitIntersectArguments);
  if (width >= 8) return trace(valid, scene, rays, arguments);
  trace_in_parts<RTCRayHit4>(valid, scene, rays, arguments);
}
inline void intersect(const int* valid, RTCScene scene, int width, RayContext& context, RTCRayHit16& rays) {
  auto arguments = embree_arguments(context, rtcInitIntersectArguments);
  if (width >= 16) return trace(valid, scene, rays, arguments);
  if (width >= 8) return trace_in_parts<RTCRayHit8>(valid, scene, rays, arguments);
  trace_in_parts<RTCRayHit4>(valid, scene, rays, arguments);
}
/// Finds for each ray of a packet whether anything blocks it.
inline void occluded(const int* valid, RTCScene scene, int width, RayContext& context, RTCRay8& rays) {
  auto arguments = embree_arguments(context, rtcInitOccludedArguments);
  if (width >= 8) return trace(valid, scene, rays, arguments);
  trace_in_parts<RTCRay4>(valid, scene, rays, arguments);
}
inline void occluded(const int* valid, RTCScene scene, int width, RayContext& context, RTCRay16& rays) {
  auto arguments = embree_arguments(context, rtcInitOccludedArguments);
  if (width >= 16) return trace(valid, scene, rays, arguments);
  if (width >= 8) return trace_in_parts<RTCRay8>(valid, scene, rays, arguments);
  trace_in_parts<RTCRay4>(valid, scene, rays, arguments);
}

#else

inline void intersect(RTCScene scene, RayContext& context, RTCRayHit& ray) {
  rtcIntersect1(scene, &context.embree, &ray);
}
inline void intersect(const int* valid, RTCScene scene, int, RayContext& context, RTCRayHit8& rays) {
  rtcIntersect8(valid, scene, &context.embree, &rays);
}
inline void intersect(const int* valid, RTCScene scene, int, RayContext& context, RTCRayHit16& rays) {
  rtcIntersect16(valid, scene, &context.embree, &rays);
}
inline void occluded(const int* valid, RTCScene scene, int, RayContext& context, RTCRay8& rays) {
  rtcOccluded8(valid, scene, &context.embree, &rays);
}
inline void occluded(const int* valid, RTCScene scene, int, RayContext& context, RTCRay16& rays) {
  rtcOccluded16(valid, scene, &context.embree, &rays);
}

#endif

}  // namespace umbrage
