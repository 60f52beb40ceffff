// Runs Umbrage's effects on a Vulkan device and images of the caller: a C++ layer over umbrage/vulkan.h.
//
// Needs Vulkan's headers. examples/vulkan_images.cpp is a complete program that uses it.
#pragma once
#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "umbrage/umbrage.hpp"
#include "umbrage/vulkan.h"

namespace umb {

/// The caller's device: Vulkan 1.2 or later, with the features bufferDeviceAddress and scalarBlockLayout enabled and a
/// maxPerStageDescriptorStorageBuffers of at least 16.
struct VulkanContext {
  PFN_vkGetInstanceProcAddr get_instance_proc_addr = nullptr;
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical_device = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;  ///< must support compute; nothing else may use it during a call
  uint32_t queue_family = 0;
};

/// A 2D image with `width` x `height` texels; mip level 0 and array layer 0 are used. Formats: R32_SFLOAT, D32_SFLOAT
/// (input only), R16G16B16A16_SFLOAT, R32G32B32A32_SFLOAT, R8G8B8A8 and B8G8R8A8 as UNORM or SRGB. Inputs need the
/// usage TRANSFER_SRC, outputs TRANSFER_DST. The queue's family owns the image, or the sharing mode is concurrent.
struct VulkanImage {
  VkImage image = VK_NULL_HANDLE;
  VkFormat format = VK_FORMAT_UNDEFINED;
  VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;                       ///< before the call
  VkImageLayout layout_after = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;  ///< after the call
};

/// Inputs of shading. Row 0 is the top row. An image with a null handle is absent.
struct VulkanGBuffer {
  int width = 0, height = 0;
  VulkanImage depth;
  DepthKind depth_kind = DepthKind::kWindow;
  float near_plane = 0.1f, far_plane = std::numeric_limits<float>::infinity();  ///< for kWindow and kReversed
  /// Unit vectors that point outwards; UNORM bytes map [0, 1] to [-1, 1]. Without an image normals are computed from
  /// depth.
  VulkanImage normal;
  /// Rotation from the space of the normals, such as world space, to view space, row by row. View space: +x right, +y
  /// up, the camera looks down -z.
  float view_from_normal[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  VulkanImage albedo;  ///< diffuse reflectance; default: grey
  VulkanImage light;   ///< linear radiance towards the camera, for effects that change it (composite, output)
  bool orthographic = false;
  /// View window of the image: at distance 1, or in scene units for an orthographic camera.
  float left = -1.0f, right = 1.0f, bottom = -1.0f, top = 1.0f;
  float scene_radius = 1.0f;  ///< bounding-sphere radius, scene units, > 0; relative lengths refer to it
};

/// The effects to run, their settings and their outputs.
struct VulkanShadeRequest {
  std::vector<std::string> effects;   ///< run in this order, such as "bitmask", "denoise": see `umbrage list effects`
  std::vector<std::string> settings;  ///< "effect.parameter=value"
  struct Output {
    /// Written to the image's channels: {"ao"}, {"indirect.r", "indirect.g", "indirect.b"}.
    std::vector<std::string> planes;
    VulkanImage image;
  };
  std::vector<Output> outputs;
  /// Signalled when the G-buffer is ready; null: it was submitted to this queue before.
  VkSemaphore wait = VK_NULL_HANDLE;
  VkSemaphore signal = VK_NULL_HANDLE;  ///< to be signalled when the outputs are ready
};

/// Runs effects on the caller's device. Not thread-safe. Must be destroyed before the device.
class VulkanShading {
 public:
  /// Errors: code 2 for a missing handle, 4 if the device lacks a required feature.
  Outcome open(const VulkanContext& c) {
    const UmbVulkanContext context{
        c.get_instance_proc_addr, c.instance, c.physical_device, c.device, c.queue, c.queue_family};
    Handle made(umbNewVulkanShading(&context));
    if (!made) return detail::told_without_code(UMB_ERROR_DEVICE, umbGetError);
    handle_ = std::move(made);
    return {};
  }
  /// Submits the work once and returns without waiting for it. The next call waits for the previous one. For an effect
  /// that also runs on the host, such as `outline`, the call first submits the preceding work and waits for it. Errors:
  /// code 2 for unknown names and formats, 4 if memory runs out or the device is lost. After code 2 nothing has been
  /// submitted except such preceding work.
  Outcome shade(const VulkanGBuffer& g, const VulkanShadeRequest& request) {
    return call(false, VK_NULL_HANDLE, 0, g, request);
  }
  /// Records the same work into a command buffer of the caller, outside of render passes, and submits nothing. `slot`,
  /// 0 to UMB_VULKAN_SLOTS - 1: the frame in flight, whose former submission is complete. The contract is that of
  /// umbRecordVulkanImages. Errors: those of shade(); code 2 also for effects with work on the host and for rays.
  Outcome record(VkCommandBuffer commands, int slot, const VulkanGBuffer& g, const VulkanShadeRequest& request) {
    return call(true, commands, slot, g, request);
  }
  /// Returns what one execution of the slot's last recording costs; all 0 without one.
  UmbVulkanCost cost(int slot) const {
    UmbVulkanCost cost{};
    umbGetVulkanCost(handle_.get(), slot, &cost);
    return cost;
  }
  /// Waits for the last submission. Errors: code 4.
  Outcome finish() { return handle_ ? outcome(umbFinishVulkanShading(handle_.get())) : Outcome(); }
  /// Returns the device memory that is allocated for this and later pictures of the same size, in bytes.
  uint64_t device_bytes() const { return umbGetVulkanShadingMemory(handle_.get()); }

