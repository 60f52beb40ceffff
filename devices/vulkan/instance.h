// A Vulkan instance, and its physical devices.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "devices/vulkan/loader.h"

namespace umbrage {

/// Callback for one message of the validation layers.
using ValidationMessage = std::function<void(std::string_view)>;

struct Instance {
  VulkanFunctions vk;
  VkInstance handle = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
  bool owned = true;  ///< this struct destroys the instance
  std::unique_ptr<ValidationMessage> on_message;

  Instance() = default;
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;
  ~Instance();
};
using InstancePtr = std::shared_ptr<const Instance>;

/// Creates an instance with the system's loader, or with `get` if that is not null. If `on_message` is set, validation
/// layers check every call, synchronization included. Errors: kDevice if the loader is missing or too old, there is no
/// driver, or requested validation layers are missing.
Result<InstancePtr> make_instance(PFN_vkGetInstanceProcAddr get = nullptr, ValidationMessage on_message = {});

/// A physical device of a driver.
struct PhysicalGpu {
  VkPhysicalDevice handle = VK_NULL_HANDLE;
  std::string name, driver;
  std::uint64_t memory_bytes = 0;  ///< size of its largest heap
  bool software = false;           ///< the driver runs on the CPU
  std::string lacks;               ///< what effects require and the device lacks, as a noun; empty: nothing
};

/// Returns whether there may be a graphics card, judging by the device files of drivers. On a machine without one this
/// saves starting Vulkan, which takes 30 ms.
bool may_have_gpu();

/// Returns all physical devices in the loader's order, as counted by `vulkan:N`. Errors: kDevice if there is none.
Result<std::vector<PhysicalGpu>> physical_gpus(const Instance& instance);

/// Returns what effects require and these limits lack, as a noun; empty: nothing. Does not check features.
std::string missing_limits(const VkPhysicalDeviceLimits& limits);

/// Returns a queue family that can compute, preferably one that can also draw; -1: none.
int queue_family(const Instance& instance, VkPhysicalDevice gpu);

}  // namespace umbrage
