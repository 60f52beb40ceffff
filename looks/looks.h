// The registry of looks, and functions that run a look on a frame.
#pragma once
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/device.h"
#include "core/look.h"
#include "looks/metering.h"
#include "looks/settings.h"

namespace umbrage {

/// Returns all looks, sorted by name.
std::span<const Look* const> looks();

/// Returns the looks that can draw a scene: all but those that need a finished picture, sorted by name.
std::span<const Look* const> scene_looks();

/// Returns the look of that name, or null.
const Look* find_look(std::string_view name);

/// Name of "no occlusion": `ao` is 1 everywhere.
inline constexpr std::string_view kNoOcclusion = "none";

/// Returns the valid values of `occlusion`: the names of all occlusion techniques, including external ones, and `none`.
std::vector<std::string_view> occlusion_names(std::span<const Effect* const> external_effects = {});

/// Runs an external technique, which no device can run because it needs more than a frame. Adds its planes to the
/// frame.
using RunExternalEffect = std::function<Result<void>(const Effect&, const ParameterBytes&, Frame&)>;

/// Returns the stops to add to the exposure of a picture, kPicture or kMedian, or nullopt for a strip whose picture is
/// not complete yet.
using Meter = std::function<Result<std::optional<float>>(Device&, const Frame&, Exposure)>;

/// What to run and with which settings.
struct LookRun {
  const Look* look = nullptr;
  std::string_view occlusion;  ///< name of the technique, or kNoOcclusion
  /// Downsampling factor of the technique and of the filters that follow it: 1, 2 or 4. External techniques and those
  /// that filter themselves always run at full resolution.
  int occlusion_downsampling = 1;
  const EffectSettings* settings = nullptr;
  /// Requested planes; effects that contribute to none of them are skipped. nullopt: all effects run.
  std::optional<std::vector<std::string>> wanted = {};
  /// The planes that are read after the run, on all layers: `wanted` and more. The device releases each other plane
  /// when no later step reads it. nullopt: all planes are kept.
  std::optional<std::vector<std::string>> kept = {};
  /// Called with the name of each effect when the effect is done.
  std::function<void(std::string_view)> after = [](std::string_view) {};
  /// kMarked: draws a further sample, on a frame of capture_marked. The technique and its filters are left out, so the
  /// frame must have the planes that they write. Requires runs_on_marked and `stops`.
  PixelSet pixels = PixelSet::kAll;
  ProgressMonitor monitor = {};                          ///< passed to every effect
  std::optional<float> stops = {};                       ///< to add in place of metering; unused if Exposure::kAsSet
  Meter meter = metered_stops;                           ///< used with Exposure::kPicture and kMedian
  std::span<const Effect* const> external_effects = {};  ///< external techniques
  RunExternalEffect run_external_effect = {};            ///< required if an external technique is used
};

/// Returns the effects of a run in order, with the occlusion technique in its place. Filters behind a technique that
/// filters itself are left out.
std::vector<const Effect*> steps_of(const LookRun& run);

/// Returns the effects of a run except for the technique and the filters that follow it.
std::vector<const Effect*> steps_besides_technique(const LookRun& run);

/// Returns whether a run can draw further samples at marked pixels: apart from the technique and its filters all
/// effects compute each pixel by itself, and neither they nor `planes` need any planes of the technique and its
/// filters but `ao` and `indirect`.
bool runs_on_marked(const LookRun& run, std::span<const std::string> planes);

/// Returns the planes that a run reads from a frame of `layers` layers. Those that nothing has written exist after the
/// run with their neutral value everywhere, if they have one. Planes that the run downsamples first are not included.
std::set<std::string> planes_read(const LookRun& run, int layers);

/// The result of a run.
struct LookDone : RunState {
  float stops = 0.0f;  ///< stops added to the exposure by metering; 0: none
};

/// Runs a look's effects on a frame. Afterwards the frame has color.r, color.g, color.b and color.a. If a later effect
/// reads an effect's planes on further layers, such as `layer1.direct.r`, that effect runs on all layers of the frame,
/// otherwise on the first only. On a strip the run may be unfinished: see Device::run.
Result<LookDone> run_look(const LookRun& run, Device& device, Frame& frame);

}  // namespace umbrage
