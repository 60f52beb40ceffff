// The registry of looks, and what runs them.
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

/// All looks, in the order of their names.
std::span<const Look* const> looks();

/// The look of that name, or null.
const Look* find_look(std::string_view name);

/// No occlusion at all: `ao` is 1 everywhere.
inline constexpr std::string_view kNoOcclusion = "none";

/// Names that `occlusion` takes: every occlusion technique, also those handed in, and `none`.
std::vector<std::string_view> occlusion_names(std::span<const Effect* const> handed_in = {});

/// Runs a technique that no device can run, since it needs more than a frame: it adds its planes to the frame.
using RunHandedIn = std::function<Result<void>(const Effect&, const ParameterBytes&, Frame&)>;

/// The stops that suit a picture; nothing: of a band, whose picture has not been seen whole.
using Meter = std::function<Result<std::optional<float>>(Device&, const Frame&)>;

struct LookRun {
  const Look* look = nullptr;
  std::string_view occlusion;  ///< the technique, or kNoOcclusion
  /// The technique, and filters that follow it, run on every so manieth pixel across and down: 1, 2 or 4. Techniques
  /// that are handed in run on all.
  int occlusion_every = 1;
  const EffectSettings* settings = nullptr;
  /// The planes that are wanted: effects that none of them comes from are left out. Nothing: all are run.
  std::optional<std::vector<std::string>> wanted = {};
  /// Called with the name of each effect once it is done.
  std::function<void(std::string_view)> after = [](std::string_view) {};
  ProgressMonitor monitor = {};     ///< of each effect
  std::optional<float> stops = {};  ///< exposure to add in place of metering, where the look is exposed by something
  Meter meter = metered_stops;      ///< where it is exposed by what is seen
  std::span<const Effect* const> handed_in = {};
  RunHandedIn run_handed_in = {};  ///< of the techniques in `handed_in`
};

/// The effects that such a run takes, in their order, the technique in its place.
std::vector<const Effect*> steps_of(const LookRun& run);

/// The planes that such a run asks a frame for, of so many layers: what of these nobody made is there afterwards with
/// one value everywhere, if there is one. Without those that are reduced first.
std::set<std::string> planes_read(const LookRun& run, int layers);

struct LookDone : Progression {
  float stops = 0.0f;  ///< that metering added to the exposure; 0 without
};

/// Runs a look's effects on a frame; afterwards the frame has color.r, color.g, color.b and color.a. An effect whose
/// planes a later one reads on further layers, `layer1.direct.r`, runs on all that the frame has, else on the first. On
/// a band it may not be finished: see Device::run.
Result<LookDone> run_look(const LookRun& run, Device& device, Frame& frame);

}  // namespace umbrage
