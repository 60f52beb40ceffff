// What is kept from one picture of a scene to the next: its completed copy, its environment image, and captures.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "renderer/draw.h"
#include "scene/scene.h"

namespace umbrage {

/// A copy of a scene that complete_scene has completed for a recipe.
struct CompletedScene {
  std::unique_ptr<Scene> scene;  ///< null: none
  long version = -1;             ///< that of the scene that was copied
  std::string key;               ///< settings of the recipe on which the copy depends
  std::vector<View> views;       ///< the views that the scene suggests

  /// Returns whether the copy serves for pictures of this recipe, and if so, sets its view to that of the recipe.
  /// Errors: those of use_camera.
  Result<bool> serves(const Recipe& recipe, long scene_version);
};

/// Completes a copy of a scene. The environment image of the recipe has been read. Errors: those of use_camera.
Result<CompletedScene> completed(Scene copy, const Recipe& recipe, long version);

/// Returns a key of all settings on which the default lights of a scene without lights depend, except the camera.
std::string light_key(const Recipe& recipe);

/// Reads an environment image as read_hdri, or takes its pixels from `last` if that has the same file. Returns
/// warnings. Errors: those of read_hdri.
Result<std::vector<std::string>> read_changed_hdri(Hdri& hdri, const Hdri& last, const ProgressMonitor& monitor = {});

/// The capture of the last picture, which is reused while only settings of effects change; and the exposure of the
/// scene, which does not depend on the camera.
struct KeptCapture {
  std::optional<Plan> plan;
  Frame frame;
  long made = 0;                        ///< number of captures so far
  std::shared_ptr<const Plan> metered;  ///< Plan::metered whose exposure is `stops`; null: none
  std::optional<float> stops;

  void clear();
};

/// Returns whether two plans of a scene differ in the camera, and in lights that follow it, alone.
bool differ_in_camera_alone(const Plan& a, const Plan& b);

/// Draws a plan of a scene as `draw`, with the kept capture if it is valid. Keeps none of averaged pictures, since
/// captures of many samples would need too much memory. `prepare` prepares the device and is called before each
/// capture. `capturing`: monitor of the capture. Errors: those of `draw` and of `prepare`.
Result<Drawn> draw_keeping(Device& device, const Scene& scene, const Plan& plan, KeptCapture& kept, StageTimes& times,
                           const std::function<Result<void>()>& prepare, const ProgressMonitor& capturing,
                           const ProgressMonitor& monitor, const Continuation& more = {});

}  // namespace umbrage
