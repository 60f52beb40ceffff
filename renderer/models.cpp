#include "renderer/models.h"

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat3x3.hpp>
#include <tuple>
#include <utility>

#include "generators/builtin.h"
#include "scene/fields.h"
#include "scene/front.h"
#include "scene/readers/content.h"

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

/// Appends why two models hardly belong to one scene, if they do not.
void add_reason(const Scene& a, const Scene& b, std::string& reasons) {
  constexpr std::tuple<double, const char*, const char*> kUnits[] = {
      {10.0, "mm", "cm"}, {25.4, "mm", "inches"}, {39.37, "inches", "m"}, {100.0, "cm", "m"}, {1000.0, "mm", "m"}};
  constexpr double kSameRatio = 2e-3;  // relative difference
  constexpr double kMaxRatio = 100.0;  // of sizes; the smaller one is a few pixels of the picture
  constexpr double kMaxGap = 10.0;     // in units of their size; each is less than a tenth of the picture
  const double radius_a = a.radius(), radius_b = b.radius();
  const glm::dvec3 shift = b.origin - a.origin;
  const glm::dvec3 low_b = glm::dvec3(b.bounds_min) + shift, high_b = glm::dvec3(b.bounds_max) + shift;
  const glm::dvec3 gap =
      glm::max(glm::max(low_b - glm::dvec3(a.bounds_max), glm::dvec3(a.bounds_min) - high_b), glm::dvec3(0.0));
  const Scene &larger = radius_a > radius_b ? a : b, &smaller = radius_a > radius_b ? b : a;
  const double ratio = double(larger.radius()) / std::max(double(smaller.radius()), 1e-30);
  const double distance = glm::length(gap) / (radius_a + radius_b);
  const auto add = [&](const std::string& reason) { reasons += (reasons.empty() ? "" : "; ") + reason; };
  if (constexpr float kSame = 0.999f; glm::dot(a.up, b.up) < kSame)
    add(fmt::format("'{}' has {} up, '{}' {}, and neither is turned (`up` gives the axis of both)", b.name,
                    axis_text(b.up), a.name, axis_text(a.up)));
  std::string units = ratio > kMaxRatio ? "; their units may differ, such as mm and m" : "";
  for (const auto& [factor, of_larger, of_smaller] : kUnits)
    if (std::abs(ratio / factor - 1.0) < kSameRatio)
      units = fmt::format(": it is probably in {}, the other in {}", of_larger, of_smaller);
  const std::string of_larger = units_of(import_format(larger.name)),
                    of_smaller = units_of(import_format(smaller.name));
  if (of_larger != of_smaller && !of_larger.empty() && !of_smaller.empty())
    units = fmt::format(": it is in {}, the other in {}, and neither is scaled", of_larger, of_smaller);
  if (units.empty() && !(distance > kMaxGap)) return;
  add(units.empty()
          ? fmt::format("'{}' is {:.3g} times farther from '{}' than they are large", b.name, distance, a.name)
          : fmt::format("'{}' is {:.4g} times as large as '{}'{}", larger.name, ratio, smaller.name, units));
}

/// Returns a scene of the positions and fields of another one.
Scene with_fields_alone(const Scene& scene) {
  Scene out;
  out.name = scene.name;
  for (const Mesh& mesh : scene.meshes) {
    out.meshes.emplace_back().positions = mesh.positions;
    out.meshes.back().fields = mesh.fields;
  }
  return out;
}

/// Returns whether a mesh of the scene has the field.
bool has_values(const Scene& scene, const std::string& field) {
  return std::any_of(scene.meshes.begin(), scene.meshes.end(),
                     [&](const Mesh& mesh) { return find_values(mesh, field) != nullptr; });
}

/// Prepares scenes to be appended of which one moves: the other is part of its motion and of its start.
void join_motions(Scene& next, Scene& all) {
  if (next.start || all.start) {
    auto start = std::make_shared<Scene>(all.start ? *all.start : all);
    append_scene(next.start ? *next.start : next, *start);
    all.start = std::move(start);
  }
  if (next.motion.empty() == all.motion.empty()) return;
  for (Scene* scene : {&next, &all})
    if (scene->motion.empty()) scene->motion = points_around(*scene);
}

}  // namespace

