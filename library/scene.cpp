#include "library/scene.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "library/job.h"
#include "renderer/models.h"
#include "renderer/recipe.h"

namespace umbrage {
namespace {

/// Returns a transformed copy of a mesh.
Mesh placed(const Mesh& mesh, const glm::mat4& world_from_mesh) {
  Mesh at = mesh;
  const glm::mat3 turn(world_from_mesh);
  const glm::mat3 of_normals = glm::transpose(glm::inverse(turn));
  const float scale = std::cbrt(std::abs(glm::determinant(turn)));
  for (glm::vec3& p : at.positions) p = glm::vec3(world_from_mesh * glm::vec4(p, 1.0f));
  for (glm::vec3& n : at.normals)
    if (const glm::vec3 v = of_normals * n; glm::length(v) > 0.0f) n = glm::normalize(v);
  for (float& r : at.radii) r *= scale;
  // A reflection reverses the winding of triangles.
  if (glm::determinant(turn) < 0.0f)
    for (std::size_t k = 0; k + 2 < at.indices.size(); k += 3) std::swap(at.indices[k + 1], at.indices[k + 2]);
  return at;
}

/// Returns an unfinished scene with all instances of one mesh.
Scene scene_of(const SharedMesh& shared) {
  Scene scene;
  scene.name = shared.mesh.name;
  scene.materials.push_back(shared.material);
  // Colours and textures multiply the albedo, as in files.
  if (!shared.has_albedo && (!shared.mesh.colors.empty() || !shared.albedo.rgba.empty()))
    scene.materials[0].albedo = glm::vec3(1.0f);
  const auto add = [&](const Texture& texture, int& index) {
    if (texture.rgba.empty()) return;
    index = int(scene.textures.size());
    scene.textures.push_back(texture);
  };
  add(shared.albedo, scene.materials[0].texture);
  add(shared.emission, scene.materials[0].emission_texture);
  if (shared.instances.empty()) scene.meshes.push_back(shared.mesh);
  for (const glm::mat4& instance : shared.instances) {
    scene.meshes.push_back(placed(shared.mesh, instance));
    scene.meshes.back().object = int(scene.meshes.size()) - 1;
  }
  if (shared.settings.up != glm::vec3(0.0f)) scene.up = shared.settings.up;
  return scene;
}

/// Returns the bounding box of all instances of a mesh, equal to that of finish_scene; empty if nothing can be drawn.
SceneBox box_of(const SharedMesh& shared) {
  SceneBox box;
  if (!shared.mesh.points) {
    if (shared.instances.empty()) add_triangles(shared.mesh, glm::mat4(1.0f), box);
    for (const glm::mat4& instance : shared.instances) add_triangles(shared.mesh, instance, box);
    return box;
  }
  Scene cloud = scene_of(shared);  // the size of points depends on their neighbours
  finish_scene(cloud, shared.settings.crease_angle_deg, shared.settings.points);
  if (!cloud.meshes.empty()) box = {cloud.bounds_min, cloud.bounds_max};
  return box;
}

}  // namespace

Result<void> SceneObject::set_parameter(const std::string& name, const char* value) {
  const Option* row = find_parameter(name, "scene");
  if (!row) return unknown_parameter(name, "scene");
  Request changed = request_;
  if (value && *value) {
    if (auto set = set_option(*row, value, changed); !set) return set;
  } else {
    reset_option(*row, changed);
  }
  request_ = std::move(changed);
  return {};
}

Result<void> SceneObject::load(const std::string& model) {
  const auto settings = import_settings(request_);
  if (!settings) return settings.error();
  if (progress && !progress(0.0)) return interrupted();
  auto scene = load_scene(model, *settings, progress);
  if (!scene) return scene.error();
  for (const std::string& warning : scene->warnings) device_->report_warning(warning);
  if (has_models_) {
    Scene both = models_;  // so that the scene is unchanged if memory runs out
    append_scene(std::move(*scene), both);
    models_ = std::move(both);
  } else {
    models_ = std::move(*scene);
  }
  has_models_ = true;
  changed();
  return {};
}

Result<int> SceneObject::add_mesh(const std::string& name, std::size_t vertices, std::size_t triangles) {
  constexpr std::size_t kMaxCount = std::size_t(1) << 31;
  if (vertices == 0 || vertices >= kMaxCount || triangles >= kMaxCount)
    return usage_error(
        "a mesh cannot have {} vertices and {} triangles: it takes 1 to {} vertices and at most {} triangles", vertices,
        triangles, kMaxCount - 1, kMaxCount - 1);
  const auto settings = import_settings(request_);
  if (!settings) return settings.error();
  SharedMesh shared{.vertices = vertices, .triangles = triangles, .settings = *settings};
  shared.mesh.name = name;
  shared.mesh.points = triangles == 0;
  meshes_.push_back(std::move(shared));
  changed();
  return int(meshes_.size()) - 1;
}

Result<SharedMesh*> SceneObject::mesh(int index) {
  if (index < 0 || std::size_t(index) >= meshes_.size())
    return usage_error("the scene has no mesh {}: umbAddMesh made {}", index, meshes_.size());
  SharedMesh& mesh = meshes_[std::size_t(index)];
  if (mesh.is_removed) return usage_error("mesh {} of the scene was removed", index);
  return &mesh;
}

Result<void> SceneObject::remove_mesh(int index) {
  const auto found = mesh(index);
  if (!found) return found.error();
  **found = SharedMesh{.is_removed = true};
  changed();
  return {};
}

Error SceneObject::empty_scene_error() const {
  for (std::size_t k = 0; k < meshes_.size(); ++k)
    if (!meshes_[k].is_removed && !meshes_[k].is_whole())
      return usage_error("the scene is empty: its mesh {} lacks its {}", k,
                         meshes_[k].mesh.positions.empty() ? "positions" : "indices");
  const bool has_meshes = std::any_of(meshes_.begin(), meshes_.end(), [](const SharedMesh& m) { return m.is_whole(); });
  return has_meshes ? usage_error("the scene has nothing to draw: all of it is degenerate or not finite")
                    : usage_error("the scene is empty: call umbLoadModel or umbAddMesh");
}

Result<Scene> SceneObject::copied(std::vector<std::string>& warnings) const {
  Scene all;
  bool is_empty = !has_models_;
  if (has_models_) all = models_;
  for (const SharedMesh& shared : meshes_) {
    if (!shared.is_whole()) continue;
    Scene part = scene_of(shared);
    if (const std::size_t dropped = finish_scene(part, shared.settings.crease_angle_deg, shared.settings.points))
      warnings.push_back(fmt::format("{} {} of the mesh '{}' are left out: they are {}not finite", dropped,
                                     shared.mesh.points ? "points" : "triangles", shared.mesh.name,
                                     shared.mesh.points ? "" : "degenerate or "));
    if (part.meshes.empty()) continue;
    if (is_empty)
      all = std::move(part);
    else
      append_scene(std::move(part), all);
    is_empty = false;
  }
  if (is_empty) return empty_scene_error();
  return all;
}

Result<std::pair<glm::dvec3, glm::dvec3>> SceneObject::bounds() const {
  constexpr double kMax = std::numeric_limits<double>::max();
  glm::dvec3 low(kMax), high(-kMax);
  if (has_models_)
    low = glm::dvec3(models_.bounds_min) + models_.origin, high = glm::dvec3(models_.bounds_max) + models_.origin;
  for (const SharedMesh& shared : meshes_) {
    if (!shared.is_whole()) continue;
    const SceneBox box = box_of(shared);
    if (box.is_empty()) continue;
    low = glm::min(low, glm::dvec3(box.low)), high = glm::max(high, glm::dvec3(box.high));
  }
  if (low.x > high.x) return empty_scene_error();
  return std::pair(low, high);
}

}  // namespace umbrage

