#include "renderer/devices.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>

#include "core/suggest.h"
#include "devices/cpu/cpu_device.h"
#include "devices/vulkan/vulkan_device.h"
#include "kernel/isa.h"

namespace umbrage {

Result<void> use_isa(std::string_view name) {
  if (choose_isa(name)) return {};
  const auto& known = known_isas();
  const std::string usable_text = fmt::format("this machine has {}", fmt::join(usable_isas(), ", "));
  if (std::find(known.begin(), known.end(), name) == known.end())
    return field_error("isa", name, "`{}` (or UMBRAGE_ISA) cannot be '{}': {}", usable_text);
  return with_field(device_error("`isa` (or UMBRAGE_ISA) cannot be '{}' on this CPU: {}", name, usable_text), "isa",
                    name);
}

Result<void> check_isa_setting() {
  return unusable_isa_setting().empty() ? Result<void>() : use_isa(unusable_isa_setting());
}

namespace {

/// Returns how Vulkan devices capture, as UMBRAGE_VULKAN_CAPTURE sets it; by default the device decides.
Result<VulkanCapture> vulkan_capture() {
  const char* requested = std::getenv("UMBRAGE_VULKAN_CAPTURE");
  if (!requested || *requested == '\0') return VulkanCapture::kAuto;
  if (requested == std::string_view("cpu")) return VulkanCapture::kCpu;
  if (requested == std::string_view("rays")) return VulkanCapture::kRays;
  if (requested == std::string_view("raster") || requested == std::string_view("gpu")) return VulkanCapture::kRaster;
  return usage_error("UMBRAGE_VULKAN_CAPTURE cannot be '{}': it takes raster, rays, gpu or cpu", requested);
}

}  // namespace

Result<std::unique_ptr<Device>> make_device(const std::string& name, int threads) {
  if (auto valid = check_isa_setting(); !valid) return valid.error();
  const auto cpu = [&] { return make_cpu_device({.threads = threads}); };
  if (name == "cpu") return cpu();
  const auto capture = vulkan_capture();
  if (!capture) return capture.error();
  if (name == "auto") {
    auto gpu = make_vulkan_device({.real = true, .capture = *capture}, cpu());
    return gpu ? std::move(gpu) : cpu();
  }
  if (name == "vulkan") return make_vulkan_device({.capture = *capture}, cpu());
  if (const std::string prefix = "vulkan:"; name.starts_with(prefix)) {
    const char* end = name.data() + name.size();
    int index = -1;
    const auto [stop, failed] = std::from_chars(name.data() + prefix.size(), end, index);
    if (failed == std::errc() && stop == end && index >= 0)
      return make_vulkan_device({.index = index, .capture = *capture}, cpu());
    return field_error("device", name, "there is no {} '{}': vulkan: takes a number, such as vulkan:0");
  }
  constexpr std::string_view kNames[] = {"cpu", "vulkan", "auto"};
  return with_field(unknown_name("device", name, kNames), "device", name);
}

}  // namespace umbrage
