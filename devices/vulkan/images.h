// Images of a caller's Vulkan device, which planes are read from and written to.
#pragma once
#include <optional>

#include "core/device.h"
#include "devices/vulkan/convert.h"
#include "devices/vulkan/gpu.h"

namespace umbrage {

/// A 2D image of the frame's size (without a guard band), one level, one layer.
struct DeviceImage {
  VkImage image = VK_NULL_HANDLE;
  VkFormat format = VK_FORMAT_UNDEFINED;
  VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;  ///< layout before the operation
  VkImageLayout layout_after = VK_IMAGE_LAYOUT_UNDEFINED;
};

/// The layout of texels in a buffer; nullopt if convert.comp does not support the format.
struct TexelFormat {
  int format = kFloat1;
  int bytes = 4;
  bool srgb = false;
  bool depth = false;
};
std::optional<TexelFormat> texel_format(VkFormat format);

/// Returns the names of the formats that texel_format supports: "R8G8B8A8_UNORM, ...".
std::string_view texel_format_names();

/// Returns the error for an image of another format.
Error unknown_format(const DeviceImage& image);

/// Returns the region of a whole image, for a copy from or to a buffer at `offset`.
VkBufferImageCopy whole_image(const PictureInfo& info, const TexelFormat& format, VkDeviceSize offset);

/// Records a full memory barrier that also changes an image's layout.
void change_layout(const Gpu& gpu, VkCommandBuffer buffer, const DeviceImage& image, const TexelFormat& format,
                   VkImageLayout from, VkImageLayout to);

/// Meaning of texels, besides their format.
struct ImageMeaning {
  int role = kPlainRole;
  bool orthographic = false;
  float near_depth = 0.0f, far_depth = 0.0f;
  float left = -1.0f, right = 1.0f, bottom = -1.0f, top = 1.0f;  ///< kRayDepthRole: window at distance 1
  float turn[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};                   ///< kNormalRole: rotation, rows
};

}  // namespace umbrage
