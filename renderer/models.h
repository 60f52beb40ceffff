// Models by name: files, and built-in scenes.
#pragma once
#include <string>
#include <vector>

#include "core/result.h"
#include "scene/readers/import.h"
#include "scene/scene.h"

namespace umbrage {

/// A file's scene, or a built-in one for `scene:NAME?detail=N`.
/// Errors: kInterrupted besides. A built-in scene asks before alone.
Result<Scene> load_scene(const std::string& model, const ImportSettings& settings = {},
                         const ProgressMonitor& monitor = {});

/// Puts a finished scene beside another one, whose lights and name's beginning stay.
void append_scene(Scene next, Scene& all);

/// Several models side by side in one scene, as they are placed in their files.
Result<Scene> load_scenes(const std::vector<std::string>& models, const ImportSettings& settings = {},
                          const ProgressMonitor& monitor = {});

/// Makes the camera of that number the scene's own view: one of the file's, or else of those that a built-in scene
/// suggests. Errors: kUsage for one that there is not.
Result<void> use_camera(int index, Scene& scene);

}  // namespace umbrage
