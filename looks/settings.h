// Settings: the parameter values of all effects, and the text form that sets one, "effect.parameter=value".
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

/// Parameter values, by the name of the effect.
using EffectSettings = std::map<std::string, ParameterBytes, std::less<>>;

/// Return the parameters of an effect, which must be in `settings`: the one called `effect`, or the one whose params
/// struct is `Params`. They are const if `settings` are.
inline ParameterBytes& params_of(EffectSettings& settings, std::string_view effect) {
  return settings.find(effect)->second;
}
inline const ParameterBytes& params_of(const EffectSettings& settings, std::string_view effect) {
  return settings.find(effect)->second;
}
template <class Params>
auto& params_of(auto& settings) {
  return as<Params>(params_of(settings, effect_with<Params>().name));
}

/// Returns all effects: the registered ones, then `external_effects`.
std::vector<const Effect*> all_effects(std::span<const Effect* const> external_effects);

/// A parsed "effect.parameter=value".
struct Setting {
  const Effect* effect = nullptr;
  const Parameter* parameter = nullptr;
  std::string_view name;   ///< the parameter as written: its name or its former name; view into the parsed text
  std::string_view value;  ///< view into the parsed text
};

/// Parses a setting without checking its value. Errors: kUsage, with a suggestion for a misspelt name.
Result<Setting> parse_setting(std::string_view assignment, std::span<const Effect* const> external_effects = {});

/// Applies one setting. Errors: kUsage.
Result<void> apply_setting(EffectSettings& settings, std::string_view assignment,
                           std::span<const Effect* const> external_effects = {});

/// Returns the defaults of all effects, including `external_effects`.
EffectSettings initial_settings(std::span<const Effect* const> external_effects = {});

/// Returns the defaults of all effects with the presets of a look applied.
EffectSettings look_settings(const Look& look, std::span<const Effect* const> external_effects = {});

/// Applies presets of the look or effect named `look`; an invalid preset is a programming error (fail_check).
void apply_presets(std::string_view look, const LookPresets& presets, EffectSettings& settings,
                   std::span<const Effect* const> external_effects = {});

}  // namespace umbrage
