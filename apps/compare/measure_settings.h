// Settings shared by compare and tune: models, cameras, ground truth and number of timed runs.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "core/numbers.h"
#include "core/progress.h"
#include "reference/trace.h"
#include "renderer/models.h"
#include "renderer/recipe.h"

namespace umbrage {

inline constexpr Interval kCameras{1, 100, NumberKind::kInteger}, kSamples{2, kMaxSamples, NumberKind::kEven},
    kRuns{1, 1000, NumberKind::kInteger};

/// Settings of a measurement. The numbers are in the intervals above.
struct MeasureSettings {
  std::vector<std::string> models;  ///< as for load_scene
  ImportSettings import;
  Request draw;
  int cameras = 2;    ///< max cameras per scene: its suggested views, or else views from around it
  int samples = 256;  ///< rays per pixel of the ground truth; even
  int runs = 3;       ///< timed runs, after one that is not timed; the reference runs once
  /// Reads a model. read_model then selects the camera that `draw` names.
  std::function<Result<Scene>(const std::string&, const ImportSettings&)> load =
      [](const std::string& model, const ImportSettings& settings) { return load_scene(model, settings); };
  /// Receives the activity and the approximate fraction of the whole work that is done, 0 to 1. Returning false ends
  /// the work with kInterrupted.
  std::function<bool(const std::string&, double)> progress = [](const std::string&, double) { return true; };
};

/// Reads a model and selects the camera that `draw` names. Appends the warnings. `done`: fraction of the whole work
/// that is done before this call, for progress. Errors: those of `load` and use_camera; kInterrupted.
inline Result<Scene> read_model(const MeasureSettings& settings, const std::string& model, double done,
                                std::vector<std::string>& warnings) {
  if (!settings.progress("reading " + model, done)) return interrupted();
  auto scene = settings.load(model, settings.import);
  if (!scene) return scene;
  if (settings.draw.camera.index)
    if (auto used = use_camera(*settings.draw.camera.index, *scene); !used) return used.error();
  warnings.insert(warnings.end(), scene->warnings.begin(), scene->warnings.end());
  return scene;
}

}  // namespace umbrage
