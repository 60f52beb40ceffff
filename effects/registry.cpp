// The list of all effects, which CMake generates.
#include <limits>
#include <map>
#include <vector>

#include "core/check.h"
#include "core/registry.h"
#include "effects/effects.h"

namespace umbrage {

// CMake generates effects.inc, with one line per folder of effects/.
#define UMBRAGE_EFFECT(name) Effect effect_##name();
#include "effects.inc"
#undef UMBRAGE_EFFECT

std::span<const Effect* const> effects() {
  static const Effect list[] = {
#define UMBRAGE_EFFECT(name) effect_##name(),
#include "effects.inc"
#undef UMBRAGE_EFFECT
  };
  static const std::vector<const Effect*> all = pointers_to(list);
  return all;
}

const Effect* find_effect(std::string_view name) { return find_named(effects(), name); }

const Effect& effect_with(std::type_index params_type) {
  for (const Effect* effect : effects())
    if (effect->params_type == params_type) return *effect;
  fail_check(fmt::format("no effect has the parameters {}", params_type.name()));
}

namespace {

using Values = std::map<std::string_view, float>;

/// The values by pass or plane: those of a G-buffer, of all techniques, and of the planes of each effect.
Values make_values() {
  Values values = {{"albedo", 0.8f},   {"specular", 0.0f},  {"shininess", 1.0f},   {"emission", 0.0f},
                   {"metallic", 0.0f}, {"object_id", 0.0f}, {"material_id", 0.0f}, {"roughness", kNoRoughness},
                   {"ao", 1.0f},       {"indirect", 0.0f},  {"material_ao", 1.0f}};
  for (const Effect* effect : effects())
    for (const NeutralValue& neutral : effect->neutral)
      if (!values.emplace(neutral.pass, neutral.value).second)
        fail_check(fmt::format("{} declares a neutral value of {}, which has one", effect->name, neutral.pass));
  return values;
}

}  // namespace

std::optional<float> neutral_value(std::string_view plane) {
  static const Values values = make_values();
  const auto without = [&](std::string_view start) {
    const bool has = plane.starts_with(start);
    if (has) plane.remove_prefix(start.size());
    return has;
  };
  const auto value_of = [&](std::string_view name) -> std::optional<float> {
    auto found = values.find(name);
    if (found == values.end()) found = values.find(pass_of(name));
    return found != values.end() ? std::optional(found->second) : std::nullopt;
  };
  without(reduced_plane(""));
  if (const auto value = value_of(plane)) return value;  // also a name that begins as those of first samples do
  without(other_plane(""));
  const bool of_layer = layer_of_plane(plane) > 0;
  plane = name_on_first_layer(plane);
  // A layer that does not exist has no surface, and no output of an effect.
  if (of_layer && plane == "depth") return std::numeric_limits<float>::infinity();
  if (is_shadow_plane(plane)) return 1.0f;
  const auto value = value_of(plane);
  return of_layer ? value.value_or(0.0f) : value;
}

}  // namespace umbrage
