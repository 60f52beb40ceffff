// Materials of glTF files. Metalness and roughness also become a Blinn-Phong highlight, see import_materials.cpp.
#pragma once
#include <vector>

#include "importer/gltf_mesh.h"

namespace umbrage {

struct GltfMaterials {
  std::vector<GltfPlacement> placements;  ///< of the textures of each material
  std::vector<bool> has_borders;          ///< whether a texture is clamped or mirrored
  std::vector<bool> not_drawn;            ///< whether surfaces of a material are wholly transparent
  std::vector<bool> uses_alpha;           ///< blended, or cut out
};

/// Appends one Material per material of the file, in order, and one more, the standard's default; and the textures that
/// they need, each once. Each texture that cannot be read adds a sentence to scene.warnings.
GltfMaterials read_gltf_materials(GltfFile& file, Scene& scene);

/// Removes textures that no material refers to.
void drop_unused_textures(Scene& scene);

}  // namespace umbrage
