#include "rays/embree.h"

#include <new>

#include "kernel/isa.h"
#include "scene/scene.h"

namespace umbrage {
namespace {

/// Returns Embree's configuration string for an instruction set; null: no limit. For an unknown name, or a set that the
/// machine lacks, Embree silently uses its lowest set.
const char* embree_bound(std::string_view isa) {
  if (isa == "avx2") return "isa=avx2";
  if (isa == "sse4") return "isa=sse4.2";
  if (isa == "scalar" && usable_isas().front() != "neon") return "isa=sse2";
  return nullptr;
}

std::string_view widest_of(RTCDevice device) {
  if (rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED)) return "avx512";
  if (rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED)) return "avx2";
  if (usable_isas().front() == "neon") return "neon";
  return isa_in_use() == "scalar" ? "sse2" : "sse4";
}

}  // namespace

Result<RTCDevice> new_embree_device() {
  const RTCDevice device = rtcNewDevice(embree_bound(isa_in_use()));
  if (device) return device;
  const RTCError error = rtcGetDeviceError(nullptr);
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  return device_error("Embree cannot start on this machine (error {})", int(error));
}

Error build_error(const Scene& scene, RTCError error) {
  if (error == RTC_ERROR_OUT_OF_MEMORY)
    return device_error("'{}': not enough memory for {}", scene.name, size_text(scene));
  return device_error("'{}': Embree cannot build a hierarchy of {} (error {})", scene.name, size_text(scene),
                      int(error));
}

std::string_view isa_of_embree() {
  const auto device = new_embree_device();
  if (!device) return "none";
  const std::string_view name = widest_of(*device);
  rtcReleaseDevice(*device);
  return name;
}

}  // namespace umbrage
