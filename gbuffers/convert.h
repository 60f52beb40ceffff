// Conversion of stored values to the planes of core/gbuffer.h. A pure function of conventions and values.
#pragma once
#include <string>
#include <vector>

#include "core/image.h"
#include "gbuffers/conventions.h"
#include "gbuffers/ids.h"
#include "gbuffers/raw_planes.h"

namespace umbrage {

/// What the conversion needs.
struct Conversion {
  Conventions conventions;
  std::vector<std::string> own;  ///< plane names of the channels of Role::kOwn
  IdTable object_ids, material_ids;
};

/// Returns the names of the planes that convert() makes.
std::vector<std::string> converted_names(const RawPlanes& raw, const Conversion& conversion);

/// Returns the view depth of rows.
Plane converted_depth(const RawRows& raw, const Conventions& conventions, const Rows& rows);

/// Returns the rows of all planes, as GBufferFile::rows. `raw` contains the rows.
Image convert(const RawRows& raw, const Conversion& conversion, const Rows& rows);

}  // namespace umbrage
