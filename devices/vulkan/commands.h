// Records the work of a Vulkan device until a result is needed; then submits all of it at once.
#pragma once
#include <array>
#include <compare>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/device.h"
#include "devices/vulkan/memory.h"

namespace umbrage {

/// Max number of recordings in command buffers of the caller that exist at a time.
inline constexpr int kRecordingSlots = 8;

/// What one run of recorded work costs. Each dispatch counts each of its planes once, however many of its pixels a
/// kernel reads; copies of images are included.
struct RecordingCost {
  int dispatches = 0;
  std::uint64_t bytes_read = 0, bytes_written = 0;
  double ms = 0.0;  ///< on the device, from the first command to the last; 0: unknown
};

class Commands {
 public:
  /// Creates the recorder. Errors: kDevice.
  static Result<std::unique_ptr<Commands>> make(GpuPtr gpu, const std::shared_ptr<Memory>& memory);
  ~Commands();
  Commands(const Commands&) = delete;
  Commands& operator=(const Commands&) = delete;

  /// Directs all work to `buffer`, which belongs to the caller and is submitted by him, until end_recording. Constants,
  /// descriptor sets, times and memory of the planes remain until the next recording in this slot, 0 to kRecordingSlots
  /// - 1; before it the former one must be complete. Meanwhile finish() only waits for earlier work. Errors: kDevice.
  Result<void> begin_recording(VkCommandBuffer buffer, int slot);
  void end_recording();
  /// Adds the bytes of a dispatch or copy to the cost of the recording, if there is one.
  void count(VkDeviceSize read, VkDeviceSize written) {
    if (callers_) callers_->cost.bytes_read += read, callers_->cost.bytes_written += written;
  }
  /// Returns the cost of the slot's last recording; `ms` is that of its last complete execution.
  RecordingCost cost(int slot) const;

  /// Returns the command buffer; begins recording if nothing is recorded yet. Errors: kDevice.
  Result<VkCommandBuffer> buffer();
  /// Makes later commands see all earlier writes, and write only after all earlier reads.
  void barrier();
  /// Submits the recorded work and waits for it. Errors: kDevice; the recorded work is then lost.
  Result<void> finish();
  /// Makes the next submission wait for `semaphore`, unless null.
  void wait_for(VkSemaphore semaphore) { wait_semaphore_ = semaphore; }
  /// Submits the recorded work and returns at once. Signals `signal`, unless null, when the work is done. The next
  /// recording waits until then. Errors: kDevice.
  Result<void> submit_without_waiting(VkSemaphore signal);
  /// Discards the recorded work.
  void drop();
  /// Keeps an object alive until the recorded work is done.
  void keep(std::shared_ptr<const void> what) { kept_.push_back(std::move(what)); }

  /// Returns memory for the constants of the commands that are recorded next; `offset` is its offset in
  /// uniform_buffer(). If no memory is left, the recorded work is submitted first; so call it before buffer(). Errors:
  /// kDevice; kUsage if a recording of the caller has too many dispatches.
  struct Uniforms {
    std::byte* bytes = nullptr;
    std::uint32_t offset = 0;
  };
  Result<Uniforms> uniforms(std::size_t bytes);
  VkBuffer uniform_buffer() const { return uniforms_->buffer; }
  /// Returns a descriptor set of storage buffers for the dispatch that is recorded next. Call it at most once per
  /// dispatch, after uniforms() and before buffer(). Errors: kDevice.
  Result<VkDescriptorSet> descriptor_set(VkDescriptorSetLayout layout, std::span<const VkDescriptorBufferInfo> buffers);

  /// Identifies dispatches that take about the same time per workgroup: a shader, and a number for its settings.
  struct Kind {
    VkPipeline pipeline = VK_NULL_HANDLE;
    std::size_t settings = 0;
    auto operator<=>(const Kind&) const = default;
  };
  /// Call begin_dispatch() before and end_dispatch() after the commands of a dispatch of `groups` workgroups, to
  /// measure its time. `continues`: the commands run the previous dispatch on more rows, and their time is added to its
  /// time.
  void begin_dispatch(std::string_view effect, std::string_view dispatch, Kind kind, double groups, bool continues);
  void end_dispatch();
  /// Returns the time per workgroup of a kind when it was last measured, milliseconds; empty: never.
  std::optional<double> ms_per_group(Kind kind) const;
  /// Returns the expected time of the recorded dispatches, milliseconds. Kinds that were never measured count 0.
  double recorded_ms() const { return recorded_ms_; }
  bool measures_times() const { return queries_ != VK_NULL_HANDLE; }
  std::vector<DispatchTime> take_dispatch_times() { return std::exchange(times_, {}); }

 private:
  Commands(GpuPtr gpu, std::shared_ptr<Memory> memory) : gpu_(std::move(gpu)), memory_(std::move(memory)) {}
  /// Makes pools of descriptor sets and, if the device has timestamps, of queries. Errors: kDevice.
  Result<void> make_pools(std::uint32_t max_sets, std::uint32_t queries, VkDescriptorPool& set_pool,
                          VkQueryPool& query_pool) const;
  Result<void> submit(VkSemaphore signal);
  Result<void> wait_for_submission();
  void make_visible_to_host(VkCommandBuffer buffer) const;  // of copies
  void reset();
  Result<void> read_times();
  Error failed(VkResult result);

  GpuPtr gpu_;
  std::shared_ptr<Memory> memory_;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkCommandBuffer buffer_ = VK_NULL_HANDLE;
  VkFence fence_ = VK_NULL_HANDLE;
  VkSemaphore wait_semaphore_ = VK_NULL_HANDLE;  // the next submission waits for it
  VkQueryPool queries_ = VK_NULL_HANDLE;
  VkDescriptorPool sets_ = VK_NULL_HANDLE;
  HostBufferPtr uniforms_;
  std::size_t uniforms_used_ = 0;
  bool recording_ = false, submitted_ = false;
  std::optional<Error> lost_;  // set when the device is lost: no more work is submitted
  std::vector<std::shared_ptr<const void>> kept_;
  struct Timed {
    DispatchTime time;
    Kind kind;
    double groups = 0.0;
    bool continues = false;
  };
  std::vector<Timed> timed_;  // recorded dispatches, not yet measured
  std::map<Kind, double> ms_per_group_;
  double recorded_ms_ = 0.0;
  std::vector<DispatchTime> times_;
  /// The resources of a recording in a command buffer of the caller.
  struct Recording {
    VkCommandBuffer buffer = VK_NULL_HANDLE;
    VkDescriptorPool sets = VK_NULL_HANDLE;
    VkQueryPool queries = VK_NULL_HANDLE;  // of its beginning and end
    std::size_t begin = 0, used = 0;       // its memory for constants
    std::shared_ptr<const void> user;      // of the memory of its planes
    RecordingCost cost;
  };
  std::array<Recording, kRecordingSlots> slots_;
  Recording* callers_ = nullptr;  // the current one
};

/// Max size of the constants of one dispatch, bytes: every Vulkan device supports uniform ranges of this size.
inline constexpr std::size_t kMaxUniforms = 16384;

}  // namespace umbrage
