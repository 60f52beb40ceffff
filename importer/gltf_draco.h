// Primitives compressed with Draco [KHR_draco_mesh_compression], decoded by its library.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "importer/gltf_accessor.h"

namespace umbrage {

/// A decoded primitive: triangles, and the attributes that the extension lists, such as "POSITION".
struct DracoPrimitive {
  std::vector<std::uint32_t> indices;
  std::map<std::string, GltfNumbers> attributes;
};

/// Decodes a primitive that has the extension. Errors: kFile.
Result<DracoPrimitive> decode_draco(GltfFile& file, const Json& primitive);

}  // namespace umbrage
