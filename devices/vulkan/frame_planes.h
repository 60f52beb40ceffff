// The planes of a frame on a GPU, and their transfer from and to the host.
#pragma once
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/device.h"
#include "core/lists.h"
#include "devices/shared/planes.h"
#include "devices/vulkan/commands.h"
#include "devices/vulkan/device_scene.h"
#include "devices/vulkan/memory.h"

namespace umbrage {

/// The storage of a frame. A missing plane that a dispatch reads has one neutral value everywhere; all missing planes
/// with the same value share one plane.
struct DevicePlanes {
  int stride = 0;  // floats between rows
  VkDeviceSize bytes = 0;
  std::vector<std::string> names;  // names in `stored`, in the order in which they were added
  std::map<std::string, DevicePlanePtr, std::less<>> stored;
  // Names of planes in `stored` that belong to the frame of which this is a branch.
  std::set<std::string, std::less<>> of_parent;
  Branches branches;
  std::vector<std::string> neutral;  // missing planes read so far, in order; some may be in `stored` by now
  std::map<float, DevicePlanePtr> constants;
  std::shared_ptr<const DeviceScene> scene;  // the captured scene; null for planes of the host

  bool is_neutral(std::string_view name) const { return !stored.contains(name) && contains(neutral, name); }
  const DevicePlane* find(std::string_view name) const {
    if (const auto found = stored.find(name); found != stored.end()) return found->second.get();
    return is_neutral(name) ? constants.at(*neutral_value(name)).get() : nullptr;
  }
};

inline DevicePlanes& planes_of(const Frame& frame) { return *static_cast<DevicePlanes*>(frame.storage.get()); }

/// Returns the storage of a new frame of the size in `info`, without planes.
std::shared_ptr<DevicePlanes> empty_planes(const PictureInfo& info);

/// A plane of the host to copy to a frame.
struct NamedPlane {
  std::string name;
  const Plane* plane;
};

/// Creates planes and copies them. Copies to a frame are recorded; copies to the host are completed at once.
class PlaneStore {
 public:
  PlaneStore(const Gpu& gpu, Memory& memory, Commands& commands) : gpu_(&gpu), memory_(&memory), commands_(&commands) {}

  /// Returns the frame's own plane of that name. A new one starts as a copy of the plane that `find` returns, if any,
  /// since a dispatch may write only a part of it.
  Result<DevicePlanePtr> writable(DevicePlanes& planes, const std::string& name);

  /// Copies planes of the host to a frame.
  Result<void> copy_to(const std::vector<NamedPlane>& from, const PictureInfo& info, DevicePlanes& planes);

  /// Returns planes of the frame without `margin` pixels on each side.
  Result<Image> copied(const DevicePlanes& planes, const std::vector<std::string>& names, const PictureInfo& info,
                       int margin);

  /// Adds the constant plane with this value, unless it exists, and records its initialization.
  Result<void> add_constant(DevicePlanes& planes, float value);

 private:
  /// Returns the number of planes copied to or from the host at once.
  std::size_t staged_at_once(const DevicePlanes& planes) const;

  /// Copies the planes `names[first]` to `names[end - 1]` to the host, without `margin` pixels on each side.
  Result<void> copy_from(const DevicePlanes& planes, const std::vector<std::string>& names, std::size_t first,
                         std::size_t end, int margin, Image& out);

  const Gpu* gpu_;
  Memory* memory_;
  Commands* commands_;
};

}  // namespace umbrage
