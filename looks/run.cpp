#include <algorithm>

#include "core/check.h"
#include "core/suggest.h"
#include "effects/effects.h"
#include "looks/looks.h"

namespace umbrage {

// looks.inc is made by CMake: one line per file.
#define UMBRAGE_LOOK(name) const Look& look_##name();
#include "looks.inc"
#undef UMBRAGE_LOOK

std::span<const Look* const> looks() {
  static const std::vector<const Look*> all = {
#define UMBRAGE_LOOK(name) &look_##name(),
#include "looks.inc"
#undef UMBRAGE_LOOK
  };
  return all;
}

const Look* find_look(std::string_view name) {
  for (const Look* look : looks())
    if (look->name == name) return look;
  return nullptr;
}

std::vector<std::string_view> occlusion_names() {
  std::vector<std::string_view> names;
  for (const Effect* effect : effects())
    if (effect->kind == EffectKind::kOcclusion) names.push_back(effect->name);
  names.push_back(kNoOcclusion);
  return names;
}

EffectSettings look_settings(const Look& look) {
  EffectSettings settings;
  for (const Effect* effect : effects())
    settings[std::string(effect->name)] = initial_parameters(effect->parameters, effect->params_size);
  for (const auto& [name, value] : look.presets)
    if (const auto done = apply_setting(settings, fmt::format("{}={}", name, value)); !done)
      fail_check(fmt::format("look {}: {}", look.name, done.error().message));
  return settings;
}

Result<void> apply_setting(EffectSettings& settings, std::string_view assignment) {
  const std::size_t equals = assignment.find('=');
  const std::size_t dot = assignment.substr(0, equals).find('.');
  if (equals == std::string_view::npos || dot == std::string_view::npos)
    return usage_error("'{}' is not a setting: write effect.parameter=value, such as unsharp.kernel=40", assignment);
  const std::string_view owner = assignment.substr(0, dot);
  const std::string_view name = assignment.substr(dot + 1, equals - dot - 1);
  const Effect* effect = find_effect(owner);
  if (!effect) {
    std::vector<std::string_view> names;
    for (const Effect* each : effects()) names.push_back(each->name);
    return usage_error("there is no effect '{}'{}", owner, suggestion(owner, names));
  }
  const Parameter* row = find_parameter(*effect, name);
  if (!row) {
    std::vector<std::string_view> names;
    for (const Parameter& each : effect->parameters) names.push_back(each.name);
    return usage_error("{} has no parameter '{}'{}", owner, name, suggestion(name, names));
  }
  return set_parameter(owner, *row, assignment.substr(equals + 1), settings.find(owner)->second);
}

Result<void> run_look(const Look& look, std::string_view occlusion, const EffectSettings& settings, Device& device,
                      Frame& frame, const std::function<void(std::string_view)>& after) {
  for (std::string_view name : look.effects) {
    if (name == "occlusion") {
      if (occlusion == kNoOcclusion) continue;  // `ao` is then the device's neutral 1
      name = occlusion;
    }
    const Effect* effect = find_effect(name);
    if (!effect) fail_check(fmt::format("look {} names no effect: {}", look.name, name));
    if (auto done = device.run(*effect, settings.find(name)->second, frame); !done) return done;
    after(name);
  }
  return {};
}

}  // namespace umbrage
