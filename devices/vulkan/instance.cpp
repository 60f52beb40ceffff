#include "devices/vulkan/instance.h"

#include <algorithm>
#include <cstring>
#include <filesystem>

#include "kernel/frame_constants.h"

namespace umbrage {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL forward_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                               const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  // Newer layers name the rule only in pMessageIdName.
  const std::string rule = data->pMessageIdName ? std::string(data->pMessageIdName) + ": " : "";
  (*static_cast<const ValidationMessage*>(user))(rule + (data->pMessage ? data->pMessage : ""));
  return VK_FALSE;
}

std::string version_text(std::uint32_t version) {
  return fmt::format("{}.{}", VK_API_VERSION_MAJOR(version), VK_API_VERSION_MINOR(version));
}

/// Returns what effects require and the device lacks, as a noun; empty: nothing.
std::string missing_features(const Instance& instance, VkPhysicalDevice gpu, std::uint32_t version) {
  if (version < VK_API_VERSION_1_2) return fmt::format("Vulkan 1.2 (its driver supports {})", version_text(version));
  VkPhysicalDeviceVulkan12Features has{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
  VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &has};
  instance.vk.GetPhysicalDeviceFeatures2(gpu, &features);
  if (!has.bufferDeviceAddress) return "buffer device addresses";
  if (!has.scalarBlockLayout) return "scalar block layout";
  VkPhysicalDeviceProperties properties{};
  instance.vk.GetPhysicalDeviceProperties(gpu, &properties);
  if (std::string missing = missing_limits(properties.limits); !missing.empty()) return missing;
  if (queue_family(instance, gpu) < 0) return "a compute queue";
  return {};
}

}  // namespace

std::string missing_limits(const VkPhysicalDeviceLimits& limits) {
  const std::uint32_t binds = limits.maxPerStageDescriptorStorageBuffers;
  if (binds >= std::uint32_t(kBoundPlanes)) return {};
  return fmt::format("bound buffers (it supports {} per shader; {} are required)", binds, kBoundPlanes);
}

Instance::~Instance() {
  if (!handle || !owned) return;
  if (messenger)
    reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
        vk.GetInstanceProcAddr(handle, "vkDestroyDebugUtilsMessengerEXT"))(handle, messenger, nullptr);
  vk.DestroyInstance(handle, nullptr);
}

