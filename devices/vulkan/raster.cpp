#include "devices/vulkan/raster.h"

#include <array>

namespace umbrage {
namespace {

constexpr VkPipelineStageFlags kDepthStages =
    VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;
constexpr VkPipelineStageFlags kDrawingStages = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT | kDepthStages;
constexpr VkAccessFlags kColorAccess = VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
constexpr VkAccessFlags kDepthAccess =
    VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;

VkImageMemoryBarrier image_barrier(const AttachmentImage& image, VkImageAspectFlags aspect, VkAccessFlags source_access,
                                   VkAccessFlags target_access, VkImageLayout from, VkImageLayout to) {
  VkImageMemoryBarrier barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
  barrier.srcAccessMask = source_access;
  barrier.dstAccessMask = target_access;
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image.image;
  barrier.subresourceRange = {aspect, 0, 1, 0, 1};
  return barrier;
}

}  // namespace

Result<VkRenderPass> make_render_pass(const Gpu& gpu, bool clear) {
  std::array<VkAttachmentDescription, 2> attachments{};
  for (VkAttachmentDescription& attachment : attachments) {
    attachment.samples = VK_SAMPLE_COUNT_1_BIT;
    attachment.loadOp = clear ? VK_ATTACHMENT_LOAD_OP_CLEAR : VK_ATTACHMENT_LOAD_OP_LOAD;
    attachment.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    attachment.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    attachment.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
  }
  attachments[0].format = kTriangleIndexFormat;
  attachments[0].initialLayout = attachments[0].finalLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  attachments[1].format = kDepthFormat;
  attachments[1].initialLayout = attachments[1].finalLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
  const VkAttachmentReference indices{0, attachments[0].initialLayout}, depth{1, attachments[1].initialLayout};
  VkSubpassDescription subpass{};
  subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
  subpass.colorAttachmentCount = 1;
  subpass.pColorAttachments = &indices;
  subpass.pDepthStencilAttachment = &depth;
  VkRenderPassCreateInfo create{VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO};
  create.attachmentCount = 2;
  create.pAttachments = attachments.data();
  create.subpassCount = 1;
  create.pSubpasses = &subpass;
  VkRenderPass pass = VK_NULL_HANDLE;
  if (const auto r = gpu.vk.CreateRenderPass(gpu.device, &create, nullptr, &pass); r != VK_SUCCESS)
    return vulkan_error(r, "prepared to draw");
  return pass;
}

RasterTarget::~RasterTarget() {
  if (framebuffer) gpu->vk.DestroyFramebuffer(gpu->device, framebuffer, nullptr);
}

Result<RasterTargetPtr> make_raster_target(GpuPtr gpu, Memory& memory, VkRenderPass pass, int width, int height) {
  auto target = std::make_shared<RasterTarget>();
  target->width = width;
  target->height = height;
  const auto indices =
      memory.image(width, height, kTriangleIndexFormat,
                   VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT, VK_IMAGE_ASPECT_COLOR_BIT);
  if (!indices) return indices.error();
  const auto depth =
      memory.image(width, height, kDepthFormat, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, VK_IMAGE_ASPECT_DEPTH_BIT);
  if (!depth) return depth.error();
  target->indices = *indices;
  target->depth = *depth;
  const VkImageView views[] = {target->indices->view, target->depth->view};
  VkFramebufferCreateInfo create{VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO};
  create.renderPass = pass;
  create.attachmentCount = 2;
  create.pAttachments = views;
  create.width = std::uint32_t(width);
  create.height = std::uint32_t(height);
  create.layers = 1;
  target->gpu = std::move(gpu);
  const Gpu& opened = *target->gpu;
  if (const auto r = opened.vk.CreateFramebuffer(opened.device, &create, nullptr, &target->framebuffer);
      r != VK_SUCCESS)
    return vulkan_error(r, "prepared to draw");
  return RasterTargetPtr(std::move(target));
}

void begin_drawing(const Gpu& gpu, VkCommandBuffer buffer, const RasterTarget& target, VkRenderPass pass, bool first) {
  constexpr VkImageLayout kColor = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  constexpr VkImageLayout kDepth = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
  const VkMemoryBarrier written{VK_STRUCTURE_TYPE_MEMORY_BARRIER, nullptr,
                                VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT, VK_ACCESS_SHADER_READ_BIT};
  const VkImageMemoryBarrier image_barriers[] = {
      image_barrier(*target.indices, VK_IMAGE_ASPECT_COLOR_BIT, kColorAccess, kColorAccess,
                    first ? VK_IMAGE_LAYOUT_UNDEFINED : kColor, kColor),
      image_barrier(*target.depth, VK_IMAGE_ASPECT_DEPTH_BIT, kDepthAccess, kDepthAccess,
                    first ? VK_IMAGE_LAYOUT_UNDEFINED : kDepth, kDepth)};
  gpu.vk.CmdPipelineBarrier(
      buffer, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT | kDrawingStages,
      VK_PIPELINE_STAGE_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT | kDrawingStages, 0, 1, &written, 0,
      nullptr, 2, image_barriers);
  const std::array<VkClearValue, 2> clear_values{};  // no triangle, infinitely far
  VkRenderPassBeginInfo begin{VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO};
  begin.renderPass = pass;
  begin.framebuffer = target.framebuffer;
  begin.renderArea = {{0, 0}, {std::uint32_t(target.width), std::uint32_t(target.height)}};
  begin.clearValueCount = std::uint32_t(clear_values.size());
  begin.pClearValues = clear_values.data();
  gpu.vk.CmdBeginRenderPass(buffer, &begin, VK_SUBPASS_CONTENTS_INLINE);
  const VkViewport viewport{0.0f, 0.0f, float(target.width), float(target.height), 0.0f, 1.0f};
  gpu.vk.CmdSetViewport(buffer, 0, 1, &viewport);
  gpu.vk.CmdSetScissor(buffer, 0, 1, &begin.renderArea);
}

void end_drawing(const Gpu& gpu, VkCommandBuffer buffer) { gpu.vk.CmdEndRenderPass(buffer); }

void copy_triangle_indices(const Gpu& gpu, VkCommandBuffer buffer, const RasterTarget& target, const DevicePlane& to,
                           int stride) {
  const VkMemoryBarrier used{VK_STRUCTURE_TYPE_MEMORY_BARRIER, nullptr,
                             VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT, VK_ACCESS_TRANSFER_WRITE_BIT};
  const VkImageMemoryBarrier drawn =
      image_barrier(*target.indices, VK_IMAGE_ASPECT_COLOR_BIT, kColorAccess, VK_ACCESS_TRANSFER_READ_BIT,
                    VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  gpu.vk.CmdPipelineBarrier(buffer,
                            VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT | kDrawingStages,
                            VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 1, &used, 0, nullptr, 1, &drawn);
  VkBufferImageCopy region{};
  region.bufferOffset = to.offset;
  region.bufferRowLength = std::uint32_t(stride);
  region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  region.imageExtent = {std::uint32_t(target.width), std::uint32_t(target.height), 1};
  gpu.vk.CmdCopyImageToBuffer(buffer, target.indices->image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, to.buffer, 1,
                              &region);
}

}  // namespace umbrage
