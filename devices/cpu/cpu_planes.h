// The storage of a frame on the CPU, for a whole picture or a strip of it, and plane lookup for dispatches.
#pragma once
#include <tbb/task_arena.h>

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/device.h"
#include "core/image.h"
#include "core/rows.h"
#include "core/strip.h"
#include "devices/shared/dispatches.h"
#include "devices/shared/planes.h"
#include "rays/traced_scene.h"

namespace umbrage {

/// The rows of a plane that the frame of a strip contains.
struct StripRows {
  Rows valid;          ///< rows that are identical to those of a picture drawn whole
  int version = 0;     ///< see WholePlanes
  int first = 0;       ///< row of the picture that is the plane's row 0
  bool stored = true;  ///< false: the plane exists only in WholePlanes
};

/// The storage of a frame. A missing plane that a dispatch reads has one neutral value everywhere. All missing planes
/// with the same value share one plane, since filling one for each costs more than the dispatches that read them.
struct CpuPlanes {
  Image image;  ///< for a strip, only `rows`
  /// Names of the missing planes read so far, in order; some may be in `image` by now.
  std::vector<std::string> neutral;
  /// The neutral planes, by value.
  std::map<float, std::shared_ptr<const Plane>> constants;
  std::map<std::string, std::pair<int, int>> placed;  ///< by plane name: size of the reduced plane placed in it
  std::shared_ptr<const CpuPlanes> parent;            ///< planes of the frame of which this is a branch, or null
  std::shared_ptr<const CpuPlanes> first;             ///< all planes of the first sample, if add_planes_of added some
  std::shared_ptr<const PixelMask> mask;              ///< that of the capture: dispatches compute only these pixels
  Branches branches;
  std::shared_ptr<const TracedScene> traced;  ///< the captured scene; null for planes of the host
  std::set<std::string> released;             ///< names of planes that Device::release has freed
  // For a strip:
  std::optional<Strip> strip;
  Rows rows;                                                 ///< rows of the picture in `image`
  std::map<std::string, StripRows, std::less<>> strip_rows;  ///< of every plane, by name
  int dispatches = 0;                                        ///< number of dispatches so far
};

inline CpuPlanes& cpu_planes(const Frame& frame) { return *static_cast<CpuPlanes*>(frame.storage.get()); }

/// Returns the plane of that name that was captured, added or computed in this frame or one of which it is a branch, or
/// null.
const Plane* find_stored(const CpuPlanes& planes, std::string_view name);

/// Returns the frame's own plane of that name. A new one starts as a copy of find_plane, or uninitialised if there is
/// none.
Plane& writable(CpuPlanes& planes, const std::string& name);

/// Returns the plane of that name, stored or neutral, of this frame or one of which it is a branch, or null.
const Plane* find_plane(const CpuPlanes& planes, std::string_view name);

/// Returns the names of all planes: first the stored ones, starting with those of the frame that is not a branch, then
/// the neutral ones.
std::vector<std::string> names_of(const CpuPlanes& planes);

/// Returns the plane of the whole picture with that name and version, or null if it is incomplete.
const Plane* find_whole(const CpuPlanes& planes, const PictureInfo& info, std::string_view name, int version);

/// Makes `planes`, which have the rows of the strip and its margin, those of a strip. All rows are valid. `height`:
/// height of the picture.
void begin_strip(const Strip& strip, int height, CpuPlanes& planes);

/// Returns the rows of that plane in a strip, or null if the strip has no such plane.
const StripRows* find_strip_rows(const CpuPlanes& planes, std::string_view name);

/// Returns `rows` without the first and last `margin` rows, except at the border of the picture, which has `height`
/// rows.
Rows shrunk(const Rows& rows, int margin, int height);

/// Returns the rows of a reduced picture that show `rows`; both ends are rounded up.
Rows reduced_rows(const Rows& rows, int factor);

/// The part of a strip on which a dispatch can run.
struct StripRun {
  Rows rows;                           ///< rows for which the outputs can be computed
  std::vector<std::string> unbounded;  ///< names of the planes that the dispatch reads at any pixel
  bool done = false;                   ///< all outputs already exist as whole planes
  RunState state;                      ///< if not finished, the dispatch cannot run yet
};

/// Determines the rows of a strip on which a dispatch can run. Copies the strip's rows to the incomplete whole planes
/// that the dispatch reads.
StripRun prepare_strip(const DispatchRun& run, CpuPlanes& planes, tbb::task_arena& arena);

/// Returns the address of row 0 of the picture in a plane. For a plane that contains only the rows of a strip it may
/// lie outside the memory of the plane.
float* row_zero_of(const DispatchRun& run, const CpuPlanes& planes, const StripRun& strip, const std::string& name);

/// Frees the planes of EffectRun::last_used that this dispatch of the run was the last one to read or write.
void release_ended(const DispatchRun& run, const std::vector<std::string>& last_used, CpuPlanes& planes);

/// See Device::release.
void release_planes(const std::vector<std::string>& names, CpuPlanes& planes);

/// Returns the planes of a strip, without the guard band.
Result<Image> download_strip(const Frame& frame, const std::vector<std::string>& names);

/// Calls work(y) for all rows of a plane, on all threads.
template <class Work>
void for_rows(tbb::task_arena& arena, int height, const Work& work) {
  arena.execute([&] { umbrage::for_rows(0, height, work); });
}

}  // namespace umbrage
