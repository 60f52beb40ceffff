// RawPlanes: the values that files store for the roles of a G-buffer, before they are converted; in memory, or in
// scratch files if the picture is too large.
#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/result.h"
#include "core/strip.h"
#include "gbuffers/roles.h"
#include "gbuffers/row_store.h"

namespace umbrage {

/// Returns the name of the plane of a role's channel: "normal.1".
std::string raw_plane(Role role, std::size_t channel);

/// Planes of stored values that contain some rows of the picture.
struct RawRows {
  int first = 0;  ///< row of the picture that is row 0 of the planes
  std::vector<std::string> names;
  std::vector<const Plane*> planes;
  std::vector<Image> owned;  ///< pixels of `planes` that are not kept elsewhere

  /// Returns the plane of a role's channel, or null.
  const Plane* find(Role role, std::size_t channel) const;
};

struct Packing;

/// Reads channels of a file, as io/layers.h does.
using ReadChannelRows = std::function<Result<void>(const LayeredFile&, std::span<const int>, const TakeLayerRows&)>;

/// How files are read.
struct RawReading {
  bool flip = false;                 ///< the first row of the files is the lowest
  const Packing* packing = nullptr;  ///< of the depth, whose channels become one plane; null: none
  double memory = 1e18;              ///< pixels that exceed these bytes go to a file in `scratch_folder`
  std::string scratch_folder = ".";
  ReadChannelRows read_rows = umbrage::read_rows;
};

class RawPlanes {
 public:
  /// Reads all channels that have roles. Where Role::kMask is 0, depth and positions become NaN. Errors: kFile; kUsage
  /// if the files differ in size.
  static Result<RawPlanes> read(std::span<const LayeredFile> headers, const Roles& roles, const RawReading& reading);

  int width() const { return width_; }
  int height() const { return height_; }
  bool is_in_memory() const;
  bool has(Role role, std::size_t channel = 0) const;
  /// Returns planes that contain the rows. They refer to this object. Errors: kFile.
  Result<RawRows> rows(const Rows& rows) const;

 private:
  int width_ = 0, height_ = 0;
  std::vector<RowStore> stores_;  // one per file
};

}  // namespace umbrage
