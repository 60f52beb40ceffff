#include "apps/compare/compare.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "apps/compare/environments.h"
#include "apps/compare/pictures.h"
#include "apps/compare/run.h"
#include "core/check.h"
#include "core/lists.h"
#include "core/suggest.h"
#include "effects/lighting/lighting.h"
#include "reference/reference.h"
#include "scene/environment.h"
#include "scene/framing.h"

namespace umbrage {

Result<std::vector<const Effect*>> techniques_of(const CompareSettings& settings) {
  std::vector<const Effect*> all;
  for (const Effect* effect : effects_with_external())
    if (effect->kind == EffectKind::kOcclusion) all.push_back(effect);
  if (settings.techniques.empty()) return all;
  std::vector<std::string_view> names;
  names.reserve(all.size());
  for (const Effect* effect : all) names.push_back(effect->name);
  std::vector<const Effect*> chosen;
  for (const std::string& name : settings.techniques) {
    if (name == "all") return all;
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) return with_field(unknown_name("occlusion technique", name, names), "occlusion", name);
    const Effect* effect = all[std::size_t(found - names.begin())];
    if (!contains(chosen, effect)) chosen.push_back(effect);
  }
  return chosen;
}

std::string view_text(const Camera& camera) {
  const glm::vec3 eye = camera.eye();
  const glm::mat4& m = camera.view_from_world;
  return fmt::format("{} {:.3g} {:.3g} {:.3g}, {:.2f} {:.2f} {:.2f}, {:.3g} {:.3g} {:.3g} {:.3g}",
                     camera.projection == Projection::kOrthographic ? "orthographic" : "perspective", eye.x, eye.y,
                     eye.z, -m[0][2], -m[1][2], -m[2][2], camera.left, camera.right, camera.bottom, camera.top);
}

