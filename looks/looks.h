// The registry of looks, and what runs them.
#pragma once
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "core/device.h"
#include "core/look.h"

namespace umbrage {

/// All looks, in the order of their names.
std::span<const Look* const> looks();

/// The look of that name, or null.
const Look* find_look(std::string_view name);

/// No occlusion at all: `ao` is 1 everywhere.
inline constexpr std::string_view kNoOcclusion = "none";

/// Names that --ao takes: every occlusion technique, and `none`.
std::vector<std::string_view> occlusion_names();

/// Parameters by the effect's name.
using EffectSettings = std::map<std::string, ParameterBytes, std::less<>>;

/// Every effect's own settings with the look's presets applied.
EffectSettings look_settings(const Look& look);

/// Applies one "effect.parameter=value". Errors: kUsage, with a suggestion for a misspelt name.
Result<void> apply_setting(EffectSettings& settings, std::string_view assignment);

/// Runs a look's effects on a frame; afterwards the frame has color.r, color.g, color.b and color.a.
/// `occlusion` is the technique, or kNoOcclusion. `after` is called with the name of each effect once it is done.
Result<void> run_look(
    const Look& look, std::string_view occlusion, const EffectSettings& settings, Device& device, Frame& frame,
    const std::function<void(std::string_view)>& after = [](std::string_view) {});

}  // namespace umbrage