Result<Scene> load_scene(const std::string& model, const ImportSettings& settings, const ProgressMonitor& monitor) {
  if (model.empty()) return usage_error("the name of a model is empty");
  if (!model.starts_with("scene:")) {
    auto scene = import_scene(model, settings, monitor);
    const std::string field = settings.field.value_or("");
    if (!scene || field.empty() || has_values(*scene, field)) return scene;
    // With all of its fields, so that an error can name them.
    ImportSettings all = settings;
    all.field = "";
    return import_scene(model, all, monitor);
  }
  if (auto status = check_scene_index(settings, model, 1); !status) return status.error();
  if (auto status = check_animation_index(settings, model, 0); !status) return status.error();
  if (monitor && !monitor(0.0)) return interrupted();
  auto scene = make_builtin_scene(model);
  if (scene && settings.up != glm::vec3(0.0f)) scene->up = settings.up;
  return scene;
}

void append_scene(Scene next, Scene& all) {
  share_origin(all, next);
  join_motions(next, all);
  const int materials = int(all.materials.size()), textures = int(all.textures.size());
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
  all.motion.insert(all.motion.end(), next.motion.begin(), next.motion.end());
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
  std::string reasons;
  ProgressMonitor model_monitor;
  if (monitor) model_monitor = [&](double done) { return monitor((double(loaded) + done) / double(models.size())); };
  auto all = load_scene(models.at(0), settings, model_monitor);
  for (std::size_t m = 1; all && m < models.size(); ++m) {
    loaded = m;
    auto next = load_scene(models[m], settings, model_monitor);
    if (!next) return next;
    add_reason(*all, *next, reasons);
    append_scene(std::move(*next), *all);
  }
  if (all && !reasons.empty())
    all->warnings.push_back(reasons +
                            "; all are drawn in one scene: umbrage thumbnails draws each alone, umbrage render "
                            "--same-view alone in one view");
  return all;
}

Result<std::shared_ptr<const Scene>> load_same_view(const std::vector<std::string>& models,
                                                    const ImportSettings& settings, const Framing* turned,
                                                    const ValueSettings* values) {
  std::shared_ptr<Scene> first;
  std::vector<glm::vec3> around;
  std::string reasons;
  std::vector<Scene> with_values;
  for (const std::string& model : models) {
    auto scene = load_scene(model, settings);
    if (!scene) return scene.error();
    if (first) set_origin(first->origin, *scene);
    if (first) add_reason(*first, *scene, reasons);
    const auto points = points_around(*scene);
    around.insert(around.end(), points.begin(), points.end());
    if (values) with_values.push_back(with_fields_alone(*scene));
    if (!first) first = std::make_shared<Scene>(scene->start ? *scene->start : std::move(*scene));
  }
  set_motion(std::exchange(around, {}), *first);
  first->warnings.clear();
  if (values) {
    std::vector<const Scene*> scenes;
    for (const Scene& each : with_values) scenes.push_back(&each);
    auto colors = value_colors(*values, scenes, first->warnings);
    if (!colors) return colors.error();
    first->value_colors = std::make_shared<const ValueColors>(std::move(*colors));
  }
  if (!reasons.empty())
    first->warnings.push_back(reasons + "; all are drawn in one view: umbrage thumbnails draws each in its own");
  if (turned) {
    constexpr int kTurns = 16;  // between two of them a model is up to 2 % wider
    const glm::vec3 center = turn_center(*first, *turned);
    for (int k = 0; k < kTurns; ++k) {
      const glm::mat3 turn(glm::rotate(glm::mat4(1.0f), glm::two_pi<float>() * float(k) / float(kTurns), first->up));
      for (const glm::vec3& p : first->motion) around.push_back(center + turn * (p - center));
    }
    set_motion(std::move(around), *first);
  }
  return std::shared_ptr<const Scene>(std::move(first));
}

void set_same_view(const std::shared_ptr<const Scene>& first, Scene& scene) {
  set_origin(first->origin, scene);
  set_motion(first->motion, scene);
  scene.up = first->up;
  scene.has_front = first->has_front;
  scene.views = first->views;
  scene.cameras = first->cameras;
  scene.value_colors = first->value_colors;
  scene.start = first;
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
