#include "renderer/completed_scene.h"

#include <fmt/format.h>

#include "renderer/models.h"

namespace umbrage {
namespace {

/// Returns a key that identifies the clay that replaces the scene's materials, and the environment image that lights
/// it.
std::string environment_key(const Recipe& recipe) {
  const Hdri& hdri = recipe.hdri;
  std::string key;
  if (recipe.clay) key += fmt::format(" clay {} {} {}", recipe.clay->r, recipe.clay->g, recipe.clay->b);
  if (hdri.lights()) key += fmt::format(" {} {} {}", hdri.file, hdri.rotation_deg, hdri.intensity);
  return key;
}

/// Sets the view of a completed scene to that of the recipe.
Result<void> choose_view(const Recipe& recipe, CompletedScene& completed) {
  completed.scene->views = completed.views;
  return recipe.camera_index ? use_camera(*recipe.camera_index, *completed.scene) : Result<void>();
}

}  // namespace

Result<bool> CompletedScene::serves(const Recipe& recipe, long scene_version) {
  if (!scene || version != scene_version || key != environment_key(recipe)) return false;
  if (auto viewed = choose_view(recipe, *this); !viewed) return viewed.error();
  return needs_ground(*scene, recipe) == (scene->ground_object >= 0);
}

Result<CompletedScene> completed(Scene copy, const Recipe& recipe, long version) {
  CompletedScene made{.scene = std::make_unique<Scene>(std::move(copy)),
                      .version = version,
                      .key = environment_key(recipe),
                      .views = {}};
  made.views = made.scene->views;
  if (auto viewed = choose_view(recipe, made); !viewed) return viewed.error();
  complete_scene(*made.scene, recipe);
  return made;
}

std::string light_key(const Recipe& recipe) {
  const auto& angles = recipe.framing.light_deg;
  return fmt::format("{} {} {} {} {} {}", environment_key(recipe), recipe.look->name, recipe.occlusion,
                     recipe.light_size_deg.value_or(-1.0f), fmt::join(recipe.light_factors, " "),
                     angles ? fmt::format("{} {}", angles->x, angles->y) : "");
}

Result<std::vector<std::string>> read_changed_hdri(Hdri& hdri, const Hdri& last, const ProgressMonitor& monitor) {
  if (hdri.file == last.file) hdri.panorama = last.panorama;
  return hdri.panorama ? Result<std::vector<std::string>>(std::vector<std::string>()) : read_hdri(hdri, monitor);
}

void KeptCapture::clear() {
  plan.reset();
  frame = {};
}

Result<Drawn> draw_keeping(Device& device, const Scene& scene, const Plan& plan, KeptCapture& kept, StageTimes& times,
                           const std::function<Result<void>()>& prepare, const ProgressMonitor& capturing,
                           const ProgressMonitor& monitor, const Continuation& more) {
  if (plan.averages()) {
    kept.clear();
    if (auto ready = prepare(); !ready) return ready.error();
    kept.made += plan.recipe.frames;
    return draw(device, scene, plan, times, monitor, {}, more);
  }
  if (!kept.plan || !same_capture(*kept.plan, plan)) {
    kept.clear();
    if (auto ready = prepare(); !ready) return ready.error();
    auto captured = capture(device, plan, times, capturing);
    if (!captured) return captured.error();
    kept.frame = std::move(*captured);
    kept.plan = plan;
    ++kept.made;
  }
  return draw_captured(device, scene, plan, kept.frame, times, monitor);
}

}  // namespace umbrage
