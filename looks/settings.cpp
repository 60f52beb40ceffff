#include "looks/settings.h"

#include "core/check.h"
#include "core/suggest.h"

namespace umbrage {

std::vector<const Effect*> all_effects(std::span<const Effect* const> external_effects) {
  std::vector<const Effect*> all(effects().begin(), effects().end());
  all.insert(all.end(), external_effects.begin(), external_effects.end());
  return all;
}

Result<Setting> parse_setting(std::string_view assignment, std::span<const Effect* const> external_effects) {
  const std::size_t equals = assignment.find('=');
  const std::size_t dot = assignment.substr(0, equals).find('.');
  if (equals == std::string_view::npos || dot == std::string_view::npos)
    return usage_error("'{}' is not a setting: write effect.parameter=value, such as unsharp.kernel=40", assignment);
  const std::string_view owner = assignment.substr(0, dot);
  const std::string_view name = assignment.substr(dot + 1, equals - dot - 1);
  const auto effect = require_named<Effect>("effect", all_effects(external_effects), owner);
  if (!effect) return effect.error();
  const Parameter* row = find_parameter(**effect, name);
  if (!row) {
    std::vector<std::string_view> names;
    for (const Parameter& each : (*effect)->parameters) names.push_back(each.name);
    return usage_error("effect {} has no parameter '{}'{}", owner, name, suggestion(name, names));
  }
  return Setting{*effect, row, name, assignment.substr(equals + 1)};
}

Result<void> apply_setting(EffectSettings& settings, std::string_view assignment,
                           std::span<const Effect* const> external_effects) {
  const auto setting = parse_setting(assignment, external_effects);
  if (!setting) return setting.error();
  const std::string_view owner = setting->effect->name;
  return set_parameter(owner, *setting->parameter, setting->value, params_of(settings, owner));
}

EffectSettings initial_settings(std::span<const Effect* const> external_effects) {
  EffectSettings settings;
  for (const Effect* effect : all_effects(external_effects))
    settings[std::string(effect->name)] = initial_parameters(effect->parameters, effect->params_size);
  return settings;
}

EffectSettings look_settings(const Look& look, std::span<const Effect* const> external_effects) {
  EffectSettings settings = initial_settings(external_effects);
  apply_presets(look.name, look.presets, settings, external_effects);
  return settings;
}

void apply_presets(std::string_view look, const LookPresets& presets, EffectSettings& settings,
                   std::span<const Effect* const> external_effects) {
  for (const std::string_view preset : presets)
    if (const auto status = apply_setting(settings, preset, external_effects); !status)
      fail_check(fmt::format("look {}: {}", look, status.error().message));
}

}  // namespace umbrage
