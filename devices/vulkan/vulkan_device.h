// The Vulkan device: kernels run as compute shaders, compiled from the same text as on the CPU.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/device.h"
#include "devices/vulkan/commands.h"
#include "devices/vulkan/images.h"
#include "devices/vulkan/instance.h"

namespace umbrage {

/// How scenes are captured.
enum class VulkanCapture {
  kAuto,    ///< kRaster; kCpu for a software device, which captures many times slower than Embree
  kCpu,     ///< by another device, whose planes are copied
  kRays,    ///< on the GPU: rays find the visible triangles
  kRaster,  ///< on the GPU: triangles are rasterised if the queue can draw; otherwise as kRays
};

struct VulkanSettings {
  int index = -1;     ///< in the loader's order; -1: a hardware GPU if there is one, else any device
  bool real = false;  ///< with index -1: fail if there is no usable hardware GPU
  /// If set, validation layers check every call, synchronization included, and report here.
  ValidationMessage on_message;
  VulkanCapture capture = VulkanCapture::kAuto;
  bool tuned = true;  ///< use Dispatch::gpu_variants where one fits
  /// Max expected time of a submission, milliseconds: drivers abort work that takes seconds. Longer dispatches are
  /// split into row ranges, in several submissions; 0: unlimited.
  double max_submission_ms = 200.0;
  /// Workgroups of a dispatch with unknown time that run first to measure it.
  int first_groups = 256;
  PFN_vkGetInstanceProcAddr get = nullptr;  ///< vkGetInstanceProcAddr; null: that of the system's loader
  std::string pipeline_folder;              ///< for compiled pipelines; empty: the user's cache; "none": not stored
};

/// A device of a driver.
struct VulkanGpu {
  std::string name;     ///< "vulkan:0"
  std::string summary;  ///< model, driver, memory, missing features
  bool software = false, usable = true;
};

/// Returns all devices. Errors: kDevice if the loader or the driver is missing or too old.
Result<std::vector<VulkanGpu>> vulkan_gpus(const VulkanSettings& settings = {});

/// Creates a Vulkan device. `capture` captures scenes if the GPU does not. Errors: kDevice, as for vulkan_gpus, and if
/// no device has that index or the device lacks features that effects require.
Result<std::unique_ptr<Device>> make_vulkan_device(const VulkanSettings& settings, std::unique_ptr<Device> capture);

/// The memory that a Vulkan device has allocated, used or pooled.
struct VulkanMemory {
  std::uint64_t device_bytes = 0, host_bytes = 0;
};
VulkanMemory vulkan_memory(const Device& device);

/// Creates a device on one opened by the caller; it captures no scenes. Errors: kDevice.
Result<std::unique_ptr<Device>> make_vulkan_device_on(const ForeignGpu& foreign);

/// The functions below require a Vulkan device. Their work is submitted only by a download, a host step, finish or
/// Commands::submit_without_waiting.
///
/// Returns a frame of this size without planes.
Result<Frame> empty_frame(Device& device, const PictureInfo& info);
/// Records a copy of the first channels of an image to one to four planes of the frame. The image must have the usage
/// TRANSFER_SRC. Errors: kUsage for an unknown format.
Result<void> read_image(Device& device, const DeviceImage& image, const ImageMeaning& meaning,
                        const std::vector<std::string>& planes, Frame& frame);
/// Records a copy of planes to the first channels of an image; its other channels become 0, alpha 1. The image must
/// have the usage TRANSFER_DST. Errors: kUsage for a plane that is missing, or an unknown format.
Result<void> write_image(Device& device, const Frame& frame, const std::vector<std::string>& planes,
                         const DeviceImage& image);
/// Returns what records the work of the device.
Commands& commands_of(Device& device);

}  // namespace umbrage
