// What the look of a recipe runs and reads, and settings of its effects.
#include <algorithm>

#include "core/light_rig.h"
#include "reference/reference.h"
#include "renderer/recipe.h"

namespace umbrage {

std::span<const Effect* const> external_effects() {
  static const Effect* const all[] = {&reference_effect()};
  return all;
}

LookRun look_run(const Recipe& recipe) {
  return {.look = recipe.look,
          .occlusion = recipe.occlusion,
          .occlusion_downsampling = recipe.occlusion_downsampling,
          .settings = &recipe.settings,
          .wanted = recipe.wanted,
          .kept = recipe.kept,
          .external_effects = external_effects()};
}

int shadows_read(const Recipe& recipe, std::span<const Effect* const> steps) {
  int count = 0;
  for (const Effect* effect : steps) {
    if (find_named(external_effects(), effect->name)) continue;
    const ParameterBytes& params = params_of(recipe.settings, effect->name);
    const Parameter* strength = find_parameter(*effect, "shadow");
    if (strength && real_value(*strength, params) == 0.0f) continue;
    if (find_parameter(*effect, "rig") && !uses_scene_lights(*effect, recipe.settings)) continue;
    for (const Dispatch& dispatch : effect->dispatches)
      for (int light = count; light < kMaxShadows; ++light)
        if (contains(dispatch.inputs, shadow_plane(light))) count = light + 1;
  }
  return count;
}

std::vector<const Effect*> effects_with_external() { return all_effects(external_effects()); }

bool uses_scene_lights(const Effect& effect, const EffectSettings& settings) {
  const Parameter* rig = find_parameter(effect, "rig");
  return rig && int_value(*rig, params_of(settings, effect.name)) == int(Rig::kScene);
}

bool uses_scene_lights(const Recipe& recipe) {
  const auto uses = [&](std::string_view name) {
    const Effect* effect = find_effect(name);
    return effect && uses_scene_lights(*effect, recipe.settings);
  };
  const auto& names = recipe.look->effects;
  return recipe.occlusion == reference_effect().name || std::any_of(names.begin(), names.end(), uses);
}

bool depends_on_light_brightness(const Recipe& recipe) {
  const Effect* lighting = find_effect(recipe.look->lit_by);
  return lighting && uses_scene_lights(*lighting, recipe.settings);
}

Result<EffectSettings> effect_settings(std::span<const std::string> assignments) {
  EffectSettings settings = initial_settings(external_effects());
  for (const std::string& assignment : assignments)
    if (auto status = apply_setting(settings, assignment, external_effects()); !status) return status.error();
  return settings;
}

Result<void> apply_variant(EffectSettings& settings, const Effect& effect, std::string_view variant) {
  for (std::size_t start = 0; start < variant.size();) {
    const std::size_t end = std::min(variant.find(' ', start), variant.size());
    const std::string setting = fmt::format("{}.{}", effect.name, variant.substr(start, end - start));
    if (auto set = apply_setting(settings, setting, external_effects()); !set) return set;
    start = end + 1;
  }
  return {};
}

void apply_radius(float radius, const PictureInfo& info, Recipe& recipe) {
  const EffectSettings before = recipe.settings;
  for (const Effect* effect : effects_with_external())
    if (effect->set_radius) effect->set_radius(radius, info, params_of(recipe.settings, effect->name));
  for (const Setting& given : recipe.set_by_request)
    copy_parameter(*given.parameter, params_of(before, given.effect->name),
                   params_of(recipe.settings, given.effect->name));
}

}  // namespace umbrage
