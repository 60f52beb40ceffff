// What a frame stores on the CPU, of a whole picture or of a band of it, and what passes find there.
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

#include "core/band.h"
#include "core/device.h"
#include "core/image.h"
#include "devices/shared/branches.h"
#include "devices/shared/passes.h"

namespace umbrage {

/// What a band holds of a plane.
struct Held {
  Rows valid;        ///< rows of the picture that are as they would be in the whole one
  int version = 0;   ///< see WholePlanes
  int first = 0;     ///< the row, of the plane, that is held first
  bool made = true;  ///< false: of the whole planes alone
};

/// What a frame stores. A plane that a pass asked for and nobody made has one value everywhere; all such names of one
/// value share a plane, since filling a plane for each costs more than the passes that read them.
struct CpuPlanes {
  Image image;                       ///< of a band, its rows alone
  std::vector<std::string> neutral;  ///< names that have been asked for, in that order; `image` may have got one since
  std::map<float, Plane> constants;
  std::map<std::string, std::pair<int, int>> placed;  ///< by name, size of the reduced picture that lies there
  std::shared_ptr<const CpuPlanes> kept;              ///< of the frame that this is a branch of, or null
  Branches branches;
  std::shared_ptr<CpuPlanes> last_reduced;  ///< what was made of this last at reduced resolution
  // Of a band:
  std::optional<Band> band;
  Rows rows;                                      ///< those that are held
  std::map<std::string, Held, std::less<>> held;  ///< of every plane
  int passes = 0;                                 ///< that have run
};

inline CpuPlanes& cpu_planes(const Frame& frame) { return *static_cast<CpuPlanes*>(frame.storage.get()); }

/// The plane of that name that was captured, added or made, here or in what this is a branch of; or null.
const Plane* find_made(const CpuPlanes& planes, std::string_view name);

/// The frame's own plane of that name. It starts as find_plane has it, else uninitialised.
Plane& writable(CpuPlanes& planes, const std::string& name);

/// The plane of that name, made or neutral, here or in what this is a branch of; or null.
const Plane* find_plane(const CpuPlanes& planes, std::string_view name);

/// Names of all planes: those that were made, from what this is a branch of on, and then the neutral ones.
std::vector<std::string> names_of(const CpuPlanes& planes);

/// That version of a band's plane in the whole picture, or null.
const Plane* find_whole(const CpuPlanes& planes, const PictureInfo& info, std::string_view name, int version);

/// What a band holds of the plane of that name, or null where nobody made it.
const Held* find_held(const CpuPlanes& planes, std::string_view name);

/// `rows` less `margin` of them at either end, but where the picture ends.
Rows shrunk(const Rows& rows, int margin, int height);

Rows divided(const Rows& rows, int factor);

/// What a pass needs of the band that it runs on.
struct BandRun {
  Rows rows;                     ///< for which the outputs can be made
  std::vector<std::string> far;  ///< planes that it reads anywhere
  bool done = false;             ///< all it would make is there as whole planes
  Progression progression;       ///< not finished: it cannot run yet
};

/// Finds out on which rows of a band a pass can run. Where planes have to be whole that are not yet, the band's rows
/// become part of them.
BandRun prepare_band(const PassRun& run, CpuPlanes& planes, tbb::task_arena& arena);

/// Where row 0 of a plane would be: of a whole one, or of what a band holds of it.
float* row_zero_of(const PassRun& run, const CpuPlanes& planes, const BandRun& band, const std::string& name);

/// See Device::missing_rows.
int missing_band_rows(const Frame& frame, const std::vector<std::string>& names);

/// Of a band, its rows that lie inside the guard band.
Result<Image> download_band(const Frame& frame, const std::vector<std::string>& names);

/// Calls work(y) for the rows of a plane, from all threads.
template <class Work>
void for_rows(tbb::task_arena& arena, int height, const Work& work) {
  constexpr int kRowsAtOnce = 32;  // fewer cost more to hand out than to copy
  arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<int>(0, height, kRowsAtOnce), [&](const tbb::blocked_range<int>& rows) {
      for (int y = rows.begin(); y < rows.end(); ++y) work(y);
    });
  });
}

}  // namespace umbrage
