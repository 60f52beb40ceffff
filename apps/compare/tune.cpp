#include "apps/compare/tune.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <list>
#include <optional>
#include <set>

#include "apps/compare/pictures.h"
#include "effects/effects.h"
#include "reference/reference.h"

namespace umbrage {
namespace {

constexpr double kTruthFraction = 0.3;  // fraction of the progress before the first trial; a rough guess
constexpr std::array<std::string_view, 3> kScales = {"full", "half", "quarter"};
// Max time, relative to the budget, of a trial that the search continues from.
constexpr double kMaxTimeFactor = 1.3;
// Errors count as equal if they differ by at most this fraction.
constexpr double kEqualErrorTolerance = 0.005;
// Factor of one step of a number.
constexpr double kStep = 1.4142135623730951;

/// The settings of a trial.
struct Candidate {
  EffectSettings settings;
  int every = 1;  ///< downsampling factor of occlusion, see LookRun
};

/// A captured picture, ready to be shaded, with its ground truth.
struct Picture {
  Frame frame;
  Truth truth;
  ClassMap classes;
};

/// The state of a search.
struct Search {
  Device& device;
  const TuneSettings& settings;
  Recipe recipe;
  const Effect* technique;
  const Effect* filter;
  std::vector<Picture> pictures;
  std::vector<Candidate> candidates;  ///< candidates of the trials, in the same order
  std::vector<Trial> trials;
  std::set<std::string> known;  ///< names of all candidates that were tried
};

/// Returns the next lower and higher value of a number. Integers step through 1, 2, 3, 4, 6, 8, 12 ...
std::vector<double> step_values(double value, bool whole) {
  if (!whole) return {value / kStep, value * kStep};
  const auto rung = [](double v, bool up) {
    // Powers of 2, and 1.5 times powers of 2.
    double best = up ? 1e9 : 0.0;
    for (double power = 1.0; power < 1e6; power *= 2.0)
      for (const double r : {power, 1.5 * power}) {
        if (r != std::floor(r)) continue;
        if (up && r > v) best = std::min(best, r);
        if (!up && r < v) best = std::max(best, r);
      }
    return best;
  };
  return {rung(value, false), rung(value, true)};
}

/// Returns the values one step away from a parameter's value, as text.
std::vector<std::string> beside(const Parameter& row, const ParameterBytes& bytes) {
  const std::string now = parameter_text(row, bytes);
  std::vector<std::string> texts;
  if (row.type == ParameterType::kBool) return {now == "on" ? "off" : "on"};
  if (row.type == ParameterType::kChoice) {
    for (const std::string_view choice : row.choices)
      if (choice != now) texts.emplace_back(choice);
    return texts;
  }
  const bool fraction = now.ends_with('%');
  double value = 0.0;
  std::from_chars(now.data(), now.data() + now.size(), value);
  if (value == 0.0) return {};
  for (double next : step_values(value, row.type == ParameterType::kInt)) {
    if (!fraction) next = std::clamp(next, row.min, row.max);
    std::string text = fmt::format("{:.3g}{}", next, fraction ? "%" : "");
    if (text != now) texts.push_back(std::move(text));
  }
  return texts;
}

/// Returns the tunable settings of technique and filter as "effect.parameter=value".
std::vector<std::string> settings_of(const Search& search, const Candidate& candidate) {
  std::vector<std::string> all;
  for (const Effect* effect : {search.technique, search.filter}) {
    if (!effect) continue;
    for (const std::string_view name : effect->tunable)
      all.push_back(
          fmt::format("{}.{}={}", effect->name, name,
                      parameter_text(*find_parameter(*effect, name), params_of(candidate.settings, effect->name))));
  }
  return all;
}

std::string scale_name(int every) { return std::string(kScales[every == 1 ? 0 : every == 2 ? 1 : 2]); }

/// Runs and scores a candidate on all pictures and adds it to the trials. Does nothing if it was tried before.
Result<void> attempt(Search& search, Candidate candidate) {
  const std::vector<std::string> settings = settings_of(search, candidate);
  std::string name = scale_name(candidate.every);
  for (const std::string& setting : settings) name += ' ' + setting;
  if (!search.known.insert(name).second) return {};
  const int max = search.settings.trials;
  const double tried = double(search.trials.size()) / double(max);
  if (!search.settings.progress(fmt::format("trial {} of at most {}", search.trials.size() + 1, max),
                                kTruthFraction + (1.0 - kTruthFraction) * tried))
    return interrupted();

  Look look{
      .name = "tune", .summary = "", .occlusion = search.technique->name, .effects = {"occlusion"}, .presets = {}};
  if (search.filter) look.effects.push_back(search.filter->name);
  const LookRun look_run{.look = &look,
                         .occlusion = search.technique->name,
                         .occlusion_downsampling = candidate.every,
                         .settings = &candidate.settings};
  Trial trial{.settings = {}, .scale = scale_name(candidate.every)};
  double squares = 0.0, sum = 0.0;
  long pixels = 0;
  for (Picture& picture : search.pictures) {
    const auto ms = median_time(look_run, search.device, picture.frame, search.settings.runs);
    if (!ms) return ms.error();
    trial.ms += *ms / double(search.pictures.size());
    auto made = search.device.download(picture.frame, kQuantityPlanes[int(Quantity::kOcclusion)]);
    if (!made) return made.error();
    clamp_occlusion(*made);
    const ScoreCard card = score(*made, picture.truth.planes, picture.classes);
    squares += card.covered.rmse * card.covered.rmse * double(picture.truth.pixels);
    sum += card.covered.bias * double(picture.truth.pixels);
    pixels += picture.truth.pixels;
  }
  trial.rmse = std::sqrt(squares / double(pixels));
  trial.bias = sum / double(pixels);
  if (!search.trials.empty()) {
    const std::vector<std::string> start = settings_of(search, search.candidates[0]);
    for (std::size_t k = 0; k < settings.size(); ++k)
      if (settings[k] != start[k]) trial.settings.push_back(settings[k]);
  }
  search.trials.push_back(std::move(trial));
  search.candidates.push_back(std::move(candidate));
  return {};
}

void mark_frontier(std::vector<Trial>& trials) {
  for (Trial& trial : trials)
    trial.frontier = std::none_of(trials.begin(), trials.end(), [&](const Trial& other) {
      return other.ms <= trial.ms && other.rmse <= trial.rmse && (other.ms < trial.ms || other.rmse < trial.rmse);
    });
}

/// Returns whether the user set this parameter.
bool is_fixed(const Request& draw, std::string_view effect, std::string_view name) {
  const std::string start = fmt::format("{}.{}=", effect, name);
  return std::any_of(draw.settings.begin(), draw.settings.end(),
                     [&](const std::string& setting) { return setting.starts_with(start); });
}

/// Returns the candidates one step away from another.
Result<std::vector<Candidate>> steps_from(const Search& search, const Candidate& from) {
  const Request& draw = search.settings.draw;
  std::vector<Candidate> next;
  const int max_every = search.technique->filters_itself ? 1 : 4;  // such a technique runs at full resolution only
  for (int every = 1; every <= max_every; every *= 2)
    if (every != from.every && draw.occlusion_scale.empty()) next.push_back({from.settings, every});
  for (const Effect* effect : {search.technique, search.filter}) {
    if (!effect) continue;
    for (const std::string_view name : effect->tunable) {
      if (is_fixed(draw, effect->name, name)) continue;
      for (const std::string& value : beside(*find_parameter(*effect, name), params_of(from.settings, effect->name))) {
        Candidate candidate = from;
        if (auto set = apply_setting(candidate.settings, fmt::format("{}.{}={}", effect->name, name, value)); !set)
          return set.error();
        next.push_back(std::move(candidate));
      }
    }
  }
  return next;
}

/// Returns the radius as an option value: the user's, else that of the technique in this look, else that of the
/// reference.
std::string radius_text(const Request& draw, const Recipe& recipe, const Effect& technique) {
  if (!draw.occlusion_radius.empty()) return draw.occlusion_radius;
  const Parameter* own = find_parameter(technique, "radius");
  if (own && own->type == ParameterType::kLength && technique.set_radius)
    return parameter_text(*own, params_of(recipe.settings, technique.name));
  return reference_radius();
}

Result<Recipe> recipe_of(const TuneSettings& settings) {
  Request draw = settings.draw;
  draw.anti_aliasing = 1;
  return make_recipe(draw);
}

Result<const Effect*> technique_of(const Recipe& recipe) {
  const Effect* technique = find_effect(recipe.occlusion);
  if (!technique || technique->tunable.empty())
    return field_error("occlusion", recipe.occlusion,
                       "`{}` {} has no settings to search: name another technique, such as bitmask");
  return technique;
}

/// Captures all pictures of a model and traces their ground truth.
Result<void> take_pictures(Search& search, std::size_t model_index, Scene& scene,
                           const std::string& radius_as_written) {
  const std::string& model = search.settings.models[model_index];
  const TuneSettings& settings = search.settings;
  if (auto ready = search.device.prepare(scene); !ready) return ready;
  const auto traced = build_traced_scene(scene);
  if (!traced) return traced.error();
  auto capture = capture_settings(settings.draw, *search.recipe.look, 0);
  if (!capture) return capture.error();
  const Effect& technique = **technique_of(search.recipe);
  capture->ray_offsets = needs_scene(technique);
  capture->occluders = occluders_read(technique, params_of(search.recipe.settings, technique.name));
  const auto length = parse_length("occlusion_radius", radius_as_written);
  if (!length) return length.error();
  const std::vector<CameraShot> shots = shots_of(scene, framing_of(settings.draw.camera), settings.cameras);
  // Each ground truth is traced in two halves.
  const double half_span = kTruthFraction / double(settings.models.size()) / double(2 * shots.size());
  double halves = double(2 * shots.size()) * double(model_index);
  for (const CameraShot& shot : shots) {
    scene.views = shot.views;
    auto frame =
        search.device.capture(frame_scene(scene, shot.framing, settings.draw.width, settings.draw.height), *capture);
    if (!frame) return frame.error();
    const auto radius = radius_in_scene("`occlusion_radius`", *length, frame->info);
    if (!radius) return with_field(radius.error(), "occlusion_radius");
    const std::string what = fmt::format("{}, camera {}, truth", model, shot.name);
    const TraceControl control{search.device.threads(),
                               [&](double done) { return settings.progress(what, half_span * (halves + done)); }};
    const auto shown = download_gbuffer(search.device, *frame);
    if (!shown) return shown.error();
    ClassMap classes = classify(*shown);
    auto truth = trace_truth(Quantity::kOcclusion, frame->info, classes, [&](std::uint32_t seed) {
      auto half = trace_occlusion(**traced, frame->info,
                                  {.samples = settings.samples / 2, .radius = *radius, .seed = seed}, control);
      halves += 1.0;
      return half;
    });
    if (!truth) return truth.error();
    if (truth->pixels == 0)
      return usage_error("nothing of '{}' is in view of camera {}: move the camera or omit the camera options", model,
                         shot.name);
    search.pictures.push_back({std::move(*frame), std::move(*truth), std::move(classes)});
  }
  return {};
}

/// Returns the options of `umbrage render` that select a trial.
std::vector<std::string> options_of(const Search& search, const Trial& best, const std::string& radius) {
  const Request& draw = search.settings.draw;
  std::vector<std::string> words = {"--look", std::string(search.recipe.look->name)};
  const auto add = [&](const std::string& name, const std::string& value) {
    if (!value.empty()) words.insert(words.end(), {name, value});
  };
  add("--quality", draw.quality);
  add("--ao", std::string(search.technique->name));
  add("--ao-radius", radius);
  add("--ao-scale", best.scale);
  if (draw.layers) add("--layers", fmt::format("{}", *draw.layers));
  if (draw.extra_views) add("--extra-views", fmt::format("{}", *draw.extra_views));
  if (draw.guard_band > 0.0f) add("--guard-band", fmt::format("{:g}%", draw.guard_band));
  for (const std::string& setting : draw.settings) add("--set", setting);
  for (const std::string& setting : best.settings) add("--set", setting);
  return words;
}

bool any_within(const std::vector<Trial>& trials, double budget_ms) {
  return std::any_of(trials.begin(), trials.end(), [&](const Trial& trial) { return trial.ms <= budget_ms; });
}

/// Returns the trial to search from next, one on the frontier that was not searched from yet: the closest of those near
/// the budget, or the fastest while no trial is within it. Returns nothing if there is none.
std::optional<std::size_t> next_start(const std::vector<Trial>& trials, double budget_ms,
                                      const std::set<std::size_t>& searched) {
  const bool within = any_within(trials, budget_ms);
  std::optional<std::size_t> from;
  for (std::size_t k = 0; k < trials.size(); ++k) {
    const Trial& trial = trials[k];
    if (!trial.frontier || searched.count(k) || (within && trial.ms > kMaxTimeFactor * budget_ms)) continue;
    if (!from || (within ? trial.rmse < trials[*from].rmse : trial.ms < trials[*from].ms)) from = k;
  }
  return from;
}

/// Returns the trial with the fewest changes among those within the budget with about the min error there. Errors:
/// kInternal if none is within the budget.
Result<std::size_t> best_of(const std::vector<Trial>& trials, double budget_ms) {
  std::optional<double> closest;  // min error within the budget
  for (const Trial& trial : trials)
    if (trial.ms <= budget_ms && (!closest || trial.rmse < *closest)) closest = trial.rmse;
  if (!closest) {
    const auto fastest =
        std::min_element(trials.begin(), trials.end(), [](const Trial& a, const Trial& b) { return a.ms < b.ms; });
    return Error{ErrorKind::kInternal,
                 fmt::format("none of the {} settings tried takes {:g} ms or less, the fastest takes {:.3g} ms: raise "
                             "--time or --trials, or lower --resolution",
                             trials.size(), budget_ms, fastest->ms)};
  }
  const auto rank = [&](const Trial& trial) {
    const std::size_t changes = trial.settings.size() + (trial.scale != trials[0].scale ? 1 : 0);
    return std::pair(changes, trial.rmse);
  };
  std::optional<std::size_t> best;
  for (std::size_t k = 0; k < trials.size(); ++k)
    if (trials[k].ms <= budget_ms && trials[k].rmse <= *closest * (1.0 + kEqualErrorTolerance) &&
        (!best || rank(trials[k]) < rank(trials[*best])))
      best = k;
  return *best;
}

}  // namespace

Result<void> check_tune(const TuneSettings& settings) {
  if (settings.models.empty()) return usage_error("name a model to tune");
  if (auto status = check_picture_options(settings.models, settings.cameras, settings.samples, settings.runs); !status)
    return status;
  if (!kTrials.has(settings.trials))
    return field_error("--trials", settings.trials, "{} cannot be '{}': it takes {}", kTrials.words());
  if (!kBudgetMs.has(settings.budget_ms))
    return field_error("--time", settings.budget_ms, "{} cannot be '{}': it takes {}", kBudgetMs.words());
  const auto recipe = recipe_of(settings);
  if (!recipe) return recipe.error();
  if (const auto technique = technique_of(*recipe); !technique) return technique.error();
  if (const auto capture = capture_settings(settings.draw, *recipe->look, 0); !capture) return capture.error();
  return {};
}

Result<Tuning> tune(Device& device, const TuneSettings& settings) {
  if (auto status = check_tune(settings); !status) return status.error();
  const auto recipe = recipe_of(settings);
  const Effect* technique = *technique_of(*recipe);
  const Effect* filter = technique->filters_itself ? nullptr : look_filter(*recipe->look);
  std::list<Scene> scenes;  // rays of a technique may visit them as long as the pictures live
  Search search{device, settings, *recipe, technique, filter, {}, {}, {}, {}};
  Tuning result{.technique = std::string(technique->name),
                .filter = filter ? std::string(filter->name) : "",
                .radius = radius_text(settings.draw, *recipe, *technique)};

  for (std::size_t m = 0; m < settings.models.size(); ++m) {
    const double done = kTruthFraction * double(m) / double(settings.models.size());
    auto scene = read_model(settings, settings.models[m], done, result.warnings);
    if (!scene) return scene.error();
    if (auto taken = take_pictures(search, m, scenes.emplace_back(std::move(*scene)), result.radius); !taken)
      return taken.error();
  }
  Candidate start{recipe->settings, recipe->occlusion_downsampling};
  const Frame& first = search.pictures[0].frame;
  if (technique->set_radius)
    if (const auto length = parse_length("occlusion_radius", result.radius); length)
      if (const auto radius = radius_in_scene("`occlusion_radius`", *length, first.info); radius)
        technique->set_radius(*radius, first.info, params_of(start.settings, technique->name));
  if (auto status = attempt(search, start); !status) return status.error();
  result.budget_ms = settings.budget_ms > 0.0 ? settings.budget_ms : search.trials[0].ms;

  std::set<std::size_t> searched;
  while (int(search.trials.size()) < settings.trials) {
    mark_frontier(search.trials);
    const auto from = next_start(search.trials, result.budget_ms, searched);
    if (!from) break;
    searched.insert(*from);
    const double from_ms = search.trials[*from].ms;
    const auto next = steps_from(search, search.candidates[*from]);
    if (!next) return next.error();
    for (const Candidate& candidate : *next) {
      const std::size_t tried = search.trials.size();
      if (int(tried) >= settings.trials) break;
      if (auto status = attempt(search, candidate); !status) return status.error();
      // Over the budget, a faster trial is the next start; the other steps from here follow once the budget is met.
      if (!any_within(search.trials, result.budget_ms) && search.trials.size() > tried &&
          search.trials.back().ms < from_ms) {
        searched.erase(*from);
        break;
      }
    }
  }
  mark_frontier(search.trials);
  const auto best = best_of(search.trials, result.budget_ms);
  if (!best) return best.error();
  result.start = search.trials[0];
  result.best = search.trials[*best];
  result.options = options_of(search, result.best, settings.draw.occlusion_radius);
  result.trials = std::move(search.trials);
  return result;
}

}  // namespace umbrage
