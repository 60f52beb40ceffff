// What comparing and tuning share: scenes, views, the truth, and how often a time is taken.
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

inline constexpr Interval kCameras{1, 100, NumberKind::kWhole}, kSamples{2, kMaxSamples, NumberKind::kEven},
    kRuns{1, 1000, NumberKind::kWhole};

/// Numbers lie in the intervals above.
struct MeasureSettings {
  std::vector<std::string> models;  ///< as for load_scene
  ImportSettings import;
  Request draw;
  int cameras = 2;    ///< at most so many per scene: its suggested views, or turns around a file's model
  int samples = 256;  ///< of the truth, per pixel; even
  int runs = 3;       ///< behind each time, after one that does not count; the reference runs once
  /// Reads a model; its camera, where `draw` names one, is chosen afterwards.
  std::function<Result<Scene>(const std::string&, const ImportSettings&)> load =
      [](const std::string& model, const ImportSettings& settings) { return load_scene(model, settings); };
  /// Told what is done now, and about the share of the whole that is done; false ends the work.
  std::function<bool(const std::string&, double)> progress = [](const std::string&, double) { return true; };
};

/// Reads a model, with the camera that `draw` names. `done` is the share of the whole that is done before. Errors: as
/// `load`, and kInterrupted.
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
