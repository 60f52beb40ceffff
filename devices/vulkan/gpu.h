// An opened Vulkan device with the queue that all work goes through.
#pragma once
#include <memory>

#include "devices/vulkan/instance.h"

namespace umbrage {

struct Gpu {
  InstancePtr instance;
  VulkanFunctions vk;  ///< the instance's
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::uint32_t family = 0;
  VkPhysicalDeviceProperties properties{};
  VkPhysicalDeviceMemoryProperties memory{};
  VkDeviceSize largest_allocation = 0;
  double ns_of_tick = 0.0;  ///< of timestamps; 0: there are none
  int largest_drawn = 0;    ///< pixels to a side of a picture that triangles can be drawn into; 0: none
  bool owned = true;        ///< the device ends with this struct

  Gpu() = default;
  Gpu(const Gpu&) = delete;
  Gpu& operator=(const Gpu&) = delete;
  ~Gpu();
};
using GpuPtr = std::shared_ptr<const Gpu>;

/// Opens a device that lacks nothing. Errors: kDevice.
Result<GpuPtr> open_gpu(InstancePtr instance, const PhysicalGpu& gpu);

/// A device that somebody else opened, with bufferDeviceAddress and scalarBlockLayout enabled. It must live longer than
/// what is made with it. Errors: kDevice where a function is missing, or room for 16 storage buffers in a shader.
struct ForeignGpu {
  PFN_vkGetInstanceProcAddr get = nullptr;
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::uint32_t family = 0;
};
Result<GpuPtr> adopt_gpu(const ForeignGpu& foreign);

}  // namespace umbrage