namespace {

/// The parameter of techniques that take ambient light from the open directions.
constexpr std::string_view kDirectional = "directional";

/// Turns the direction of ambient light on or off, for a technique that has it.
Result<void> set_directional(const Effect& effect, bool on, EffectSettings& settings) {
  if (!find_parameter(effect, kDirectional)) return {};
  return apply_setting(settings, fmt::format("{}.{}={}", effect.name, kDirectional, int(on)), external_effects());
}

Result<const Effect*> filter_of(const CompareSettings& settings) {
  if (settings.filter.empty()) return look_filter(*find_look("ao"));
  if (settings.filter == kNoFilter) return nullptr;
  std::vector<std::string_view> names;
  for (const Effect* effect : effects_with_external())
    if (effect->kind == EffectKind::kFilter) names.push_back(effect->name);
  names.push_back(kNoFilter);
  if (!contains(names, settings.filter))
    return field_error("--filter", settings.filter, "there is no filter '{1}'{2}: it takes {3}",
                       did_you_mean(nearest_name(settings.filter, names)), fmt::join(names, ", "));
  return find_effect(settings.filter);
}

/// Returns the capture settings. If light is compared, they include shadows and, with more than one layer, back sides.
Result<CaptureSettings> capture_with(const CompareSettings& settings, const Request& draw, const Look& look) {
  Look wanted = look;
  auto capture = capture_settings(draw, wanted, settings.light ? kMaxShadows : 0);
  if (settings.light && capture && capture->layers > 1) {
    wanted.back_sides = true;
    capture = capture_settings(draw, wanted, kMaxShadows);
  }
  const auto techniques = techniques_of(settings);
  if (capture && techniques)
    capture->ray_offsets = std::any_of(techniques->begin(), techniques->end(), [](auto* t) { return needs_scene(*t); });
  return capture;
}

/// Returns whether a technique knows only what the view holds.
bool is_screen_space(const Effect& effect) {
  return &effect != &reference_effect() && !needs_scene(effect) && !effect.occluders;
}

/// Returns the recipe of the look `ao` with the user's settings. If light is compared, the filter also filters
/// `indirect`, and ambient light and highlights are off.
Result<Recipe> recipe_of(const CompareSettings& settings) {
  Request draw = settings.draw;
  draw.look = "ao";
  draw.anti_aliasing = 1;  // score the technique without averaging
  if (const auto filter = filter_of(settings); !filter)
    return filter.error();
  else if (*filter && settings.light && find_parameter(**filter, "indirect"))
    draw.settings.insert(draw.settings.begin(), fmt::format("{}.indirect=1", (*filter)->name));
  if (settings.light) {
    draw.settings.push_back("lighting.ambient=0");
    draw.settings.push_back("lighting.specular=0");
  }
  auto recipe = make_recipe(draw);
  if (!recipe) return recipe;
  // Techniques have their defaults in place of the look's settings.
  for (const std::string_view preset : recipe->look->presets)
    if (const Setting set = *parse_setting(preset); set.effect->kind == EffectKind::kOcclusion)
      copy_parameter(*set.parameter, initial_parameters(set.effect->parameters, set.effect->params_size),
                     params_of(recipe->settings, set.effect->name));
  return recipe;
}

/// Returns the radius as an option value; if none is set, the radius of the reference.
std::string radius_text(const CompareSettings& settings) {
  return settings.draw.occlusion_radius.empty() ? reference_radius() : settings.draw.occlusion_radius;
}

/// Returns the estimated work of a variant of a technique, in units of Run. All techniques that trace no rays count
/// alike, since they take a fraction of a second.
double units_of(const Run& run, const Effect& effect) {
  constexpr double kUnitsWithoutRays = 2.0;
  if (&effect != &reference_effect()) return kUnitsWithoutRays;
  return double(as<ReferenceParams>(params_of(run.recipe.settings, effect.name)).samples);
}

/// Returns the estimated work of a picture, in units of Run.
double units_of_picture(const Run& run) {
  double sum = double(run.settings.samples) * (1.0 + double(run.settings.light) + double(run.settings.budget));
  for (const Effect* effect : run.techniques) sum += double(effect->variants.size()) * units_of(run, *effect);
  return sum;
}

/// Runs one technique with its filter, which leaves the results in the frame. Returns the median time, milliseconds.
Result<double> run_technique(const Run& run, const TracedScene& traced, const Effect& effect,
                             const EffectSettings& settings, Frame& frame, const std::string& what) {
  const bool traces = &effect == &reference_effect();
  const double work_units = units_of(run, effect);
  Look look{.name = "compare", .summary = "", .occlusion = effect.name, .effects = {"occlusion"}, .presets = {}};
  if (run.filter && !traces) look.effects.push_back(run.filter->name);
  const auto run_reference = [&](const Effect&, const ParameterBytes& params, Frame& on) -> Result<void> {
    const auto planes = trace_reference(traced, on.info, params, run.control(what, work_units));
    return planes ? run.device.add(*planes, on) : planes.error();
  };
  const LookRun look_run{.look = &look,
                         .occlusion = effect.name,
                         .occlusion_downsampling = run.recipe.occlusion_downsampling,
                         .settings = &settings,
                         .external_effects = external_effects(),
                         .run_external_effect = run_reference};
  return median_time(look_run, run.device, frame, traces ? 1 : run.settings.runs, !traces);
}

/// Divides the error of a picture of occlusion.
ErrorBudget budget_of(const Image& picture, const Truth& truth, const ClassMap& classes) {
  return {covered_rmse(truth.of_view, truth.planes, classes), covered_rmse(picture, truth.of_view, classes)};
}

/// Runs the effect `lighting` on all layers of the frame, with the settings of the recipe.
Result<void> light_frame(const Run& run, Frame& frame) {
  const Effect& lighting = effect_with<LightingParams>();
  const ParameterBytes& params = params_of(run.recipe.settings, lighting.name);
  for (int layer = 0; layer <= int(frame.info.more_layers.size()); ++layer)
    if (auto status = run.device.run(lighting, params, frame, {.layer = layer}); !status) return status.error();
  return {};
}

/// A picture and its ground truths.
struct Picture {
  Frame& frame;
  const Image& normals;  // planes normal.x .y .z
  const ClassMap& classes;
  glm::mat3 axes;  // of the environments, in world space
  const std::vector<Truth>& truths;
  std::string model, camera, what;
  std::pair<int, int> size;
  bool keep = false;                // keep the results
  std::vector<ComparedView> views;  // one per ground truth
  std::array<EnvironmentAmbient, kEnvironments> ambient = {};

