// The render target of triangles: for each pixel the number of the visible triangle, and its depth.
#pragma once
#include <memory>

#include "devices/vulkan/memory.h"

namespace umbrage {

inline constexpr VkFormat kTriangleIndexFormat = VK_FORMAT_R32_UINT, kDepthFormat = VK_FORMAT_D32_SFLOAT;

/// Creates a render pass with an image of triangle indices and a depth image. `clear`: clears them first. Errors:
/// kDevice.
Result<VkRenderPass> make_render_pass(const Gpu& gpu, bool clear);

struct RasterTarget {
  GpuPtr gpu;
  int width = 0, height = 0;
  DrawnImagePtr indices, depth;
  VkFramebuffer framebuffer = VK_NULL_HANDLE;

  RasterTarget() = default;
  RasterTarget(const RasterTarget&) = delete;
  RasterTarget& operator=(const RasterTarget&) = delete;
  ~RasterTarget();
};
using RasterTargetPtr = std::shared_ptr<const RasterTarget>;

/// Creates a render target. It must not be released while the device uses it. Errors: kDevice.
Result<RasterTargetPtr> make_raster_target(GpuPtr gpu, Memory& memory, VkRenderPass pass, int width, int height);

/// Records the start of drawing to the target, after all earlier writes of shaders and copies. `first`: discards the
/// former contents.
void begin_drawing(const Gpu& gpu, VkCommandBuffer buffer, const RasterTarget& target, VkRenderPass pass, bool first);
void end_drawing(const Gpu& gpu, VkCommandBuffer buffer);
/// Records a copy of the triangle indices to a plane. `stride`: distance of its rows, in pixels.
void copy_triangle_indices(const Gpu& gpu, VkCommandBuffer buffer, const RasterTarget& target, const DevicePlane& to,
                           int stride);

}  // namespace umbrage
