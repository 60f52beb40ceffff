#include "renderer/completed_scene.h"

#include <fmt/format.h>

#include <tuple>

#include "renderer/models.h"

namespace umbrage {
namespace {

/// Returns a key that identifies the clay that replaces the scene's materials, and the environment image that lights
/// it.
std::string environment_key(const Recipe& recipe) {
  const Hdri& hdri = recipe.hdri;
  std::string key;
  if (recipe.clay) key += fmt::format(" clay {} {} {}", recipe.clay->r, recipe.clay->g, recipe.clay->b);
  if (recipe.values) key += key_of(*recipe.values);
  if (recipe.explode > 0.0f) key += fmt::format(" explode {}", recipe.explode);
  // Which side of a plane stays can depend on the view.
  if (!recipe.sections.planes.empty())
    key += fmt::format("{} {}", key_of(recipe.sections), recipe.camera_index.value_or(-1));
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
  if (auto done = complete_scene(*made.scene, recipe); !done) return done.error();
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

namespace {

/// Returns whether the exposure that is metered for one plan is that of the other.
bool same_metering(const Plan& a, const Plan& b) {
  const auto key = [](const Recipe& r) {
    const Hdri& hdri = r.hdri;
    return std::tie(r.look, r.occlusion, r.occlusion_downsampling, r.settings, hdri.file, hdri.ambient, hdri.skybox,
                    hdri.rotation_deg, hdri.intensity);
  };
  return a.start == b.start && a.camera == b.camera && a.capture == b.capture && key(a.recipe) == key(b.recipe);
}

}  // namespace

bool differ_in_camera_alone(const Plan& a, const Plan& b) {
  if (bool(a.metered) != bool(b.metered) || a.recipe.passes != b.recipe.passes) return false;
  if (a.metered && !same_metering(*a.metered, *b.metered)) return false;
  Plan other = b;
  other.camera = a.camera;
  if (a.lit_from_camera) other.capture.lighting = a.capture.lighting;
  return same_metering(a, other);
}

void KeptCapture::clear() {
  const long count = made;
  *this = {};
  made = count;
}

Result<Drawn> draw_keeping(Device& device, const Scene& scene, const Plan& plan, KeptCapture& kept, StageTimes& times,
                           const std::function<Result<void>()>& prepare, const ProgressMonitor& capturing,
                           const ProgressMonitor& monitor, const Continuation& more) {
  const bool is_metered = kept.metered && plan.metered && same_metering(*kept.metered, *plan.metered);
  const std::optional<float> stops = is_metered ? kept.stops : std::nullopt;
  const bool is_captured = !plan.averages() && kept.plan && same_capture(*kept.plan, plan);
  if (!is_captured) {
    kept.plan.reset();
    kept.frame = {};
    if (auto ready = prepare(); !ready) return ready.error();
    if (!plan.averages()) {
      auto captured = capture(device, plan, times, capturing);
      if (!captured) return captured.error();
      kept.frame = std::move(*captured);
      kept.plan = plan;
    }
    kept.made += plan.recipe.frames;
  }
  auto drawn = plan.averages() ? draw(device, scene, plan, times, monitor, stops, more)
                               : draw_captured(device, scene, plan, kept.frame, times, monitor, stops);
  if (drawn && plan.metered) kept.metered = plan.metered, kept.stops = drawn->stops;
  return drawn;
}

}  // namespace umbrage
