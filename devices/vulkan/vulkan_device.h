// A Vulkan GPU as a device: kernels run as compute shaders, from the one text of each effect.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/device.h"
#include "devices/vulkan/images.h"
#include "devices/vulkan/instance.h"

namespace umbrage {

/// What draws scenes.
enum class VulkanCapture {
  kAuto,    ///< kRaster, unless it is the CPU in disguise, which captures many times slower than Embree
  kCpu,     ///< another device, whose planes are copied
  kRays,    ///< the GPU: which triangle a pixel sees is found by a ray
  kRaster,  ///< the GPU: triangles are drawn, where its queue draws; else rays
};

struct VulkanSettings {
  int index = -1;     ///< in the driver's order; -1: a real GPU where there is one, else what there is
  bool real = false;  ///< with index -1: fails where the best one is the CPU in disguise
  /// Where set, validation layers look at every call, synchronization included, and what they say comes here.
  ValidationMessage on_message;
  VulkanCapture capture = VulkanCapture::kAuto;
  bool tuned = true;  ///< run passes in their own ways for GPUs, where they have one that fits
  /// Drivers end work that takes seconds. A pass that is likely to take the time of a submission beyond this is done in
  /// bands, in several submissions; 0: never.
  double longest_ms = 200.0;
  /// Workgroups of a pass that is new, or newly set, after which its time is looked at.
  int first_groups = 256;
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

/// A device on what somebody else opened; it draws no scenes. Errors: kDevice.
Result<std::unique_ptr<Device>> make_vulkan_device_on(const ForeignGpu& foreign);

/// Of devices made by make_vulkan_device_on. Nothing is handed over before a download, a host step, finish or
/// hand_over.
///
/// An empty frame of this size.
Result<Frame> empty_frame(Device& device, const PictureInfo& info);
/// Notes down that planes of the frame, one to four, become what an image holds in its first channels. The image has
/// usage TRANSFER_SRC. Errors: kUsage for a format that is not known.
Result<void> read_image(Device& device, const DeviceImage& image, const ImageMeaning& meaning,
                        const std::vector<std::string>& planes, Frame& frame);
/// Notes down that planes go to an image's first channels; the others get 0, alpha 1. It has usage TRANSFER_DST.
/// Errors: kUsage for a plane that is missing, or a format that is not known.
Result<void> write_image(Device& device, const Frame& frame, const std::vector<std::string>& planes,
                         const DeviceImage& image);
/// What is handed over next waits for `before`, unless that is null or the noted is dropped.
void wait_for(Device& device, VkSemaphore before);
/// Hands over what is noted, before `signal` where that is not null, without waiting. Errors: kDevice.
Result<void> hand_over(Device& device, VkSemaphore signal);
/// Forgets what is noted.
void drop(Device& device);

}  // namespace umbrage
