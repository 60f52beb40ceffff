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
  /// Makes the next submission wait for `before`, unless that is null.
  void wait_for(VkSemaphore before) { before_ = before; }
  /// Submits the recorded work without waiting, and signals `signal` when it is done, unless that is null. The next
  /// recording waits until it is done. Errors: kDevice.
  Result<void> submit_without_waiting(VkSemaphore signal);
  /// Discards the recorded work.
  void drop();
  /// Keeps an object alive until the recorded work is done.
  void keep(std::shared_ptr<const void> what) { kept_.push_back(std::move(what)); }

  /// Returns bytes for constants of the commands recorded next; `offset` is their offset in uniform_buffer(). Submits
  /// the recorded work if there is no more room, so call it before buffer(). Errors: kDevice.
  struct Uniforms {
    std::byte* bytes = nullptr;
    std::uint32_t offset = 0;
  };
  Result<Uniforms> uniforms(std::size_t bytes);
  VkBuffer uniform_buffer() const { return uniforms_->buffer; }
  /// Returns a set of storage buffers for the dispatch recorded next: at most one, between uniforms() and buffer().
  /// Errors: kDevice.
  Result<VkDescriptorSet> descriptor_set(VkDescriptorSetLayout layout, std::span<const VkDescriptorBufferInfo> buffers);

  /// Work that takes about the same time each run: a shader, and a number that identifies its settings.
  struct Kind {
    VkPipeline pipeline = VK_NULL_HANDLE;
    std::size_t settings = 0;
    auto operator<=>(const Kind&) const = default;
  };
  /// Enclose the recording of a dispatch of `groups` workgroups, or with `further` of another row range of the previous
  /// one, and measure its time.
  void begin_dispatch(std::string_view effect, std::string_view dispatch, Kind kind, double groups, bool further);
  void end_dispatch();
  /// Returns the last known time per workgroup of a kind, milliseconds.
  std::optional<double> ms_of_group(Kind kind) const;
  /// Returns the expected time of all recorded work, as far as it is known.
  double recorded_ms() const { return recorded_ms_; }
  bool takes_times() const { return queries_ != VK_NULL_HANDLE; }
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
  VkSemaphore before_ = VK_NULL_HANDLE;  // semaphore that the next submission waits for
  VkQueryPool queries_ = VK_NULL_HANDLE;
  VkDescriptorPool sets_ = VK_NULL_HANDLE;
  HostBufferPtr uniforms_;
  std::size_t uniforms_used_ = 0;
  bool recording_ = false, submitted_ = false;
  std::optional<Error> lost_;  // error of a lost device: it gets no more work
  std::vector<std::shared_ptr<const void>> kept_;
  struct Timed {
    DispatchTime time;
    Kind kind;
    double groups = 0.0;
    bool further = false;
  };
  std::vector<Timed> timed_;  // dispatches that are recorded, without times yet
  std::map<Kind, double> ms_of_group_;
  double recorded_ms_ = 0.0;
  std::vector<DispatchTime> times_;
};

/// Max bytes of constants of one dispatch: every device can read that many at once.
inline constexpr std::size_t kMaxUniforms = 16384;

}  // namespace umbrage
