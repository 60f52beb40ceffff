// Parts of glTF files that importer/gltf.cpp and gltf_mesh.cpp leave to other files: materials, lights, extensions and
// compressed primitives.
#pragma once
#include <glm/mat4x4.hpp>
#include <map>
#include <string>
#include <vector>

#include "importer/gltf_accessor.h"
#include "importer/gltf_file.h"
#include "importer/gltf_mesh.h"
#include "scene/scene.h"

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

/// Appends the lights at these nodes to scene.lights, the brightest at the scene's centre first, at most kMaxShadows.
/// Their intensities keep their ratios; together they light the centre as the built-in lights do. The meshes and the
/// origin of the scene must be set. `world`: the transforms of all nodes of the file.
void add_gltf_lights(GltfFile& file, const std::vector<int>& nodes, const std::vector<glm::dmat4>& world, Scene& scene);

/// Adds one warning for each extension that the file uses or requires, that may change the picture and that is not
/// read. Those of materials are left to warn_of_ignored, which knows whether they have an effect.
void warn_of_extensions(GltfFile& file);

/// A decoded primitive: triangles, and the attributes that the extension lists, such as "POSITION".
struct DracoPrimitive {
  std::vector<std::uint32_t> indices;
  std::map<std::string, GltfNumbers> attributes;
};

/// Decodes a primitive that has the extension. Errors: kFile.
Result<DracoPrimitive> decode_draco(GltfFile& file, const Json& primitive);

}  // namespace umbrage
