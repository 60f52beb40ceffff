// The textures of an OBJ file's materials.
#include "importer/readers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "importer/material_rules.h"
#include "importer/texture_cache.h"

namespace umbrage {
namespace {

constexpr glm::vec3 kNeutralAlbedo{0.8f};  ///< surfaces whose texture is missing

/// The names of a material's maps in the texture cache; empty: no map.
struct MapNames {
  std::array<std::string, kMtlMaps> names;
  const MtlMap* first = nullptr;  ///< places the others

  MapNames(const MtlMaterial& source, TextureCache& textures, Material& material) {
    for (int k = 0; k < kMtlMaps; ++k) {
      const MtlMap& map = source.maps[std::size_t(k)];
      if (map.file.empty()) continue;
      if (!first) first = &map;
      if (map.same_place(*first))
        names[std::size_t(k)] = name_of(map, textures);
      else
        material.ignored.push_back(fmt::format("{} with other -s or -o", kMtlMapNames[std::size_t(k)]));
    }
  }
  const std::string& operator[](MtlMapKind kind) const { return names[kind]; }

 private:
  /// Returns a map's name in the cache: its file's, or one for the file with changed texels.
  static std::string name_of(const MtlMap& map, TextureCache& textures) {
    if (map.channel == '\0' && map.base == 0.0f && map.gain == 1.0f) return map.file;
    std::string name = fmt::format("{} with -mm {} {}", map.file, map.base, map.gain);
    if (map.channel != '\0') name += fmt::format(" -imfchan {}", map.channel);
    textures.edits[name] = {map.file, map.channel, map.base, map.gain};
    return name;
  }
};

/// Sets the maps of metalness and roughness, which replace their numbers, and of normals.
void set_surface(const MtlMaterial& source, const MapNames& maps, TextureCache& textures, Material& material) {
  const std::string &rough = maps[kMapPr], &metal = maps[kMapPm];
  if (!rough.empty() || !metal.empty())
    material.surface_texture = textures.find_packed({{{"", 0}, {rough, 0}, {metal, 0}}});
  const auto is_read = [&](const std::string& map) {
    return material.surface_texture != kNoTexture && !map.empty() && !textures.reported.contains(map);
  };
  const bool rough_mapped = is_read(rough), metal_mapped = is_read(metal);
  if (material.roughness == kNoRoughness && (rough_mapped || metal_mapped))
    material.roughness = std::pow(2.0f / (material.specular_exponent + 2.0f), 0.25f);
  if (rough_mapped) material.roughness = 1.0f;
  if (metal_mapped) material.metallic = 1.0f;
  if (!maps[kNorm].empty()) {
    material.normal_texture = textures.find_linear(maps[kNorm]);
    material.normal_scale = source.maps[kNorm].bump;
  } else if (!maps[kMapBump].empty()) {
    material.normal_texture = textures.find_normals_of_heights(maps[kMapBump], source.maps[kMapBump].bump);
  }
}

void set_color(const MapNames& maps, TextureCache& textures, Material& material) {
  const std::string &color = maps[kMapKd], &mask = maps[kMapD];
  if (color.empty() && mask.empty()) return;
  material.texture = mask.empty() || mask == color ? textures.find(color) : textures.find_with_mask(color, mask);
  if (material.texture == kNoTexture) {
    if (!color.empty()) material.albedo = kNeutralAlbedo;
    return;
  }
  // Some exporters write a black colour with a texture, because the texture replaces the colour in their viewer.
  if (!color.empty() && material.albedo == glm::vec3(0.0f)) material.albedo = glm::vec3(1.0f);
  const Texture& texture = textures.scene.textures[std::size_t(material.texture)];
  material.alpha_mask = is_cut_out(texture);
  // The alpha of a colour texture that no map_d names is often left over from an image editor.
  if (!material.alpha_mask && !mask.empty() && !textures.reported.contains(mask) && has_transparent_texels(texture))
    material.blended = true;
}

void set_emission(const MapNames& maps, TextureCache& textures, Material& material) {
  const std::string& map = maps[kMapKe];
  if (map.empty()) return;
  material.emission_texture = textures.find(map, "its surfaces do not glow");
  material.emission = glm::vec3(material.emission_texture == kNoTexture ? 0.0f : 1.0f);
}

void set_maps(const MtlMaterial& source, const MapNames& maps, TextureCache& textures, Material& material) {
  set_emission(maps, textures, material);
  set_surface(source, maps, textures, material);
  set_color(maps, textures, material);
}

/// Returns the images that the materials need.
ImageUses images_of(const ObjScene& obj) {
  Scene without_images;
  ImageUses images;
  TextureCache textures{.source = nullptr, .folder = {}, .scene = without_images, .asked = &images};
  for (std::size_t m = 0; m < obj.scene.materials.size(); ++m) {
    if (!obj.sources[m]) continue;
    Material material;
    set_maps(*obj.sources[m], MapNames(*obj.sources[m], textures, material), textures, material);
  }
  return images;
}

}  // namespace

void import_obj_maps(const ObjFile& file, ObjScene& obj) {
  Scene& scene = obj.scene;
  TextureCache textures{nullptr, file.path.parent_path(), scene};
  textures.decode(images_of(obj));
  std::vector<const MtlMap*> places;
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    places.push_back(nullptr);
    if (!obj.sources[m]) continue;
    Material& material = scene.materials[m];
    const MapNames maps(*obj.sources[m], textures, material);
    places[m] = maps.first;
    set_maps(*obj.sources[m], maps, textures, material);
  }
  bool is_clamped = false;
  std::set<std::string> unplaced;  // materials with textures on faces without texture coordinates
  for (Mesh& mesh : scene.meshes) {
    if (mesh.uvs.empty())
      for (const int* texture : textures_of(scene.materials[std::size_t(mesh.material)]))
        if (*texture != kNoTexture) unplaced.insert(scene.materials[std::size_t(mesh.material)].name);
    const MtlMap* place = places[std::size_t(mesh.material)];
    if (!place) continue;
    if (place->scale != glm::vec2(1.0f) || place->offset != glm::vec2(0.0f))
      for (glm::vec2& uv : mesh.uvs) uv = uv * place->scale + place->offset;
    const auto is_outside = [](const glm::vec2& uv) {
      return std::max(std::abs(uv.x - 0.5f), std::abs(uv.y - 0.5f)) > 0.5001f;
    };
    is_clamped = is_clamped || (place->clamp && std::any_of(mesh.uvs.begin(), mesh.uvs.end(), is_outside));
  }
  if (!unplaced.empty())
    scene.warnings.push_back(
        fmt::format("faces of the material '{}'{} have no texture coordinates and are drawn without its textures",
                    *unplaced.begin(), unplaced.size() > 1 ? fmt::format(" and {} more", unplaced.size() - 1) : ""));
  if (is_clamped) scene.warnings.push_back("-clamp of maps is not drawn; textures repeat");
}

}  // namespace umbrage
