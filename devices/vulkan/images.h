// Images of a caller's Vulkan device, from which planes are read or into which they are written.
#pragma once
#include <optional>

#include "core/device.h"
#include "devices/vulkan/convert.h"
#include "devices/vulkan/gpu.h"

namespace umbrage {

/// A 2D image of the size of the frame, which has no guard band, with one level and one layer.
struct DeviceImage {
  VkImage image = VK_NULL_HANDLE;
  VkFormat format = VK_FORMAT_UNDEFINED;
  VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;  ///< layout before the operation
  VkImageLayout layout_after = VK_IMAGE_LAYOUT_UNDEFINED;
};

/// The layout of texels in a buffer.
struct TexelFormat {
  int format = kFloat1;  ///< see convert.h
  int bytes = 4;         ///< per texel
  bool srgb = false;
  bool depth = false;
};
/// Returns the texel format of images of that format, or nullopt if convert.comp does not support it.
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

/// The meaning of texels; see convert.h.
struct ImageMeaning {
  int role = kPlainRole;
  bool orthographic = false;
  float near_depth = 0.0f, far_depth = 0.0f;
  float left = -1.0f, right = 1.0f, bottom = -1.0f, top = 1.0f;  ///< kRayDepthRole: window at distance 1
  float rotation[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};               ///< kNormalRole: by rows
};

/// Returns the constants of convert.comp for an image of this size. `stride`: floats between rows of the planes.
ConvertConstants convert_constants(const PictureInfo& info, int stride, const TexelFormat& format,
                                   const ImageMeaning& meaning, bool to_image);

}  // namespace umbrage
