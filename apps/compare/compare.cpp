#include "apps/compare/compare.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/suggest.h"
#include "effects/effects.h"
#include "reference/reference.h"
#include "scene/framing.h"

namespace umbrage {
namespace {

constexpr float kTurnDeg = 120.0f;  // from one camera around a file's model to the next
constexpr int kTurns = 3;           // after which the first one comes again
// Seeds of the truth's two halves, away from those that people give to the technique `reference`.
constexpr std::uint32_t kFirstSeed = 0x51ed2701u, kSecondSeed = 0x0b5e77edu;

/// The truth of one picture.
struct Truth {
  Image ao;            ///< the plane `ao`
  double error = 0.0;  ///< mean square over covered pixels of its own noise
  double sum = 0.0;    ///< over covered pixels, of which there are
  long pixels = 0;
};

/// Traces the truth as the mean of two independent halves; their difference tells its noise.
Result<Truth> trace_truth(const TracedScene& traced, const PictureInfo& info, const ReferenceParams& params,
                          float radius, int samples, const ClassMap& classes, const TraceControl& control) {
  OcclusionSettings half{.samples = samples / 2,
                         .radius = radius,
                         .falloff = Falloff(params.falloff),
                         .normal = HemisphereNormal(params.normal),
                         .seed = kFirstSeed};
  auto first = trace_occlusion(traced, info, half, control);
  if (!first) return first.error();
  half.seed = kSecondSeed;
  const auto second = trace_occlusion(traced, info, half, control);
  if (!second) return second.error();
  Truth truth;
  truth.ao = Image(info.inner_width(), info.inner_height());
  Plane& mean = truth.ao.add("ao");
  const Plane a = cropped(first->plane("ao"), info.guard), b = cropped(second->plane("ao"), info.guard);
  double errors = 0.0;
  for (int y = 0; y < mean.height; ++y)
    for (int x = 0; x < mean.width; ++x) {
      mean.at(x, y) = 0.5f * (a.at(x, y) + b.at(x, y));
      if (classes.row(y)[x] == PixelClass::kBackground) continue;
      const double half_difference = 0.5 * (double(a.at(x, y)) - double(b.at(x, y)));
      errors += half_difference * half_difference;
      truth.sum += mean.at(x, y);
      ++truth.pixels;
    }
  truth.error = truth.pixels > 0 ? errors / double(truth.pixels) : 0.0;
  return truth;
}

/// Cameras of a scene: the views that it suggests, or turns around it.
struct Shot {
  std::string name;
  Framing framing;
  std::vector<View> views;
};

std::vector<Shot> shots_of(const Scene& scene, const CompareSettings& settings) {
  const Framing& wish = settings.draw.framing;
  if (wish.position || wish.focal_point || wish.direction) return {{"given", wish, {}}};
  std::vector<Shot> shots;
  const int count = std::min(settings.cameras, scene.views.empty() ? kTurns : int(scene.views.size()));
  for (int k = 0; k < count; ++k) {
    Shot shot{fmt::format("{}", k + 1), wish, {}};
    if (scene.views.empty())
      shot.framing.azimuth_deg += kTurnDeg * float(k);
    else
      shot.views = {scene.views[k]};
    shots.push_back(shot);
  }
  return shots;
}

Result<std::vector<const Effect*>> techniques_of(const CompareSettings& settings) {
  std::vector<const Effect*> all;
  for (const Effect* effect : every_effect())
    if (effect->kind == EffectKind::kOcclusion) all.push_back(effect);
  if (settings.techniques.empty()) return all;
  std::vector<std::string_view> names;
  for (const Effect* effect : all) names.push_back(effect->name);
  std::vector<const Effect*> chosen;
  for (const std::string& name : settings.techniques) {
    if (name == "all") return all;
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end())
      return usage_error("there is no occlusion technique '{}' to compare{}", name, suggestion(name, names));
    const Effect* effect = all[std::size_t(found - names.begin())];
    if (std::find(chosen.begin(), chosen.end(), effect) == chosen.end()) chosen.push_back(effect);
  }
  return chosen;
}

/// The radius as it would be written: the reference's own where nobody says.
std::string radius_text(const CompareSettings& settings) {
  if (!settings.draw.radius.empty()) return settings.draw.radius;
  const Effect& reference = reference_effect();
  return parameter_text(*find_parameter(reference, "radius"),
                        initial_parameters(reference.parameters, reference.params_size));
}

/// A camera in numbers, rounded so that another compiler's last bits do not matter.
std::string view_text(const Camera& camera) {
  const glm::vec3 eye = camera.eye();
  const glm::mat4& m = camera.view_from_world;
  return fmt::format("{} {:.3g} {:.3g} {:.3g}, {:.2f} {:.2f} {:.2f}, {:.3g} {:.3g} {:.3g} {:.3g}",
                     camera.projection == Projection::kOrthographic ? "orthographic" : "perspective", eye.x, eye.y,
                     eye.z, -m[0][2], -m[1][2], -m[2][2], camera.left, camera.right, camera.bottom, camera.top);
}

GBuffer downloaded(Device& device, const Frame& frame) {
  GBuffer gbuffer;
  gbuffer.info = inner_info(frame.info);
  if (auto planes = device.download(frame, {"depth", "normal.x", "normal.y", "normal.z"}))
    gbuffer.layers.push_back(std::move(*planes));
  else
    fail_check(planes.error().message);
  return gbuffer;
}

/// Occlusion as it is seen: an unsharp mask also brightens, and its shade may exceed 1.
void clamp_to_shown(Plane& ao) {
  for (int y = 0; y < ao.height; ++y)
    for (int x = 0; x < ao.width; ++x) ao.at(x, y) = std::clamp(ao.at(x, y), 0.0f, 1.0f);
}

/// Everything about one run that does not change from picture to picture.
struct Run {
  Device& device;
  const CompareSettings& settings;
  std::vector<const Effect*> techniques;
  Recipe recipe;
  Comparison& result;
  double error_sum = 0.0, truth_sum = 0.0;
  long pictures = 0, pixels = 0;

