// Functions of Scene: bounds, counts, size text, lighting.
#include "scene/scene.h"

#include <algorithm>

#include <cmath>

namespace umbrage {

float Scene::radius() const {
  const double x = double(bounds_max.x) - double(bounds_min.x), y = double(bounds_max.y) - double(bounds_min.y),
               z = double(bounds_max.z) - double(bounds_min.z);
  return float(0.5 * std::sqrt(x * x + y * y + z * z));
}

std::size_t Scene::triangle_count() const {
  std::size_t count = 0;
  for (const Mesh& mesh : meshes) count += mesh.indices.size() / 3;
  return count;
}

std::size_t Scene::point_count() const {
  std::size_t count = 0;
  for (const Mesh& mesh : meshes) count += mesh.points ? mesh.positions.size() : 0;
  return count;
}

std::string size_text(const Scene& scene) {
  const std::size_t triangles = scene.triangle_count(), points = scene.point_count();
  if (points == 0) return std::to_string(triangles) + " triangles";
  return (triangles > 0 ? std::to_string(triangles) + " triangles and " : "") + std::to_string(points) + " points";
}

bool has_roughness(const Scene& scene) {
  return std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& material) { return material.roughness >= 0.0f; });
}

namespace {

/// Returns whether a blended material is seen through: on meshes with texture coordinates, or on those without.
bool is_seen_through(const Scene& scene, const Material& material, bool has_uvs) {
  if (material.opacity < kOpaque || material.texture == kNoTexture || !has_uvs) return material.opacity < kOpaque;
  const std::vector<std::uint8_t>& rgba = scene.textures[std::size_t(material.texture)].rgba;
  for (std::size_t i = 3; i < rgba.size(); i += 4)
    if (material.opacity * float(rgba[i]) < kOpaque * 255.0f) return true;
  return false;
}

}  // namespace

bool has_blended(const Scene& scene) {
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    if (!scene.materials[m].blended) continue;
    for (const bool has_uvs : {false, true}) {
      const bool is_used = std::any_of(scene.meshes.begin(), scene.meshes.end(), [&](const Mesh& mesh) {
        return std::size_t(mesh.material) == m && mesh.uvs.empty() != has_uvs;
      });
      if (is_used && is_seen_through(scene, scene.materials[m], has_uvs)) return true;
    }
  }
  return false;
}

Lighting lighting_of(const Scene& scene) {
  return {scene.lights, scene.ambient, scene.ambient_shape, scene.lit_white_luminance, scene.reflections};
}

void set_lighting(Lighting lighting, Scene& scene) {
  scene.lights = std::move(lighting.lights);
  scene.ambient = lighting.ambient;
  scene.ambient_shape = lighting.ambient_shape;
  scene.lit_white_luminance = lighting.lit_white_luminance;
  scene.reflections = std::move(lighting.reflections);
}

}  // namespace umbrage
