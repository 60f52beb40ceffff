// Loads models by name: files and built-in scenes.
#pragma once
#include <string>
#include <vector>

#include "core/result.h"
#include "scene/readers/import.h"
#include "scene/scene.h"

namespace umbrage {

/// Loads a file, or a built-in scene for `scene:NAME?detail=N`. Errors: those of import_scene; kInterrupted. For a
/// built-in scene the monitor is called only once, before it is made.
Result<Scene> load_scene(const std::string& model, const ImportSettings& settings = {},
                         const ProgressMonitor& monitor = {});

/// Appends a finished scene to another, which keeps its lights and the start of its name.
void append_scene(Scene next, Scene& all);

/// Loads several models into one scene, placed as in their files.
Result<Scene> load_scenes(const std::vector<std::string>& models, const ImportSettings& settings = {},
                          const ProgressMonitor& monitor = {});

/// Makes camera `index` the scene's view: one of the file's, or of those that a built-in scene suggests. Errors: kUsage
/// if there is no such camera.
Result<void> use_camera(int index, Scene& scene);

}  // namespace umbrage
