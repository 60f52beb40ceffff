// Records the work of a Vulkan device until a result is needed; then submits all of it at once.
#pragma once
#include <compare>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/device.h"
#include "devices/vulkan/memory.h"

namespace umbrage {

class Commands {
 public:
  /// Creates the recorder. Errors: kDevice.
  static Result<std::unique_ptr<Commands>> make(GpuPtr gpu, const std::shared_ptr<Memory>& memory);
  ~Commands();
  Commands(const Commands&) = delete;
  Commands& operator=(const Commands&) = delete;

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
  /// kDevice.
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
  explicit Commands(GpuPtr gpu) : gpu_(std::move(gpu)) {}
  Result<void> submit(VkSemaphore signal);
  Result<void> wait_for_submission();
  void reset();
  Result<void> read_times();
  Error failed(VkResult result);

  GpuPtr gpu_;
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
};

/// Max size of the constants of one dispatch, bytes: every Vulkan device supports uniform ranges of this size.
inline constexpr std::size_t kMaxUniforms = 16384;

}  // namespace umbrage
