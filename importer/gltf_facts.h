// Properties of a glTF file that Assimp 5.2 does not provide: texture transforms, emissive strengths, cameras, scenes.
#pragma once
#include <array>
#include <filesystem>
#include <glm/vec2.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace umbrage {

/// Placement of a texture on a surface [KHR_texture_transform].
struct GltfPlacement {
  int set = 0;  ///< index of the set of texture coordinates
  glm::vec2 offset{0.0f}, scale{1.0f};
  float rotation = 0.0f;  ///< radians

  bool operator==(const GltfPlacement&) const = default;
  /// Converts texture coordinates of the mesh to texture coordinates of the texture, in the convention of Scene.
  glm::vec2 placed(glm::vec2 uv) const;
};

/// The maps of a material, in the order of preference for the mesh's texture coordinates.
enum GltfMap { kColorMap, kEmissionMap, kSurfaceMap, kNormalMap, kOcclusionMap, kGltfMaps };

struct GltfMaterial {
  std::array<std::optional<GltfPlacement>, kGltfMaps> maps;  ///< nothing: there is no such map
  bool has_roughness = false;                                ///< the file has `pbrMetallicRoughness`
  float metallic = 1.0f, roughness = 1.0f;
  float normal_scale = 1.0f, occlusion_strength = 1.0f;
  std::vector<std::string> ignored;  ///< extensions that are not drawn, without their prefix: "transmission"
  float emission_strength = 1.0f;    ///< [KHR_materials_emissive_strength]
  bool unlit = false;                ///< [KHR_materials_unlit]
  float alpha = 1.0f;                ///< alpha of the base color factor
  float cutoff = 0.5f;
  std::string mode = "OPAQUE";

  /// Returns the placement for the mesh's texture coordinates: that of the first map.
  GltfPlacement placement() const;
};

/// Properties of a glTF file.
struct GltfFacts {
  std::vector<GltfMaterial> materials;  ///< in the order of the file
  std::vector<View> cameras;            ///< cameras of the scene that is drawn; targets are 1 unit away
  std::vector<std::string> scenes;      ///< names of all scenes
  int scene = 0;                        ///< index of the scene that is drawn
  int lights = 0;                       ///< number of lights
};

/// Reads the properties of scene `scene`, or of the file's default scene. Never fails: a missing or invalid property
/// keeps its default.
GltfFacts read_gltf_facts(const std::filesystem::path& file, std::optional<int> scene = std::nullopt);

/// Returns the bytes of a .gltf or .glb file with `scene` set as its default scene; empty if they cannot be changed.
std::string gltf_with_scene(const std::filesystem::path& file, int scene);

}  // namespace umbrage