  /// Returns the view of a quantity, or null.
  ComparedView* view(Quantity quantity) {
    const auto found = std::find_if(views.begin(), views.end(), [&](auto& v) { return v.quantity == quantity; });
    return found == views.end() ? nullptr : &*found;
  }
};

/// Scores the result `image` of a variant that took `ms`, and keeps it if it is to be shown; under environments only
/// the first variant is.
void add_score(Run& run, Picture& picture, Quantity quantity, const Effect& effect, std::string_view variant, double ms,
               Image image) {
  ComparedView& view = *picture.view(quantity);
  const bool light = quantity != Quantity::kOcclusion;
  const bool divided = !light && run.settings.budget && is_screen_space(effect);
  run.result.scores.push_back(
      {quantity, picture.model, picture.camera, std::string(effect.name), std::string(variant),
       std::string(run.device.name()), view_text(inner_camera(picture.frame.info)), picture.size.first,
       picture.size.second, ms,
       divided ? std::optional(budget_of(image, picture.truths[0], picture.classes)) : std::nullopt,
       light ? score_light(image, view.truth, picture.classes) : score(image, view.truth, picture.classes)});
  if (picture.keep && (int(quantity) < kFirstEnvironment || variant.empty()))
    view.techniques.push_back({std::string(effect.name), std::string(variant), std::move(image)});
}

/// Runs a variant under each environment and scores it. `settings`: those of the variant, which gathers no light. `ms`:
/// its time.
Result<void> compare_environments(Run& run, const TracedScene& traced, const Effect& effect, std::string_view variant,
                                  EffectSettings settings, double ms, Picture& picture) {
  const bool directional = find_parameter(effect, kDirectional) != nullptr;
  if (auto status = set_directional(effect, true, settings); !status) return status;
  for (std::size_t e = 0; e < environments().size(); ++e) {
    const int quantity = kFirstEnvironment + int(e);
    if (!picture.view(Quantity(quantity))) continue;
    if (!run.report_progress(picture.what + ", " + std::string(environments()[e].name))) return interrupted();
    const EnvironmentAmbient& ambient = picture.ambient[e];
    std::vector<std::string> planes = {"ao"};
    if (directional) {
      picture.frame.info.ambient_shape = ambient.shape;
      const auto took = run_technique(run, traced, effect, settings, picture.frame, picture.what);
      picture.frame.info.ambient_shape = {};
      if (!took) return took.error();
      ms = *took;
      planes.insert(planes.end(), {"indirect.r", "indirect.g", "indirect.b"});
    }
    auto image = run.device.download(picture.frame, planes);
    if (!image) return image.error();
    clamp_occlusion(*image);
    add_score(run, picture, Quantity(quantity), effect, variant, ms,
              environment_light(*image, picture.normals, ambient, kQuantityPlanes[std::size_t(quantity)]));
  }
  return {};
}

/// Runs a variant of a technique and scores it for every quantity that it has.
Result<void> compare_variant(Run& run, const TracedScene& traced, const Effect& effect, std::string_view variant,
                             EffectSettings settings, Picture& picture) {
  const ParameterBytes& params = params_of(settings, effect.name);
  const bool gathers_light = writes(effect, params, kQuantityPlanes[1][0]);
  const std::string label = fmt::format("{}, {} {}", picture.what, effect.name, variant);
  if (!run.report_progress(label)) return interrupted();
  const auto ms = run_technique(run, traced, effect, settings, picture.frame, label);
  if (!ms) return ms.error();
  run.done += units_of(run, effect);
  auto occlusion = run.device.download(picture.frame, kQuantityPlanes[int(Quantity::kOcclusion)]);
  if (!occlusion) return occlusion.error();
  clamp_occlusion(*occlusion);
  add_score(run, picture, Quantity::kOcclusion, effect, variant, *ms, std::move(*occlusion));
  if (gathers_light && picture.view(Quantity::kLight)) {
    auto light = run.device.download(picture.frame, kQuantityPlanes[int(Quantity::kLight)]);
    if (!light) return light.error();
    add_score(run, picture, Quantity::kLight, effect, variant, *ms, std::move(*light));
  }
  if (!run.settings.light || gathers_light || &effect == &reference_effect()) return {};
  return compare_environments(run, traced, effect, variant, std::move(settings), *ms, picture);
}

Result<void> compare_picture(Run& run, const Scene& scene, const TracedScene& traced, const std::string& model,
                             const CameraShot& shot, std::pair<int, int> size, bool keep) {
  Request draw = run.settings.draw;
  std::tie(draw.width, draw.height) = size;
  const std::string what = fmt::format("{}, camera {}, {}x{}", model, shot.name, size.first, size.second);
  auto wanted = capture_with(run.settings, draw, *run.recipe.look);
  if (!wanted) return wanted.error();
  for (const Effect* effect : run.techniques)
    wanted->occluders =
        std::max(wanted->occluders, occluders_read(*effect, params_of(run.recipe.settings, effect->name)));
  auto frame = run.device.capture(frame_scene(scene, shot.framing, draw.width, draw.height), *wanted);
  if (!frame) return frame.error();
  if (run.settings.light) {  // no ambient light on the surfaces that rays hit, either
    frame->info.ambient = glm::vec3(0.0f);
    frame->info.ambient_shape = {};
  }
  const auto length = parse_length("occlusion_radius", radius_text(run.settings));
  if (!length) return length.error();
  const auto radius = radius_in_scene("`occlusion_radius`", *length, frame->info);
  if (!radius) return with_field(radius.error(), "occlusion_radius");

  const auto shown = download_gbuffer(run.device, *frame);
  if (!shown) return shown.error();
  const ClassMap classes = classify(*shown);
  const glm::mat3 axes = panorama_axes(scene.up, 0.0f);
  const auto truths = trace_truths(run, traced, frame->info, *radius, classes, axes, what);
  if (!truths) return truths.error();
  Picture picture{*frame, shown->layers[0], classes, axes, *truths, model, shot.name, what, size, keep, {}};
  for (std::size_t e = 0; run.settings.light && e < environments().size(); ++e)
    picture.ambient[e] = ambient_of(environments()[e], glm::mat3(frame->info.camera.view_from_world) * axes);
  for (const Truth& truth : *truths) {
    const bool light = truth.quantity != Quantity::kOcclusion;
    picture.views.push_back({.quantity = truth.quantity,
                             .scene = model,
                             .camera = shot.name,
                             .radius = *radius,
                             .exposure = light ? float(kMiddleGrey / mean_of(truth.planes, classes)) : 1.0f,
                             .truth = truth.planes,
                             .classes = classes,
                             .techniques = {}});
  }
  if (run.settings.light)
    if (auto status = light_frame(run, *frame); !status) return status;
  for (const Effect* effect : run.techniques) {
    for (const std::string_view variant : effect->variants) {
      EffectSettings settings = run.recipe.settings;
      ParameterBytes& params = params_of(settings, effect->name);
      if (effect->set_radius) effect->set_radius(*radius, frame->info, params);
      for (const std::string& setting : draw.settings)
        if (auto status = apply_setting(settings, setting, external_effects()); !status) return status;
      if (auto status = apply_variant(settings, *effect, variant); !status) return status;
      if (auto status = set_directional(*effect, false, settings); !status) return status;
      if (effect == &reference_effect()) {
        auto& reference = as<ReferenceParams>(params);
        reference.light = picture.view(Quantity::kLight) ? kReferenceBounce : kReferenceOcclusion;
        reference.bounce_from = kReferenceFromRadius;
        reference.shadows = kReferenceCapturedShadows;
      }
      if (auto status = compare_variant(run, traced, *effect, variant, std::move(settings), picture); !status)
        return status;
    }
  }
  if (keep)
    for (ComparedView& view : picture.views) run.result.views.push_back(std::move(view));
  return {};
}

}  // namespace

