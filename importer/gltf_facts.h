// What a glTF file says beyond what Assimp 5.2 hands over: how textures lie, how strongly surfaces shine, its cameras.
#pragma once
#include <filesystem>
#include <glm/vec2.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace umbrage {

/// How a texture lies on a surface [KHR_texture_transform].
struct GltfPlacement {
  int set = 0;  ///< of texture coordinates
  glm::vec2 offset{0.0f}, scale{1.0f};
  float rotation = 0.0f;  ///< radians

  bool operator==(const GltfPlacement&) const = default;
  /// Texture coordinates as Scene has them, from those of the mesh's set.
  glm::vec2 placed(glm::vec2 uv) const;
};

struct GltfMaterial {
  GltfPlacement color, emission;
  bool has_color_texture = false, has_emission_texture = false;
  float emission_strength = 1.0f;  ///< [KHR_materials_emissive_strength]
  bool unlit = false;              ///< [KHR_materials_unlit]
  float alpha = 1.0f;              ///< of the colour's factor
  float cutoff = 0.5f;
  std::string mode = "OPAQUE";

  /// Where its texture coordinates come from: the colour's, or the emission's where it has no other texture.
  const GltfPlacement& placement() const { return has_color_texture ? color : emission; }
};

struct GltfFacts {
  std::vector<GltfMaterial> materials;  ///< as they are numbered in the file
  std::vector<View> cameras;            ///< of the scene that is drawn; targets are one unit away
  std::vector<std::string> scenes;      ///< names
  int scene = 0;                        ///< which one is drawn
  int lights = 0;
};

/// Reads them, of the scene of that number, or of the one that the file names. Nothing of it is an error: what is not
/// there, or not as it should be, stays as it is by default.
GltfFacts read_gltf_facts(const std::filesystem::path& file, std::optional<int> scene = std::nullopt);

/// The bytes of a .gltf or .glb file in which scene `scene` is the one to draw; empty where it cannot be changed so.
std::string gltf_with_scene(const std::filesystem::path& file, int scene);

}  // namespace umbrage
