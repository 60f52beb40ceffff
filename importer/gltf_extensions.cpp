// Extensions of glTF: which are read, and warnings for the others.
#include "importer/gltf_parts.h"

#include <set>

#include "core/lists.h"

namespace umbrage {
namespace {

/// Extensions that are read, or that have warnings of their own where they are used.
constexpr std::string_view kRead[] = {
    "EXT_mesh_gpu_instancing", "EXT_meshopt_compression",    "EXT_texture_avif",    "EXT_texture_webp",
    "KHR_animation_pointer",   "KHR_draco_mesh_compression", "KHR_lights_punctual", "KHR_mesh_quantization",
    "KHR_meshopt_compression", "KHR_node_visibility",        "KHR_texture_basisu",  "KHR_texture_transform",
    "MSFT_texture_dds"};

/// Extensions without an effect on a still picture: metadata, interaction, sound, physics, levels of detail.
constexpr std::string_view kInvisible[] = {"ADOBE_materials_thin_transparency_hint",
                                           "AGI_articulations",
                                           "AGI_stk_metadata",
                                           "EXT_feature_metadata",
                                           "EXT_instance_features",
                                           "EXT_mesh_features",
                                           "EXT_structural_metadata",
                                           "FB_geometry_metadata",
                                           "GODOT_single_root",
                                           "KHR_audio_emitter",
                                           "KHR_interactivity",
                                           "KHR_node_hoverability",
                                           "KHR_node_selectability",
                                           "KHR_physics_rigid_bodies",
                                           "KHR_xmp",
                                           "KHR_xmp_json_ld",
                                           "MSFT_lod",
                                           "OMI_physics_body",
                                           "OMI_physics_shape",
                                           "VRM",
                                           "VRMC_springBone",
                                           "VRMC_vrm"};

constexpr std::string_view kOfMaterials = "KHR_materials_", kVariants = "KHR_materials_variants";

std::set<std::string> names_in(const Json& list) {
  std::set<std::string> names;
  for (std::size_t k = 0; k < count_of(list); ++k)
    if (list[k].is_string()) names.insert(text_of(list[k]));
  return names;
}

}  // namespace

void warn_of_extensions(GltfFile& file) {
  const std::set<std::string> required = names_in(member(file.json, "extensionsRequired"));
  std::set<std::string> names = names_in(member(file.json, "extensionsUsed"));
  names.insert(required.begin(), required.end());
  // Some files do not list what they use.
  if (const Json& of_root = member(file.json, "extensions"); of_root.is_object())
    for (const auto& [name, ignored] : of_root.items()) names.insert(name);
  for (const std::string& name : names) {
    if (contains(kRead, name) || contains(kInvisible, name)) continue;
    if (name == kVariants) {
      const std::size_t count = count_of(member(extension_of(file.json, kVariants.data()), "variants"));
      file.warn_once(name,
                     fmt::format("the file has {} variants of its materials (KHR_materials_variants); its default "
                                 "materials are drawn",
                                 count));
    } else if (required.contains(name) && !name.starts_with(kOfMaterials)) {
      file.warn_once(
          name, fmt::format("the file requires the extension {}, which is not read: the picture may be wrong", name));
    } else if (!name.starts_with(kOfMaterials)) {
      file.warn_once(name, fmt::format("the file uses the extension {}, which is not read", name));
    }
  }
}

}  // namespace umbrage
