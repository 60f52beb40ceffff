// Functions of Vulkan, loaded at run time: the program does not link to a Vulkan library and starts without one.
#pragma once
#define VK_NO_PROTOTYPES
#include <vulkan/vulkan_core.h>

#include <string>

#include "core/result.h"

// All functions that are used: those that are found without an instance, and the others.
#define UMBRAGE_VULKAN_GLOBAL(X) X(EnumerateInstanceVersion) X(EnumerateInstanceLayerProperties) X(CreateInstance)
// clang-format off
#define UMBRAGE_VULKAN_FUNCTIONS(X) \
  X(DestroyInstance) X(EnumeratePhysicalDevices) X(GetPhysicalDeviceProperties) X(GetPhysicalDeviceProperties2) \
  X(GetPhysicalDeviceFeatures2) X(GetPhysicalDeviceMemoryProperties) X(GetPhysicalDeviceQueueFamilyProperties) \
  X(CreateDevice) X(DestroyDevice) X(GetDeviceQueue) X(QueueSubmit) X(DeviceWaitIdle) X(CreateBuffer) \
  X(DestroyBuffer) X(GetBufferMemoryRequirements) X(GetBufferDeviceAddress) X(AllocateMemory) X(FreeMemory) \
  X(BindBufferMemory) X(MapMemory) X(CreateCommandPool) X(DestroyCommandPool) X(AllocateCommandBuffers) \
  X(BeginCommandBuffer) X(EndCommandBuffer) X(ResetCommandPool) X(CreateFence) X(DestroyFence) X(WaitForFences) \
  X(ResetFences) X(CreateQueryPool) X(DestroyQueryPool) X(GetQueryPoolResults) X(CmdResetQueryPool) X(CmdCopyQueryPoolResults) \
  X(CmdWriteTimestamp) X(CreateDescriptorSetLayout) X(DestroyDescriptorSetLayout) X(CreateDescriptorPool) \
  X(DestroyDescriptorPool) X(ResetDescriptorPool) X(AllocateDescriptorSets) X(UpdateDescriptorSets) X(CreatePipelineLayout) \
  X(DestroyPipelineLayout) X(CreateShaderModule) X(DestroyShaderModule) X(CreateComputePipelines) \
  X(DestroyPipeline) X(CreatePipelineCache) X(DestroyPipelineCache) X(GetPipelineCacheData) X(CmdBindPipeline) \
  X(CmdBindDescriptorSets) X(CmdPushConstants) X(CmdDispatch) X(CmdDispatchBase) X(CmdPipelineBarrier) X(CmdCopyBuffer) \
  X(CmdFillBuffer) X(CmdCopyImageToBuffer) X(CmdCopyBufferToImage) X(GetPhysicalDeviceFormatProperties) X(CreateImage) \
  X(DestroyImage) X(GetImageMemoryRequirements) X(BindImageMemory) X(CreateImageView) X(DestroyImageView) \
  X(CreateRenderPass) X(DestroyRenderPass) X(CreateFramebuffer) X(DestroyFramebuffer) X(CreateGraphicsPipelines) \
  X(CmdBeginRenderPass) X(CmdEndRenderPass) X(CmdSetViewport) X(CmdSetScissor) X(CmdDraw)
// clang-format on

namespace umbrage {

struct VulkanFunctions {
  PFN_vkGetInstanceProcAddr GetInstanceProcAddr = nullptr;
#define UMBRAGE_MEMBER(name) PFN_vk##name name = nullptr;
  UMBRAGE_VULKAN_GLOBAL(UMBRAGE_MEMBER)
  UMBRAGE_VULKAN_FUNCTIONS(UMBRAGE_MEMBER)
#undef UMBRAGE_MEMBER
};

/// Loads the system's Vulkan loader, which stays loaded, and returns the function that finds all others. Errors:
/// kDevice if there is none of that name.
Result<PFN_vkGetInstanceProcAddr> load_vulkan(const std::string& library = "libvulkan.so.1");

/// Returns the functions that are found without an instance. Errors: kDevice.
Result<VulkanFunctions> global_functions(PFN_vkGetInstanceProcAddr get);

/// Adds the other functions. Errors: kDevice if one is missing.
Result<void> add_functions(VkInstance instance, VulkanFunctions& vk);

/// Returns the error of a failed function as a sentence: "the Vulkan device ran out of memory while it ...", followed
/// by `doing`, such as "compiled a kernel".
Error vulkan_error(VkResult result, std::string_view doing);

}  // namespace umbrage
