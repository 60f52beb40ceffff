#include "devices/vulkan/images.h"

#include <algorithm>
#include <utility>

namespace umbrage {

std::optional<TexelFormat> texel_format(VkFormat format) {
  static const std::pair<VkFormat, TexelFormat> known[] = {
      {VK_FORMAT_R32_SFLOAT, {kFloat1, 4, false, false}},
      {VK_FORMAT_D32_SFLOAT, {kFloat1, 4, false, true}},
      {VK_FORMAT_R32G32B32A32_SFLOAT, {kFloat4, 16, false, false}},
      {VK_FORMAT_R16G16B16A16_SFLOAT, {kHalf4, 8, false, false}},
      {VK_FORMAT_R8G8B8A8_UNORM, {kBytes4, 4, false, false}},
      {VK_FORMAT_R8G8B8A8_SRGB, {kBytes4, 4, true, false}},
      {VK_FORMAT_B8G8R8A8_UNORM, {kBytes4Swapped, 4, false, false}},
      {VK_FORMAT_B8G8R8A8_SRGB, {kBytes4Swapped, 4, true, false}}};
  for (const auto& [each, texel] : known)
    if (each == format) return texel;
  return std::nullopt;
}

std::string_view texel_format_names() {
  return "R32_SFLOAT, D32_SFLOAT, R32G32B32A32_SFLOAT, R16G16B16A16_SFLOAT, R8G8B8A8 or B8G8R8A8 as UNORM or SRGB";
}

Error unknown_format(const DeviceImage& image) {
  return usage_error("images of format {} cannot be used; the supported formats are {}", int(image.format),
                     texel_format_names());
}

VkBufferImageCopy whole_image(const PictureInfo& info, const TexelFormat& format, VkDeviceSize offset) {
  VkBufferImageCopy region{};
  region.bufferOffset = offset;
  region.imageSubresource = {VkImageAspectFlags(format.depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT),
                             0, 0, 1};
  region.imageExtent = {std::uint32_t(info.width), std::uint32_t(info.height), 1};
  return region;
}

void change_layout(const Gpu& gpu, VkCommandBuffer buffer, const DeviceImage& image, const TexelFormat& format,
                   VkImageLayout from, VkImageLayout to) {
  VkImageMemoryBarrier barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
  barrier.srcAccessMask = barrier.dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image.image;
  barrier.subresourceRange = {VkImageAspectFlags(format.depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT),
                              0, 1, 0, 1};
  gpu.vk.CmdPipelineBarrier(buffer, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0,
                            nullptr, 0, nullptr, 1, &barrier);
}

ConvertConstants convert_constants(const PictureInfo& info, int stride, const TexelFormat& format,
                                   const ImageMeaning& meaning, bool to_image) {
  ConvertConstants constants{};
  constants.width = info.width;
  constants.height = info.height;
  constants.stride = stride;
  constants.format = format.format;
  constants.srgb = format.srgb ? 1 : 0;
  constants.to_image = to_image ? 1 : 0;
  constants.role = meaning.role;
  constants.orthographic = meaning.orthographic ? 1 : 0;
  constants.left = meaning.left;
  constants.right = meaning.right;
  constants.bottom = meaning.bottom;
  constants.top = meaning.top;
  constants.near_depth = meaning.near_depth;
  constants.far_depth = meaning.far_depth;
  std::copy_n(meaning.rotation, 9, constants.rotation);
  return constants;
}

}  // namespace umbrage
