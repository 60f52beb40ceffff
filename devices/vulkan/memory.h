// Memory of a Vulkan device: planes of pictures, and buffers through which the host hands bytes over. Both are pooled:
// what is given back serves the next one of its size, so that pictures that are drawn one after the other take no new
// memory.
#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "core/result.h"
#include "devices/vulkan/gpu.h"

namespace umbrage {

/// A buffer with memory of its own.
struct Block {
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  VkDeviceSize size = 0;
  VkDeviceAddress address = 0;  ///< on the device; 0: none
  std::byte* mapped = nullptr;  ///< on the host, coherent; null: none
  bool counted = false;         ///< among what the pool holds
};

/// Room for one plane on the device.
struct DevicePlane {
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceSize offset = 0;
  VkDeviceAddress address = 0;
};
/// A picture that triangles are drawn into, with memory of its own.
struct DrawnImage {
  VkImage image = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  VkImageView view = VK_NULL_HANDLE;
  VkDeviceSize size = 0;
};
using DrawnImagePtr = std::shared_ptr<const DrawnImage>;

using DevicePlanePtr = std::shared_ptr<const DevicePlane>;
using HostBufferPtr = std::shared_ptr<const Block>;

class Memory : public std::enable_shared_from_this<Memory> {
 public:
  explicit Memory(GpuPtr gpu) : gpu_(std::move(gpu)) {}
  ~Memory();
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;

  /// Called before memory is given back to the driver: must wait until the device uses none.
  std::function<Result<void>()> wait = [] { return Result<void>(); };
  /// Called where the driver has no more memory: lets go of what can be made anew, and waits until the device uses it
  /// no longer.
  std::function<Result<void>()> spare = [] { return Result<void>(); };

  /// Room for a plane, uninitialised. What was recorded before may still read what it held: whoever writes it puts a
  /// barrier before. Errors: kDevice.
  Result<DevicePlanePtr> plane(VkDeviceSize bytes);
  /// A buffer of at least this size that the host writes or reads, and the device copies from or to; or, `uniform`,
  /// reads constants from. It must not be let go while the device uses it. Errors: kDevice.
  Result<HostBufferPtr> host(VkDeviceSize bytes, bool uniform = false);

  /// An attachment, uninitialised. It must not be let go while the device uses it. Errors: kDevice.
  Result<DrawnImagePtr> image(int width, int height, VkFormat format, VkImageUsageFlags usage,
                              VkImageAspectFlags aspect);

  /// Bytes taken from the driver, in use or kept.
  std::uint64_t device_bytes() const { return device_bytes_; }
  std::uint64_t host_bytes() const { return host_bytes_; }

 private:
  /// Planes of one size in one block.
  struct Slab {
    Block block;
    VkDeviceSize plane_bytes = 0;
    int count = 0;
    std::vector<int> free;
  };

  Result<Block> make_block(VkDeviceSize bytes, VkBufferUsageFlags usage, VkMemoryPropertyFlags wanted,
                           VkMemoryPropertyFlags liked);
  /// Memory for a buffer or an image; what it has of `liked` makes one type better than another. Errors: kDevice.
  Result<VkDeviceMemory> allocate(const VkMemoryRequirements& needs, VkMemoryPropertyFlags wanted,
                                  VkMemoryPropertyFlags liked, bool addressed);
  void destroy(Block& block);
  void destroy(const DrawnImage& image);
  Result<void> add_slab(VkDeviceSize plane_bytes);
  /// Gives slabs without a plane back to the driver.
  Result<void> free_empty_slabs();
  /// Where an allocation failed: `spare`, then the empty slabs.
  Result<void> make_room();
  std::uint64_t empty_bytes() const;

  GpuPtr gpu_;
  std::vector<std::unique_ptr<Slab>> slabs_;
  std::vector<Block> free_host_;
  std::atomic<std::uint64_t> device_bytes_ = 0, host_bytes_ = 0;  ///< which any thread may ask for
};

}  // namespace umbrage
