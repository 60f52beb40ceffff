// The planes of a frame on a GPU, and their transfer from and to the host.
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

/// The storage of a frame. A plane that a pass reads and that does not exist has one value everywhere; all such names
/// with the same value share one plane.
struct DevicePlanes {
  int stride = 0;  // floats between rows
  VkDeviceSize bytes = 0;
  std::vector<std::string> names;  // names of `made`, in order
  std::map<std::string, DevicePlanePtr, std::less<>> made;
  // Names of planes in `made` that belong to the frame that this is a branch of.
  std::set<std::string, std::less<>> kept;
  Branches branches;
  std::vector<std::string> neutral;  // missing planes read so far, in order; some may be in `made` by now
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

/// Returns the storage of a new frame of that size.
std::shared_ptr<DevicePlanes> empty_planes(const PictureInfo& info);

/// A plane of the host to copy to a frame.
struct NamedPlane {
  std::string name;
  const Plane* plane;
};

/// Creates planes and copies them. Copies are recorded, or done at once if the host needs the result.
class PlaneStore {
 public:
  PlaneStore(const Gpu& gpu, Memory& memory, Commands& commands) : gpu_(&gpu), memory_(&memory), commands_(&commands) {}

  /// Returns the frame's own plane of that name, created if there is none. It starts as a copy of `find`, since a pass
  /// may write only a part of a plane.
  Result<DevicePlanePtr> writable(DevicePlanes& planes, const std::string& name);

  /// Copies planes of the host to a frame.
  Result<void> copy_to(const std::vector<NamedPlane>& from, const PictureInfo& info, DevicePlanes& planes);

  /// Returns planes of the frame without `margin` pixels on each side.
  Result<Image> copied(const DevicePlanes& planes, const std::vector<std::string>& wanted, const PictureInfo& info,
                       int margin);

  /// Records the fill of the plane with this constant value, unless it exists.
  Result<void> add_constant(DevicePlanes& planes, float value);

 private:
  /// Returns the number of planes copied to or from the host at once.
  std::size_t staged_at_once(const DevicePlanes& planes) const;

  /// Copies the planes [first, end) of those wanted to the host, without `margin` pixels on each side.
  Result<void> copy_from(const DevicePlanes& planes, const std::vector<std::string>& wanted, std::size_t first,
                         std::size_t end, int margin, Image& out);

  const Gpu* gpu_;
  Memory* memory_;
  Commands* commands_;
};

}  // namespace umbrage
