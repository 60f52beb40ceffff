#include "renderer/recipe.h"

#include <fmt/format.h>

#include "core/lists.h"
#include "effects/resample/resample.h"
#include "effects/steady/steady.h"
#include "looks/looks.h"
#include "looks/settings.h"
#include "reference/reference.h"
#include "renderer/marked_samples.h"

namespace umbrage {
namespace {

/// Returns whether the picture uses the effect. The one that upsamples always counts as used: another quality may
/// compute occlusion at reduced resolution.
bool uses_effect(const Recipe& recipe, std::string_view name) {
  const Effect* effect = find_effect(name);
  if (effect == &effect_with<ResampleParams>()) return draws_marked_samples(recipe);
  if (effect == &effect_with<SteadyParams>()) return recipe.is_steady;
  return name == recipe.occlusion || (effect && effect->set_reduction) || contains(recipe.look->effects, name);
}

void warn_about_effects(const Request& request, const Recipe& recipe, std::string_view word,
                        const std::function<bool(std::string_view)>& is_reported, std::vector<std::string>& sentences) {
  const auto techniques = occlusion_names(external_effects());
  for (const std::string& setting : request.settings) {
    const std::string effect = setting.substr(0, setting.find('.'));
    if (uses_effect(recipe, effect) || !is_reported(setting)) continue;
    if (recipe.effects_look)
      sentences.push_back(fmt::format("{}{} does nothing: {} is not among the `effects`", word, setting, effect));
    else if (contains(techniques, effect))
      sentences.push_back(fmt::format("{}{} does nothing: the occlusion of this picture is {}; try `occlusion` {}",
                                      word, setting, recipe.occlusion == kNoOcclusion ? "off" : recipe.occlusion,
                                      effect));
    else
      sentences.push_back(
          fmt::format("{}{} does nothing: the look {} has no {}", word, setting, recipe.look->name, effect));
  }
}

/// Adds a warning for each effect that needs several layers if the request sets one, or not all of them fit.
void warn_about_layers(const Request& request, const Recipe& recipe, std::string_view word,
                       std::vector<std::string>& sentences) {
  const int captured = recipe.capture.layers;
  for (const std::string_view name : recipe.look->effects) {
    const Effect* effect = find_effect(name);
    const int needed = effect ? layers_needed(*effect, params_of(recipe.settings, name)) : 1;
    if (request.layers == 1 && needed > 1)
      sentences.push_back(fmt::format("{}{} draws nothing: the picture has one layer", word, name));
    if (!request.layers && captured > 1 && captured < needed)
      sentences.push_back(fmt::format("{}{} draws what {} layers show: {} layers of {} x {} pixels are too large", word,
                                      name, captured, needed, recipe.width, recipe.height));
  }
}

void warn_about_former_names(const Request& request, std::string_view word, std::vector<std::string>& sentences) {
  for (const std::string& text : request.settings) {
    const auto setting = parse_setting(text, external_effects());
    if (!setting) continue;  // reported as an error
    const auto& [effect, parameter, name, value] = *setting;
    if (name == parameter->name) continue;
    sentences.push_back(fmt::format("{}{}: the parameter is now {}.{}; the former name will be removed in 0.3", word,
                                    text, effect->name, parameter->name));
  }
}

/// Adds warnings about settings of looks, for a request that names effects in place of a look.
void warn_about_looks(const Request& request, std::vector<std::string>& sentences) {
  const Request initial;
  const std::pair<const char*, bool> all[] = {{"look", request.look != initial.look},
                                              {"quality", request.quality != initial.quality},
                                              {"occlusion", request.occlusion != initial.occlusion},
                                              {"occlusion_scale", request.occlusion_scale != initial.occlusion_scale}};
  for (const auto& [field, is_set] : all)
    if (is_set) sentences.push_back(fmt::format("`{}` does nothing: `effects` replace the look", field));
}

void warn_about_images(const Request& request, const Recipe& recipe, std::vector<std::string>& sentences) {
  const Hdri& hdri = recipe.hdri;
  if (hdri.file.empty()) {
    const Request initial;
    const std::pair<const char*, bool> all[] = {
        {"hdri_rotation_deg", request.hdri_rotation_deg != initial.hdri_rotation_deg},
        {"hdri_intensity", request.hdri_intensity != initial.hdri_intensity},
        {"hdri_ambient", request.hdri_ambient != initial.hdri_ambient}};
    for (const auto& [field, is_set] : all)
      if (is_set) sentences.push_back(fmt::format("`{}` does nothing: there is no image; try `hdri_file` sky:", field));
    return;
  }
  if (hdri.skybox || (uses_scene_lights(recipe) && hdri.ambient)) return;
  sentences.push_back(hdri.ambient
                          ? fmt::format("`hdri_file` does nothing: the look {} has its own lights", recipe.look->name)
                          : "`hdri_file` does nothing: it is used neither as light nor as background");
}

/// Adds warnings about strengths of what the picture does not have, and about a background that it does not show.
void warn_about_strengths(const Request& request, const Recipe& recipe, std::vector<std::string>& sentences) {
  if (request.occlusion_strength != 1.0f && recipe.occlusion == kNoOcclusion && !recipe.effects_look)
    sentences.push_back("`occlusion_strength` does nothing: this picture has no occlusion");
  if (request.shadow_strength != 1.0f && recipe.occlusion == reference_effect().name &&
      as<ReferenceParams>(params_of(recipe.settings, recipe.occlusion)).light != kReferenceOcclusion)
    sentences.push_back("`shadow_strength` does nothing: the reference traces the shadows");
  if (request.background && (recipe.hdri.shown() || request.transparent))
    sentences.push_back(fmt::format("`background` does nothing: `{}` replaces it",
                                    recipe.hdri.shown() ? "hdri_skybox" : "transparent"));
}

/// Adds warnings about factors and directions of lights that the picture does not have.
void warn_about_lights(const Request& request, const Recipe& recipe, const Scene* scene,
                       std::vector<std::string>& sentences) {
  if (recipe.clay && !request.style.empty() && request.model.empty() && !scene)
    sentences.push_back("`style` " + request.style + " changes the background alone: a G-buffer keeps its colours");
  if (!uses_scene_lights(recipe)) {
    const std::pair<const char*, bool> all[] = {{"light_direction", !request.light_direction.empty()},
                                                {"key", request.key != 1.0f},
                                                {"fill", request.fill != 1.0f},
                                                {"rim", request.rim != 1.0f},
                                                {"shadow_strength", request.shadow_strength != 1.0f}};
    for (const auto& [field, is_set] : all)
      if (is_set)
        sentences.push_back(fmt::format("`{}` does nothing: the look {} has its own light", field, recipe.look->name));
    return;
  }
  const bool by_image = recipe.hdri.lights(), own = by_image || (scene && !scene->lights.empty());
  const std::string why = by_image ? "an image lights the scene"
                          : own    ? "the scene has its own lights"
                                   : fmt::format("the look {} has no such light", recipe.look->name);
  for (const auto& [field, factor] : {std::pair{"fill", request.fill}, {"rim", request.rim}})
    if (factor != 1.0f && (own || !recipe.look->studio_lights))
      sentences.push_back(fmt::format("`{}` does nothing: {}", field, why));
  if (request.light_direction.empty()) return;
  if (by_image) sentences.push_back("`light_direction` does nothing: an image lights the scene");
  if (!by_image && own && scene->lights[0].kind != LightKind::kDirectional)
    sentences.push_back("`light_direction` does nothing: the first light of the scene is a lamp");
}

/// Adds warnings about options of values that are not shown. Those of a configuration file are preferences.
void warn_about_values(const Request& request, const std::function<bool(std::string_view setting)>& is_reported,
                       std::vector<std::string>& sentences) {
  Request given = request;
  Request defaults;
  for (const Option& option : options()) {
    if (option.group != "Values" || !is_reported(option.option)) continue;
    const bool is_set = std::visit(
        [&](auto of) {
          if constexpr (std::is_same_v<decltype(of), std::monostate>)
            return false;
          else
            return of(given) != of(defaults);
        },
        option.where);
    if (is_set)
      sentences.push_back(fmt::format("`{}` does nothing: `color_by` names no field of values", option.field));
  }
}

/// Adds a warning if the technique would read the model of a picture that has none.
void warn_about_missing_model(const Request& request, const Recipe& recipe, const Scene* scene,
                              std::vector<std::string>& sentences) {
  const Effect* technique = find_effect(recipe.occlusion);
  if (scene || !request.model.empty() || !technique) return;
  if (occluders_read(*technique, params_of(recipe.settings, technique->name)) > 0)
    sentences.push_back(
        fmt::format("`occlusion` {}: a G-buffer has no model, so that only what is near occludes", recipe.occlusion));
}

}  // namespace

std::vector<std::string> setting_warnings(const Request& request, const Recipe& recipe, const Scene* scene,
                                          const std::function<bool(std::string_view setting)>& is_reported,
                                          std::string_view word) {
  std::vector<std::string> sentences;
  warn_about_former_names(request, word, sentences);
  warn_about_effects(request, recipe, word, is_reported, sentences);
  warn_about_layers(request, recipe, word, sentences);
  if (recipe.effects_look) warn_about_looks(request, sentences);
  if (recipe.radius && recipe.occlusion == kNoOcclusion && !recipe.effects_look)
    sentences.push_back(
        fmt::format("`occlusion_radius` {} does nothing: this picture has no occlusion", request.occlusion_radius));
  warn_about_images(request, recipe, sentences);
  warn_about_strengths(request, recipe, sentences);
  warn_about_lights(request, recipe, scene, sentences);
  if (request.color_by.empty()) warn_about_values(request, is_reported, sentences);
  warn_about_missing_model(request, recipe, scene, sentences);
  if (scene && scene->point_count() == 0) {
    const char* field = !request.point_size.empty()       ? "point_size"
                        : request.point_sprites != "auto" ? "point_sprites"
                                                          : nullptr;
    if (field) sentences.push_back(fmt::format("`{}` does nothing: '{}' has no points", field, scene->name));
  }
  return sentences;
}

}  // namespace umbrage
