// Meshes of glTF files: primitives of all modes as triangles or points, morphed, skinned and placed in the world.
#pragma once
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <vector>

#include "importer/gltf_accessor.h"
#include "importer/placed_mesh.h"
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

}  // namespace umbrage