  TraceControl control(const std::string& what) const {
    return {device.threads(),
            [this, what](double done) { return settings.progress(fmt::format("{}: {:.0f} %", what, 100.0 * done)); }};
  }
};

/// Runs one technique; its `ao` is then in the frame. Gives the median time.
Result<double> run_technique(const Run& run, const TracedScene& traced, const Effect& effect,
                             const ParameterBytes& params, Frame& frame, const std::string& what) {
  const bool traces = &effect == &reference_effect();
  std::vector<double> ms;
  for (int k = traces ? 1 : 0; k <= (traces ? 1 : run.settings.runs); ++k) {
    StageTimes times;
    Image planes;
    if (traces) {
      auto made = trace_reference(traced, frame.info, params, run.control(what));
      if (!made) return made.error();
      planes = std::move(*made);
    } else if (auto done = run.device.run(effect, params, frame); !done) {
      return done.error();
    }
    times.done("run");
    if (k > 0) ms.push_back(times.total());
    if (traces)
      if (auto added = run.device.add(planes, frame); !added) return added.error();
  }
  std::sort(ms.begin(), ms.end());
  return ms[ms.size() / 2];
}

Result<void> compare_picture(Run& run, const Scene& scene, const TracedScene& traced, const std::string& model,
                             const Shot& shot, std::pair<int, int> size, bool keep) {
  DrawSettings draw = run.settings.draw;
  std::tie(draw.width, draw.height) = size;
  const std::string what = fmt::format("{}, camera {}, {}x{}", model, shot.name, size.first, size.second);
  const auto capture_with = capture_settings(draw, *run.recipe.look, 0);
  if (!capture_with) return capture_with.error();
  auto frame = run.device.capture(frame_scene(scene, shot.framing, draw.width, draw.height), *capture_with);
  if (!frame) return frame.error();
  const auto length = parse_radius("--ao-radius", radius_text(run.settings));
  if (!length) return length.error();
  const auto radius = radius_in_scene("--ao-radius", *length, frame->info);
  if (!radius) return radius.error();

  const ClassMap classes = classify(downloaded(run.device, *frame));
  const auto& reference = as<ReferenceParams>(run.recipe.settings.find("reference")->second);
  const auto truth = trace_truth(traced, frame->info, reference, *radius, run.settings.samples, classes,
                                 run.control(what + ", truth"));
  if (!truth) return truth.error();
  const Plane& truth_plane = truth->ao.plane("ao");
  if (truth->pixels == 0) return usage_error("{} shows nothing: move the camera or leave it to be placed", what);
  run.error_sum += truth->error;
  ++run.pictures;
  run.truth_sum += truth->sum;
  run.pixels += truth->pixels;

  ComparedView view{model, shot.name, *radius, truth_plane, classes, {}};
  for (const Effect* effect : run.techniques) {
    for (const std::string_view variant : effect->variants) {
      EffectSettings settings = run.recipe.settings;
      ParameterBytes& params = settings.find(effect->name)->second;
      if (effect->set_radius) effect->set_radius(*radius, frame->info, params);
      for (const std::string& setting : draw.settings)
        if (auto done = apply_setting(settings, setting, handed_in()); !done) return done;
      if (auto done = apply_variant(settings, *effect, variant); !done) return done;
      if (effect == &reference_effect()) as<ReferenceParams>(params).light = 0;  // occlusion alone is compared
      const std::string label = fmt::format("{}, {} {}", what, effect->name, variant);
      if (!run.settings.progress(label)) return Error{ErrorKind::kInterrupted, "interrupted"};
      const auto ms = run_technique(run, traced, *effect, params, *frame, label);
      if (!ms) return ms.error();
      auto ao = run.device.download(*frame, {"ao"});
      if (!ao) return ao.error();
      clamp_to_shown(ao->plane("ao"));
      run.result.scores.push_back({model, shot.name, std::string(effect->name), std::string(variant),
                                   std::string(run.device.name()), view_text(inner_camera(frame->info)), size.first,
                                   size.second, *ms, score(*ao, truth->ao, classes)});
      if (keep) view.techniques.push_back({std::string(effect->name), std::string(variant), ao->plane("ao")});
    }
  }
  if (keep) run.result.views.push_back(std::move(view));
  return {};
}

}  // namespace

