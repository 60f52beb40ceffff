// The frames of `umbrage render`: one picture, a turntable, a camera path or an animation, as files or as a video.
#pragma once
#include <optional>
#include <string_view>
#include <vector>

#include "apps/cli/frame_names.h"
#include "apps/cli/line_file.h"
#include "apps/cli/render_options.h"
#include "core/device.h"
#include "renderer/plan.h"
#include "renderer/recipe.h"
#include "renderer/times.h"
#include "scene/camera_path.h"

namespace umbrage::cli {

/// What moves from frame to frame.
enum class Motion { kNone, kTurntable, kPath, kAnimation };

/// The files to write and the frames, found before the model is drawn.
struct Output {
  Motion motion = Motion::kNone;   ///< kNone: one picture
  int count = 1;                   ///< number of frames of the motion
  std::optional<CameraPath> path;  ///< of --camera-path
  float duration_s = 0.0f;         ///< of the animation of --animate
  bool is_video = false;
  std::vector<int> frames = {0};  ///< those to draw, of all shards
  FrameNames names = {};          ///< file names of frames that are no video
  Sequence sequence = {};         ///< of these files

  bool is_moving() const { return motion != Motion::kNone; }
  /// Returns the option of the motion.
  std::string_view option() const {
    return motion == Motion::kTurntable ? "--turntable" : motion == Motion::kPath ? "--camera-path" : "--animate";
  }
  bool is_sequence() const { return is_moving() && !is_video; }
};

/// A command line whose options are checked and resolved, before the model is read.
struct RenderJob {
  Output output;
  LineFile lines;
  Recipe requested;  ///< recipe of all options, for warnings about unused settings
  Recipe recipe;     ///< recipe reduced to the planes that the output needs
  ImportSettings model_import;
  double memory = 0.0;
  int steady = 0;  ///< --steady, or less if that needs more memory
};

/// Adds the options that move the camera or the model, and those of the frames.
void add_frame_options(CLI::App& command, RenderOptions& options);

/// Returns the output of a command line. Reads the camera path, and for --animate the model. Errors: kUsage; kFile.
Result<Output> output_of(const RenderOptions& o, const ImportSettings& settings);

/// Draws and writes all frames. `scene` is prepared on the device; of an animation it is the first frame.
Result<void> draw_frames(const RenderOptions& o, const RenderJob& job, Device& device, const Scene& scene,
                         const Plan& plan, StageTimes& times);

}  // namespace umbrage::cli
