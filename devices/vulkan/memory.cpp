#include "devices/vulkan/memory.h"

#include <algorithm>

namespace umbrage {
namespace {

constexpr VkDeviceSize kAlignment = 256;  // of planes in a slab, bytes; no device requires more for descriptors
constexpr VkDeviceSize kSlab = VkDeviceSize(64) << 20;  // bytes: few allocations, but little unused memory
constexpr VkDeviceSize kMaxPlanesOfSlab = 16;
// Max bytes of empty slabs that are kept when a new slab is allocated.
constexpr VkDeviceSize kMaxEmptySlabBytes = VkDeviceSize(256) << 20;
constexpr VkDeviceSize kHostStep = VkDeviceSize(1) << 20;  // sizes of host buffers are multiples of this
// Max bytes of free host buffers that are kept when a new one is allocated.
constexpr VkDeviceSize kMaxFreeHostBytes = VkDeviceSize(256) << 20;

VkDeviceSize rounded_up(VkDeviceSize v, VkDeviceSize step) { return (v + step - 1) / step * step; }

double mebibytes(VkDeviceSize bytes) { return double(bytes) / double(1 << 20); }

}  // namespace

Memory::~Memory() {
  for (auto& slab : slabs_) destroy(slab->block);
  for (Block& block : free_host_) destroy(block);
}

Result<VkDeviceMemory> Memory::allocate(const VkMemoryRequirements& needs, VkMemoryPropertyFlags required,
                                        VkMemoryPropertyFlags preferred, bool addressed) {
  int type = -1, best = -1;
  for (std::uint32_t k = 0; k < gpu_->memory.memoryTypeCount; ++k) {
    const VkMemoryPropertyFlags has = gpu_->memory.memoryTypes[k].propertyFlags;
    if (!(needs.memoryTypeBits >> k & 1u) || (has & required) != required) continue;
    const int score = __builtin_popcount(has & preferred);
    if (score > best) best = score, type = int(k);
  }
  if (type < 0)
    return device_error("the Vulkan device has no usable memory type for a picture of {:.0f} MiB",
                        mebibytes(needs.size));
  // Checks the size here, since some drivers grant more memory than there is.
  const bool on_device = (required & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT) != 0;
  const VkDeviceSize heap = gpu_->memory.memoryHeaps[gpu_->memory.memoryTypes[type].heapIndex].size;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  VkResult done = VK_ERROR_OUT_OF_DEVICE_MEMORY;
  if (needs.size <= gpu_->max_allocation && (on_device ? device_bytes_ : host_bytes_) + needs.size <= heap) {
    VkMemoryAllocateFlagsInfo flags{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO};
    flags.flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT;
    VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
    if (addressed) allocate.pNext = &flags;
    allocate.allocationSize = needs.size;
    allocate.memoryTypeIndex = std::uint32_t(type);
    done = gpu_->vk.AllocateMemory(gpu_->device, &allocate, nullptr, &memory);
  }
  if (done != VK_SUCCESS) return vulkan_error(done, "allocated memory for a picture");
  return memory;
}

Result<Block> Memory::make_block(VkDeviceSize bytes, VkBufferUsageFlags usage, VkMemoryPropertyFlags required,
                                 VkMemoryPropertyFlags preferred) {
  const auto& vk = gpu_->vk;
  Block block;
  block.size = bytes;
  VkBufferCreateInfo create{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  create.size = bytes;
  create.usage = usage;
  create.sharingMode = VK_SHARING_MODE_EXCLUSIVE;
  if (const VkResult result = vk.CreateBuffer(gpu_->device, &create, nullptr, &block.buffer); result != VK_SUCCESS)
    return vulkan_error(result, "allocated memory for a picture");
  VkMemoryRequirements needs{};
  vk.GetBufferMemoryRequirements(gpu_->device, block.buffer, &needs);
  const bool addressed = (usage & VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT) != 0;
  const auto memory = allocate(needs, required, preferred, addressed);
  if (!memory) {
    destroy(block);
    return memory.error();
  }
  block.memory = *memory;
  VkResult done = vk.BindBufferMemory(gpu_->device, block.buffer, block.memory, 0);
  if (done == VK_SUCCESS && (required & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT)) {
    void* mapped = nullptr;
    done = vk.MapMemory(gpu_->device, block.memory, 0, VK_WHOLE_SIZE, 0, &mapped);
    block.mapped = static_cast<std::byte*>(mapped);
  }
  if (done != VK_SUCCESS) {
    destroy(block);
    return vulkan_error(done, "allocated memory for a picture");
  }
  (required & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT ? device_bytes_ : host_bytes_) += block.size;
  block.counted = true;
  if (addressed) {
    const VkBufferDeviceAddressInfo info{VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO, nullptr, block.buffer};
    block.address = vk.GetBufferDeviceAddress(gpu_->device, &info);
  }
  return block;
}

bool Memory::Slab::is_free() const {
  return int(free.size()) == count &&
         std::all_of(users.begin(), users.end(), [](const auto& user) { return user.expired(); });
}

Result<void> Memory::free_empty_slabs() {
  if (empty_bytes() == 0) return {};
  if (auto idle = wait(); !idle) return idle;
  for (auto& slab : slabs_)
    if (slab->is_free()) {
      destroy(slab->block);
      slab.reset();
    }
  std::erase(slabs_, nullptr);
  return {};
}

Result<void> Memory::make_room() {
  if (auto released = release_memory(); !released) return released;
  return free_empty_slabs();
}

std::uint64_t Memory::empty_bytes() const {
  std::uint64_t bytes = 0;
  for (const auto& slab : slabs_)
    if (slab->is_free()) bytes += slab->block.size;
  return bytes;
}

Result<void> Memory::add_slab(VkDeviceSize plane_bytes) {
  if (plane_bytes > gpu_->max_allocation)
    return device_error(
        "the picture is too large for the Vulkan device: a plane takes {:.0f} MiB, and at most {:.0f} MiB "
        "can be allocated at once; use `device` cpu or a smaller `width`",
        mebibytes(plane_bytes), mebibytes(gpu_->max_allocation));
  if (empty_bytes() > kMaxEmptySlabBytes)
    if (auto freed = free_empty_slabs(); !freed) return freed;
  int count = int(std::clamp(std::min(kSlab, gpu_->max_allocation) / plane_bytes, VkDeviceSize(1), kMaxPlanesOfSlab));
  const auto make = [&] {
    return make_block(plane_bytes * VkDeviceSize(count),
                      VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                          VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                      VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0);
  };
  auto block = make();
  if (!block) {
    if (auto freed = make_room(); !freed) return freed;
    count = 1;
    block = make();
  }
  if (!block) return block.error();
  auto slab = std::make_unique<Slab>(Slab{*block, plane_bytes, count, {}});
  for (int k = count - 1; k >= 0; --k) slab->free.push_back(k);
  slabs_.push_back(std::move(slab));
  return {};
}

Result<DevicePlanePtr> Memory::plane(VkDeviceSize bytes) {
  const VkDeviceSize size = rounded_up(std::max(bytes, VkDeviceSize(1)), kAlignment);
  const auto with_room = [&] {
    return std::find_if(slabs_.begin(), slabs_.end(),
                        [&](const auto& slab) { return slab->plane_bytes == size && !slab->free.empty(); });
  };
  auto found = with_room();
  if (found == slabs_.end()) {
    if (auto added = add_slab(size); !added) return added.error();
    found = with_room();
  }
  Slab& slab = **found;
  if (!user_.expired() && (slab.users.empty() || slab.users.back().lock() != user_.lock())) {
    std::erase_if(slab.users, [](const auto& user) { return user.expired(); });
    slab.users.push_back(user_);
  }
  const int index = slab.free.back();
  slab.free.pop_back();
  const VkDeviceSize offset = VkDeviceSize(index) * size;
  return DevicePlanePtr(new DevicePlane{slab.block.buffer, offset, slab.block.address + offset},
                        [self = shared_from_this(), &slab, index](const DevicePlane* plane) {
                          slab.free.push_back(index);
                          delete plane;
                        });
}

Result<HostBufferPtr> Memory::host(VkDeviceSize bytes, bool uniform) {
  const VkDeviceSize size = rounded_up(std::max(bytes, VkDeviceSize(1)), kHostStep);
  Block block;
  const auto fits = [&](const Block& free) { return free.size >= size && free.size <= 2 * size; };
  const auto found = uniform ? free_host_.end() : std::find_if(free_host_.begin(), free_host_.end(), fits);
  if (found != free_host_.end()) {
    block = *found;
    free_host_.erase(found);
  } else {
    VkDeviceSize free_bytes = 0;
    for (const Block& free : free_host_) free_bytes += free.size;
    if (free_bytes > kMaxFreeHostBytes) {
      for (Block& free : free_host_) destroy(free);
      free_host_.clear();
    }
    const VkBufferUsageFlags usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                                     (uniform ? VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT : VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
    auto created = make_block(size, usage, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
                              uniform ? VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT : VK_MEMORY_PROPERTY_HOST_CACHED_BIT);
    if (!created) return created.error();
    block = *created;
  }
  return HostBufferPtr(new Block(block), [self = shared_from_this(), uniform](const Block* buffer) {
    Block copy = *buffer;
    if (uniform)
      self->destroy(copy);
    else
      try {
        self->free_host_.push_back(copy);
      } catch (const std::bad_alloc&) {  // not kept for reuse
        self->destroy(copy);
      }
    delete buffer;
  });
}

Result<DrawnImagePtr> Memory::image(int width, int height, VkFormat format, VkImageUsageFlags usage,
                                    VkImageAspectFlags aspect) {
  const auto& vk = gpu_->vk;
  AttachmentImage result;
  VkImageCreateInfo create{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
  create.imageType = VK_IMAGE_TYPE_2D;
  create.format = format;
  create.extent = {std::uint32_t(width), std::uint32_t(height), 1};
  create.mipLevels = create.arrayLayers = 1;
  create.samples = VK_SAMPLE_COUNT_1_BIT;
  create.usage = usage;
  const auto failed = [&](const Error& error) {
    destroy(result);
    return error;
  };
  if (const VkResult r = vk.CreateImage(gpu_->device, &create, nullptr, &result.image); r != VK_SUCCESS)
    return failed(vulkan_error(r, "allocated memory for a picture"));
  VkMemoryRequirements needs{};
  vk.GetImageMemoryRequirements(gpu_->device, result.image, &needs);
  auto memory = allocate(needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0, false);
  if (!memory) {
    if (auto freed = make_room(); !freed) return failed(freed.error());
    memory = allocate(needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0, false);
  }
  if (!memory) return failed(memory.error());
  result.memory = *memory;
  result.size = needs.size;
  device_bytes_ += result.size;
  VkResult done = vk.BindImageMemory(gpu_->device, result.image, result.memory, 0);
  if (done == VK_SUCCESS) {
    VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
    view.image = result.image;
    view.viewType = VK_IMAGE_VIEW_TYPE_2D;
    view.format = format;
    view.subresourceRange = {aspect, 0, 1, 0, 1};
    done = vk.CreateImageView(gpu_->device, &view, nullptr, &result.view);
  }
  if (done != VK_SUCCESS) return failed(vulkan_error(done, "allocated memory for a picture"));
  return DrawnImagePtr(new AttachmentImage(result), [self = shared_from_this()](const AttachmentImage* image) {
    self->destroy(*image);
    delete image;
  });
}

void Memory::destroy(const AttachmentImage& image) {
  device_bytes_ -= image.size;
  if (image.view) gpu_->vk.DestroyImageView(gpu_->device, image.view, nullptr);
  if (image.image) gpu_->vk.DestroyImage(gpu_->device, image.image, nullptr);
  if (image.memory) gpu_->vk.FreeMemory(gpu_->device, image.memory, nullptr);
}

void Memory::destroy(Block& block) {
  if (block.counted) (block.mapped ? host_bytes_ : device_bytes_) -= block.size;
  if (block.buffer) gpu_->vk.DestroyBuffer(gpu_->device, block.buffer, nullptr);
  if (block.memory) gpu_->vk.FreeMemory(gpu_->device, block.memory, nullptr);
  block = {};
}

}  // namespace umbrage
