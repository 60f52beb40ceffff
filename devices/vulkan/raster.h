// What triangles are drawn into: which of them each pixel sees, and how near it is.
#pragma once
#include <memory>

#include "devices/vulkan/memory.h"

namespace umbrage {

inline constexpr VkFormat kSeenFormat = VK_FORMAT_R32_UINT, kNearnessFormat = VK_FORMAT_D32_SFLOAT;

/// The way of drawing: a picture of numbers and one of depth, which are emptied before (`clear`) or kept. Errors:
/// kDevice.
Result<VkRenderPass> make_render_pass(const Gpu& gpu, bool clear);

struct RasterTarget {
  GpuPtr gpu;
  int width = 0, height = 0;
  DrawnImagePtr seen, nearness;
  VkFramebuffer framebuffer = VK_NULL_HANDLE;

  RasterTarget() = default;
  RasterTarget(const RasterTarget&) = delete;
  RasterTarget& operator=(const RasterTarget&) = delete;
  ~RasterTarget();
};
using RasterTargetPtr = std::shared_ptr<const RasterTarget>;

/// It must not be let go while the device uses it. Errors: kDevice.
Result<RasterTargetPtr> make_raster_target(GpuPtr gpu, Memory& memory, VkRenderPass pass, int width, int height);

/// Notes down that what is drawn next goes to the target: after all that shaders and copies wrote before. `first`:
/// what it held is forgotten.
void begin_drawing(const Gpu& gpu, VkCommandBuffer buffer, const RasterTarget& target, VkRenderPass pass, bool first);
void end_drawing(const Gpu& gpu, VkCommandBuffer buffer);
/// Notes down that what pixels see is copied to a plane with rows of `stride`.
void copy_seen(const Gpu& gpu, VkCommandBuffer buffer, const RasterTarget& target, const DevicePlane& to, int stride);

}  // namespace umbrage
