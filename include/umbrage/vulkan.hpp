// Umbrage's effects on a caller's own Vulkan device and images, in C++: a layer over umbrage/vulkan.h.
//
// Needs Vulkan's headers. examples/vulkan_images.cpp is a whole program around it.
#pragma once
#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "umbrage/umbrage.hpp"
#include "umbrage/vulkan.h"

namespace umb {

/// The caller's device: Vulkan 1.2 or later, with the features bufferDeviceAddress and scalarBlockLayout enabled, which
/// binds 16 storage buffers to a shader (maxPerStageDescriptorStorageBuffers).
struct VulkanContext {
  PFN_vkGetInstanceProcAddr get_instance_proc_addr = nullptr;
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical_device = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;  ///< computes; nobody else may use it during a call
  uint32_t queue_family = 0;
};

/// A 2D image: its first level and layer, with `width` x `height` texels. Formats: R32_SFLOAT, D32_SFLOAT (read alone),
/// R16G16B16A16_SFLOAT, R32G32B32A32_SFLOAT, R8G8B8A8 and B8G8R8A8 as UNORM or SRGB. What is read has the usage
/// TRANSFER_SRC, what is written TRANSFER_DST. It belongs to the queue's family, or is shared.
struct VulkanImage {
  VkImage image = VK_NULL_HANDLE;
  VkFormat format = VK_FORMAT_UNDEFINED;
  VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;                       ///< in which it comes
  VkImageLayout layout_after = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;  ///< and is left
};

/// What shading starts from. Row 0 is the top one.
struct VulkanGBuffer {
  int width = 0, height = 0;
  VulkanImage depth;
  DepthKind depth_kind = DepthKind::kWindow;
  float near_plane = 0.1f, far_plane = std::numeric_limits<float>::infinity();  ///< of kWindow and kReversed
  /// Unit vectors to the surface's outside, bytes from [0, 1] to [-1, 1]. Without an image they follow from depth.
  VulkanImage normal;
  /// World space, turned by the rows of this rotation to view space: +x right, +y up, the camera looks down -z.
  float view_from_normal[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  VulkanImage albedo;  ///< diffuse reflectance; without: grey
  VulkanImage light;   ///< light that surfaces send to the eye, linear; for effects that change it (composite, output)
  bool orthographic = false;
  /// The window that the image fills: at distance 1, or in scene units for an orthographic camera.
  float left = -1.0f, right = 1.0f, bottom = -1.0f, top = 1.0f;
  float scene_radius = 1.0f;  ///< of a ball around what is shaded: lengths given as shares are shares of it
};

/// What to run, and where what it makes goes.
struct VulkanShadeRequest {
  std::vector<std::string> effects;   ///< one after the other, such as "bitmask", "denoise": see `umbrage list effects`
  std::vector<std::string> settings;  ///< "effect.parameter=value"
  struct Output {
    std::vector<std::string> planes;  ///< for the image's channels: {"ao"}, {"indirect.r", "indirect.g", "indirect.b"}
    VulkanImage image;
  };
  std::vector<Output> outputs;
  VkSemaphore wait = VK_NULL_HANDLE;    ///< that the G-buffer is there; null: it was submitted to this queue before
  VkSemaphore signal = VK_NULL_HANDLE;  ///< that the outputs are
};

/// Effects on a caller's device. Not for several threads at once; to be ended before the device.
class VulkanShading {
 public:
  /// Errors: code 4 where the device does not have what is needed.
  Outcome open(const VulkanContext& c) {
    const UmbVulkanContext context{
        c.get_instance_proc_addr, c.instance, c.physical_device, c.device, c.queue, c.queue_family};
    Handle made(umbNewVulkanShading(&context));
    if (!made) return detail::told_without_code(UMB_ERROR_DEVICE, umbGetError);
    handle_ = std::move(made);
    return {};
  }
  /// Submits once and returns without waiting. The next call waits for the one before. An effect that works on the
  /// host, too, as `outline` does, has what comes before it submitted first, and waits for that. Errors: code 2 for
  /// names and formats that there are not, 4 where memory is short or the device is lost; after 2 nothing has been
  /// submitted but that.
  Outcome shade(const VulkanGBuffer& g, const VulkanShadeRequest& request) {
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
    return outcome(umbShadeVulkanImages(handle_.get(), &gbuffer, &work));
  }
  /// Waits for the last one. Errors: code 4.
  Outcome finish() { return handle_ ? outcome(umbFinishVulkanShading(handle_.get())) : Outcome(); }
  /// Bytes of device memory that it holds, for this and the next pictures of the size.
  uint64_t device_bytes() const { return umbGetVulkanShadingMemory(handle_.get()); }

 private:
  using Handle = detail::Ref<UmbVulkanShading, umbRetainVulkanShading, umbReleaseVulkanShading>;

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
    return detail::told(code, [&](const char** message) { return umbGetVulkanShadingError(handle_.get(), message); });
  }

  Handle handle_;
};

}  // namespace umb