Result<void> check_compare(const CompareSettings& settings) {
  if (settings.models.empty() || settings.sizes.empty()) return usage_error("name a model and a size to compare");
  if (auto status = check_picture_options(settings.models, settings.cameras, settings.samples, settings.runs); !status)
    return status;
  if (const auto techniques = techniques_of(settings); !techniques) return techniques.error();
  const auto recipe = recipe_of(settings);
  if (!recipe) return recipe.error();
  if (settings.budget &&
      as<ReferenceParams>(params_of(recipe->settings, "reference")).occluders != int(Occluders::kAll))
    return field_error("--budget", true, "{} needs the whole ground truth: it takes `reference.occluders` all");
  for (const auto& [width, height] : settings.sizes) {
    Request draw = settings.draw;
    draw.width = width;
    draw.height = height;
    if (const auto capture = capture_with(settings, draw, *recipe->look); !capture) return capture.error();
  }
  return {};
}

Terms terms_of(const CompareSettings& settings) {
  const auto recipe = recipe_of(settings);
  const Effect* filter = *filter_of(settings);
  const ParameterBytes& reference = params_of(recipe->settings, "reference");
  const auto value_text = [&](std::string_view name) {
    return parameter_text(*find_parameter(reference_effect(), name), reference);
  };
  const auto captured = capture_with(settings, settings.draw, *recipe->look);
  return {.radius = radius_text(settings),
          .falloff = value_text("falloff"),
          .normal = value_text("normal"),
          .samples = settings.samples,
          .settings = fmt::format("{}", fmt::join(settings.draw.settings, " ")),
          .guard = fmt::format("{:g}%", settings.draw.guard_band),
          .layers = captured ? captured->layers : 1,
          .extra_views = settings.draw.extra_views.value_or(recipe->look->extra_views),
          .scale = recipe->occlusion_downsampling == 1   ? "full"
                   : recipe->occlusion_downsampling == 2 ? "half"
                                                         : "quarter",
          .filter = filter ? std::string(filter->name) : "",
          .quality = settings.draw.quality};
}

