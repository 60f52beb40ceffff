// Memory of a Vulkan device: planes of pictures, and buffers for transfers from and to the host. Both are pooled:
// released memory is reused for the next request of its size, so that drawing several pictures allocates no new memory.
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
  bool counted = false;         ///< included in the byte counts of the pool
};

/// The memory of one plane on the device: a part of a buffer.
struct DevicePlane {
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceSize offset = 0;
  VkDeviceAddress address = 0;
};
/// A render target with its own memory.
struct AttachmentImage {
  VkImage image = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  VkImageView view = VK_NULL_HANDLE;
  VkDeviceSize size = 0;
};
using DrawnImagePtr = std::shared_ptr<const AttachmentImage>;

using DevicePlanePtr = std::shared_ptr<const DevicePlane>;
using HostBufferPtr = std::shared_ptr<const Block>;

class Memory : public std::enable_shared_from_this<Memory> {
 public:
  explicit Memory(GpuPtr gpu) : gpu_(std::move(gpu)) {}
  ~Memory();
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;

  /// Called before memory is returned to the driver: must wait until the device no longer uses any memory of the pool.
  std::function<Result<void>()> wait = [] { return Result<void>(); };
  /// Called when the driver is out of memory: must release memory whose contents can be recreated, and wait until the
  /// device no longer uses it.
  std::function<Result<void>()> release_memory = [] { return Result<void>(); };

  /// Keeps the memory of planes that are requested from now on while `user` lives, even after they were released.
  void set_user(std::weak_ptr<const void> user) { user_ = std::move(user); }
  /// Returns memory for a plane, uninitialised. Earlier recorded work may still read the former contents: place a
  /// barrier before writing to it. Errors: kDevice.
  Result<DevicePlanePtr> plane(VkDeviceSize bytes);
  /// Returns a buffer of at least this size that the host writes or reads, and from or to which the device copies; or,
  /// with `uniform`, from which the device reads constants. It must not be released while the device uses it. Errors:
  /// kDevice.
  Result<HostBufferPtr> host(VkDeviceSize bytes, bool uniform = false);

  /// Returns an attachment, uninitialised. It must not be released while the device uses it. Errors: kDevice.
  Result<DrawnImagePtr> image(int width, int height, VkFormat format, VkImageUsageFlags usage,
                              VkImageAspectFlags aspect);

  /// Return the bytes allocated from the driver, in use or pooled.
  std::uint64_t device_bytes() const { return device_bytes_; }
  std::uint64_t host_bytes() const { return host_bytes_; }

 private:
  /// Planes of one size in one block.
  struct Slab {
    Block block;
    VkDeviceSize plane_bytes = 0;
    int count = 0;
    std::vector<int> free;
    std::vector<std::weak_ptr<const void>> users;
    /// Returns whether no plane is in use.
    bool is_free() const;
  };

  Result<Block> make_block(VkDeviceSize bytes, VkBufferUsageFlags usage, VkMemoryPropertyFlags required,
                           VkMemoryPropertyFlags preferred);
  /// Allocates memory for a buffer or an image; prefers the memory type with most of the `preferred` flags. Errors:
  /// kDevice.
  Result<VkDeviceMemory> allocate(const VkMemoryRequirements& needs, VkMemoryPropertyFlags required,
                                  VkMemoryPropertyFlags preferred, bool addressed);
  void destroy(Block& block);
  void destroy(const AttachmentImage& image);
  Result<void> add_slab(VkDeviceSize plane_bytes);
  /// Frees all slabs that contain no plane in use.
  Result<void> free_empty_slabs();
  /// Frees memory after a failed allocation: calls `release_memory`, then frees empty slabs.
  Result<void> make_room();
  std::uint64_t empty_bytes() const;

  GpuPtr gpu_;
  std::weak_ptr<const void> user_;
  std::vector<std::unique_ptr<Slab>> slabs_;
  std::vector<Block> free_host_;
  std::atomic<std::uint64_t> device_bytes_ = 0, host_bytes_ = 0;  ///< may be read by any thread
};

}  // namespace umbrage
