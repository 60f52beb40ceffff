#include "devices/vulkan/gpu.h"

#include <algorithm>

namespace umbrage {

namespace {

/// Fills in the properties and limits of the device.
void query_properties(Gpu& gpu) {
  VkPhysicalDeviceMaintenance3Properties max{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &max};
  gpu.vk.GetPhysicalDeviceProperties2(gpu.physical, &properties);
  gpu.properties = properties.properties;
  gpu.max_allocation = max.maxMemoryAllocationSize;
  gpu.vk.GetPhysicalDeviceMemoryProperties(gpu.physical, &gpu.memory);
  std::uint32_t count = 0;
  gpu.vk.GetPhysicalDeviceQueueFamilyProperties(gpu.physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  gpu.vk.GetPhysicalDeviceQueueFamilyProperties(gpu.physical, &count, families.data());
  if (families[gpu.family].timestampValidBits > 0) gpu.ns_of_tick = gpu.properties.limits.timestampPeriod;
  VkFormatProperties depth{};
  gpu.vk.GetPhysicalDeviceFormatProperties(gpu.physical, VK_FORMAT_D32_SFLOAT, &depth);
  const VkPhysicalDeviceLimits& limits = gpu.properties.limits;
  if ((families[gpu.family].queueFlags & VK_QUEUE_GRAPHICS_BIT) &&
      (depth.optimalTilingFeatures & VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT))
    gpu.max_drawn_side =
        int(std::min({limits.maxImageDimension2D, limits.maxFramebufferWidth, limits.maxFramebufferHeight,
                      limits.maxViewportDimensions[0], limits.maxViewportDimensions[1]}));
}

}  // namespace

Gpu::~Gpu() {
  if (!device || !owned) return;
  vk.DeviceWaitIdle(device);
  vk.DestroyDevice(device, nullptr);
}

Result<GpuPtr> open_gpu(InstancePtr instance, const PhysicalGpu& from) {
  auto gpu = std::make_shared<Gpu>();
  gpu->vk = instance->vk;
  gpu->instance = std::move(instance);
  gpu->physical = from.handle;
  gpu->family = std::uint32_t(queue_family(*gpu->instance, from.handle));

  const float priority = 1.0f;
  VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
  queue.queueFamilyIndex = gpu->family;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  VkPhysicalDeviceVulkan12Features features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
  features.bufferDeviceAddress = VK_TRUE;
  features.scalarBlockLayout = VK_TRUE;
  VkDeviceCreateInfo create{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, &features};
  create.queueCreateInfoCount = 1;
  create.pQueueCreateInfos = &queue;
  if (const VkResult result = gpu->vk.CreateDevice(from.handle, &create, nullptr, &gpu->device); result != VK_SUCCESS)
    return vulkan_error(result, "was opened");
  gpu->vk.GetDeviceQueue(gpu->device, gpu->family, 0, &gpu->queue);

  query_properties(*gpu);
  return GpuPtr(std::move(gpu));
}

Result<GpuPtr> adopt_gpu(const ForeignGpu& foreign) {
  auto functions = global_functions(foreign.get);
  if (!functions) return functions.error();
  auto instance = std::make_shared<Instance>();
  instance->owned = false;
  instance->handle = foreign.instance;
  instance->vk = *functions;
  if (auto found = add_functions(foreign.instance, instance->vk); !found) return found.error();
  auto gpu = std::make_shared<Gpu>();
  gpu->owned = false;
  gpu->vk = instance->vk;
  gpu->instance = std::move(instance);
  gpu->physical = foreign.physical;
  gpu->device = foreign.device;
  gpu->queue = foreign.queue;
  gpu->family = foreign.family;
  query_properties(*gpu);
  if (const std::string missing = missing_limits(gpu->properties.limits); !missing.empty())
    return device_error("the Vulkan device '{}' cannot be used: it lacks {}", gpu->properties.deviceName, missing);
  return GpuPtr(std::move(gpu));
}

}  // namespace umbrage
