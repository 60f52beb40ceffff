// Ids of objects and materials: Cryptomatte, integers, or colours; from the values of files to small integers.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "gbuffers/raw_planes.h"

namespace umbrage {

/// Max number of different ids: a float represents integers up to this exactly.
inline constexpr std::size_t kMaxIds = 1 << 24;

/// The ids that occur in a picture, sorted; planes hold indices into it, since floats cannot represent all ids.
struct IdTable {
  std::vector<std::uint32_t> ids;
  bool zero_is_none = false;  ///< Cryptomatte: 0 is the background

  /// Returns the index of an id, or -1.
  float index_of(std::uint32_t id) const;
};

/// Finds Cryptomatte's layers of rank 0 in a file, those of objects first: channels id and coverage of the best match,
/// as Psyop's specification names them. Returns nothing if there are none. `materials`: those of materials.
std::optional<RoleChannels> find_cryptomatte(const LayeredFile& header, int file, bool materials);

/// Reads ids from rows: the bits of one float, or a number for each colour.
class IdReader {
 public:
  IdReader(const RawRows& raw, Role role);
  /// `row`: of the planes, not of the picture.
  std::uint32_t at(int x, int row) const;

 private:
  const Plane* first_;
  const Plane *second_, *third_;  // null unless ids are colours
};

/// Collects the ids that occur. Errors: kFile; also if there are more than floats can number.
Result<IdTable> collect_ids(const RawPlanes& raw, Role role, bool zero_is_none);

}  // namespace umbrage
