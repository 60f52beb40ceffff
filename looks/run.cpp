#include <algorithm>

#include "core/check.h"
#include "core/registry.h"
#include "core/suggest.h"
#include "effects/effects.h"
#include "effects/output/output.h"
#include "looks/looks.h"
#include "looks/metering.h"

namespace umbrage {

// looks.inc is made by CMake: one line per file.
#define UMBRAGE_LOOK(name) Look look_##name();
#include "looks.inc"
#undef UMBRAGE_LOOK

std::span<const Look* const> looks() {
  static const Look list[] = {
#define UMBRAGE_LOOK(name) look_##name(),
#include "looks.inc"
#undef UMBRAGE_LOOK
  };
  static const std::vector<const Look*> all = pointers_to(list);
  return all;
}

const Look* find_look(std::string_view name) { return find_named(looks(), name); }

namespace {

std::vector<const Effect*> all_effects(std::span<const Effect* const> handed_in) {
  std::vector<const Effect*> all(effects().begin(), effects().end());
  all.insert(all.end(), handed_in.begin(), handed_in.end());
  return all;
}

}  // namespace

std::vector<std::string_view> occlusion_names(std::span<const Effect* const> handed_in) {
  std::vector<std::string_view> names;
  for (const Effect* effect : all_effects(handed_in))
    if (effect->kind == EffectKind::kOcclusion) names.push_back(effect->name);
  names.push_back(kNoOcclusion);
  return names;
}

EffectSettings look_settings(const Look& look, std::span<const Effect* const> handed_in) {
  EffectSettings settings;
  for (const Effect* effect : all_effects(handed_in))
    settings[std::string(effect->name)] = initial_parameters(effect->parameters, effect->params_size);
  for (const std::string_view preset : look.presets)
    if (const auto done = apply_setting(settings, preset, handed_in); !done)
      fail_check(fmt::format("look {}: {}", look.name, done.error().message));
  return settings;
}

Result<void> apply_setting(EffectSettings& settings, std::string_view assignment,
                           std::span<const Effect* const> handed_in) {
  const std::size_t equals = assignment.find('=');
  const std::size_t dot = assignment.substr(0, equals).find('.');
  if (equals == std::string_view::npos || dot == std::string_view::npos)
    return usage_error("'{}' is not a setting: write effect.parameter=value, such as unsharp.kernel=40", assignment);
  const std::string_view owner = assignment.substr(0, dot);
  const std::string_view name = assignment.substr(dot + 1, equals - dot - 1);
  const auto all = all_effects(handed_in);
  const Effect* effect = find_named<Effect>(all, owner);
  if (!effect) {
    std::vector<std::string_view> names;
    names.reserve(all.size());
    for (const Effect* each : all) names.push_back(each->name);
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

namespace {

/// Whether a pass reads, on a layer beyond the first, what `effect` makes.
bool reads_on_layers(const Effect& reader, const ParameterBytes& params, const Effect& effect) {
  for (const Pass& pass : reader.passes) {
    if (pass.needed && !pass.needed(params)) continue;
    for (const Pass& made : effect.passes)
      for (const std::string_view output : made.outputs)
        if (std::find(pass.inputs.begin(), pass.inputs.end(), layer_plane(1, output)) != pass.inputs.end()) return true;
  }
  return false;
}

/// A look's effects in their order, the technique in its place.
using Steps = std::vector<const Effect*>;

const ParameterBytes& params_of(const LookRun& run, const Effect& effect) {
  return run.settings->find(effect.name)->second;
}

/// Runs one step, on every layer where a later one reads what it makes there.
Result<void> run_step(const LookRun& run, const Steps& steps, std::size_t step, Device& device, Frame& frame) {
  const Effect& effect = *steps[step];
  const ParameterBytes& params = params_of(run, effect);
  if (find_named(run.handed_in, effect.name)) {
    if (auto done = run.run_handed_in(effect, params, frame); !done) return done;
  } else {
    const bool on_layers = std::any_of(steps.begin() + long(step) + 1, steps.end(), [&](const Effect* later) {
      return reads_on_layers(*later, params_of(run, *later), effect);
    });
    const int layers = on_layers ? 1 + int(frame.info.more_layers.size()) : 1;
    for (int layer = 0; layer < layers; ++layer)
      if (auto done = device.run(effect, params, frame, layer); !done) return done;
  }
  run.after(effect.name);
  return {};
}

/// Runs the steps from `first` to before `last` at reduced resolution, and brings the occlusion and the light that they
/// make to the frame. What no computed pixel shows, a technique that can computes at full resolution; at a quarter that
/// would be too much.
Result<void> run_reduced(const LookRun& run, const Steps& steps, std::size_t first, std::size_t last, Device& device,
                         Frame& frame) {
  std::vector<std::string> read;
  std::vector<std::string_view> made;  // by the technique: of an earlier run at full resolution nothing is taken
  for (const Pass& pass : steps[first]->passes)
    if (!pass.needed || pass.needed(params_of(run, *steps[first])))
      made.insert(made.end(), pass.outputs.begin(), pass.outputs.end());
  const auto has = [](const auto& names, std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  const PictureInfo small_info = reduced_info(frame.info, run.occlusion_every);
  bool light = false;
  for (std::size_t step = first; step < last; ++step)
    for (const Pass& pass : steps[step]->passes) {
      if (!pass.for_all || (pass.needed && !pass.needed(params_of(run, *steps[step])))) continue;
      const bool once = !steps[step]->rounds || steps[step]->rounds(params_of(run, *steps[step]), small_info) == 1;
      for (std::string_view input : pass.inputs) {
        if (once && has(pass.later_inputs, input)) continue;
        // Every layer's plane of that name is reduced with the first one's.
        if (!input.starts_with("layer") && !has(made, input) && !has(read, input)) read.emplace_back(input);
      }
      light |= has(pass.outputs, "indirect.r");
    }
  auto small = device.reduced(frame, run.occlusion_every, read);
  if (!small) return small.error();
  for (std::size_t step = first; step < last; ++step)
    if (auto done = run_step(run, steps, step, device, *small); !done) return done;
  std::vector<std::string> taken_back = {"ao"};
  if (light) taken_back.insert(taken_back.end(), {"indirect.r", "indirect.g", "indirect.b"});
  if (auto done = device.place(*small, taken_back, frame); !done) return done;
  const Effect& technique = *steps[first];
  const bool leave = run.occlusion_every == 2 && runs_for_missing(technique, params_of(run, technique));
  EffectSettings settings = *run.settings;
  for (const std::string& setting : {fmt::format("upsample.factor={}", run.occlusion_every),
                                     fmt::format("upsample.indirect={}", light ? "on" : "off"),
                                     fmt::format("upsample.leave={}", leave ? "on" : "off")})
    if (auto set = apply_setting(settings, setting, run.handed_in); !set) fail_check(set.error().message);
  if (auto done = device.run(*find_effect("upsample"), settings.find("upsample")->second, frame); !done) return done;
  if (leave)
    if (auto done = device.run(technique, params_of(run, technique), frame, 0, PixelSet::kMissing); !done) return done;
  run.after("upsample");
  return {};
}

/// Runs `output`, with the exposure that suits the picture if that is asked for; returns the stops that are added.
Result<float> run_output(const LookRun& run, Device& device, Frame& frame) {
  const Effect& output = *find_effect("output");
  ParameterBytes bytes = run.settings->find(output.name)->second;
  auto& params = as<OutputParams>(bytes);
  float stops = 0.0f;
  if (params.metering != kMeteringNone) {
    const bool by_light = params.metering == kMeteringLight;
    Result<float> metered = run.stops  ? Result<float>(*run.stops)
                            : by_light ? Result<float>(usual_stops(frame.info))
                                       : run.meter(device, frame);
    if (!metered) return metered;
    stops = *metered;
    params.exposure += stops;
  }
  if (auto done = device.run(output, bytes, frame); !done) return done.error();
  run.after(output.name);
  return stops;
}

}  // namespace

Result<float> run_look(const LookRun& run, Device& device, Frame& frame) {
  float stops = 0.0f;
  Steps steps;
  std::size_t technique = run.look->effects.size();  // none
  for (std::string_view name : run.look->effects) {
    if (name == "occlusion") {
      if (run.occlusion == kNoOcclusion) continue;  // `ao` is then the device's neutral 1
      name = run.occlusion;
      technique = steps.size();
    }
    const Effect* of_others = find_named(run.handed_in, name);
    steps.push_back(of_others ? of_others : find_effect(name));
    if (of_others && !run.run_handed_in) fail_check(fmt::format("nobody runs {}", name));
    if (!steps.back()) fail_check(fmt::format("look {} names no effect: {}", run.look->name, name));
  }
  for (std::size_t step = 0; step < steps.size();) {
    if (step == technique && run.occlusion_every > 1 && !find_named(run.handed_in, run.occlusion)) {
      std::size_t last = step + 1;
      while (last < steps.size() && steps[last]->kind == EffectKind::kFilter) ++last;
      if (auto done = run_reduced(run, steps, step, last, device, frame); !done) return done.error();
      step = last;
    } else {
      if (steps[step]->name == "output") {
        auto metered = run_output(run, device, frame);
        if (!metered) return metered;
        stops = *metered;
      } else if (auto done = run_step(run, steps, step, device, frame); !done) {
        return done.error();
      }
      ++step;
    }
  }
  return stops;
}

}  // namespace umbrage
