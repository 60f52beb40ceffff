// Parts of glTF files that importer/gltf.cpp leaves to other files: meshes, whose primitives of all modes become
// triangles or points, morphed, skinned and placed in the world; materials, lights, extensions and compressed
// primitives.
#pragma once
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <map>
#include <string>
#include <vector>

#include "importer/common/placed_mesh.h"
#include "importer/gltf_accessor.h"
#include "importer/gltf_file.h"
#include "importer/texture_cache.h"
#include "scene/readers/import.h"
#include "scene/scene.h"

namespace umbrage {

/// Placement of a texture on a surface [KHR_texture_transform].
struct GltfPlacement {
  int set = 0;  ///< index of the set of texture coordinates
  glm::vec2 offset{0.0f}, scale{1.0f};
  float rotation = 0.0f;  ///< radians

  bool operator==(const GltfPlacement&) const = default;
  /// Converts texture coordinates of the file to those of Scene, whose v points up.
  glm::vec2 placed(glm::vec2 uv) const;
};

/// A primitive in the space of its mesh.
struct GltfPrimitive {
  Mesh mesh;
  std::vector<GltfNumbers> joints, weights;  ///< of each set, VEC4; equally many
  bool has_alpha = false;                    ///< colours of vertices with an alpha below 1
};

/// What a file's meshes have in common.
struct GltfMeshRules {
  std::vector<GltfPlacement> placements;  ///< of each material
  std::vector<bool> has_borders;          ///< of each material: whether a texture is clamped or mirrored
  int default_material = 0;               ///< index of the material for primitives without one
  bool flat = true;                       ///< primitives without normals are flat
  std::optional<std::string> field;       ///< see ImportSettings
};

/// Triangles that were left out.
struct GltfCounts {
  std::size_t triangles = 0, out_of_range = 0;
};

/// Reads a primitive, with its morph targets applied by their weights. Parts that are invalid are left out with a
/// warning. Errors: kFile if nothing can be drawn; a message that is empty if there are only lines, for which there is
/// a warning.
Result<GltfPrimitive> read_primitive(GltfFile& file, const Json& mesh, std::size_t primitive,
                                     const std::vector<float>& morph_weights, const GltfMeshRules& rules,
                                     GltfCounts& counts);

/// Places a primitive by the joints of a skin: transforms from the space of the mesh to world space.
PlacedMesh skinned(const GltfPrimitive& primitive, const std::vector<glm::dmat4>& world_from_bind);

struct GltfMaterials {
  std::vector<GltfPlacement> placements;  ///< of the textures of each material
  std::vector<bool> has_borders;          ///< whether a texture is clamped or mirrored
  std::vector<bool> not_drawn;            ///< whether surfaces of a material are wholly transparent
  std::vector<bool> uses_alpha;           ///< blended, or cut out
  std::vector<ImageUses> images;          ///< that each material needs
};

/// Lists the materials of the file, in order, and one more, the standard's default. Reads no images.
GltfMaterials list_gltf_materials(GltfFile& file);

/// Appends one Material per listed one, and the textures that they need, each once. `footprints`: see
/// smallest_footprints. Each texture that cannot be read adds a sentence to scene.warnings.
void read_gltf_materials(GltfFile& file, const GltfMaterials& listed, const std::vector<float>& footprints,
                         Scene& scene);

/// Returns for each material, of which `images` are needed, the width of the smallest area of a texture that a pixel
/// averages, in texture coordinates, if the picture is that of ImportSettings::fitted_px; 0: not known. Sets the bounds
/// of the scene, about.
std::vector<float> smallest_footprints(Scene& scene, const std::vector<ImageUses>& images,
                                       const ImportSettings& settings);

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
