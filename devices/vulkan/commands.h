// What a Vulkan device is asked for, noted down until somebody needs the result; then it is all handed over at once.
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

  /// Where to note down; begins where nothing is noted yet. Errors: kDevice.
  Result<VkCommandBuffer> buffer();
  /// What follows sees all that was written before, and writes only after all that was read before.
  void barrier();
  /// Hands over what is noted and waits for it. Errors: kDevice; what was noted is then gone.
  Result<void> finish();
  /// What is handed over next waits for `before`, unless that is null.
  void wait_for(VkSemaphore before) { before_ = before; }
  /// Hands over what is noted, before `signal` where that is not null, without waiting: that is done before something
  /// is noted again. Errors: kDevice.
  Result<void> hand_over(VkSemaphore signal);
  /// Forgets what is noted.
  void drop();
  /// Keeps something alive until that has happened.
  void keep(std::shared_ptr<const void> what) { kept_.push_back(std::move(what)); }

  /// Bytes for constants of the commands noted down next; `offset` is where they lie in uniform_buffer(). Hands over
  /// what is noted where there is no more room, so it comes before buffer(). Errors: kDevice.
  struct Uniforms {
    std::byte* bytes = nullptr;
    std::uint32_t offset = 0;
  };
  Result<Uniforms> uniforms(std::size_t bytes);
  VkBuffer uniform_buffer() const { return uniforms_->buffer; }
  /// A set of storage buffers for the pass noted down next: one at most, between uniforms() and buffer(). Errors:
  /// kDevice.
  Result<VkDescriptorSet> descriptor_set(VkDescriptorSetLayout layout, std::span<const VkDescriptorBufferInfo> buffers);

  /// Work that takes about as long each time: a shader, and a number that stands for what it is set to.
  struct Kind {
    VkPipeline pipeline = VK_NULL_HANDLE;
    std::size_t settings = 0;
    auto operator<=>(const Kind&) const = default;
  };
  /// Between these a pass of so many workgroups is noted down, or a further band of the one before, whose time is
  /// taken.
  void begin_pass(std::string_view effect, std::string_view pass, Kind kind, double groups, bool further);
  void end_pass();
  /// What a workgroup of a kind took when that was last known.
  std::optional<double> ms_of_group(Kind kind) const;
  /// What all that is noted down is likely to take, as far as that is known.
  double noted_ms() const { return noted_ms_; }
  bool takes_times() const { return queries_ != VK_NULL_HANDLE; }
  std::vector<PassTime> take_pass_times() { return std::exchange(times_, {}); }

 private:
  explicit Commands(GpuPtr gpu) : gpu_(std::move(gpu)) {}
  Result<void> submit(VkSemaphore signal);
  Result<void> wait_for_it();
  void reset();
  Result<void> read_times();
  Error failed(VkResult result);

  GpuPtr gpu_;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkCommandBuffer buffer_ = VK_NULL_HANDLE;
  VkFence fence_ = VK_NULL_HANDLE;
  VkSemaphore before_ = VK_NULL_HANDLE;  // of what is handed over next
  VkQueryPool queries_ = VK_NULL_HANDLE;
  VkDescriptorPool sets_ = VK_NULL_HANDLE;
  HostBufferPtr uniforms_;
  std::size_t uniforms_used_ = 0;
  bool recording_ = false, handed_over_ = false;
  std::optional<Error> lost_;  // what there is to say of a device that is gone: it is asked for nothing more
  std::vector<std::shared_ptr<const void>> kept_;
  struct Timed {
    PassTime time;
    Kind kind;
    double groups = 0.0;
    bool further = false;
  };
  std::vector<Timed> timed_;  // of the commands noted down, still without times
  std::map<Kind, double> ms_of_group_;
  double noted_ms_ = 0.0;
  std::vector<PassTime> times_;
};

/// The most bytes of constants that one pass may have: what every device reads at once.
inline constexpr std::size_t kMaxUniforms = 16384;

}  // namespace umbrage
