// The registry of looks, and what runs them.
#pragma once
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/device.h"
#include "core/look.h"
#include "looks/metering.h"

namespace umbrage {

/// All looks, in the order of their names.
std::span<const Look* const> looks();

/// The look of that name, or null.
const Look* find_look(std::string_view name);

/// No occlusion at all: `ao` is 1 everywhere.
inline constexpr std::string_view kNoOcclusion = "none";

/// Names that --ao takes: every occlusion technique, also those handed in, and `none`.
std::vector<std::string_view> occlusion_names(std::span<const Effect* const> handed_in = {});

/// Parameters by the effect's name.
using EffectSettings = std::map<std::string, ParameterBytes, std::less<>>;

/// Every effect's own settings, also of those handed in, with the look's presets applied.
EffectSettings look_settings(const Look& look, std::span<const Effect* const> handed_in = {});

/// Applies one "effect.parameter=value". Errors: kUsage, with a suggestion for a misspelt name.
Result<void> apply_setting(EffectSettings& settings, std::string_view assignment,
                           std::span<const Effect* const> handed_in = {});

/// Runs a technique that no device can run, since it needs more than a frame: it adds its planes to the frame.
using RunHandedIn = std::function<Result<void>(const Effect&, const ParameterBytes&, Frame&)>;

struct LookRun {
  const Look* look = nullptr;
  std::string_view occlusion;  ///< the technique, or kNoOcclusion
  /// The technique, and filters that follow it, run on every so manieth pixel across and down: 1, 2 or 4. Techniques
  /// that are handed in run on all.
  int occlusion_every = 1;
  const EffectSettings* settings = nullptr;
  /// Called with the name of each effect once it is done.
  std::function<void(std::string_view)> after = [](std::string_view) {};
  std::optional<float> stops = {};  ///< exposure to add in place of metering, where `output` is to meter
  /// What metering adds, where it is to be found out.
  std::function<Result<float>(Device&, const Frame&)> meter = metered_stops;
  std::span<const Effect* const> handed_in = {};
  RunHandedIn run_handed_in = {};  ///< of the techniques in `handed_in`
};

/// Runs a look's effects on a frame; afterwards the frame has color.r, color.g, color.b and color.a. An effect whose
/// planes a later one reads on further layers, `layer1.direct.r`, runs on all that the frame has, else on the first.
/// Returns the stops that metering added to the exposure, 0 without.
Result<float> run_look(const LookRun& run, Device& device, Frame& frame);

}  // namespace umbrage