Result<InstancePtr> make_instance(PFN_vkGetInstanceProcAddr get, ValidationMessage on_message) {
  if (!get) {
    auto loaded = load_vulkan();
    if (!loaded) return loaded.error();
    get = *loaded;
  }
  auto functions = global_functions(get);
  if (!functions) return functions.error();
  auto instance = std::make_shared<Instance>();
  instance->vk = *functions;
  std::uint32_t version = 0;
  if (instance->vk.EnumerateInstanceVersion(&version) != VK_SUCCESS || version < VK_API_VERSION_1_2)
    return device_error("the Vulkan loader has version {}; 1.2 is required, or use `device` cpu",
                        version_text(version));

  const VkApplicationInfo application{
      VK_STRUCTURE_TYPE_APPLICATION_INFO, nullptr, "umbrage", 0, "umbrage", 0, VK_API_VERSION_1_2};
  VkInstanceCreateInfo create{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
  create.pApplicationInfo = &application;
  VkDebugUtilsMessengerCreateInfoEXT messenger{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
  const VkValidationFeatureEnableEXT also[] = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
  VkValidationFeaturesEXT validation{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT, &messenger, 1, also};
  const char* extensions[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};
  if (on_message) {
    std::uint32_t count = 0;
    instance->vk.EnumerateInstanceLayerProperties(&count, nullptr);
    std::vector<VkLayerProperties> layers(count);
    instance->vk.EnumerateInstanceLayerProperties(&count, layers.data());
    if (std::none_of(layers.begin(), layers.end(), [](const VkLayerProperties& layer) {
          return std::strcmp(layer.layerName, kValidationLayer) == 0;
        }))
      return device_error("the Vulkan validation layers are not installed: install vulkan-validationlayers");
    instance->on_message = std::make_unique<ValidationMessage>(std::move(on_message));
    messenger.messageSeverity =
        VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    messenger.messageType =
        VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
    messenger.pfnUserCallback = forward_message;
    messenger.pUserData = instance->on_message.get();
    create.pNext = &validation;
    create.enabledLayerCount = 1;
    create.ppEnabledLayerNames = &kValidationLayer;
    create.enabledExtensionCount = 2;
    create.ppEnabledExtensionNames = extensions;
  }
  const VkResult result = instance->vk.CreateInstance(&create, nullptr, &instance->handle);
  if (result == VK_ERROR_INCOMPATIBLE_DRIVER)
    return device_error("there is no Vulkan driver: install the graphics card's driver or use `device` cpu");
  if (result != VK_SUCCESS) return vulkan_error(result, "was started");
  if (auto found = add_functions(instance->handle, instance->vk); !found) return found.error();
  if (instance->on_message) {
    // The messenger chained to the instance above reports only while the instance is created or destroyed.
    const auto create_messenger =
        reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(get(instance->handle, "vkCreateDebugUtilsMessengerEXT"));
    if (!create_messenger ||
        create_messenger(instance->handle, &messenger, nullptr, &instance->messenger) != VK_SUCCESS)
      return device_error("the Vulkan validation layers cannot report messages");
  }
  return InstancePtr(std::move(instance));
}

bool may_have_gpu() {
#ifdef __linux__
  // Kernel drivers: DRM (most cards), NVIDIA, Windows Subsystem for Linux, Mali, Adreno.
  constexpr std::string_view kStarts[] = {"dri", "nvidia", "dxg", "mali", "kgsl"};
  std::error_code failed;
  for (const auto& entry : std::filesystem::directory_iterator("/dev", failed)) {
    const std::string name = entry.path().filename();
    for (const std::string_view start : kStarts)
      if (name.starts_with(start)) return true;
  }
  return bool(failed);
#else
  return true;
#endif
}

Result<std::vector<PhysicalGpu>> physical_gpus(const Instance& instance) {
  std::uint32_t count = 0;
  std::vector<VkPhysicalDevice> handles;
  VkResult listed = instance.vk.EnumeratePhysicalDevices(instance.handle, &count, nullptr);
  if (listed == VK_SUCCESS && count > 0) {
    handles.resize(count);
    listed = instance.vk.EnumeratePhysicalDevices(instance.handle, &count, handles.data());
  }
  if (count == 0 || (listed != VK_SUCCESS && listed != VK_INCOMPLETE))
    return device_error(
        "there is no Vulkan driver with a device: install the graphics card's driver or use `device` cpu");
  std::vector<PhysicalGpu> gpus;
  for (VkPhysicalDevice handle : handles) {
    VkPhysicalDeviceProperties properties{};
    instance.vk.GetPhysicalDeviceProperties(handle, &properties);
    PhysicalGpu gpu{handle, properties.deviceName, {}, 0, properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU, {}};
    if (properties.apiVersion >= VK_API_VERSION_1_2) {
      VkPhysicalDeviceDriverProperties driver{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
      VkPhysicalDeviceProperties2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &driver};
      instance.vk.GetPhysicalDeviceProperties2(handle, &all);
      gpu.driver = fmt::format("{} {}", driver.driverName, driver.driverInfo);
    } else {
      gpu.driver = fmt::format("{:#x}", properties.driverVersion);
    }
    VkPhysicalDeviceMemoryProperties memory{};
    instance.vk.GetPhysicalDeviceMemoryProperties(handle, &memory);
    for (std::uint32_t k = 0; k < memory.memoryHeapCount; ++k)
      if (memory.memoryHeaps[k].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT)
        gpu.memory_bytes = std::max(gpu.memory_bytes, std::uint64_t(memory.memoryHeaps[k].size));
    gpu.lacks = missing_features(instance, handle, properties.apiVersion);
    gpus.push_back(std::move(gpu));
  }
  return gpus;
}

int queue_family(const Instance& instance, VkPhysicalDevice gpu) {
  std::uint32_t count = 0;
  instance.vk.GetPhysicalDeviceQueueFamilyProperties(gpu, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  instance.vk.GetPhysicalDeviceQueueFamilyProperties(gpu, &count, families.data());
  int found = -1;
  for (int k = int(count) - 1; k >= 0; --k) {
    const bool computes = families[k].queueFlags & VK_QUEUE_COMPUTE_BIT;
    const bool draws = families[k].queueFlags & VK_QUEUE_GRAPHICS_BIT;
    if (computes && (found < 0 || draws || !(families[found].queueFlags & VK_QUEUE_GRAPHICS_BIT))) found = k;
  }
  return found;
}

}  // namespace umbrage
