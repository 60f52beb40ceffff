#include "devices/vulkan/images.h"

namespace umbrage {

std::optional<TexelFormat> texel_format(VkFormat format) {
  switch (format) {
    case VK_FORMAT_R32_SFLOAT:
      return TexelFormat{kFloat1, 4, false, false};
    case VK_FORMAT_D32_SFLOAT:
      return TexelFormat{kFloat1, 4, false, true};
    case VK_FORMAT_R32G32B32A32_SFLOAT:
      return TexelFormat{kFloat4, 16, false, false};
    case VK_FORMAT_R16G16B16A16_SFLOAT:
      return TexelFormat{kHalf4, 8, false, false};
    case VK_FORMAT_R8G8B8A8_UNORM:
      return TexelFormat{kBytes4, 4, false, false};
    case VK_FORMAT_R8G8B8A8_SRGB:
      return TexelFormat{kBytes4, 4, true, false};
    case VK_FORMAT_B8G8R8A8_UNORM:
      return TexelFormat{kBytes4Swapped, 4, false, false};
    case VK_FORMAT_B8G8R8A8_SRGB:
      return TexelFormat{kBytes4Swapped, 4, true, false};
    default:
      return std::nullopt;
  }
}

std::string_view texel_format_names() {
  return "R32_SFLOAT, D32_SFLOAT, R32G32B32A32_SFLOAT, R16G16B16A16_SFLOAT, R8G8B8A8 or B8G8R8A8 as UNORM or SRGB";
}

}  // namespace umbrage