Result<void> check_compare(const CompareSettings& settings) {
  constexpr int kMostCameras = 100, kMostRuns = 1000;
  if (settings.cameras < 1 || settings.cameras > kMostCameras)
    return usage_error("--cameras cannot be {}: it takes 1 to {}", settings.cameras, kMostCameras);
  if (settings.runs < 1 || settings.runs > kMostRuns)
    return usage_error("--runs cannot be {}: it takes 1 to {}", settings.runs, kMostRuns);
  if (settings.models.empty() || settings.sizes.empty()) return usage_error("name a model and a size to compare");
  if (settings.samples < 2 || settings.samples > kMostSamples || settings.samples % 2 != 0)
    return usage_error("--samples cannot be {}: it takes an even number from 2 to {}", settings.samples, kMostSamples);
  if (const auto techniques = techniques_of(settings); !techniques) return techniques.error();
  for (const std::string& model : settings.models)
    if (std::count(settings.models.begin(), settings.models.end(), model) > 1)
      return usage_error("the model '{}' is named twice", model);
  const auto recipe = make_recipe(settings.draw);
  if (!recipe) return recipe.error();
  for (const auto& [width, height] : settings.sizes) {
    DrawSettings draw = settings.draw;
    draw.width = width;
    draw.height = height;
    if (const auto capture = capture_settings(draw, *recipe->look, 0); !capture) return capture.error();
  }
  return {};
}

Terms terms_of(const CompareSettings& settings) {
  DrawSettings draw = settings.draw;
  draw.look = "ao";
  const auto recipe = make_recipe(draw);
  const ParameterBytes& reference = recipe->settings.find("reference")->second;
  const auto said = [&](std::string_view name) {
    return parameter_text(*find_parameter(reference_effect(), name), reference);
  };
  return {.radius = radius_text(settings),
          .falloff = said("falloff"),
          .normal = said("normal"),
          .samples = settings.samples,
          .settings = fmt::format("{}", fmt::join(settings.draw.settings, " ")),
          .guard = fmt::format("{:g}%", settings.draw.guard_percent),
          .layers = settings.draw.layers.value_or(recipe->look->layers),
          .extra_views = settings.draw.extra_views.value_or(recipe->look->extra_views)};
}

Result<Comparison> compare(Device& device, const CompareSettings& settings) {
  if (auto fine = check_compare(settings); !fine) return fine.error();
  const auto techniques = techniques_of(settings);
  DrawSettings draw = settings.draw;
  draw.look = "ao";
  const auto recipe = make_recipe(draw);
  if (!recipe) return recipe.error();

  Comparison result;
  Run run{device, settings, *techniques, *recipe, result};
  result.terms = terms_of(settings);
  for (const std::string& model : settings.models) {
    if (!settings.progress(model)) return Error{ErrorKind::kInterrupted, "interrupted"};
    auto scene = load_scene(model, settings.import);
    if (!scene) return scene.error();
    result.warnings.insert(result.warnings.end(), scene->warnings.begin(), scene->warnings.end());
    if (auto ready = device.prepare(*scene); !ready) return ready.error();
    const auto traced = trace_ready(*scene);
    if (!traced) return traced.error();
    for (const Shot& shot : shots_of(*scene, settings)) {
      scene->views = shot.views;
      for (std::size_t s = 0; s < settings.sizes.size(); ++s)
        if (auto done =
                compare_picture(run, *scene, **traced, model, shot, settings.sizes[s], settings.pictures && s == 0);
            !done)
          return done.error();
    }
  }
  result.noise = std::sqrt(run.error_sum / double(std::max(run.pictures, 1L)));
  result.mean = run.pixels > 0 ? run.truth_sum / double(run.pixels) : 1.0;
  return result;
}

}  // namespace umbrage
