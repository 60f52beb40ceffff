// What stored depths mean: candidates by name and range, tried against normals or flat surfaces; and
// depth computed from positions, for files without a usable depth layer.
#pragma once
#include <optional>
#include <string>

#include "gbuffers/camera_guess.h"
#include "gbuffers/conventions.h"
#include "gbuffers/depth_trial.h"
#include "gbuffers/depth_values.h"

namespace umbrage {

/// What a guess may use.
struct DepthEvidence {
  const GBufferSettings& settings;
  const DepthValues& values;
  DepthHint hint = DepthHint::kNone;
  Cells cells;
  std::optional<Camera> camera;  ///< if its window is known
  double aspect = 1.0;           ///< width / height of the picture
};

struct DepthGuess {
  Trial trial;
  std::string meaning;          ///< for the facts: "planar"
  std::string reason;           ///< for the facts: "by its name"
  bool fitted_fov = false;      ///< the camera of the trial was fitted, else it is assumed
  bool is_relative = false;     ///< scale and offset are not known
  bool assumes_planes = false;  ///< a depth buffer of unknown planes
  bool may_be_buffer = false;   ///< a length that may as well be a depth buffer
  bool may_be_length = false;   ///< a depth buffer, by its planes, that may as well be a length
};

/// Returns what the depths mean. Errors: kUsage for options that contradict each other.
Result<DepthGuess> guess_depth(const DepthEvidence& evidence);

/// Returns whether the settings give a near or a far plane, which only a depth buffer has.
bool gives_planes(const GBufferSettings& settings);

/// Returns the camera that is assumed if nothing but the projection is known: 55 degrees or 2 scene units high.
Camera assumed_camera(bool is_orthographic, double aspect);

/// Sets how view depth follows from positions, and replaces the depths of the samples by it. Without a fit, positions
/// are in the world of the file's camera if that puts them before it, else relative to the camera.
void use_positions(const Samples& samples, const std::optional<ProjectionFit>& fit, const KnownCamera& known,
                   PositionConvention& position, DepthValues& values, DepthModel& model);

}  // namespace umbrage
