// A Vulkan instance, and the devices that it finds.
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

/// Gets what the validation layers say: one message.
using ValidationMessage = std::function<void(std::string_view)>;

struct Instance {
  VulkanFunctions vk;
  VkInstance handle = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
  bool owned = true;  ///< ends with this struct
  std::unique_ptr<ValidationMessage> on_message;

  Instance() = default;
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;
  ~Instance();
};
using InstancePtr = std::shared_ptr<const Instance>;

/// An instance of the system's loader, or of `get` where that is not null. Where `on_message` is set, validation layers
/// look at every call, synchronization included. Errors: kDevice: no loader, one that is too old, no driver, or no
/// validation layers where they are wanted.
Result<InstancePtr> make_instance(PFN_vkGetInstanceProcAddr get = nullptr, ValidationMessage on_message = {});

/// A device that a driver offers.
struct PhysicalGpu {
  VkPhysicalDevice handle = VK_NULL_HANDLE;
  std::string name, driver;
  std::uint64_t memory_bytes = 0;  ///< of its largest heap
  bool software = false;           ///< it is the CPU
  std::string lacks;               ///< what we need and it does not have; empty: nothing
};

/// Whether a graphics card can be there, by the files through which drivers reach one: starting Vulkan to learn that
/// there is none takes 30 ms.
bool may_have_gpu();

/// All of them, in the loader's order, which `vulkan:N` counts. Errors: kDevice where there is none.
Result<std::vector<PhysicalGpu>> physical_gpus(const Instance& instance);

/// What effects need of a device and this one does not have, as a noun; empty: nothing. Features are not asked.
std::string lacks_room(const VkPhysicalDeviceLimits& limits);

/// The queue family that work is handed to, or -1: one that also draws where there is one.
int queue_family(const Instance& instance, VkPhysicalDevice gpu);

}  // namespace umbrage
