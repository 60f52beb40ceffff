// Embree 3 or 4. The only header that knows which: other code has the types that both share, and the context and the
// calls below. Devices are limited to the instruction set in use.
#pragma once
#if UMBRAGE_EMBREE >= 4
#include <embree4/rtcore.h>
#elif UMBRAGE_EMBREE == 3
#include <embree3/rtcore.h>
#else
#error "UMBRAGE_EMBREE is 3 or 4"
#endif

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string_view>

#include "core/result.h"

namespace umbrage {

struct Scene;  // scene/scene.h

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

#if UMBRAGE_EMBREE >= 4

template <class Arguments>
Arguments embree_arguments(RayContext& context, void (*init)(Arguments*)) {
  Arguments arguments;
  init(&arguments);
  arguments.flags =
      context.coherence == Coherence::kCoherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
  arguments.context = &context.embree;
  return arguments;
}
inline void trace(RTCScene scene, RTCRayHit& ray, RayContext& context) {
  auto arguments = embree_arguments(context, rtcInitIntersectArguments);
  rtcIntersect1(scene, &ray, &arguments);
}
inline void trace(const int* valid, RTCScene scene, RTCRayHit4& rays, RayContext& context) {
  auto arguments = embree_arguments(context, rtcInitIntersectArguments);
  rtcIntersect4(valid, scene, &rays, &arguments);
}
inline void trace(const int* valid, RTCScene scene, RTCRayHit8& rays, RayContext& context) {
  auto arguments = embree_arguments(context, rtcInitIntersectArguments);
  rtcIntersect8(valid, scene, &rays, &arguments);
}
inline void trace(const int* valid, RTCScene scene, RTCRay4& rays, RayContext& context) {
  auto arguments = embree_arguments(context, rtcInitOccludedArguments);
  rtcOccluded4(valid, scene, &rays, &arguments);
}
inline void trace(const int* valid, RTCScene scene, RTCRay8& rays, RayContext& context) {
  auto arguments = embree_arguments(context, rtcInitOccludedArguments);
  rtcOccluded8(valid, scene, &rays, &arguments);
}

#else

inline void trace(RTCScene scene, RTCRayHit& ray, RayContext& context) { rtcIntersect1(scene, &context.embree, &ray); }
inline void trace(const int* valid, RTCScene scene, RTCRayHit4& rays, RayContext& context) {
  rtcIntersect4(valid, scene, &context.embree, &rays);
}
inline void trace(const int* valid, RTCScene scene, RTCRayHit8& rays, RayContext& context) {
  rtcIntersect8(valid, scene, &context.embree, &rays);
}
inline void trace(const int* valid, RTCScene scene, RTCRay4& rays, RayContext& context) {
  rtcOccluded4(valid, scene, &context.embree, &rays);
}
inline void trace(const int* valid, RTCScene scene, RTCRay8& rays, RayContext& context) {
  rtcOccluded8(valid, scene, &context.embree, &rays);
}

#endif

/// Returns the number of rays to pass to Embree at a time: 8, or 4 where it has no kernels for 8. Embree 4 traces
/// packets for which it has no kernels ray by ray, which takes up to 1.9 times as long. Its kernels for 16 are no
/// faster for coherent rays, and take 1.2 times as long for others.
inline int packet_width(RTCDevice device) {
  return rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) ? 8 : 4;
}

/// Traces a packet in parts of type Part. Each member of Embree's packets is an array with four bytes for each ray.
template <class Part, class Packet>
void trace_in_parts(const int* valid, RTCScene scene, Packet& packet, RayContext& context) {
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
    trace(part_valid, scene, part, context);
    for (std::size_t k = 0; k < kMembers; ++k)
      std::memcpy(rays + (k * kWide + first) * kRay, part_rays + k * kNarrow * kRay, kNarrow * kRay);
  }
}

/// Find the nearest hit of each ray of a packet, or whether anything blocks it. `width`: packet_width of the device.
inline void intersect(const int* valid, RTCScene scene, int width, RayContext& context, RTCRayHit8& rays) {
  if (width == 8) return trace(valid, scene, rays, context);
  trace_in_parts<RTCRayHit4>(valid, scene, rays, context);
}
inline void intersect(const int* valid, RTCScene scene, int width, RayContext& context, RTCRayHit16& rays) {
  if (width == 8) return trace_in_parts<RTCRayHit8>(valid, scene, rays, context);
  trace_in_parts<RTCRayHit4>(valid, scene, rays, context);
}
inline void occluded(const int* valid, RTCScene scene, int width, RayContext& context, RTCRay8& rays) {
  if (width == 8) return trace(valid, scene, rays, context);
  trace_in_parts<RTCRay4>(valid, scene, rays, context);
}
inline void occluded(const int* valid, RTCScene scene, int width, RayContext& context, RTCRay16& rays) {
  if (width == 8) return trace_in_parts<RTCRay8>(valid, scene, rays, context);
  trace_in_parts<RTCRay4>(valid, scene, rays, context);
}

/// Creates a device that uses no wider instructions than isa_in_use() (kernel/isa.h). Throws std::bad_alloc if memory
/// is exhausted. Errors: kDevice if Embree cannot start for another reason.
Result<RTCDevice> new_embree_device();

/// Returns the kDevice error for a scene for which Embree could not build a hierarchy.
Error build_error(const Scene& scene, RTCError error);

/// Returns the name of the widest instruction set that Embree's kernels use on this machine, as in kernel/isa.h, or
/// "sse2"; "none" if Embree cannot start.
std::string_view isa_of_embree();

}  // namespace umbrage
