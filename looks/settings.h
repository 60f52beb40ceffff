// Settings: the parameters of every effect of a picture, and the text that sets one, "effect.parameter=value".
#pragma once
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/look.h"
#include "core/registry.h"
#include "effects/effects.h"

namespace umbrage {

/// Parameters by the effect's name.
using EffectSettings = std::map<std::string, ParameterBytes, std::less<>>;

/// Those of an effect, which must be among them.
inline ParameterBytes& params_of(EffectSettings& settings, std::string_view effect) {
  return settings.find(effect)->second;
}
inline const ParameterBytes& params_of(const EffectSettings& settings, std::string_view effect) {
  return settings.find(effect)->second;
}

/// All effects, and those that are handed in.
std::vector<const Effect*> all_effects(std::span<const Effect* const> handed_in);

/// What "effect.parameter=value" names.
struct Setting {
  const Effect* effect = nullptr;
  const Parameter* parameter = nullptr;
  std::string_view value;  ///< of the text that was parsed
};

/// Errors: kUsage, with a suggestion for a misspelt name. The value is not looked at.
Result<Setting> parse_setting(std::string_view assignment, std::span<const Effect* const> handed_in = {});

/// Applies one. Errors: kUsage.
Result<void> apply_setting(EffectSettings& settings, std::string_view assignment,
                           std::span<const Effect* const> handed_in = {});

/// Every effect's own settings, also of those handed in.
EffectSettings initial_settings(std::span<const Effect* const> handed_in = {});

/// The same with the look's presets applied.
EffectSettings look_settings(const Look& look, std::span<const Effect* const> handed_in = {});

/// Applies presets of the look of that name, which must be right.
void apply_presets(std::string_view look, const LookPresets& presets, EffectSettings& settings,
                   std::span<const Effect* const> handed_in = {});

}  // namespace umbrage
