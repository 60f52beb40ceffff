// Functions of Scene: bounds, counts, size text, lighting.
#include "scene/scene.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <map>

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

glm::dvec3 scene_origin(const glm::dvec3& low, const glm::dvec3& high) {
  /// Centres within this many sizes of the box stay: a float then resolves a millionth of the size.
  constexpr double kMaxDistance = 16.0;
  const glm::dvec3 center = 0.5 * (low + high), size = high - low;
  const double extent = std::max({size.x, size.y, size.z});
  const double distance = std::max({std::abs(center.x), std::abs(center.y), std::abs(center.z)});
  if (!(extent > 0.0) || !std::isfinite(extent) || !(distance > kMaxDistance * extent)) return glm::dvec3(0.0);
  const double step = std::exp2(std::ceil(std::log2(extent)));
  return glm::round(center / step) * step;
}

void set_origin(const glm::dvec3& origin, Scene& scene) {
  if (origin == scene.origin) return;
  const glm::dvec3 shift = scene.origin - origin;
  const auto move = [&](glm::vec3& position) { position = glm::vec3(glm::dvec3(position) + shift); };
  for (Mesh& mesh : scene.meshes) std::for_each(mesh.positions.begin(), mesh.positions.end(), move);
  for (std::vector<View>* views : {&scene.views, &scene.cameras})
    for (View& view : *views) move(view.eye), move(view.target);
  for (Light& light : scene.lights) move(light.position);
  std::for_each(scene.motion.begin(), scene.motion.end(), move);
  if (scene.start) {
    auto start = std::make_shared<Scene>(*scene.start);
    set_origin(origin, *start);
    scene.start = std::move(start);
  }
  for (glm::vec3* position : {&scene.bounds_min, &scene.bounds_max, &scene.ground_center}) move(*position);
  scene.origin = origin;
}

void explode(float fraction, Scene& scene) {
  constexpr float kFar = std::numeric_limits<float>::max();
  struct Box {
    glm::vec3 low{kFar}, high{-kFar};
    void add(const glm::vec3& p, float radius) { low = glm::min(low, p - radius), high = glm::max(high, p + radius); }
  };
  std::map<int, Box> boxes;  // by object
  for (const Mesh& mesh : scene.meshes)
    for (const glm::vec3& p : mesh.positions) boxes[mesh.object].add(p, 0.0f);
  if (boxes.size() < 2) scene.warnings.push_back("`explode` does nothing: the model is one part");
  const glm::vec3 center = scene.center();
  // Vertices outside of the bounds are strays, which do not count.
  const glm::vec3 low = scene.bounds_min, high = scene.bounds_max;
  Box all;
  for (Mesh& mesh : scene.meshes) {
    const Box& box = boxes[mesh.object];
    const glm::vec3 shift = fraction * (0.5f * (box.low + box.high) - center);
    for (std::size_t k = 0; k < mesh.positions.size(); ++k) {
      glm::vec3& p = mesh.positions[k];
      const bool counts = glm::clamp(p, low, high) == p;
      p += shift;
      if (counts) all.add(p, mesh.radii.empty() ? 0.0f : mesh.radii[k]);
    }
  }
  if (all.low.x <= all.high.x) scene.bounds_min = all.low, scene.bounds_max = all.high;
  std::vector<glm::vec3> motion = scene.motion;
  for (glm::vec3& p : motion) p += fraction * (p - center);
  set_motion(std::move(motion), scene);
  scene.shape_facts = std::make_shared<ShapeFacts>();
}

void set_motion(std::vector<glm::vec3> points, Scene& scene) {
  if (points.empty()) return;
  scene.bounds_min = scene.bounds_max = points[0];
  for (const glm::vec3& p : points)
    scene.bounds_min = glm::min(scene.bounds_min, p), scene.bounds_max = glm::max(scene.bounds_max, p);
  scene.motion = std::move(points);
}

glm::dmat4 view_from_file(const glm::mat4& view_from_scene, const glm::dvec3& origin) {
  return glm::translate(glm::dmat4(view_from_scene), -origin);
}

}  // namespace umbrage
