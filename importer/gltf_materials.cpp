// Materials of glTF files. Metalness and roughness also become a Blinn-Phong highlight, see import_materials.cpp.
#include "importer/gltf_parts.h"

#include <algorithm>
#include <cmath>

#include "core/lists.h"
#include "importer/gltf_textures.h"
#include "importer/material_rules.h"

namespace umbrage {
namespace {

/// The maps of a material, in the order of preference for the mesh's texture coordinates.
enum Map { kColorMap, kEmissionMap, kSurfaceMap, kNormalMap, kOcclusionMap, kTransmissionMap, kMaps };

constexpr double kMaxEmission = 1e9;

/// An extension of materials that is not drawn, and the property that switches it on.
struct IgnoredExtension {
  std::string_view kind;  ///< without its prefix "KHR_materials_"
  const char* property;   ///< a number or a colour; null: it always has an effect
  double neutral;         ///< the value without an effect, and the default
  const char* texture;    ///< a texture that has an effect, too; null: none
};
constexpr IgnoredExtension kIgnored[] = {{"clearcoat", "clearcoatFactor", 0.0, nullptr},
                                         {"sheen", "sheenColorFactor", 0.0, nullptr},
                                         {"iridescence", "iridescenceFactor", 0.0, nullptr},
                                         {"anisotropy", "anisotropyStrength", 0.0, nullptr},
                                         {"dispersion", "dispersion", 0.0, nullptr},
                                         {"diffuse_transmission", "diffuseTransmissionFactor", 0.0, nullptr},
                                         {"ior", "ior", 1.5, nullptr},
                                         {"specular", "specularFactor", 1.0, "specularTexture"},
                                         {"specular", "specularColorFactor", 1.0, "specularColorTexture"}};
constexpr std::string_view kDrawn[] = {"unlit", "emissive_strength", "pbrSpecularGlossiness", "transmission", "volume"};
constexpr std::string_view kPrefix = "KHR_materials_";

bool differs(const Json& value, double neutral) {
  if (value.is_number()) return value.get<double>() != neutral;
  for (std::size_t k = 0; k < count_of(value); ++k)
    if (value[k].is_number() && value[k].get<double>() != neutral) return true;
  return false;
}

/// Returns whether an extension of a material changes its look and is not drawn.
bool is_ignored(std::string_view kind, const Json& properties) {
  if (contains(kDrawn, kind)) return false;
  bool is_known = false;
  for (const IgnoredExtension& each : kIgnored) {
    if (each.kind != kind) continue;
    is_known = true;
    if (differs(member(properties, each.property), each.neutral)) return true;
    if (each.texture && member(properties, each.texture).is_object()) return true;
  }
  return !is_known;
}

GltfPlacement placement_of(const Json& use, const JsonPlace& place, JsonFaults& faults) {
  constexpr double kMax = 1e6;
  GltfPlacement placement;
  placement.set = int(std::min<std::int64_t>(integer_in(use, "texCoord", 0, place, faults), 1 << 20));
  const Json& transform = extension_of(use, "KHR_texture_transform");
  if (!transform.is_object()) return placement;
  const auto offset = numbers_in<2>(transform, "offset", {0.0, 0.0}, -kMax, kMax, place, faults),
             scale = numbers_in<2>(transform, "scale", {1.0, 1.0}, -kMax, kMax, place, faults);
  placement.offset = {float(offset[0]), float(offset[1])};
  placement.scale = {float(scale[0]), float(scale[1])};
  placement.rotation = float(number_in(transform, "rotation", 0.0, -kMax, kMax, place, faults));
  placement.set = int(std::min<std::int64_t>(integer_in(transform, "texCoord", placement.set, place, faults), 1 << 20));
  return placement;
}

/// A material that is being read.
struct MaterialReader {
  GltfFile& file;
  GltfTextures& textures;
  const Json& json;
  JsonPlace place;
  Material material = {};
  std::array<Json, kMaps> uses = {};  ///< null: there is no such map
  GltfPlacement placement = {};
  float alpha = 1.0f;

