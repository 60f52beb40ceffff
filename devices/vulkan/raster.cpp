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

VkImageMemoryBarrier turn(const DrawnImage& image, VkImageAspectFlags aspect, VkAccessFlags before, VkAccessFlags after,
                          VkImageLayout from, VkImageLayout to) {
  VkImageMemoryBarrier turn{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
  turn.srcAccessMask = before;
  turn.dstAccessMask = after;
  turn.oldLayout = from;
  turn.newLayout = to;
  turn.srcQueueFamilyIndex = turn.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  turn.image = image.image;
  turn.subresourceRange = {aspect, 0, 1, 0, 1};
  return turn;
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
  const VkAttachmentReference seen{0, attachments[0].initialLayout}, nearness{1, attachments[1].initialLayout};
  VkSubpassDescription subpass{};
  subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
  subpass.colorAttachmentCount = 1;
  subpass.pColorAttachments = &seen;
  subpass.pDepthStencilAttachment = &nearness;
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
  const auto seen =
      memory.image(width, height, kTriangleIndexFormat,
                   VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT, VK_IMAGE_ASPECT_COLOR_BIT);
  if (!seen) return seen.error();
  const auto nearness =
      memory.image(width, height, kDepthFormat, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, VK_IMAGE_ASPECT_DEPTH_BIT);
  if (!nearness) return nearness.error();
  target->seen = *seen;
  target->nearness = *nearness;
  const VkImageView views[] = {target->seen->view, target->nearness->view};
  VkFramebufferCreateInfo create{VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO};
  create.renderPass = pass;
  create.attachmentCount = 2;
  create.pAttachments = views;
  create.width = std::uint32_t(width);
  create.height = std::uint32_t(height);
  create.layers = 1;
  target->gpu = std::move(gpu);
  const Gpu& on = *target->gpu;
  if (const auto r = on.vk.CreateFramebuffer(on.device, &create, nullptr, &target->framebuffer); r != VK_SUCCESS)
    return vulkan_error(r, "prepared to draw");
  return RasterTargetPtr(std::move(target));
}

void begin_drawing(const Gpu& gpu, VkCommandBuffer buffer, const RasterTarget& target, VkRenderPass pass, bool first) {
  constexpr VkImageLayout kColor = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  constexpr VkImageLayout kDepth = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
  const VkMemoryBarrier written{VK_STRUCTURE_TYPE_MEMORY_BARRIER, nullptr,
                                VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT, VK_ACCESS_SHADER_READ_BIT};
  const VkImageMemoryBarrier turns[] = {turn(*target.seen, VK_IMAGE_ASPECT_COLOR_BIT, kColorAccess, kColorAccess,
                                             first ? VK_IMAGE_LAYOUT_UNDEFINED : kColor, kColor),
                                        turn(*target.nearness, VK_IMAGE_ASPECT_DEPTH_BIT, kDepthAccess, kDepthAccess,
                                             first ? VK_IMAGE_LAYOUT_UNDEFINED : kDepth, kDepth)};
  gpu.vk.CmdPipelineBarrier(
      buffer, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT | kDrawingStages,
      VK_PIPELINE_STAGE_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT | kDrawingStages, 0, 1, &written, 0,
      nullptr, 2, turns);
  const std::array<VkClearValue, 2> nothing{};  // index 0, infinitely far
  VkRenderPassBeginInfo begin{VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO};
  begin.renderPass = pass;
  begin.framebuffer = target.framebuffer;
  begin.renderArea = {{0, 0}, {std::uint32_t(target.width), std::uint32_t(target.height)}};
  begin.clearValueCount = std::uint32_t(nothing.size());
  begin.pClearValues = nothing.data();
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
      turn(*target.seen, VK_IMAGE_ASPECT_COLOR_BIT, kColorAccess, VK_ACCESS_TRANSFER_READ_BIT,
           VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  gpu.vk.CmdPipelineBarrier(buffer,
                            VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT | kDrawingStages,
                            VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 1, &used, 0, nullptr, 1, &drawn);
  VkBufferImageCopy region{};
  region.bufferOffset = to.offset;
  region.bufferRowLength = std::uint32_t(stride);
  region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  region.imageExtent = {std::uint32_t(target.width), std::uint32_t(target.height), 1};
  gpu.vk.CmdCopyImageToBuffer(buffer, target.seen->image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, to.buffer, 1, &region);
}

}  // namespace umbrage
