// Draws a plan on a device. Drawing can be progressive: after the samples of a plan, whole further samples are added to
// the average while someone wants them. Each continues the sequences of sample positions and of noise, so that no
// sample repeats another and the average converges.
#pragma once
#include <functional>
#include <optional>
#include <span>

#include "core/device.h"
#include "renderer/plan.h"
#include "renderer/times.h"

namespace umbrage {

/// Max number of samples that are added to all pixels: with more, a picture would not change visibly.
inline constexpr int kMaxProgressiveSamples = 4096;

/// What asks for further samples. `samples`: number of samples in the average that were drawn at all pixels: 1 after
/// marked samples, whose others add only to edges.
struct Continuation {
  /// Called after the samples of the plan and after each further one. Returns whether to draw another. Empty: no
  /// further samples.
  std::function<bool(int samples)> wants_another = {};
  /// Called when no other sample is wanted. Returns whether to draw this fraction of one, some rows that the average
  /// has once more than the rows below; it is asked again after them, until they are a whole sample. Empty: no part of
  /// one. Not called for devices that draw no strips, and looks that read any row.
  std::function<bool(double fraction)> wants_part = {};
  /// Returns whether take_mean is called for this number of samples, since finishing a picture takes time. Empty: it
  /// always is.
  std::function<bool(int samples)> wants_mean = {};
  /// If set, receives the finished picture of all samples so far, before each call of wants_another. The frame is valid
  /// during the call. An error ends the drawing and is returned.
  std::function<Result<void>(const Frame& mean, int samples)> take_mean = {};
};

/// A drawn picture.
struct Drawn {
  Frame frame;
  std::optional<float> stops;  ///< exposure that metering added, in stops; for other pictures with the same exposure
};

/// Draws the scene for which the device is prepared: captures it and runs the look. `stops`: exposure of another
/// picture, used in place of metering. `more` asks for samples beyond those of the plan, which must then average
/// several; the progress stays at 1 meanwhile. Errors: kInterrupted; the errors of the device and of more.take_mean.
Result<Drawn> draw(Device& device, const Scene& scene, const Plan& plan, StageTimes& times,
                   const ProgressMonitor& monitor = {}, std::optional<float> stops = {}, const Continuation& more = {});

/// Captures the picture of a plan that does not average, before any effect has run. The device has finished all work
/// when this returns, so all errors of the device are reported here; the times of its dispatches are dropped. Errors:
/// kInterrupted; the errors of the device.
Result<Frame> capture(Device& device, const Plan& plan, StageTimes& times, const ProgressMonitor& monitor = {});
/// Returns whether the capture of one plan is valid for the other plan: the plans differ only in effects.
bool same_capture(const Plan& a, const Plan& b);
/// Draws from a capture, which stays unchanged. The picture is bitwise identical to the picture that `draw` returns.
Result<Drawn> draw_captured(Device& device, const Scene& scene, const Plan& plan, const Frame& captured,
                            StageTimes& times, const ProgressMonitor& monitor = {}, std::optional<float> stops = {});

/// Returns the technique of a recipe if it filters its own samples, separately from taking them; otherwise null.
const Effect* filtered_technique(const Recipe& recipe);
/// Returns `params` set to filter the samples that a frame has from this number of frames.
ParameterBytes params_of_filter(const Effect& technique, int frames, ParameterBytes params);
/// Returns a run of the occlusion technique, its filters and what they need; but of a filtered_technique only its
/// samples, for which it changes the recipe's settings. `given`: planes of the frame, which are kept. The run refers to
/// the recipe.
LookRun run_of_technique(Recipe& recipe, std::span<const std::string> given);
/// Captures the first picture of a plan and runs the occlusion technique, its filters and what they need; but of a
/// filtered_technique only its samples. Errors: kInterrupted; the errors of the device.
Result<Frame> draw_technique(Device& device, const Scene& scene, const Plan& plan, StageTimes& times,
                             const ProgressMonitor& monitor = {});
/// Draws a plan from a frame of draw_technique, or a branch of it, which stays unchanged. Else as `draw`.
Result<Drawn> draw_after_technique(Device& device, const Scene& scene, const Plan& plan, const Frame& frame,
                                   StageTimes& times, const ProgressMonitor& monitor, std::optional<float> stops,
                                   const Continuation& more);

/// Plans and draws a scene that `complete_scene` has completed.
Result<Frame> draw(Device& device, const Scene& scene, const Recipe& recipe, StageTimes& times);

/// Makes a recipe, plans and draws; environment images are not read. Errors: kUsage; the errors of `draw`.
Result<Frame> draw(Device& device, const Scene& scene, const Request& request, StageTimes& times);

}  // namespace umbrage
