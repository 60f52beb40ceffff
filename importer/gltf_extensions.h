// Extensions of glTF: which are read, and warnings for the others.
#pragma once
#include "importer/gltf_file.h"

namespace umbrage {

/// Adds one warning for each extension that the file uses or requires, that may change the picture and that is not
/// read. Those of materials are left to warn_of_ignored, which knows whether they have an effect.
void warn_of_extensions(GltfFile& file);

}  // namespace umbrage
