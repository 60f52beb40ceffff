// The planes of a frame on a GPU, and how they come from the host and go there.
#pragma once
#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/device.h"
#include "devices/shared/branches.h"
#include "devices/shared/neutral.h"
#include "devices/vulkan/commands.h"
#include "devices/vulkan/memory.h"

namespace umbrage {

/// What a frame stores. A plane that a pass asked for and nobody made has one value everywhere; all such names of one
/// value share a plane.
struct DevicePlanes {
  int stride = 0;  // floats from one row to the next
  VkDeviceSize bytes = 0;
  std::vector<std::string> names;  // made, in that order
  std::map<std::string, DevicePlanePtr, std::less<>> made;
  std::set<std::string, std::less<>> kept;  // of these, of the frame that this is a branch of
  Branches branches;
  std::vector<std::string> neutral;  // asked for, in that order; `made` may have got one since
  std::map<float, DevicePlanePtr> constants;

  bool is_neutral(std::string_view name) const {
    return !made.contains(name) && std::find(neutral.begin(), neutral.end(), name) != neutral.end();
  }
  const DevicePlane* find(std::string_view name) const {
    if (const auto found = made.find(name); found != made.end()) return found->second.get();
    return is_neutral(name) ? constants.at(*neutral_value(name)).get() : nullptr;
  }
};

inline DevicePlanes& planes_of(const Frame& frame) { return *static_cast<DevicePlanes*>(frame.storage.get()); }

/// What a frame of that size stores at first.
std::shared_ptr<DevicePlanes> empty_planes(const PictureInfo& info);

/// A plane of the host on its way to a frame.
struct NamedPlane {
  std::string name;
  const Plane* plane;
};

/// Makes planes and copies them. Copies are noted down, or done at once where the host gets something.
class PlaneStore {
 public:
  PlaneStore(const Gpu& gpu, Memory& memory, Commands& commands) : gpu_(&gpu), memory_(&memory), commands_(&commands) {}

  /// The frame's own plane of that name, made where there is none. It starts as `find` has it, since a pass may write a
  /// part of a plane.
  Result<DevicePlanePtr> writable(DevicePlanes& planes, const std::string& name);

  /// Copies planes of the host into a frame.
  Result<void> copy_to(const std::vector<NamedPlane>& from, const PictureInfo& info, DevicePlanes& planes);

  /// Planes of the frame, without so many pixels on each side.
  Result<Image> copied(const DevicePlanes& planes, const std::vector<std::string>& wanted, const PictureInfo& info,
                       int margin);

  /// Notes down that the plane of one value everywhere is filled, unless it is there.
  Result<void> add_constant(DevicePlanes& planes, float value);

 private:
  /// How many planes are copied to or from the host at once.
  std::size_t staged_at_once(const DevicePlanes& planes) const;

  /// Copies the planes [first, end) of those wanted to the host, without so many pixels on each side.
  Result<void> copy_from(const DevicePlanes& planes, const std::vector<std::string>& wanted, std::size_t first,
                         std::size_t end, int margin, Image& out);

  const Gpu* gpu_;
  Memory* memory_;
  Commands* commands_;
};

}  // namespace umbrage
