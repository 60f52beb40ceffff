#include "devices/vulkan/frame_planes.h"

#include <bit>
#include <cstring>

#include "core/check.h"

namespace umbrage {
namespace {

constexpr VkDeviceSize kMaxStaged = VkDeviceSize(256) << 20;  // bytes copied to or from the host at once

}  // namespace

std::shared_ptr<DevicePlanes> empty_planes(const PictureInfo& info) {
  auto planes = std::make_shared<DevicePlanes>();
  planes->stride = (info.width + kRowAlignment - 1) / kRowAlignment * kRowAlignment;
  planes->bytes = VkDeviceSize(planes->stride) * VkDeviceSize(info.height) * sizeof(float);
  return planes;
}

std::size_t PlaneStore::staged_at_once(const DevicePlanes& planes) const {
  return std::max<std::size_t>(1, std::min(kMaxStaged, gpu_->max_allocation) / std::max(planes.bytes, VkDeviceSize(1)));
}

Result<DevicePlanePtr> PlaneStore::writable(DevicePlanes& planes, const std::string& name) {
  const auto found = planes.stored.find(name);
  const bool exists = found != planes.stored.end();
  if (exists && !planes.of_parent.contains(name)) return found->second;
  auto plane = memory_->plane(planes.bytes);
  if (!plane) return plane;
  if (const DevicePlane* previous = planes.find(name)) {
    const auto buffer = commands_->buffer();
    if (!buffer) return buffer.error();
    commands_->barrier();
    const VkBufferCopy region{previous->offset, (*plane)->offset, planes.bytes};
    gpu_->vk.CmdCopyBuffer(*buffer, previous->buffer, (*plane)->buffer, 1, &region);
  }
  if (!exists) planes.names.push_back(name);
  planes.stored[name] = *plane;
  planes.of_parent.erase(name);
  return plane;
}

Result<void> PlaneStore::copy_to(const std::vector<NamedPlane>& from, const PictureInfo& info, DevicePlanes& planes) {
  const std::size_t row_bytes = std::size_t(info.width) * sizeof(float);
  const std::size_t at_once = staged_at_once(planes);
  for (std::size_t first = 0; first < from.size(); first += at_once) {
    const std::size_t end = std::min(first + at_once, from.size());
    if (first > 0)  // staged data must remain until it is copied
      if (auto status = commands_->finish(); !status) return status;
    for (std::size_t p = first; p < end; ++p)  // before staging: allocation may submit the recorded work
      if (const auto out = writable(planes, from[p].name); !out) return out.error();
    const auto staged = memory_->host(planes.bytes * (end - first));
    if (!staged) return staged.error();
    // This may wait for submitted work, and then releases kept objects.
    if (const auto begun = commands_->buffer(); !begun) return begun.error();
    commands_->keep(*staged);
    for (std::size_t p = first; p < end; ++p) {
      check_equal(from[p].plane->width, info.width, from[p].name);
      check_equal(from[p].plane->height, info.height, from[p].name);
      std::byte* to = (*staged)->mapped + planes.bytes * (p - first);
      if (from[p].plane->stride == planes.stride)
        std::memcpy(to, from[p].plane->data(), planes.bytes);
      else
        for (int y = 0; y < info.height; ++y)
          std::memcpy(to + std::size_t(y) * planes.stride * sizeof(float), from[p].plane->row(y), row_bytes);
      const DevicePlanePtr& out = planes.stored.find(from[p].name)->second;
      const auto buffer = commands_->buffer();
      if (!buffer) return buffer.error();
      if (p == first) commands_->barrier();
      const VkBufferCopy region{planes.bytes * (p - first), out->offset, planes.bytes};
      gpu_->vk.CmdCopyBuffer(*buffer, (*staged)->buffer, out->buffer, 1, &region);
    }
  }
  return {};
}

Result<Image> PlaneStore::copied(const DevicePlanes& planes, const std::vector<std::string>& names,
                                 const PictureInfo& info, int margin) {
  Image out(info.width - 2 * margin, info.height - 2 * margin);
  const std::size_t at_once = staged_at_once(planes);
  for (std::size_t first = 0; first < names.size(); first += at_once)
    if (auto status = copy_from(planes, names, first, std::min(first + at_once, names.size()), margin, out); !status)
      return status.error();
  // Finishes even if nothing is copied, since errors of earlier work are reported here.
  if (auto status = commands_->finish(); !status) return status.error();
  return out;
}

Result<void> PlaneStore::copy_from(const DevicePlanes& planes, const std::vector<std::string>& names, std::size_t first,
                                   std::size_t end, int margin, Image& out) {
  const auto staged = memory_->host(planes.bytes * (end - first));
  if (!staged) return staged.error();
  const auto buffer = commands_->buffer();
  if (!buffer) return buffer.error();
  commands_->keep(*staged);
  commands_->barrier();
  for (std::size_t p = first; p < end; ++p) {
    const DevicePlane* plane = planes.find(names[p]);
    if (!plane) return usage_error("the picture has no plane '{}'", names[p]);
    const VkBufferCopy region{plane->offset, planes.bytes * (p - first), planes.bytes};
    gpu_->vk.CmdCopyBuffer(*buffer, plane->buffer, (*staged)->buffer, 1, &region);
  }
  if (auto status = commands_->finish(); !status) return status;
  for (std::size_t p = first; p < end; ++p) {
    const auto* from = reinterpret_cast<const float*>((*staged)->mapped + planes.bytes * (p - first));
    Plane to(out.width, out.height);
    for (int y = 0; y < out.height; ++y)
      std::memcpy(to.row(y), from + std::size_t(y + margin) * planes.stride + margin,
                  std::size_t(out.width) * sizeof(float));
    out.names.push_back(names[p]);
    out.planes.push_back(std::move(to));
  }
  return {};
}

Result<void> PlaneStore::add_constant(DevicePlanes& planes, float value) {
  if (planes.constants.contains(value)) return {};
  const auto plane = memory_->plane(planes.bytes);
  if (!plane) return plane.error();
  const auto buffer = commands_->buffer();
  if (!buffer) return buffer.error();
  commands_->barrier();
  gpu_->vk.CmdFillBuffer(*buffer, (*plane)->buffer, (*plane)->offset, planes.bytes,
                         std::bit_cast<std::uint32_t>(value));
  commands_->count(0, planes.bytes);
  planes.constants.emplace(value, *plane);
  return {};
}

}  // namespace umbrage
