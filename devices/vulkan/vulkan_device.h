// The Vulkan device: kernels run as compute shaders, compiled from the same text as on the CPU.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/device.h"
#include "devices/vulkan/images.h"
#include "devices/vulkan/instance.h"

namespace umbrage {

/// How scenes are captured.
enum class VulkanCapture {
  kAuto,    ///< kRaster; kCpu for a software device, which captures many times slower than Embree
  kCpu,     ///< by another device, whose planes are copied
  kRays,    ///< on the GPU: rays find the visible triangles
  kRaster,  ///< on the GPU: triangles are drawn, if the queue can draw; else rays
};

struct VulkanSettings {
  int index = -1;     ///< in the driver's order; -1: a hardware GPU if there is one, else any device
  bool real = false;  ///< with index -1: fail if the best one is a software device
  /// If set, validation layers check every call, synchronization included, and report here.
  ValidationMessage on_message;
  VulkanCapture capture = VulkanCapture::kAuto;
  bool tuned = true;  ///< use gpu_variants of passes where one fits
  /// Max expected time of a submission, milliseconds: drivers abort work that takes seconds. Longer dispatches are
  /// split into row ranges, in several submissions; 0: unlimited.
  double max_submission_ms = 200.0;
  /// Workgroups of a dispatch with unknown time that run first to measure it.
  int first_groups = 256;
  PFN_vkGetInstanceProcAddr get = nullptr;  ///< null: that of the system's loader
  std::string pipeline_folder;              ///< of compiled pipelines; empty: in the user's cache; "none": not stored
};

/// A device of a driver.
struct VulkanGpu {
  std::string name;     ///< "vulkan:0"
  std::string summary;  ///< model, driver, memory, what it lacks
  bool software = false, usable = true;
};

/// Returns all devices. Errors: kDevice: no loader, no driver, one that is too old.
Result<std::vector<VulkanGpu>> vulkan_gpus(const VulkanSettings& settings = {});

/// Creates the device. `capture` captures scenes if the GPU does not. Errors: kDevice: see vulkan_gpus; an index that
/// does not exist, or a device that lacks what effects need.
Result<std::unique_ptr<Device>> make_vulkan_device(const VulkanSettings& settings, std::unique_ptr<Device> capture);

/// The memory that a Vulkan device has allocated, used or pooled.
struct VulkanMemory {
  std::uint64_t device_bytes = 0, host_bytes = 0;
};
VulkanMemory vulkan_memory(const Device& device);

/// Creates a device on one opened by the caller; it captures no scenes. Errors: kDevice.
Result<std::unique_ptr<Device>> make_vulkan_device_on(const ForeignGpu& foreign);

/// Functions of devices made by make_vulkan_device_on. Work is submitted only by a download, a host step, finish or
/// submit_without_waiting.
///
/// Returns an empty frame of this size.
Result<Frame> empty_frame(Device& device, const PictureInfo& info);
/// Records that one to four planes of the frame are filled from the first channels of an image. The image has usage
/// TRANSFER_SRC. Errors: kUsage for an unknown format.
Result<void> read_image(Device& device, const DeviceImage& image, const ImageMeaning& meaning,
                        const std::vector<std::string>& planes, Frame& frame);
/// Records that planes are written to an image's first channels; the others become 0, alpha 1. The image has usage
/// TRANSFER_DST. Errors: kUsage for a plane that is missing, or an unknown format.
Result<void> write_image(Device& device, const Frame& frame, const std::vector<std::string>& planes,
                         const DeviceImage& image);
/// Makes the next submission wait for `before`, unless that is null or the recorded work is dropped.
void wait_for(Device& device, VkSemaphore before);
/// Submits the recorded work without waiting, and signals `signal` when it is done, unless that is null. Errors:
/// kDevice.
Result<void> submit_without_waiting(Device& device, VkSemaphore signal);
/// Discards the recorded work.
void drop(Device& device);

}  // namespace umbrage
