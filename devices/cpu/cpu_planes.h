// The storage of a frame on the CPU, of a whole picture or of a strip of it, and plane lookup for passes.
#pragma once
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/device.h"
#include "core/image.h"
#include "core/strip.h"
#include "devices/shared/branches.h"
#include "devices/shared/dispatches.h"

namespace umbrage {

/// The rows of a plane that a strip holds.
struct Held {
  Rows valid;        ///< rows of the picture that equal those of the whole picture
  int version = 0;   ///< see WholePlanes
  int first = 0;     ///< row of the picture that is the plane's first
  bool made = true;  ///< false: exists only in WholePlanes
};

/// The storage of a frame. A plane that a pass reads and that does not exist has one value everywhere; all such names
/// with the same value share one plane, since filling one for each costs more than the passes that read them.
struct CpuPlanes {
  Image image;                       ///< of a strip, only its rows
  std::vector<std::string> neutral;  ///< names of missing planes read so far, in order; some may be in `image` by now
  /// Planes of these names, by their value.
  std::map<float, Plane> constants;
  std::map<std::string, std::pair<int, int>> placed;  ///< by name, size of the reduced picture placed in it
  std::shared_ptr<const CpuPlanes> kept;              ///< planes of the frame that this is a branch of, or null
  Branches branches;
  std::shared_ptr<CpuPlanes> last_reduced;  ///< the last reduced frame made of this one
  // For a strip:
  std::optional<Strip> strip;
  Rows rows;                                      ///< rows that are held
  std::map<std::string, Held, std::less<>> held;  ///< of every plane
  int dispatches = 0;                             ///< number of dispatches so far
};

inline CpuPlanes& cpu_planes(const Frame& frame) { return *static_cast<CpuPlanes*>(frame.storage.get()); }

/// Returns the plane of that name that was captured, added or made, in this frame or one that it is a branch of, or
/// null.
const Plane* find_made(const CpuPlanes& planes, std::string_view name);

/// Returns the frame's own plane of that name. A new one starts as a copy of find_plane, or uninitialised if there is
/// none.
Plane& writable(CpuPlanes& planes, const std::string& name);

/// Returns the plane of that name, made or neutral, in this frame or one that it is a branch of, or null.
const Plane* find_plane(const CpuPlanes& planes, std::string_view name);

/// Returns the names of all planes: first those made, starting with the frame that is no branch, then the neutral ones.
std::vector<std::string> names_of(const CpuPlanes& planes);

/// Returns that version of a strip's plane for the whole picture, or null if it is incomplete.
const Plane* find_whole(const CpuPlanes& planes, const PictureInfo& info, std::string_view name, int version);

/// Returns the rows of that plane that a strip holds, or null if it does not exist.
const Held* find_held(const CpuPlanes& planes, std::string_view name);

/// Returns `rows` without the first and last `margin` rows, except at the border of the picture, which has `height`
/// rows.
Rows shrunk(const Rows& rows, int margin, int height);

Rows divided(const Rows& rows, int factor);

/// The part of a strip that a pass can run on.
struct StripRun {
  Rows rows;                     ///< rows that the outputs can be computed for
  std::vector<std::string> far;  ///< names of the planes that it reads at any pixel
  bool done = false;             ///< all its outputs exist as whole planes already
  RunState progression;          ///< if not finished, the pass cannot run yet
};

/// Determines the rows of a strip that a pass can run on. Copies the strip's rows to whole planes that the pass needs
/// and that are incomplete.
StripRun prepare_strip(const DispatchRun& run, CpuPlanes& planes, tbb::task_arena& arena);

/// Returns the address of row 0 of a plane: of a whole one, or extrapolated for the rows that a strip holds.
float* row_zero_of(const DispatchRun& run, const CpuPlanes& planes, const StripRun& strip, const std::string& name);

/// See Device::missing_rows.
int missing_strip_rows(const Frame& frame, const std::vector<std::string>& names);

/// Returns the planes of a strip, without the guard band.
Result<Image> download_strip(const Frame& frame, const std::vector<std::string>& names);

/// Calls work(y) for all rows of a plane, on all threads.
template <class Work>
void for_rows(tbb::task_arena& arena, int height, const Work& work) {
  constexpr int kRowsAtOnce = 32;  // fewer cost more to schedule than to copy
  arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<int>(0, height, kRowsAtOnce), [&](const tbb::blocked_range<int>& rows) {
      for (int y = rows.begin(); y < rows.end(); ++y) work(y);
    });
  });
}

}  // namespace umbrage
