// A Vulkan GPU as a device: kernels run as compute shaders, from the one text of each effect.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/device.h"
#include "devices/vulkan/instance.h"

namespace umbrage {

/// What draws scenes.
enum class VulkanCapture {
  kAuto,  ///< the GPU, unless it is the CPU in disguise, which draws many times slower than Embree
  kCpu,   ///< another device, whose planes are copied
  kGpu,
};

struct VulkanSettings {
  int index = -1;     ///< in the driver's order; -1: a real GPU where there is one, else what there is
  bool real = false;  ///< with index -1: fails where the best one is the CPU in disguise
  /// Where set, validation layers look at every call, synchronization included, and what they say comes here.
  ValidationMessage on_message;
  VulkanCapture capture = VulkanCapture::kAuto;
  PFN_vkGetInstanceProcAddr get = nullptr;  ///< null: that of the system's loader
  std::string pipeline_folder;              ///< of compiled pipelines; empty: in the user's cache; "none": nowhere
};

/// A device that a driver offers.
struct VulkanGpu {
  std::string name;     ///< "vulkan:0"
  std::string summary;  ///< model, driver, memory, what it lacks
  bool software = false, usable = true;
};

/// All of them. Errors: kDevice: no loader, no driver, one that is too old.
Result<std::vector<VulkanGpu>> vulkan_gpus(const VulkanSettings& settings = {});

/// The device. `capture` is what draws scenes where the GPU does not. Errors: kDevice: see vulkan_gpus; an index
/// that does not exist, or a device that lacks what effects need.
Result<std::unique_ptr<Device>> make_vulkan_device(const VulkanSettings& settings, std::unique_ptr<Device> capture);

/// Memory that a Vulkan device holds, whether something uses it or not.
struct VulkanMemory {
  std::uint64_t device_bytes = 0, host_bytes = 0;
};
VulkanMemory vulkan_memory(const Device& device);

}  // namespace umbrage
