#include "renderer/models.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "generators/builtin.h"
#include "scene/scene.h"

namespace umbrage {

namespace {

/// Gives two scenes one origin: that of the two in whose frame the coordinates of the worse scene, relative to its
/// size, are smaller, since they are rounded to floats.
void share_origin(Scene& a, Scene& b) {
  if (a.origin == b.origin) return;
  const auto worse = [&](const glm::dvec3& origin) {
    double max = 0.0;
    for (const Scene* scene : {&a, &b})
      max = std::max(max, glm::distance(scene->origin + glm::dvec3(scene->center()), origin) /
                              std::max(double(scene->radius()), 1e-30));
    return max;
  };
  const glm::dvec3 origin = worse(b.origin) < worse(a.origin) ? b.origin : a.origin;
  set_origin(origin, a);
  set_origin(origin, b);
}

}  // namespace

Result<Scene> load_scene(const std::string& model, const ImportSettings& settings, const ProgressMonitor& monitor) {
  if (model.empty()) return usage_error("the name of a model is empty");
  if (!model.starts_with("scene:")) return import_scene(model, settings, monitor);
  if (auto status = check_scene_index(settings, model, 1); !status) return status.error();
  if (auto status = check_animation_index(settings, model, 0); !status) return status.error();
  if (monitor && !monitor(0.0)) return interrupted();
  auto scene = make_builtin_scene(model);
  if (scene && settings.up != glm::vec3(0.0f)) scene->up = settings.up;
  return scene;
}

void append_scene(Scene next, Scene& all) {
  const int materials = int(all.materials.size()), textures = int(all.textures.size());
  share_origin(all, next);
  int objects = 0;
  for (const Mesh& mesh : all.meshes) objects = std::max(objects, mesh.object + 1);
  for (Material& material : next.materials) {
    for (int* texture : textures_of(material))
      if (*texture != kNoTexture) *texture += textures;
    all.materials.push_back(std::move(material));
  }
  for (Texture& texture : next.textures) all.textures.push_back(std::move(texture));
  for (Mesh& mesh : next.meshes) {
    mesh.material += materials;
    mesh.object += objects;
    all.meshes.push_back(std::move(mesh));
  }
  for (std::string& warning : next.warnings) all.warnings.push_back(std::move(warning));
  all.bounds_min = glm::min(all.bounds_min, next.bounds_min);
  all.bounds_max = glm::max(all.bounds_max, next.bounds_max);
  all.shape_facts = std::make_shared<ShapeFacts>();
  all.views.clear();
  all.scene_names.clear();
  all.animation_names.clear();
  all.animation_durations_s.clear();
  all.cameras.insert(all.cameras.end(), next.cameras.begin(), next.cameras.end());
  all.name += " + " + next.name;
}

Result<Scene> load_scenes(const std::vector<std::string>& models, const ImportSettings& settings,
                          const ProgressMonitor& monitor) {
  std::size_t loaded = 0;
  ProgressMonitor model_monitor;
  if (monitor) model_monitor = [&](double done) { return monitor((double(loaded) + done) / double(models.size())); };
  auto all = load_scene(models.at(0), settings, model_monitor);
  for (std::size_t m = 1; all && m < models.size(); ++m) {
    loaded = m;
    auto next = load_scene(models[m], settings, model_monitor);
    if (!next) return next;
    append_scene(std::move(*next), *all);
  }
  return all;
}

Result<void> use_camera(int index, Scene& scene) {
  const std::vector<View>& cameras = scene.cameras.empty() ? scene.views : scene.cameras;
  if (index < 0 || std::size_t(index) >= cameras.size())
    return field_error("camera.index", index, "`{}` cannot be '{}': '{}' has {}", scene.name,
                       cameras.empty()       ? "no cameras"
                       : cameras.size() == 1 ? "one camera, 0"
                                             : fmt::format("cameras 0 to {}", cameras.size() - 1));
  View view = cameras[std::size_t(index)];
  // A file's camera orbits the point on its axis that is closest to the centre of the scene, if the point is in front
  // of it.
  const glm::vec3 axis = glm::normalize(view.target - view.eye);
  const float distance = glm::dot(scene.center() - view.eye, axis);
  if (!scene.cameras.empty())
    view.target = view.eye + axis * (distance > 0.0f ? distance : std::max(scene.radius(), 1e-6f));
  scene.views = {view};
  return {};
}

}  // namespace umbrage
