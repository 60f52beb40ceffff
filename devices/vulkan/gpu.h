// An open Vulkan device with the queue that executes all work.
#pragma once
#include <memory>

#include "devices/vulkan/instance.h"

namespace umbrage {

struct Gpu {
  InstancePtr instance;
  VulkanFunctions vk;  ///< functions of the instance
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::uint32_t family = 0;
  VkPhysicalDeviceProperties properties{};
  VkPhysicalDeviceMemoryProperties memory{};
  VkDeviceSize max_allocation = 0;
  double ns_of_tick = 0.0;  ///< nanoseconds per timestamp tick; 0: no timestamps
  int max_drawn_side = 0;   ///< max side of a picture into which triangles can be drawn, pixels; 0: none
  bool owned = true;        ///< this struct destroys the device

  Gpu() = default;
  Gpu(const Gpu&) = delete;
  Gpu& operator=(const Gpu&) = delete;
  ~Gpu();
};
using GpuPtr = std::shared_ptr<const Gpu>;

/// Opens a device for which PhysicalGpu::lacks is empty. Errors: kDevice.
Result<GpuPtr> open_gpu(InstancePtr instance, const PhysicalGpu& gpu);

/// A device opened by the caller, with bufferDeviceAddress and scalarBlockLayout enabled. It must outlive all objects
/// created with it.
struct ForeignGpu {
  PFN_vkGetInstanceProcAddr get = nullptr;
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  std::uint32_t family = 0;
};

/// Uses a device opened by the caller. Errors: kDevice if a function is missing, or if a shader cannot bind 16 storage
/// buffers.
Result<GpuPtr> adopt_gpu(const ForeignGpu& foreign);

}  // namespace umbrage