 private:
  using Handle = detail::Ref<UmbVulkanShading, umbRetainVulkanShading, umbReleaseVulkanShading>;

  Outcome call(bool records, VkCommandBuffer commands, int slot, const VulkanGBuffer& g,
               const VulkanShadeRequest& request) {
    UmbVulkanGBuffer gbuffer{};
    gbuffer.width = g.width;
    gbuffer.height = g.height;
    gbuffer.depth = image_of(g.depth);
    gbuffer.depth_kind = int32_t(g.depth_kind);
    gbuffer.near_plane = g.near_plane;
    gbuffer.far_plane = g.far_plane;
    gbuffer.normal = image_of(g.normal);
    std::copy_n(g.view_from_normal, 9, gbuffer.view_from_normal);
    gbuffer.albedo = image_of(g.albedo);
    gbuffer.light = image_of(g.light);
    gbuffer.orthographic = g.orthographic;
    gbuffer.left = g.left, gbuffer.right = g.right, gbuffer.bottom = g.bottom, gbuffer.top = g.top;
    gbuffer.scene_radius = g.scene_radius;
    const auto effects = texts_of(request.effects), settings = texts_of(request.settings);
    std::vector<std::vector<const char*>> planes;
    std::vector<UmbVulkanOutput> outputs;
    for (const VulkanShadeRequest::Output& output : request.outputs) planes.push_back(texts_of(output.planes));
    for (std::size_t k = 0; k < planes.size(); ++k)
      outputs.push_back({planes[k].data(), int32_t(planes[k].size()), image_of(request.outputs[k].image)});
    const UmbVulkanWork work{effects.data(), int32_t(effects.size()), settings.data(), int32_t(settings.size()),
                             outputs.data(), int32_t(outputs.size()), request.wait,    request.signal};
    return outcome(records ? umbRecordVulkanImages(handle_.get(), commands, slot, &gbuffer, &work)
                           : umbShadeVulkanImages(handle_.get(), &gbuffer, &work));
  }
  static UmbVulkanImage image_of(const VulkanImage& from) {
    return {from.image, from.format, from.layout, from.layout_after};
  }
  static std::vector<const char*> texts_of(const std::vector<std::string>& from) {
    std::vector<const char*> texts;
    for (const std::string& text : from) texts.push_back(text.c_str());
    return texts;
  }
  Outcome outcome(UmbError code) const {
    if (code == UMB_ERROR_NONE) return {};
    return detail::outcome_of(code,
                              [&](const char** message) { return umbGetVulkanShadingError(handle_.get(), message); });
  }

  Handle handle_;
};

}  // namespace umb
