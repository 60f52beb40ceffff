// Loads models by name: files and built-in scenes.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/result.h"
#include "scene/framing.h"
#include "scene/readers/import.h"
#include "scene/scene.h"
#include "scene/value_colors.h"

namespace umbrage {

/// Loads a file, or a built-in scene for `scene:NAME?detail=N`. For a built-in scene the monitor is called only once,
/// before the scene is made. Errors: those of import_scene; kUsage for an unknown scene; kInterrupted.
Result<Scene> load_scene(const std::string& model, const ImportSettings& settings = {},
                         const ProgressMonitor& monitor = {});

/// Appends a finished scene to `all`, which keeps its lights and loses its views. The name of `next` is appended to the
/// name of `all`.
void append_scene(Scene next, Scene& all);

/// Loads several models into one scene, placed as in their files. Their origin is that
/// of one of them. Models that are far apart for their sizes, or differ much in size, up axis or unit, cause a warning.
Result<Scene> load_scenes(const std::vector<std::string>& models, const ImportSettings& settings = {},
                          const ProgressMonitor& monitor = {});

/// Returns what several models that are drawn alone have in common, as the poses of an animation have: the first model,
/// with Scene::motion around all of them, and a warning if they differ much. `turned`: the framing of a turntable,
/// whose motion is around all frames; null: no turntable. `values`: what they show as colours, with one range; null:
/// nothing. Errors: those of load_scene and value_colors.
Result<std::shared_ptr<const Scene>> load_same_view(const std::vector<std::string>& models,
                                                    const ImportSettings& settings, const Framing* turned = nullptr,
                                                    const ValueSettings* values = nullptr);
/// Gives one of these models the directions, views, bounds and range of values of all, and the exposure of the first.
void set_same_view(const std::shared_ptr<const Scene>& first, Scene& scene);

/// Makes a camera the scene's only view. `index`: counts the cameras of the file, or for a scene without cameras the
/// views that it suggests. Errors: kUsage if there is no such camera.
Result<void> use_camera(int index, Scene& scene);

}  // namespace umbrage
