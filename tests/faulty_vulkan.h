// The system's Vulkan with injected faults: functions that fail on request, or report lower limits. Plain functions
// cannot store state, so there is one global state.
#pragma once
#include <map>

#include "devices/vulkan/loader.h"
#include "memory_order.h"

namespace umbrage::test {

struct Faults {
  int submits = 0;                                       ///< number of submissions so far
  VkResult submit = VK_SUCCESS;                          ///< if not success: returned instead of submitting
  VkResult wait = VK_SUCCESS;                            ///< if not success: returned by waits for fences
  VkResult idle = VK_SUCCESS;                            ///< if not success: returned by vkDeviceWaitIdle
  std::uint64_t memory_left = ~std::uint64_t(0);         ///< bytes, for all allocations from now on
  bool reuses_memory = false;                            ///< freed memory can be allocated again
  std::uint32_t loader_version = 0, device_version = 0;  ///< 0: the real ones
  VkDeviceSize max_allocation = 0;                       ///< bytes; 0: the real one
  std::uint32_t max_bound_bytes = 0,
                bound_buffers = 0;  ///< max size of a storage buffer, bytes, and max number; 0: real
  bool has_addresses = true;
  bool draws = true;  ///< queues support graphics
};

/// The faults, and the real functions that the faulty ones call.
struct FaultyVulkan {
  Faults faults;
  PFN_vkGetInstanceProcAddr get = nullptr;
  PFN_vkQueueSubmit submit = nullptr;
  PFN_vkWaitForFences wait = nullptr;
  PFN_vkDeviceWaitIdle idle = nullptr;
  PFN_vkAllocateMemory allocate = nullptr;
  PFN_vkFreeMemory free = nullptr;
  std::map<VkDeviceMemory, std::uint64_t> allocated;  ///< sizes in bytes
  PFN_vkGetPhysicalDeviceProperties properties = nullptr;
  PFN_vkGetPhysicalDeviceProperties2 properties2 = nullptr;
  PFN_vkGetPhysicalDeviceFeatures2 features = nullptr;
  PFN_vkEnumerateInstanceVersion version = nullptr;
  PFN_vkGetPhysicalDeviceQueueFamilyProperties families = nullptr;
};

inline FaultyVulkan& faulty() {
  static FaultyVulkan state;
  return state;
}

inline VKAPI_ATTR VkResult VKAPI_CALL faulty_submit(VkQueue queue, std::uint32_t count, const VkSubmitInfo* work,
                                                    VkFence fence) {
  ++faulty().faults.submits;
  return faulty().faults.submit != VK_SUCCESS ? faulty().faults.submit : faulty().submit(queue, count, work, fence);
}
inline VKAPI_ATTR VkResult VKAPI_CALL faulty_wait(VkDevice device, std::uint32_t count, const VkFence* fences,
                                                  VkBool32 all, std::uint64_t timeout) {
  const VkResult done = faulty().wait(device, count, fences, all, timeout);
  return faulty().faults.wait != VK_SUCCESS ? faulty().faults.wait : done;
}
inline VKAPI_ATTR VkResult VKAPI_CALL faulty_idle(VkDevice device) {
  const VkResult done = faulty().idle(device);
  return faulty().faults.idle != VK_SUCCESS ? faulty().faults.idle : done;
}
inline VKAPI_ATTR VkResult VKAPI_CALL faulty_allocate(VkDevice device, const VkMemoryAllocateInfo* info,
                                                      const VkAllocationCallbacks* callbacks, VkDeviceMemory* memory) {
  std::uint64_t& bytes_left = faulty().faults.memory_left;
  if (info->allocationSize > bytes_left) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
  bytes_left -= info->allocationSize;
  const VkResult done = faulty().allocate(device, info, callbacks, memory);
  if (done == VK_SUCCESS) faulty().allocated[*memory] = info->allocationSize;
  return done;
}
inline VKAPI_ATTR void VKAPI_CALL faulty_free(VkDevice device, VkDeviceMemory memory,
                                              const VkAllocationCallbacks* callbacks) {
  if (const auto found = faulty().allocated.find(memory); found != faulty().allocated.end()) {
    if (faulty().faults.reuses_memory) faulty().faults.memory_left += found->second;
    faulty().allocated.erase(found);
  }
  faulty().free(device, memory, callbacks);
}
inline void override_limits(VkPhysicalDeviceLimits& limits) {
  const Faults& faults = faulty().faults;
  if (faults.max_bound_bytes) limits.maxStorageBufferRange = faults.max_bound_bytes;
  if (faults.bound_buffers) limits.maxPerStageDescriptorStorageBuffers = faults.bound_buffers;
}
inline VKAPI_ATTR void VKAPI_CALL faulty_properties(VkPhysicalDevice gpu, VkPhysicalDeviceProperties* out) {
  faulty().properties(gpu, out);
  if (faulty().faults.device_version) out->apiVersion = faulty().faults.device_version;
  override_limits(out->limits);
}
inline VKAPI_ATTR void VKAPI_CALL faulty_properties2(VkPhysicalDevice gpu, VkPhysicalDeviceProperties2* out) {
  faulty().properties2(gpu, out);
  override_limits(out->properties.limits);
  for (auto* next = static_cast<VkBaseOutStructure*>(out->pNext); next; next = next->pNext)
    if (next->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES && faulty().faults.max_allocation)
      reinterpret_cast<VkPhysicalDeviceMaintenance3Properties*>(next)->maxMemoryAllocationSize =
          faulty().faults.max_allocation;
}
inline VKAPI_ATTR void VKAPI_CALL faulty_features(VkPhysicalDevice gpu, VkPhysicalDeviceFeatures2* out) {
  faulty().features(gpu, out);
  for (auto* next = static_cast<VkBaseOutStructure*>(out->pNext); next; next = next->pNext)
    if (next->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES && !faulty().faults.has_addresses)
      reinterpret_cast<VkPhysicalDeviceVulkan12Features*>(next)->bufferDeviceAddress = VK_FALSE;
}
inline VKAPI_ATTR void VKAPI_CALL faulty_families(VkPhysicalDevice gpu, std::uint32_t* count,
                                                  VkQueueFamilyProperties* out) {
  faulty().families(gpu, count, out);
  for (std::uint32_t k = 0; out && !faulty().faults.draws && k < *count; ++k)
    out[k].queueFlags &= ~VkQueueFlags(VK_QUEUE_GRAPHICS_BIT);
}
inline VKAPI_ATTR VkResult VKAPI_CALL faulty_version(std::uint32_t* out) {
  const VkResult done = faulty().version(out);
  if (faulty().faults.loader_version) *out = faulty().faults.loader_version;
  return done;
}

/// Returns a Vulkan function, or its faulty replacement. Pass it as VulkanSettings::get.
inline VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL faulty_get(VkInstance instance, const char* name) {
  const auto real = faulty().get(instance, name);
  if (!real) return nullptr;
  FaultyVulkan& f = faulty();
  for (const PFN_vkVoidFunction replacement :
       {replaced("vkQueueSubmit", name, real, f.submit, faulty_submit),
        replaced("vkWaitForFences", name, real, f.wait, faulty_wait),
        replaced("vkDeviceWaitIdle", name, real, f.idle, faulty_idle),
        replaced("vkAllocateMemory", name, real, f.allocate, faulty_allocate),
        replaced("vkFreeMemory", name, real, f.free, faulty_free),
        replaced("vkGetPhysicalDeviceProperties", name, real, f.properties, faulty_properties),
        replaced("vkGetPhysicalDeviceProperties2", name, real, f.properties2, faulty_properties2),
        replaced("vkGetPhysicalDeviceFeatures2", name, real, f.features, faulty_features),
        replaced("vkGetPhysicalDeviceQueueFamilyProperties", name, real, f.families, faulty_families),
        replaced("vkEnumerateInstanceVersion", name, real, f.version, faulty_version)})
    if (replacement) return replacement;
  return real;
}

/// Resets all faults. Returns false if there is no Vulkan.
inline bool start_faulty() {
  if (!load_vulkan()) return false;
  faulty() = {};
  faulty().get = checked_get;
  return true;
}

}  // namespace umbrage::test
