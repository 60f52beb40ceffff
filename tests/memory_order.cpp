#include "memory_order.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>
#include <mutex>
#include <string_view>

#include "core/lists.h"

namespace umbrage::test {

struct MemoryOrder::Rule {
  const char* name;
  VkPipelineStageFlags stage;
  VkAccessFlags access;
  bool writes, copies;
};

const std::array<MemoryOrder::Rule, MemoryOrder::kKinds> MemoryOrder::kRules = {{
    {"the reads of a kernel", VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT, false, false},
    {"the writes of a kernel", VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT, true, false},
    {"the reads of a vertex shader", VK_PIPELINE_STAGE_VERTEX_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT, false, false},
    {"the reads of a fragment shader", VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT, false, false},
    {"the reads of a copy", VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_READ_BIT, false, true},
    {"the writes of a copy", VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT, true, true},
    {"the reads of the host", VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT, false, false},
}};

void MemoryOrder::begin() {
  accesses_ = {};
  command_ = 0;
}

void MemoryOrder::kernel() {
  ++command_;
  access(kKernelReads);
  access(kKernelWrites);
}

void MemoryOrder::draw() {
  ++command_;
  access(kVertexReads);
  access(kFragmentReads);
}

void MemoryOrder::copy(bool reads_buffer, bool writes_buffer) {
  ++command_;
  if (reads_buffer) access(kCopyReads);
  if (writes_buffer) access(kCopyWrites);
}

void MemoryOrder::submit() {
  ++command_;
  // Only copies write to memory that the host reads.
  const Access copied = accesses_[kCopyWrites];
  accesses_ = {};
  accesses_[kCopyWrites] = copied;
  access(kHostReads);
}

void MemoryOrder::access(Kind kind) {
  const Rule& rule = kRules[kind];
  for (int k = 0; k < kKinds; ++k) {
    const Access& before = accesses_[std::size_t(k)];
    const Rule& rule_before = kRules[std::size_t(k)];
    if (!before.pending || before.command == command_ || !(rule.writes || rule_before.writes) ||
        (rule.copies && rule_before.copies))
      continue;
    const bool in_order = rule_before.writes ? before.visible[kind] : (before.later_stages & rule.stage) != 0;
    if (!in_order)
      report_(fmt::format("no barrier orders {} (command {}) after {} (command {})", rule.name, command_,
                          rule_before.name, before.command));
  }
  accesses_[kind] = {.pending = true, .command = command_};
}

namespace {

/// The host is not a stage of commands.
constexpr VkPipelineStageFlags kAllButHost = ~VkPipelineStageFlags(VK_PIPELINE_STAGE_HOST_BIT);

/// A barrier orders commands after all earlier stages of the graphics pipeline too, and before all later ones. What it
/// makes available and visible is only that of the stages that it names.
VkPipelineStageFlags with_earlier_stages(VkPipelineStageFlags stages) {
  constexpr VkPipelineStageFlags kFragments =
      VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT | VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT;
  constexpr VkPipelineStageFlags kOutputs =
      VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT;
  if (stages & VK_PIPELINE_STAGE_ALL_COMMANDS_BIT) return kAllButHost;
  if (stages & kOutputs) stages |= kFragments;
  if (stages & kFragments) stages |= VK_PIPELINE_STAGE_VERTEX_SHADER_BIT;
  return stages;
}
VkPipelineStageFlags with_later_stages(VkPipelineStageFlags stages) {
  if (stages & VK_PIPELINE_STAGE_ALL_COMMANDS_BIT) return kAllButHost;
  if (stages & (VK_PIPELINE_STAGE_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT))
    stages |= VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT;
  return stages;
}

}  // namespace

void MemoryOrder::barrier(VkPipelineStageFlags from, VkPipelineStageFlags to, VkAccessFlags made_available,
                          VkAccessFlags made_visible) {
  const VkPipelineStageFlags first = with_earlier_stages(from), second = with_later_stages(to);
  const auto covers = [](VkPipelineStageFlags stages, VkAccessFlags accesses, const Rule& rule) {
    const VkAccessFlags any = rule.writes ? VK_ACCESS_MEMORY_WRITE_BIT : VK_ACCESS_MEMORY_READ_BIT;
    const bool names_stage =
        (stages & rule.stage) || ((stages & VK_PIPELINE_STAGE_ALL_COMMANDS_BIT) && (rule.stage & kAllButHost));
    return names_stage && (accesses & (rule.access | any));
  };
  for (std::size_t k = 0; k < kKinds; ++k) {
    Access& before = accesses_[k];
    if (!before.pending || !((kRules[k].stage | before.later_stages) & first)) continue;
    before.available = before.available || covers(from, made_available, kRules[k]);
    before.later_stages |= second;
    for (std::size_t later = 0; later < kKinds; ++later)
      if (before.available && covers(to, made_visible, kRules[later])) before.visible[later] = true;
  }
}

namespace {

/// The system's functions that are intercepted, and the state of each command buffer.
struct Checker {
  std::mutex mutex;
  std::map<VkCommandBuffer, MemoryOrder> buffers;
  PFN_vkGetInstanceProcAddr get = nullptr;
  PFN_vkDestroyCommandPool destroy_pool = nullptr;
  PFN_vkBeginCommandBuffer begin = nullptr;
  PFN_vkQueueSubmit submit = nullptr;
  PFN_vkCmdDispatch dispatch = nullptr;
  PFN_vkCmdDispatchBase dispatch_base = nullptr;
  PFN_vkCmdDraw draw = nullptr;
  PFN_vkCmdCopyBuffer copy = nullptr;
  PFN_vkCmdFillBuffer fill = nullptr;
  PFN_vkCmdCopyImageToBuffer from_image = nullptr;
  PFN_vkCmdCopyBufferToImage to_image = nullptr;
  PFN_vkCmdPipelineBarrier barrier = nullptr;
};

Checker& checker() {
  static Checker& state = *new Checker;  // devices outlive the destructors of statics
  return state;
}

/// Calls use(order) with the commands of a buffer.
template <class Use>
void with_order(VkCommandBuffer buffer, Use use) {
  const std::lock_guard lock(checker().mutex);
  const auto report = [](const std::string& text) { memory_order_report()(text); };
  use(checker().buffers.try_emplace(buffer, report).first->second);
}

VKAPI_ATTR void VKAPI_CALL destroy_pool(VkDevice device, VkCommandPool pool, const VkAllocationCallbacks* allocator) {
  checker().destroy_pool(device, pool, allocator);
  const std::lock_guard lock(checker().mutex);
  checker().buffers.clear();  // a new buffer may have the handle of an old one, and an engine begins it unseen
}
VKAPI_ATTR VkResult VKAPI_CALL begin(VkCommandBuffer buffer, const VkCommandBufferBeginInfo* info) {
  with_order(buffer, [](MemoryOrder& order) { order.begin(); });
  return checker().begin(buffer, info);
}
VKAPI_ATTR VkResult VKAPI_CALL submit(VkQueue queue, std::uint32_t count, const VkSubmitInfo* work, VkFence fence) {
  for (std::uint32_t k = 0; k < count; ++k)
    for (std::uint32_t b = 0; b < work[k].commandBufferCount; ++b)
      with_order(work[k].pCommandBuffers[b], [](MemoryOrder& order) { order.submit(); });
  return checker().submit(queue, count, work, fence);
}
VKAPI_ATTR void VKAPI_CALL dispatch(VkCommandBuffer buffer, std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  with_order(buffer, [](MemoryOrder& order) { order.kernel(); });
  checker().dispatch(buffer, x, y, z);
}
VKAPI_ATTR void VKAPI_CALL dispatch_base(VkCommandBuffer buffer, std::uint32_t x0, std::uint32_t y0, std::uint32_t z0,
                                         std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  with_order(buffer, [](MemoryOrder& order) { order.kernel(); });
  checker().dispatch_base(buffer, x0, y0, z0, x, y, z);
}
VKAPI_ATTR void VKAPI_CALL draw(VkCommandBuffer buffer, std::uint32_t vertices, std::uint32_t instances,
                                std::uint32_t first_vertex, std::uint32_t first_instance) {
  with_order(buffer, [](MemoryOrder& order) { order.draw(); });
  checker().draw(buffer, vertices, instances, first_vertex, first_instance);
}
VKAPI_ATTR void VKAPI_CALL copy(VkCommandBuffer buffer, VkBuffer from, VkBuffer to, std::uint32_t count,
                                const VkBufferCopy* regions) {
  with_order(buffer, [](MemoryOrder& order) { order.copy(true, true); });
  checker().copy(buffer, from, to, count, regions);
}
VKAPI_ATTR void VKAPI_CALL fill(VkCommandBuffer buffer, VkBuffer to, VkDeviceSize offset, VkDeviceSize size,
                                std::uint32_t value) {
  with_order(buffer, [](MemoryOrder& order) { order.copy(false, true); });
  checker().fill(buffer, to, offset, size, value);
}
VKAPI_ATTR void VKAPI_CALL from_image(VkCommandBuffer buffer, VkImage from, VkImageLayout layout, VkBuffer to,
                                      std::uint32_t count, const VkBufferImageCopy* regions) {
  with_order(buffer, [](MemoryOrder& order) { order.copy(false, true); });
  checker().from_image(buffer, from, layout, to, count, regions);
}
VKAPI_ATTR void VKAPI_CALL to_image(VkCommandBuffer buffer, VkBuffer from, VkImage to, VkImageLayout layout,
                                    std::uint32_t count, const VkBufferImageCopy* regions) {
  with_order(buffer, [](MemoryOrder& order) { order.copy(true, false); });
  checker().to_image(buffer, from, to, layout, count, regions);
}
VKAPI_ATTR void VKAPI_CALL barrier(VkCommandBuffer buffer, VkPipelineStageFlags from, VkPipelineStageFlags to,
                                   VkDependencyFlags flags, std::uint32_t memory_count, const VkMemoryBarrier* memory,
                                   std::uint32_t buffer_count, const VkBufferMemoryBarrier* buffers,
                                   std::uint32_t image_count, const VkImageMemoryBarrier* images) {
  // Barriers of images order commands too, but make no buffers visible.
  with_order(buffer, [&](MemoryOrder& order) {
    order.barrier(from, to, 0, 0);
    if (buffer_count > 0) memory_order_report()("barriers of buffers are not in the model of the order of accesses");
    for (std::uint32_t k = 0; k < memory_count; ++k)
      order.barrier(from, to, memory[k].srcAccessMask, memory[k].dstAccessMask);
  });
  checker().barrier(buffer, from, to, flags, memory_count, memory, buffer_count, buffers, image_count, images);
}

}  // namespace

std::function<void(const std::string&)>& memory_order_report() {
  static auto& report =
      *new std::function<void(const std::string&)>([](const std::string& text) { ADD_FAILURE() << text; });
  return report;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL checked_get(VkInstance instance, const char* name) {
  // Commands that access no buffers, or only attachments, or a buffer of times that nothing else accesses.
  static constexpr std::string_view kUnchecked[] = {
      "vkCmdBindPipeline",   "vkCmdBindDescriptorSets", "vkCmdPushConstants",          "vkCmdResetQueryPool",
      "vkCmdWriteTimestamp", "vkCmdBeginRenderPass",    "vkCmdEndRenderPass",          "vkCmdSetViewport",
      "vkCmdSetScissor",     "vkCmdClearColorImage",    "vkCmdClearDepthStencilImage", "vkCmdCopyQueryPoolResults"};
  Checker& c = checker();
  const std::lock_guard lock(c.mutex);
  if (!c.get) {
    const auto loaded = load_vulkan();
    if (!loaded) return nullptr;
    c.get = *loaded;
  }
  const PFN_vkVoidFunction real = c.get(instance, name);
  if (!real) return nullptr;
  for (const PFN_vkVoidFunction replacement :
       {replaced("vkDestroyCommandPool", name, real, c.destroy_pool, destroy_pool),
        replaced("vkBeginCommandBuffer", name, real, c.begin, begin),
        replaced("vkQueueSubmit", name, real, c.submit, submit),
        replaced("vkCmdDispatch", name, real, c.dispatch, dispatch),
        replaced("vkCmdDispatchBase", name, real, c.dispatch_base, dispatch_base),
        replaced("vkCmdDraw", name, real, c.draw, draw), replaced("vkCmdCopyBuffer", name, real, c.copy, copy),
        replaced("vkCmdFillBuffer", name, real, c.fill, fill),
        replaced("vkCmdCopyImageToBuffer", name, real, c.from_image, from_image),
        replaced("vkCmdCopyBufferToImage", name, real, c.to_image, to_image),
        replaced("vkCmdPipelineBarrier", name, real, c.barrier, barrier)})
    if (replacement) return replacement;
  if (std::string_view(name).starts_with("vkCmd") && !contains(kUnchecked, name))
    memory_order_report()(fmt::format("{} is not in the model of the order of accesses", name));
  return real;
}

}  // namespace umbrage::test