using namespace umbrage;  // the functions below are C's

UmbScene umbNewScene(UmbDevice device) {
  return make_object<UmbScene>("umbNewScene", [&]() -> Result<std::shared_ptr<Object>> {
    auto of = object_of<DeviceObject>(device);
    if (!of) return usage_error("umbNewScene: the device is NULL, or was released");
    return std::shared_ptr<Object>(std::make_shared<SceneObject>(std::move(of)));
  });
}

void umbRetainScene(UmbScene scene) { retain_object<SceneObject>(scene); }
void umbReleaseScene(UmbScene scene) { release_object<SceneObject>(scene); }

UmbError umbGetSceneError(UmbScene scene, const char** message) { return take_error<SceneObject>(scene, message); }

UmbError umbSetSceneProgressCallback(UmbScene scene, UmbProgressCallback callback, void* user) {
  return set_progress<SceneObject>(scene, "umbSetSceneProgressCallback", callback, user);
}

UmbError umbSetSceneParameter(UmbScene scene, const char* name, const char* value) {
  return call_on<SceneObject>(scene, "umbSetSceneParameter", Use::kChanges,
                              [&](SceneObject& object) { return object.set_parameter(text_of(name), value); });
}

UmbError umbLoadModel(UmbScene scene, const char* model) {
  return call_on<SceneObject>(scene, "umbLoadModel", Use::kChanges,
                              [&](SceneObject& object) { return object.load(text_of(model)); });
}

int umbAddMesh(UmbScene scene, const char* name, size_t vertices, size_t triangles) {
  int index = -1;
  call_on<SceneObject>(scene, "umbAddMesh", Use::kChanges, [&](SceneObject& object) -> Result<void> {
    const auto added = object.add_mesh(text_of(name), vertices, triangles);
    if (!added) return added.error();
    index = *added;
    return {};
  });
  return index;
}

UmbError umbGetSceneBounds(UmbScene scene, double lower[3], double upper[3]) {
  return call_on<SceneObject>(scene, "umbGetSceneBounds", Use::kReads, [&](SceneObject& object) -> Result<void> {
    if (!lower || !upper) return usage_error("umbGetSceneBounds: lower and upper cannot be NULL");
    const auto box = object.bounds();
    if (!box) return box.error();
    for (int k = 0; k < 3; ++k) {
      lower[k] = box->first[k];
      upper[k] = box->second[k];
    }
    return {};
  });
}

int umbGetSceneCameraCount(UmbScene scene) {
  return read_of<SceneObject>(scene, 0, [](const SceneObject& object) { return object.camera_count(); });
}
