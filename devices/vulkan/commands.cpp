#include "devices/vulkan/commands.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

#include "core/check.h"
#include "kernel/frame_constants.h"

namespace umbrage {
namespace {

/// Memory for constants, bytes: enough for some hundreds of dispatches, and behind it for those of the caller's command
/// buffers. The memory of a slot begins with its two times.
constexpr std::size_t kUniformBytes = std::size_t(2) << 20;
constexpr std::size_t kSlotBytes = std::size_t(256) << 10;
constexpr std::size_t kSlotStart = 256;         // on every device a multiple of the alignment of constants
constexpr std::uint32_t kMaxRecorded = 256;     // dispatches of a recording in a command buffer of the caller
constexpr std::uint32_t kMaxDispatches = 1024;  // per submission; each uses two timestamps and a descriptor set
constexpr std::size_t kMaxTimes = 65536;        // unread times that are kept
constexpr std::size_t kMaxKinds = 4096;         // kinds of work whose time is known
constexpr VkAccessFlags kWrites = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
constexpr VkAccessFlags kReads = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_TRANSFER_READ_BIT;
constexpr VkPipelineStageFlags kStages = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;

}  // namespace

Result<std::unique_ptr<Commands>> Commands::make(GpuPtr gpu, const std::shared_ptr<Memory>& memory) {
  auto commands = std::unique_ptr<Commands>(new Commands(std::move(gpu), memory));
  const Gpu& opened = *commands->gpu_;
  const auto failed = [](VkResult result) -> Error { return vulkan_error(result, "was opened"); };
  VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  pool.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
  pool.queueFamilyIndex = opened.family;
  if (const auto r = opened.vk.CreateCommandPool(opened.device, &pool, nullptr, &commands->pool_); r != VK_SUCCESS)
    return failed(r);
  VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  allocate.commandPool = commands->pool_;
  allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  allocate.commandBufferCount = 1;
  if (const auto r = opened.vk.AllocateCommandBuffers(opened.device, &allocate, &commands->buffer_); r != VK_SUCCESS)
    return failed(r);
  const VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  if (const auto r = opened.vk.CreateFence(opened.device, &fence, nullptr, &commands->fence_); r != VK_SUCCESS)
    return failed(r);
  if (auto made = commands->make_pools(kMaxDispatches, 2 * kMaxDispatches, commands->sets_, commands->queries_); !made)
    return made.error();
  auto uniforms = memory->host(kUniformBytes + kRecordingSlots * kSlotBytes + kMaxUniforms, true);
  if (!uniforms) return uniforms.error();
  commands->uniforms_ = *uniforms;
  return commands;
}

Result<void> Commands::make_pools(std::uint32_t max_sets, std::uint32_t queries, VkDescriptorPool& set_pool,
                                  VkQueryPool& query_pool) const {
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, max_sets * std::uint32_t(kBoundPlanes)};
  VkDescriptorPoolCreateInfo sets{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  sets.maxSets = max_sets;
  sets.poolSizeCount = 1;
  sets.pPoolSizes = &size;
  VkQueryPoolCreateInfo times{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
  times.queryType = VK_QUERY_TYPE_TIMESTAMP;
  times.queryCount = queries;
  VkResult made = VK_SUCCESS;
  if (gpu_->ns_of_tick > 0.0 && !query_pool)
    made = gpu_->vk.CreateQueryPool(gpu_->device, &times, nullptr, &query_pool);
  if (made == VK_SUCCESS) made = gpu_->vk.CreateDescriptorPool(gpu_->device, &sets, nullptr, &set_pool);
  return made == VK_SUCCESS ? Result<void>() : vulkan_error(made, "was opened");
}

Commands::~Commands() {
  if (submitted_) gpu_->vk.WaitForFences(gpu_->device, 1, &fence_, VK_TRUE, std::numeric_limits<std::uint64_t>::max());
  if (recording_) gpu_->vk.EndCommandBuffer(buffer_);
  kept_.clear();
  for (const Recording& of : slots_) {
    if (of.sets) gpu_->vk.DestroyDescriptorPool(gpu_->device, of.sets, nullptr);
    if (of.queries) gpu_->vk.DestroyQueryPool(gpu_->device, of.queries, nullptr);
  }
  if (sets_) gpu_->vk.DestroyDescriptorPool(gpu_->device, sets_, nullptr);
  if (queries_) gpu_->vk.DestroyQueryPool(gpu_->device, queries_, nullptr);
  if (fence_) gpu_->vk.DestroyFence(gpu_->device, fence_, nullptr);
  if (pool_) gpu_->vk.DestroyCommandPool(gpu_->device, pool_, nullptr);
}

Result<VkCommandBuffer> Commands::buffer() {
  if (lost_) return *lost_;
  if (callers_) return callers_->buffer;
  if (submitted_)
    if (auto status = wait_for_submission(); !status) return status.error();
  if (recording_) return buffer_;
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  if (const auto r = gpu_->vk.BeginCommandBuffer(buffer_, &begin); r != VK_SUCCESS)
    return vulkan_error(r, "recorded its work");
  recording_ = true;
  if (queries_) gpu_->vk.CmdResetQueryPool(buffer_, queries_, 0, 2 * kMaxDispatches);
  return buffer_;
}

void Commands::barrier() {
  const VkMemoryBarrier all{VK_STRUCTURE_TYPE_MEMORY_BARRIER, nullptr, kWrites, kReads | kWrites};
  gpu_->vk.CmdPipelineBarrier(callers_ ? callers_->buffer : buffer_, kStages, kStages, 0, 1, &all, 0, nullptr, 0,
                              nullptr);
}

Result<void> Commands::begin_recording(VkCommandBuffer buffer, int slot) {
  if (lost_) return *lost_;
  Recording& to = slots_[std::size_t(slot)];
  to.user = std::make_shared<char>();
  to.cost = {};
  to.begin = kUniformBytes + std::size_t(slot) * kSlotBytes;
  to.used = kSlotStart;
  std::memset(uniforms_->mapped + to.begin, 0, kSlotStart);
  if (to.sets)
    gpu_->vk.ResetDescriptorPool(gpu_->device, to.sets, 0);
  else if (auto made = make_pools(kMaxRecorded, 2, to.sets, to.queries); !made)
    return made;
  callers_ = &to;
  to.buffer = buffer;
  memory_->set_user(to.user);
  if (!to.queries) return {};
  gpu_->vk.CmdResetQueryPool(buffer, to.queries, 0, 2);
  gpu_->vk.CmdWriteTimestamp(buffer, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, to.queries, 0);
  return {};
}

void Commands::make_visible_to_host(VkCommandBuffer buffer) const {
  const VkMemoryBarrier to_host{VK_STRUCTURE_TYPE_MEMORY_BARRIER, nullptr, VK_ACCESS_TRANSFER_WRITE_BIT,
                                VK_ACCESS_HOST_READ_BIT};
  gpu_->vk.CmdPipelineBarrier(buffer, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &to_host, 0,
                              nullptr, 0, nullptr);
}

void Commands::end_recording() {
  if (!callers_) return;
  if (callers_->queries) {
    const auto& vk = gpu_->vk;
    vk.CmdWriteTimestamp(callers_->buffer, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, callers_->queries, 1);
    vk.CmdCopyQueryPoolResults(callers_->buffer, callers_->queries, 0, 2, uniforms_->buffer, callers_->begin,
                               sizeof(std::uint64_t), VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT);
    make_visible_to_host(callers_->buffer);
  }
  callers_ = nullptr;
  memory_->set_user({});
}

RecordingCost Commands::cost(int slot) const {
  const Recording& of = slots_[std::size_t(slot)];
  RecordingCost cost = of.cost;
  std::uint64_t ticks[2];
  std::memcpy(ticks, uniforms_->mapped + of.begin, sizeof ticks);
  if (of.queries && ticks[1] > ticks[0]) cost.ms = double(ticks[1] - ticks[0]) * gpu_->ns_of_tick * 1e-6;
  return cost;
}

Result<void> Commands::finish() {
  if (lost_) return *lost_;
  if (submitted_) return wait_for_submission();
  if (!recording_) return {};
  Result<void> status = submit(VK_NULL_HANDLE);
  if (!status) {
    reset();
    return status;
  }
  return wait_for_submission();
}

Result<void> Commands::submit_without_waiting(VkSemaphore signal) {
  if (const auto begun = buffer(); !begun) return begun.error();  // semaphores require a submission, even an empty one
  Result<void> status = submit(signal);
  if (!status) reset();
  return status;
}

void Commands::drop() {
  wait_semaphore_ = VK_NULL_HANDLE;
  if (!recording_) return;
  gpu_->vk.EndCommandBuffer(buffer_);
  reset();
}

void Commands::reset() {
  recording_ = submitted_ = false;
  uniforms_used_ = 0;
  recorded_ms_ = 0.0;
  timed_.clear();
  kept_.clear();
  gpu_->vk.ResetCommandPool(gpu_->device, pool_, 0);
  gpu_->vk.ResetDescriptorPool(gpu_->device, sets_, 0);
}

Error Commands::failed(VkResult result) {
  Error error = vulkan_error(result, "worked");
  if (result == VK_ERROR_DEVICE_LOST) lost_ = error;
  return error;
}

Result<void> Commands::submit(VkSemaphore signal) {
  const auto& vk = gpu_->vk;
  make_visible_to_host(buffer_);
  if (const auto r = vk.EndCommandBuffer(buffer_); r != VK_SUCCESS) return failed(r);
  const VkPipelineStageFlags all = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT;
  VkSubmitInfo work{VK_STRUCTURE_TYPE_SUBMIT_INFO};
  work.commandBufferCount = 1;
  work.pCommandBuffers = &buffer_;
  const VkSemaphore wait_semaphore = std::exchange(wait_semaphore_, VK_NULL_HANDLE);
  work.waitSemaphoreCount = wait_semaphore ? 1 : 0;
  work.pWaitSemaphores = &wait_semaphore;
  work.pWaitDstStageMask = &all;
  work.signalSemaphoreCount = signal ? 1 : 0;
  work.pSignalSemaphores = &signal;
  if (const auto r = vk.QueueSubmit(gpu_->queue, 1, &work, fence_); r != VK_SUCCESS) return failed(r);
  recording_ = false;
  submitted_ = true;
  return {};
}

Result<void> Commands::wait_for_submission() {
  const auto& vk = gpu_->vk;
  const VkResult waited =
      vk.WaitForFences(gpu_->device, 1, &fence_, VK_TRUE, std::numeric_limits<std::uint64_t>::max());
  // If waiting failed, the GPU may still be working: its resources may be reused only once it is idle.
  if (waited != VK_SUCCESS && vk.DeviceWaitIdle(gpu_->device) != VK_SUCCESS) {
    submitted_ = false;
    lost_ = vulkan_error(waited, "worked");
    return *lost_;
  }
  struct AtEnd {
    Commands& commands;
    ~AtEnd() { commands.reset(); }
  } const at_end{*this};  // even if reading the times throws: the fence will not be signalled again
  if (const auto r = vk.ResetFences(gpu_->device, 1, &fence_); r != VK_SUCCESS) lost_ = vulkan_error(r, "worked");
  if (waited != VK_SUCCESS) return failed(waited);
  return lost_ ? Result<void>(*lost_) : read_times();
}

Result<void> Commands::read_times() {
  if (timed_.empty() || !queries_) return {};
  std::vector<std::uint64_t> ticks(2 * timed_.size());
  const VkResult read = gpu_->vk.GetQueryPoolResults(gpu_->device, queries_, 0, std::uint32_t(ticks.size()),
                                                     ticks.size() * sizeof(std::uint64_t), ticks.data(),
                                                     sizeof(std::uint64_t), VK_QUERY_RESULT_64_BIT);
  if (read != VK_SUCCESS) return vulkan_error(read, "reported the times of its dispatches");
  if (times_.size() > kMaxTimes) times_.clear();
  if (ms_per_group_.size() > kMaxKinds) ms_per_group_.clear();
  std::map<Kind, double> slowest;  // of the row ranges of a dispatch, which differ: background is faster
  for (std::size_t k = 0; k < timed_.size(); ++k) {
    Timed& timed = timed_[k];
    timed.time.ms = double(ticks[2 * k + 1] - ticks[2 * k]) * gpu_->ns_of_tick * 1e-6;
    double& per_group = slowest[timed.kind];
    per_group = std::max(per_group, timed.time.ms / timed.groups);
    if (timed.continues && !times_.empty())
      times_.back().ms += timed.time.ms;
    else
      times_.push_back(std::move(timed.time));
  }
  for (const auto& [kind, ms] : slowest) ms_per_group_[kind] = ms;
  return {};
}

std::optional<double> Commands::ms_per_group(Kind kind) const {
  const auto found = ms_per_group_.find(kind);
  return found == ms_per_group_.end() ? std::nullopt : std::optional(found->second);
}

Result<Commands::Uniforms> Commands::uniforms(std::size_t bytes) {
  check_less(bytes, kMaxUniforms + 1, "bytes of constants");
  if (lost_) return *lost_;
  std::size_t& used = callers_ ? callers_->used : uniforms_used_;
  const std::size_t begin = callers_ ? callers_->begin : 0;
  if (callers_ && (used + bytes > kSlotBytes || std::uint32_t(callers_->cost.dispatches) >= kMaxRecorded))
    return usage_error("a command buffer takes at most {} dispatches: record the effects in two of them",
                       callers_->cost.dispatches);
  if (submitted_ && !callers_)
    if (auto status = wait_for_submission(); !status) return status.error();
  if (!callers_ && (used + bytes > kUniformBytes || timed_.size() >= kMaxDispatches))
    if (auto status = finish(); !status) return status.error();
  const Uniforms slice{uniforms_->mapped + begin + used, std::uint32_t(begin + used)};
  const std::size_t step = gpu_->properties.limits.minUniformBufferOffsetAlignment;
  used = (used + bytes + step - 1) / step * step;
  return slice;
}

Result<VkDescriptorSet> Commands::descriptor_set(VkDescriptorSetLayout layout,
                                                 std::span<const VkDescriptorBufferInfo> buffers) {
  VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  allocate.descriptorPool = callers_ ? callers_->sets : sets_;
  allocate.descriptorSetCount = 1;
  allocate.pSetLayouts = &layout;
  VkDescriptorSet set = VK_NULL_HANDLE;
  if (const auto r = gpu_->vk.AllocateDescriptorSets(gpu_->device, &allocate, &set); r != VK_SUCCESS)
    return vulkan_error(r, "recorded its work");
  VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
  write.dstSet = set;
  write.descriptorCount = std::uint32_t(buffers.size());
  write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
  write.pBufferInfo = buffers.data();
  gpu_->vk.UpdateDescriptorSets(gpu_->device, 1, &write, 0, nullptr);
  return set;
}

void Commands::begin_dispatch(std::string_view effect, std::string_view dispatch, Kind kind, double groups,
                              bool continues) {
  if (callers_) {
    ++callers_->cost.dispatches;
    return;
  }
  timed_.push_back({{std::string(effect), std::string(dispatch), 0.0}, kind, groups, continues});
  recorded_ms_ += groups * ms_per_group(kind).value_or(0.0);
  if (queries_)
    gpu_->vk.CmdWriteTimestamp(buffer_, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, queries_,
                               2 * (std::uint32_t(timed_.size()) - 1));
}

void Commands::end_dispatch() {
  if (queries_ && !callers_)
    gpu_->vk.CmdWriteTimestamp(buffer_, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, queries_,
                               2 * std::uint32_t(timed_.size()) - 1);
}

}  // namespace umbrage