  double fraction(const Json& object, const char* name, double fallback) const {
    return number_in(object, name, fallback, 0.0, 1.0, place, file.faults);
  }
  const Json& extension(const char* kind) const { return extension_of(json, (std::string(kPrefix) + kind).c_str()); }
  /// Returns the name of the texture of a map. A map that is placed otherwise than the material's first one is left
  /// out, since a mesh has one set of texture coordinates.
  std::string texture_of(Map map, const char* name) {
    if (!uses[map].is_object()) return "";
    if (placement_of(uses[map], place, file.faults) == placement) return textures.name_of(uses[map], place);
    material.ignored.push_back(fmt::format("{} with other texture coordinates", name));
    return "";
  }
  bool is_unread(const std::string& texture) const { return textures.cache.reported.contains(texture); }
};

/// Sets the colour, metalness and roughness of metal-roughness materials.
void read_metal_rough(MaterialReader& r, bool unlit) {
  const Json& metal_rough = member(r.json, "pbrMetallicRoughness");
  const auto color =
      numbers_in<4>(metal_rough, "baseColorFactor", {1.0, 1.0, 1.0, 1.0}, 0.0, 1.0, r.place, r.file.faults);
  r.material.albedo = {float(color[0]), float(color[1]), float(color[2])};
  r.alpha = float(color[3]);
  const float metallic = float(r.fraction(metal_rough, "metallicFactor", 1.0)),
              roughness = float(r.fraction(metal_rough, "roughnessFactor", 1.0));
  if (unlit) return;  // drawn matte
  if (metal_rough.is_object()) {
    r.material.metallic = metallic;
    r.material.roughness = roughness;
  }
  // The factors have no meaning without their map. On average a matte surface is right.
  if (!r.uses[kSurfaceMap].is_object()) set_highlight_of_roughness(metallic, roughness, r.material);
  const std::string surface = r.texture_of(kSurfaceMap, "metallicRoughnessTexture"),
                    occlusion = r.texture_of(kOcclusionMap, "occlusionTexture");
  if (!surface.empty() || !occlusion.empty())
    r.material.surface_texture = r.textures.cache.find_packed({{{occlusion, 0}, {surface, 1}, {surface, 2}}});
  const bool read = r.material.surface_texture != kNoTexture && !surface.empty() && !r.is_unread(surface);
  if (!read && r.uses[kSurfaceMap].is_object()) {
    r.material.metallic = 0.0f;
    r.material.roughness = kNoRoughness;
  }
  if (!occlusion.empty()) r.material.occlusion_strength = float(r.fraction(r.uses[kOcclusionMap], "strength", 1.0));
}

/// Sets the colour, metalness and roughness of specular-glossiness materials.
void read_specular_glossiness(MaterialReader& r, const Json& extension) {
  const auto color = numbers_in<4>(extension, "diffuseFactor", {1.0, 1.0, 1.0, 1.0}, 0.0, 1.0, r.place, r.file.faults);
  r.alpha = float(color[3]);
  const float glossiness = float(r.fraction(extension, "glossinessFactor", 1.0));
  const std::string specular = r.texture_of(kSurfaceMap, "specularGlossinessTexture"),
                    diffuse = r.textures.name_of(r.uses[kColorMap], r.place);
  // The standard's default is a mirror; files without a specular colour mean plastic.
  const bool is_plastic = specular.empty() && member(extension, "specularFactor").is_null();
  constexpr float kPlastic = 0.04f;
  const glm::vec3 reflectance =
      is_plastic ? glm::vec3(kPlastic) : color_in(extension, "specularFactor", 1.0, 1.0, r.place, r.file.faults);
  const auto converted = r.textures.convert_specular(diffuse, {float(color[0]), float(color[1]), float(color[2])},
                                                     specular, reflectance, glossiness);
  r.material.albedo = converted.albedo;
  r.material.texture = converted.texture;
  r.material.surface_texture = converted.surface_texture;
  r.material.metallic = converted.metallic;
  r.material.roughness = converted.roughness;
  if (converted.surface_texture == kNoTexture)
    set_highlight_of_roughness(converted.metallic, converted.roughness, r.material);
}

void read_emission(MaterialReader& r) {
  const double strength =
      number_in(r.extension("emissive_strength"), "emissiveStrength", 1.0, 0.0, kMaxEmission, r.place, r.file.faults);
  r.material.emission = color_in(r.json, "emissiveFactor", 0.0, kMaxEmission, r.place, r.file.faults) * float(strength);
  if (!r.uses[kEmissionMap].is_object() || r.material.emission == glm::vec3(0.0f)) return;
  const std::string map = r.texture_of(kEmissionMap, "emissiveTexture");
  r.material.emission_texture = map.empty() ? kNoTexture : r.textures.cache.find(map, "its light is left out");
  if (r.material.emission_texture == kNoTexture) r.material.emission = glm::vec3(0.0f);
}

/// Sets the transmittance of glass [KHR_materials_transmission, KHR_materials_volume].
void read_transmission(MaterialReader& r, const std::string& color) {
  const Json &extension = r.extension("transmission"), &volume = r.extension("volume");
  // Only the dielectric part transmits.
  const float factor = float(r.fraction(extension, "transmissionFactor", 0.0)) * (1.0f - r.material.metallic);
  if (factor <= 0.0f) return;
  Material& material = r.material;
  material.blended = material.glass = true;
  material.alpha_mask = false;
  material.tint = material.albedo;
  const double thickness = number_in(volume, "thicknessFactor", 0.0, 0.0, kNoLimit, r.place, r.file.faults),
               distance = number_in(volume, "attenuationDistance", kNoLimit, 0.0, kNoLimit, r.place, r.file.faults);
  if (thickness > 0.0 && distance > 0.0 && distance < kNoLimit) {
    const glm::vec3 transmitted = color_in(volume, "attenuationColor", 1.0, 1.0, r.place, r.file.faults);
    for (int c = 0; c < 3; ++c) material.tint[c] *= float(std::pow(double(transmitted[c]), thickness / distance));
  }
  const std::string map = r.texture_of(kTransmissionMap, "transmissionTexture");
  if (map.empty() || r.textures.cache.find(map, "the surface is shown as one pane") == kNoTexture) {
    material.opacity *= std::max(1.0f - factor, kGlassOpacity);
    return;
  }
  material.texture = r.textures.find_transmission(color, map, factor, kGlassOpacity);
}

/// Sets how a surface is cut out or blended.
void read_alpha(MaterialReader& r) {
  Material& material = r.material;
  const std::string mode = text_of(member(r.json, "alphaMode"));
  const Texture* texture =
      material.texture == kNoTexture ? nullptr : &r.textures.cache.scene.textures[std::size_t(material.texture)];
  if (mode == "MASK") {
    const double cutoff = number_in(r.json, "alphaCutoff", 0.5, 0.0, kNoLimit, r.place, r.file.faults);
    material.alpha_mask = texture;
    material.alpha_cutoff = float(cutoff);
    if (r.alpha > 0.0f) material.alpha_cutoff /= r.alpha;
  } else if (mode == "BLEND") {
    const bool has_alpha = texture && has_transparent_texels(*texture);
    // Where alpha is 0 or 1 nearly everywhere, as of leaves, cutting out is exact however many surfaces overlap.
    material.alpha_mask = has_alpha && r.alpha >= 1.0f && is_cut_out(*texture);
    material.blended = !material.alpha_mask && (has_alpha || r.alpha < 1.0f);
    if (material.blended) material.opacity = r.alpha;
  } else if (!mode.empty() && mode != "OPAQUE") {
    r.file.faults.add(r.place, "alphaMode");
  }
}

void find_maps(MaterialReader& r, const Json& specular_glossiness) {
  const Json& metal_rough = member(r.json, "pbrMetallicRoughness");
  const bool is_old = specular_glossiness.is_object();
  r.uses[kColorMap] = is_old ? member(specular_glossiness, "diffuseTexture") : member(metal_rough, "baseColorTexture");
  r.uses[kEmissionMap] = member(r.json, "emissiveTexture");
  r.uses[kSurfaceMap] = is_old ? member(specular_glossiness, "specularGlossinessTexture")
                               : member(metal_rough, "metallicRoughnessTexture");
  r.uses[kNormalMap] = member(r.json, "normalTexture");
  r.uses[kOcclusionMap] = member(r.json, "occlusionTexture");
  r.uses[kTransmissionMap] = member(r.extension("transmission"), "transmissionTexture");
  for (const Json& use : r.uses) {
    if (!use.is_object()) continue;
    r.placement = placement_of(use, r.place, r.file.faults);
    break;
  }
}

void read_material(MaterialReader& r) {
  constexpr double kMaxNormalScale = 1e6;
  Material& material = r.material;
  material.name = text_of(member(r.json, "name"));
  const Json &extensions = member(r.json, "extensions"), &old = r.extension("pbrSpecularGlossiness");
  const bool unlit = r.extension("unlit").is_object(), is_old = old.is_object() && !unlit;
  if (extensions.is_object())
    for (const auto& [name, properties] : extensions.items())
      if (name.starts_with(kPrefix) && is_ignored(std::string_view(name).substr(kPrefix.size()), properties))
        material.ignored.push_back(name.substr(kPrefix.size()));
  find_maps(r, is_old ? old : Json());
  const std::string color = r.textures.name_of(r.uses[kColorMap], r.place);
  if (is_old) {
    read_specular_glossiness(r, old);
  } else {
    read_metal_rough(r, unlit);
    if (!color.empty()) material.texture = r.textures.cache.find(color);
  }
  if (!color.empty() && r.is_unread(color)) {
    constexpr glm::vec3 kNeutral{0.8f};  // surfaces without a colour in the file
    material.albedo = kNeutral;
  }
  read_emission(r);
  if (!unlit) {
    const std::string normal = r.texture_of(kNormalMap, "normalTexture");
    if (!normal.empty()) material.normal_texture = r.textures.cache.find_linear(normal);
    material.normal_scale =
        float(number_in(r.uses[kNormalMap], "scale", 1.0, -kMaxNormalScale, kMaxNormalScale, r.place, r.file.faults));
  }
  read_alpha(r);
  if (!is_old) read_transmission(r, color);
}

}  // namespace

GltfMaterials list_gltf_materials(GltfFile& file) {
  GltfMaterials result;
  const Json& list = member(file.json, "materials");
  for (std::size_t k = 0; k <= count_of(list); ++k) {
    Scene without_images;
    GltfTextures textures(file, without_images);
    ImageUses images;
    textures.cache.asked = &images;
    MaterialReader reader{file, textures, element(list, k), {"materials", k}};
    read_material(reader);
    result.images.push_back(std::move(images));
    result.has_borders.push_back(textures.has_borders);
    const Material& material = reader.material;
    result.placements.push_back(reader.placement);
    const std::string mode = text_of(member(reader.json, "alphaMode"));
    const bool masked = mode == "MASK" && reader.alpha < float(number_in(reader.json, "alphaCutoff", 0.5, 0.0, kNoLimit,
                                                                         reader.place, file.faults));
    result.not_drawn.push_back(masked || (material.blended && material.opacity <= 0.0f));
    result.uses_alpha.push_back(mode == "MASK" || mode == "BLEND");
  }
  return result;
}

void read_gltf_materials(GltfFile& file, const GltfMaterials& listed, const std::vector<float>& footprints,
                         Scene& scene) {
  GltfTextures textures(file, scene);
  ImageUses all;
  for (std::size_t k = 0; k < listed.images.size(); ++k)
    for (const auto& [name, use] : listed.images[k]) {
      // What is cut out by alpha would lose parts that are narrower than a texel.
      const float footprint = listed.uses_alpha[k] ? 0.0f : footprints[k];
      auto& merged = all.insert({name, {footprint, use.linear}}).first->second;
      merged = {std::min(merged.footprint, footprint), merged.linear && use.linear};
    }
  textures.cache.decode(all);
  const JsonFaults faults = file.faults;  // those of materials have been counted
  for (std::size_t k = 0; k < listed.images.size(); ++k) {
    MaterialReader reader{file, textures, element(member(file.json, "materials"), k), {"materials", k}};
    read_material(reader);
    scene.materials.push_back(std::move(reader.material));
  }
  file.faults = faults;
}

void drop_unused_textures(Scene& scene) {
  std::vector<int> index(scene.textures.size(), kNoTexture);
  for (Material& material : scene.materials)
    for (const int* texture : textures_of(material))
      if (*texture != kNoTexture) index[std::size_t(*texture)] = 0;
  std::vector<Texture> kept;
  for (std::size_t k = 0; k < index.size(); ++k) {
    if (index[k] == kNoTexture) continue;
    index[k] = int(kept.size());
    kept.push_back(std::move(scene.textures[k]));
  }
  scene.textures = std::move(kept);
  for (Material& material : scene.materials)
    for (int* texture : textures_of(material))
      if (*texture != kNoTexture) *texture = index[std::size_t(*texture)];
}

}  // namespace umbrage
