#include "renderer/recipe.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>

#include "core/check.h"
#include "core/color.h"
#include "core/numbers.h"
#include "core/suggest.h"
#include "effects/antialias/antialias.h"
#include "effects/ground/ground.h"
#include "effects/output/output.h"
#include "effects/resample/resample.h"
#include "effects/steady/steady.h"
#include "looks/presets.h"
#include "reference/reference.h"
#include "renderer/marked_samples.h"
#include "renderer/passes.h"

namespace umbrage {
namespace {

/// Returns the quality that the request names, or else the quality of the look; null if neither names one.
const Quality* quality_of(const Request& request, const Look& look) {
  return find_quality(request.quality.empty() ? look.quality : std::string_view(request.quality));
}

bool is_lit_by_image(const Request& request) { return !request.hdri_file.empty() && request.hdri_ambient; }

glm::vec3 vector_of(const Vector3& v) { return {v[0], v[1], v[2]}; }

/// Returns the linear albedo that replaces the model's materials; empty if they stay.
std::optional<glm::vec3> clay_of(const Request& request) {
  if (request.material == "file") return std::nullopt;
  const Style* style = find_style(request.style);
  std::optional<Vector3> color = request.color;
  if (!color && style) color = style->color;
  if (color) {
    const Vector3& c = *color;
    return glm::vec3(linear_from_srgb(c[0]), linear_from_srgb(c[1]), linear_from_srgb(c[2]));
  }
  return request.material == "clay" ? std::optional(Material{}.albedo) : std::nullopt;
}

/// Returns the planes that cut a model, and how caps look. Errors: kUsage.
Result<SectionSettings> section_settings(const Request& request, const Recipe& recipe) {
  constexpr glm::vec3 kPaper(0.9f), kGrey(0.6f);
  SectionSettings settings;
  for (const std::string& text : request.sections) {
    auto planes = parse_sections(text);
    if (!planes) return planes.error();
    settings.planes.insert(settings.planes.end(), planes->begin(), planes->end());
  }
  settings.hatched = has_lines(*recipe.look);
  settings.is_blank = recipe.look->is_colorless;
  settings.tint = settings.is_blank ? kPaper : recipe.values ? std::optional(kGrey) : recipe.clay;
  return settings;
}

/// Returns whether the look's own technique computes indirect light.
bool computes_indirect_light(const Look& look, const EffectSettings& settings) {
  const Effect* technique = find_effect(look.occlusion);
  if (!technique) return false;
  return writes(*technique, params_of(settings, technique->name), "indirect.r");
}

/// Applies the changes that an environment image makes to a look. If the image lights the scene and the picture depends
/// on the brightness of lights, the look uses the image's light unchanged, with an exposure to match.
void apply_environment(const Request& request, Recipe& recipe) {
  const Look& look = *recipe.look;
  auto& output = params_of<OutputParams>(recipe.settings);
  if (recipe.hdri.shown()) {
    output.sky = 1;
    // The shadow lies on the ground that the image shows, which does not end at the picture's border.
    params_of<GroundParams>(recipe.settings).border = 0.0f;
  }
  if (!is_lit_by_image(request) || !depends_on_light_brightness(recipe)) return;
  apply_presets(look.name, look.image_lit_presets, recipe.settings);
  if (output.metering == kMeteringNone) apply_presets(look.name, look.image_exposed_presets, recipe.settings);
}

/// Applies "effect.parameter=value" assignments of a request. Errors: kUsage.
Result<void> apply_settings(const std::vector<std::string>& assignments, Recipe& recipe) {
  for (const std::string& assignment : assignments) {
    const auto setting = parse_setting(assignment, external_effects());
    if (!setting) return with_field(setting.error(), "settings", assignment);
    const Effect& effect = *setting->effect;
    const Parameter& row = *setting->parameter;
    if (!recipe.effects_look && effect.set_reduction && (row.name == "factor" || row.name == "indirect"))
      return field_error("settings", assignment, "`{}` '{}': {}.{} follows from `occlusion_scale`", effect.name,
                         row.name);
    if (!recipe.effects_look && &effect == &effect_with<ResampleParams>() && follows_from_samples(row.name))
      return field_error("settings", assignment, "`{}` '{}': {}.{} follows from `anti_aliasing`", effect.name,
                         row.name);
    const bool joins = &effect == &effect_with<SteadyParams>() && row.name != "distance" && row.name != "angle";
    if (!recipe.effects_look && (joins || (!effect.joined_frames.empty() && row.name == effect.joined_frames)))
      return field_error("settings", assignment, "`{}` '{}': {}.{} is set for the frames of a sequence", effect.name,
                         row.name);
    if (auto status = set_parameter(effect.name, row, setting->value, params_of(recipe.settings, effect.name)); !status)
      return with_field(status.error(), "settings", assignment);
    recipe.set_by_request.push_back({&effect, &row, {}});
  }
  return {};
}

/// Applies the options that many looks share to the parameters that effects declare for them.
void apply_strengths(Request request, EffectSettings& settings) {
  for (const Effect* effect : effects()) {
    ParameterBytes& params = params_of(settings, effect->name);
    if (effect->add_stops) effect->add_stops(request.exposure, params);
    for (const Parameter& row : effect->parameters)
      if (!row.factor.empty()) multiply(row, std::get<FieldOf<float>>(option_of(row.factor).where)(request), params);
  }
}

/// Applies options and assignments of a request to the settings. Errors: kUsage.
Result<void> apply_request(const Request& request, Recipe& recipe) {
  auto& output = params_of<OutputParams>(recipe.settings);
  if (const Style* style = find_style(request.style)) apply_presets(style->name, style->presets, recipe.settings);
  if (request.background) {
    output.background_r = (*request.background)[0];
    output.background_g = (*request.background)[1];
    output.background_b = (*request.background)[2];
    output.gradient = 0.0f;  // that colour everywhere
  }
  if (request.transparent) output.transparent = 1;
  output.dither = request.values == PictureValues::kDisplay8 && !recipe.hdri.shown();
  apply_strengths(request, recipe.settings);
  if (auto status = apply_settings(request.settings, recipe); !status) return status;
  // A transparent picture is composited later by its viewer, in display values: blend the ground's shadow likewise.
  if (output.transparent && output.transfer == kTransferSrgb && request.values != PictureValues::kSceneLinear) {
    params_of<GroundParams>(recipe.settings).blend = kGroundBlendDisplay;
    output.blend = kBlendDisplay;
  }
  return {};
}

Error unknown_word(std::string_view field, const std::string& word) {
  return field_error(field, word, "`{}` cannot be '{}'{}", suggestion(word, words_of(option_of(field))));
}

/// Returns how the values of a request's field become colours. Errors: kUsage; kFile for a file of colours.
Result<ValueSettings> value_settings(const Request& request) {
  constexpr std::array<float, 3> kMissingColor = {0.70f, 0.655f, 0.604f};  // a warm grey that no built-in map has
  ValueSettings values{.field = request.color_by};
  const std::string& component = request.color_component;
  if (!component.empty()) {
    const auto axis = component.size() == 1 ? std::string_view("xyz").find(component[0]) : std::string_view::npos;
    constexpr double kMaxComponent = 1e6;
    const auto number = parse_number(component, {0.0, kMaxComponent, NumberKind::kInteger});
    if (axis == std::string_view::npos && !number)
      return field_error("color_component", component, "`{}` cannot be '{}': it takes x, y, z or a number from 0");
    values.component = axis != std::string_view::npos ? int(axis) : int(*number);
  }
  auto map = color_map(request.color_map);
  if (!map) return map.error();
  values.map = std::move(*map);
  values.scale = ValueColors::Scale(choice_index("color_scale", request.color_scale));
  values.bands = request.color_bands.value_or(0);
  values.missing = request.missing_color.value_or(kMissingColor);
  if (request.color_range.empty()) return values;
  const float low = request.color_range[0], high = request.color_range[1];
  const auto given = fmt::format("{:g},{:g}", low, high);
  if (!(low < high) || !std::isfinite(high - low))
    return field_error("color_range", given, "`{}` cannot be '{}': it takes low,high with low below high");
  if (values.scale == ValueColors::Scale::kLog && !(low > 0.0f))
    return with_field(field_error("color_range", given, "`{}` cannot be '{}' with `color_scale` log: both are above 0"),
                      "color_scale", request.color_scale);
  values.range = {low, high};
  return values;
}

/// Returns the look of a request. Errors: kUsage.
Result<const Look*> requested_look(const Request& request) {
  auto look = require_named("look", looks(), request.look.empty() ? kDefaultLook : std::string_view(request.look));
  return look ? look : with_field(look.error(), "look", request.look);
}

/// Returns whether a request sets parameters that only the screen-space technique of its look has.
bool asks_for_screen_space(const Request& request, const Look& look) {
  const std::string owner = fmt::format("{}.", look.occlusion);
  return (!request.occlusion_scale.empty() && request.occlusion_scale != "full") ||
         std::any_of(request.settings.begin(), request.settings.end(),
                     [&](const std::string& setting) { return setting.starts_with(owner); });
}

/// Returns the technique of a request. `of_model`: it draws a model, so that rays can be traced.
std::string technique_of(const Request& request, const Look& look, bool of_model) {
  if (!request.occlusion.empty()) return request.occlusion;
  const Quality* quality = quality_of(request, look);
  const bool traced = of_model && !look.model_occlusion.empty() && !(quality && quality->screen_space) &&
                      !asks_for_screen_space(request, look);
  return std::string(traced ? look.model_occlusion : look.occlusion);
}

/// Resolves the look and the technique. `of_model`: see technique_of. Errors: kUsage.
Result<void> resolve_names(const Request& request, bool of_model, Recipe& recipe) {
  const auto look = requested_look(request);
  if (!look) return look.error();
  recipe.look = *look;
  recipe.occlusion = technique_of(request, *recipe.look, of_model);
  const auto techniques = occlusion_names(external_effects());
  if (!contains(techniques, recipe.occlusion))
    return with_field(unknown_name("occlusion technique", recipe.occlusion, techniques), "occlusion", recipe.occlusion);
  if (request.ground == "on" && !recipe.look->ground)
    return field_error("ground", request.ground,
                       "`{}` {} requires a look that shows the ground only by its shadow, such as studio, not '{}'",
                       recipe.look->name);
  if (!request.color_by.empty() && recipe.look->is_colorless)
    return with_field(field_error("color_by", request.color_by,
                                  "`{}` '{}': the `look` {} shows no colours; take another, such as studio or cartoon",
                                  recipe.look->name),
                      "look", request.look);
  if (!request.style.empty() && !find_style(request.style)) return unknown_word("style", request.style);
  if (!request.quality.empty() && !find_quality(request.quality)) return unknown_word("quality", request.quality);
  return {};
}

/// Sets the downsampling factor of occlusion. Errors: kUsage.
Result<void> resolve_scale(const Request& request, const Quality* quality, Recipe& recipe) {
  const Effect* technique = find_effect(recipe.occlusion);
  // The ray-traced reference and no technique, too, have no reduced resolution.
  const bool full_only = !technique || technique->filters_itself;
  recipe.occlusion_downsampling = quality ? quality->occlusion_downsampling : recipe.look->occlusion_downsampling;
  if (full_only) recipe.occlusion_downsampling = 1;
  if (request.occlusion_scale.empty()) return {};
  const auto factor = parse_scale("occlusion_scale", request.occlusion_scale);
  if (!factor) return factor.error();
  if (full_only && *factor > 1)
    return field_error("occlusion_scale", request.occlusion_scale,
                       "`{}` cannot be '{}' with `occlusion` {}: it takes full, or another technique",
                       recipe.occlusion);
  recipe.occlusion_downsampling = *factor;
  return {};
}

/// Makes a look that consists of these effects. Errors: kUsage.
Result<Look> look_of(const std::vector<std::string>& names) {
  Look look{.name = "effects"};
  for (const std::string& name : names) {
    const auto effect = require_named("effect", effects(), name);
    if (!effect) return with_field(effect.error(), "effects", name);
    look.effects.push_back((*effect)->name);
  }
  return look;
}

/// Makes a recipe of effects only, without the presets of a look. Errors: kUsage.
Result<Recipe> recipe_of_effects(const Request& request, long max_pixels) {
  if (auto status = check_request(request, max_pixels); !status) return status.error();
  if (const auto known = requested_look(request); !known) return known.error();
  auto look = look_of(request.effects);
  if (!look) return look.error();
  Recipe recipe{.width = request.width, .height = request.height};
  recipe.effects_look = std::make_shared<const Look>(std::move(*look));
  recipe.look = recipe.effects_look.get();
  recipe.occlusion = kNoOcclusion;
  recipe.settings = initial_settings(external_effects());
  if (auto status = apply_request(request, recipe); !status) return status.error();
  enable_passes(request, recipe);
  if (!request.occlusion_radius.empty()) recipe.radius = *parse_length("occlusion_radius", request.occlusion_radius);
  return recipe;
}

}  // namespace

int choice_index(std::string_view field, std::string_view text) {
  const auto& choices = option_of(field).choices;
  const auto found = std::find(choices.begin(), choices.end(), text);
  if (found == choices.end()) fail_check(fmt::format("{} is not a choice of {}", text, field));
  return int(found - choices.begin());
}

Framing framing_of(const CameraSettings& camera) {
  Framing framing;
  const auto position = [](const std::optional<Position>& from) {
    return from ? std::optional(glm::dvec3((*from)[0], (*from)[1], (*from)[2])) : std::nullopt;
  };
  const auto direction = [](const std::optional<Vector3>& from) {
    return from ? std::optional(glm::normalize(vector_of(*from))) : std::nullopt;
  };
  framing.position = position(camera.position);
  framing.focal_point = position(camera.focal_point);
  framing.view_up = direction(camera.view_up);
  framing.direction = direction(camera.direction);
  framing.view_angle_deg = camera.view_angle_deg;
  framing.azimuth_deg = camera.azimuth_deg;
  framing.elevation_deg = camera.elevation_deg;
  framing.orbits = camera.orbit;
  framing.zoom = camera.zoom;
  framing.orthographic = camera.orthographic;
  return framing;
}

bool has_lines(const Look& look) {
  return std::any_of(look.effects.begin(), look.effects.end(), [](std::string_view name) {
    const Effect* effect = find_effect(name);
    return effect && !effect->without_lines.empty();
  });
}

Result<ImportSettings> import_settings(const Request& request) {
  ImportSettings settings;
  if (auto status = check_request(request, kMaxStripPixels); !status) return status.error();
  if (request.up) settings.up = glm::normalize(vector_of(*request.up));
  settings.scene_index = request.scene_index;
  settings.animation_index = request.animation_index;
  if (request.animation_time && !request.animation_index) settings.animation_index = 0;
  settings.animation_time = request.animation_time.value_or(0.0f);
  settings.picture_px = int(std::bit_ceil(unsigned(std::max(request.width, request.height))));
  settings.file_lights = request.lights == "file";
  if (!request.color_by.empty()) settings.field = request.color_by;
  if (!request.point_size.empty()) settings.points.size = *parse_length("point_size", request.point_size);
  settings.points.shape = PointShape(choice_index("point_sprites", request.point_sprites));
  if (request.crease_angle_deg) settings.crease_angle_deg = *request.crease_angle_deg;
  return settings;
}

int fitted_px(const Request& request) {
  const CameraSettings& camera = request.camera;
  const bool is_placed = camera.index || camera.position || camera.focal_point || camera.view_up || camera.direction;
  const bool is_default = !is_placed && !camera.view_angle_deg && camera.azimuth_deg == 0.0f &&
                          camera.elevation_deg == 0.0f && camera.zoom <= 1.0f && !camera.orthographic;
  // A camera may be fitted to what a section leaves, and parts that move apart may come closer.
  return is_default && request.sections.empty() && request.explode == 0.0f ? std::max(request.width, request.height)
                                                                           : 0;
}

Result<CaptureSettings> capture_settings(const Request& request, const Look& look, int shadows, long max_pixels) {
  const int guard = int(std::ceil(request.guard_band / 100.0f * float(std::max(request.width, request.height))));
  const long width = request.width + 2L * guard, height = request.height + 2L * guard;
  const Quality* quality = quality_of(request, look);
  int shadow_rays = quality ? quality->shadow_rays : look.shadow_rays;
  // A light of nonzero size needs shadow rays for its penumbra.
  if ((is_lit_by_image(request) && !look.lit_by.empty()) || request.light_size_deg.value_or(0.0f) > 0.0f)
    shadow_rays = std::max(shadow_rays, 1);
  CaptureSettings settings{.width = request.width,
                           .height = request.height,
                           .shadows = shadows,
                           .layers = request.layers.value_or(std::max(look.layers, quality ? quality->layers : 1)),
                           .back_sides = look.back_sides,
                           .extra_views = request.extra_views.value_or(look.extra_views),
                           .guard = guard,
                           .shadow_rays = shadow_rays};
  // A quality does not request more layers than are possible.
  while (!request.layers && settings.layers > look.layers && !layer_count(settings)) --settings.layers;
  const auto layers = layer_count(settings);
  if (!layers) return layers.error();
  if (width * height * *layers > max_pixels)
    return usage_error("{} of {} x {} pixels {} too large: at most {} pixels in total{}",
                       *layers == 1 ? "one layer" : fmt::format("{} layers", *layers), width, height,
                       *layers == 1 ? "is" : "are", max_pixels, remedy_for_size(max_pixels));
  return settings;
}

namespace {

/// Adds the layers that an effect needs to a capture, as many of them as are possible.
Result<void> add_layers(const Effect& effect, const Recipe& recipe, long max_pixels, CaptureSettings& capture) {
  const int before = capture.layers, needed = layers_needed(effect, params_of(recipe.settings, effect.name));
  const long pixels = long(capture.width + 2 * capture.guard) * (capture.height + 2 * capture.guard);
  const auto fits = [&] {
    const auto count = layer_count(capture);
    return count && pixels * *count <= max_pixels;
  };
  for (capture.layers = std::max(before, needed); capture.layers > before && !fits();) --capture.layers;
  if (needed > 1 && capture.layers == 1)
    return field_error("settings", "", "`{0}` {2} needs two layers, for which {3} x {4} pixels are too large",
                       effect.name, capture.width, capture.height);
  return {};
}

/// Returns what to capture. Techniques that trace rays need only the visible surfaces, unless the request asks for
/// more. `of_model`: the layers are captured; otherwise they are those of a G-buffer.
Result<CaptureSettings> capture_of(const Request& request, const Recipe& recipe, long max_pixels, bool of_model) {
  const auto steps = steps_of(look_run(recipe));
  Request drawn = request;
  Look look = *recipe.look;
  const bool traced = std::any_of(steps.begin(), steps.end(), [](const Effect* step) { return needs_scene(*step); });
  if (traced) {
    drawn.layers = request.layers.value_or(1);
    look.back_sides = false;
    look.extra_views = 0;
  }
  auto capture = capture_settings(drawn, look, shadows_read(recipe, steps), max_pixels);
  if (!capture) return capture;
  capture->ray_offsets = traced;
  for (const Effect* step : steps)
    capture->occluders = std::max(capture->occluders, occluders_read(*step, params_of(recipe.settings, step->name)));
  for (const Effect* step : steps)
    if (of_model && !request.layers)
      if (auto status = add_layers(*step, recipe, max_pixels, *capture); !status) return status.error();
  return capture;
}

/// `of_model`: the picture shows a model, so that rays can be traced and several pictures averaged. `at_edges`: also
/// those that Look::edge_frames adds, if the look runs at marked pixels.
Result<Recipe> make_recipe_of(const Request& request, long max_pixels, bool of_model, bool at_edges) {
  if (auto status = check_request(request, max_pixels); !status) return status.error();
  Recipe recipe{.width = request.width, .height = request.height};
  if (auto found = resolve_names(request, of_model, recipe); !found) return found.error();
  const Look& look = *recipe.look;
  const Quality* quality = quality_of(request, look);
  if (of_model) recipe.frames = request.anti_aliasing.value_or(quality ? quality->frames : look.frames);
  recipe.edges_alone = at_edges && !request.anti_aliasing && recipe.frames == 1 && look.edge_frames > 1;
  if (recipe.edges_alone) recipe.frames = look.edge_frames;
  if (auto status = resolve_scale(request, quality, recipe); !status) return status.error();
  if (!request.occlusion_radius.empty()) recipe.radius = *parse_length("occlusion_radius", request.occlusion_radius);
  recipe.framing = framing_of(request.camera);
  recipe.framing.usual_view_angle_deg = look.view_angle_deg;
  recipe.framing.margin = look.margin;
  recipe.framing.shows_horizon = request.hdri_skybox;
  recipe.framing.centers_shadow = look.ground;
  recipe.camera_index = request.camera.index;
  recipe.ground = Ground(choice_index("ground", request.ground));
  recipe.hdri = {.file = request.hdri_file,
                 .ambient = request.hdri_ambient,
                 .skybox = request.hdri_skybox,
                 .rotation_deg = request.hdri_rotation_deg,
                 .intensity = request.hdri_intensity,
                 .panorama = nullptr};
  recipe.light_size_deg = request.light_size_deg;
  recipe.light_factors = {request.key, request.fill, request.rim};
  if (!request.light_direction.empty() && !is_lit_by_image(request))
    recipe.framing.light_deg = glm::vec2(request.light_direction[0], request.light_direction[1]);
  if (!request.color_by.empty()) {
    auto values = value_settings(request);
    if (!values) return values.error();
    recipe.values = std::move(*values);
  }
  recipe.clay = recipe.values ? std::nullopt : clay_of(request);
  recipe.explode = request.explode / 100.0f;
  auto sections = section_settings(request, recipe);
  if (!sections) return sections.error();
  recipe.sections = std::move(*sections);
  recipe.settings = look_settings(look, external_effects());
  // The average of several pictures has smooth edges already, and `anti_aliasing` 1 asks for pixels as they are.
  if (recipe.frames > 1 || request.anti_aliasing) params_of<AntialiasParams>(recipe.settings).search = 0;
  const bool averages_occlusion = recipe.frames > 1 && !draws_marked_samples(recipe);
  if (quality)
    apply_presets(quality->name, averages_occlusion ? quality->settings_of_averaged : quality->settings,
                  recipe.settings);
  if (recipe.values) {
    apply_presets(look.name, value_presets(), recipe.settings);
    apply_presets(look.name, look.value_presets, recipe.settings);
  }
  apply_environment(request, recipe);
  // The reference computes indirect light, too, if the look's technique does, unless the request sets it.
  if (recipe.occlusion == reference_effect().name && computes_indirect_light(look, recipe.settings))
    as<ReferenceParams>(params_of(recipe.settings, recipe.occlusion)).light = kReferenceBounce;
  if (auto status = apply_request(request, recipe); !status) return status.error();
  const auto capture = capture_of(request, recipe, max_pixels, of_model);
  if (!capture) return capture.error();
  recipe.capture = *capture;
  if (auto status = apply_passes(request, recipe); !status) return status.error();
  if (recipe.edges_alone && !draws_marked_samples(recipe)) return make_recipe_of(request, max_pixels, of_model, false);
  return recipe;
}

}  // namespace

Result<Recipe> make_recipe(const Request& request, long max_pixels) {
  if (const Look* look = find_look(request.look); look && look->needs_beauty)
    return field_error("look", request.look,
                       "the {} '{}' needs the finished picture of another renderer: it cannot draw a model");
  return make_recipe_of(request, max_pixels, true, true);
}

Result<Recipe> make_shading_recipe(const Request& request, long max_pixels) {
  if (!request.effects.empty()) return recipe_of_effects(request, max_pixels);
  Request picture = request;
  picture.passes.clear();  // checked later against the planes of the shaded frame
  auto recipe = make_recipe_of(picture, max_pixels, false, false);
  if (!recipe) return recipe;
  const Effect* technique = find_effect(recipe->occlusion);
  if (recipe->occlusion != kNoOcclusion && (!technique || needs_scene(*technique)))
    return field_error("occlusion", recipe->occlusion, "`{}` {} needs the model: it cannot shade a G-buffer");
  enable_passes(request, *recipe);
  return recipe;
}

Result<Recipe> make_recipe_of_look(const Request& request) {
  const Look* look = find_look(request.look);
  return look && look->needs_beauty ? make_shading_recipe(request) : make_recipe(request);
}

}  // namespace umbrage
