// Images of a caller's own Vulkan device, as what planes are made from and written to.
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
  VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;  ///< before
  VkImageLayout layout_after = VK_IMAGE_LAYOUT_UNDEFINED;
};

/// How texels lie in a buffer, or nothing where convert.comp does not know the format.
struct TexelFormat {
  int format = kFloat1;
  int bytes = 4;
  bool srgb = false;
  bool depth = false;
};
std::optional<TexelFormat> texel_format(VkFormat format);

/// "R8G8B8A8_UNORM, ...": what texel_format knows.
std::string_view texel_format_names();

/// What to say of an image of another format.
Error unknown_format(const DeviceImage& image);

/// All of an image, which is copied from or to a buffer, from `offset` on.
VkBufferImageCopy whole_image(const PictureInfo& info, const TexelFormat& format, VkDeviceSize offset);

/// Notes down a barrier around all of memory that also changes an image's layout.
void turn_layout(const Gpu& gpu, VkCommandBuffer buffer, const DeviceImage& image, const TexelFormat& format,
                 VkImageLayout from, VkImageLayout to);

/// What texels mean, besides their format.
struct ImageMeaning {
  int role = kPlainRole;
  bool orthographic = false;
  float near_depth = 0.0f, far_depth = 0.0f;
  float left = -1.0f, right = 1.0f, bottom = -1.0f, top = 1.0f;  ///< the window at distance 1, of kRayDepthRole
  float turn[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};                   ///< rows; of a normal
};

}  // namespace umbrage
