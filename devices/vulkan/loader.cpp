#include "devices/vulkan/loader.h"

#include <dlfcn.h>

namespace umbrage {

Result<PFN_vkGetInstanceProcAddr> load_vulkan(const std::string& library) {
  void* handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* found = handle ? dlsym(handle, "vkGetInstanceProcAddr") : nullptr;
  if (!found)
    return device_error(
        "Vulkan is not available: {} cannot be loaded; install the Vulkan loader (libvulkan1) or use `device` cpu",
        library);
  return reinterpret_cast<PFN_vkGetInstanceProcAddr>(found);
}

Result<VulkanFunctions> global_functions(PFN_vkGetInstanceProcAddr get) {
  VulkanFunctions vk;
  vk.GetInstanceProcAddr = get;
#define UMBRAGE_FIND(name) vk.name = reinterpret_cast<PFN_vk##name>(get(nullptr, "vk" #name));
  UMBRAGE_VULKAN_GLOBAL(UMBRAGE_FIND)
#undef UMBRAGE_FIND
  if (!vk.CreateInstance) return device_error("the Vulkan loader cannot create instances; use `device` cpu");
  if (!vk.EnumerateInstanceVersion)
    return device_error("the Vulkan loader has version 1.0; 1.2 is required, or use `device` cpu");
  return vk;
}

Result<void> add_functions(VkInstance instance, VulkanFunctions& vk) {
  const char* missing = nullptr;
#define UMBRAGE_FIND(name)                                                                \
  vk.name = reinterpret_cast<PFN_vk##name>(vk.GetInstanceProcAddr(instance, "vk" #name)); \
  if (!vk.name) missing = "vk" #name;
  UMBRAGE_VULKAN_FUNCTIONS(UMBRAGE_FIND)
#undef UMBRAGE_FIND
  if (missing) return device_error("the Vulkan loader lacks {}; version 1.2 is required", missing);
  return {};
}

Error vulkan_error(VkResult result, std::string_view doing) {
  switch (result) {
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      return device_error("the Vulkan device ran out of memory while it {}; use a smaller picture or fewer layers",
                          doing);
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      return device_error("the Vulkan driver ran out of host memory while it {}; use a smaller picture or fewer layers",
                          doing);
    case VK_ERROR_DEVICE_LOST:
      return device_error(
          "the Vulkan device was lost while it {}: its driver reset it or it was removed; try again, or "
          "use `device` cpu",
          doing);
    default:
      return device_error("the Vulkan device failed while it {} (error {})", doing, int(result));
  }
}

}  // namespace umbrage