Result<Comparison> compare(Device& device, const CompareSettings& settings) {
  if (auto status = check_compare(settings); !status) return status.error();
  const auto techniques = techniques_of(settings);
  const auto recipe = recipe_of(settings);
  if (!recipe) return recipe.error();

  Comparison result;
  Run run{device, settings, *techniques, *filter_of(settings), *recipe, result};
  result.terms = terms_of(settings);
  double all_pixels = 0.0;
  for (const auto& [width, height] : settings.sizes) all_pixels += double(width) * double(height);
  run.units = units_of_picture(run);
  for (std::size_t m = 0; m < settings.models.size(); ++m) {
    const std::string& model = settings.models[m];
    const double model_span = 1.0 / double(settings.models.size()), model_start = double(m) * model_span;
    auto scene = read_model(settings, model, model_start, result.warnings);
    if (!scene) return scene.error();
    if (auto ready = device.prepare(*scene); !ready) return ready.error();
    const auto traced = build_traced_scene(*scene);
    if (!traced) return traced.error();
    const std::vector<Light> own_lights = scene->lights;
    const std::vector<CameraShot> shots = shots_of(*scene, framing_of(settings.draw.camera), settings.cameras);
    run.start = model_start;
    for (const CameraShot& shot : shots) {
      scene->views = shot.views;
      const auto [width, height] = settings.sizes[0];
      if (own_lights.empty())
        scene->lights = default_lighting(frame_scene(*scene, shot.framing, width, height), scene->up).lights;
      for (std::size_t s = 0; s < settings.sizes.size(); ++s) {
        const auto& size = settings.sizes[s];
        run.span = model_span / double(shots.size()) * double(size.first) * double(size.second) / all_pixels;
        run.done = 0.0;
        if (auto status = compare_picture(run, *scene, **traced, model, shot, size, settings.pictures && s == 0);
            !status)
          return status.error();
        run.start += run.span;
      }
    }
  }
  result.noise = std::sqrt(run.error_sum / double(std::max(run.pictures, 1L)));
  result.light_noise = std::sqrt(run.light_error_sum / double(std::max(run.light_pictures, 1L)));
  result.mean = run.pixels > 0 ? run.truth_sum / double(run.pixels) : 1.0;
  return result;
}

}  // namespace umbrage
