#include <algorithm>
#include <set>

#include "core/check.h"
#include "core/lists.h"
#include "core/registry.h"
#include "core/suggest.h"
#include "effects/effects.h"
#include "looks/looks.h"
#include "looks/metering.h"

namespace umbrage {

// CMake generates looks.inc, with one line per look.
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

std::span<const Look* const> scene_looks() {
  static const std::vector<const Look*> all = [] {
    std::vector<const Look*> kept(looks().begin(), looks().end());
    std::erase_if(kept, [](const Look* look) { return look->needs_beauty; });
    return kept;
  }();
  return all;
}

const Look* find_look(std::string_view name) { return find_named(looks(), name); }

std::vector<std::string_view> occlusion_names(std::span<const Effect* const> external_effects) {
  std::vector<std::string_view> names;
  for (const Effect* effect : all_effects(external_effects))
    if (effect->kind == EffectKind::kOcclusion) names.push_back(effect->name);
  names.push_back(kNoOcclusion);
  return names;
}

namespace {

/// Returns whether a pass of `reader` reads an output of `effect` on a layer beyond the first.
bool reads_on_layers(const Effect& reader, const ParameterBytes& params, const Effect& effect) {
  for (const Dispatch& dispatch : reader.dispatches) {
    if (!runs(dispatch, params)) continue;
    for (const Dispatch& made : effect.dispatches)
      for (const std::string_view output : made.outputs)
        if (contains(dispatch.inputs, layer_plane(1, output))) return true;
  }
  return false;
}

using Steps = std::vector<const Effect*>;

const ParameterBytes& params_of(const LookRun& run, const Effect& effect) {
  return umbrage::params_of(*run.settings, effect.name);
}

/// Removes steps that write neither a requested plane nor a plane that a later step reads.
void keep_needed(const LookRun& run, Steps& steps) {
  std::set<std::string_view> read;
  for (const std::string& plane : *run.wanted) read.insert(name_on_first_layer(plane));
  Steps kept;
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
    const ParameterBytes& params = params_of(run, **step);
    const auto makes_some = [&](const Dispatch& dispatch) {
      return runs(dispatch, params) &&
             std::any_of(dispatch.outputs.begin(), dispatch.outputs.end(),
                         [&](std::string_view plane) { return read.contains(name_on_first_layer(plane)); });
    };
    if (std::none_of((*step)->dispatches.begin(), (*step)->dispatches.end(), makes_some)) continue;
    kept.insert(kept.begin(), *step);
    for (const Dispatch& dispatch : (*step)->dispatches)
      if (runs(dispatch, params))
        for (const std::string_view plane : dispatch.inputs) read.insert(name_on_first_layer(plane));
  }
  steps = std::move(kept);
}

/// Returns whether a later step reads outputs of this step on layers beyond the first.
bool runs_on_layers(const LookRun& run, const Steps& steps, std::size_t step) {
  return std::any_of(steps.begin() + long(step) + 1, steps.end(), [&](const Effect* later) {
    return reads_on_layers(*later, params_of(run, *later), *steps[step]);
  });
}

/// Returns the end of the technique and its filters if `step` is the technique, otherwise `step`.
std::size_t technique_end(const LookRun& run, const Steps& steps, std::size_t step) {
  if (steps[step]->name != run.occlusion) return step;
  ++step;
  while (step < steps.size() && steps[step]->kind == EffectKind::kFilter) ++step;
  return step;
}

/// Returns the end of the steps that run at reduced resolution from `step` on; `step` itself if it does not.
std::size_t reduced_end(const LookRun& run, const Steps& steps, std::size_t step) {
  const bool whole = find_named(run.external_effects, steps[step]->name) || steps[step]->filters_itself;
  return run.occlusion_downsampling == 1 || whole ? step : technique_end(run, steps, step);
}

/// Returns whether a technique, after its run at reduced resolution, computes the pixels that no reduced pixel covers.
bool fills_missing(const LookRun& run, const Effect& technique) {
  return run.occlusion_downsampling == 2 && runs_for_missing(technique, params_of(run, technique));
}

/// Runs one step: on every layer if a later step reads its outputs there, otherwise on the first.
Result<RunState> run_step(const LookRun& run, const Steps& steps, std::size_t step, Device& device, Frame& frame) {
  const Effect& effect = *steps[step];
  const ParameterBytes& params = params_of(run, effect);
  if (find_named(run.external_effects, effect.name)) {
    if (auto status = run.run_external_effect(effect, params, frame); !status) return status.error();
  } else {
    const int layers = runs_on_layers(run, steps, step) ? 1 + int(frame.info.more_layers.size()) : 1;
    for (int layer = 0; layer < layers; ++layer) {
      const auto state = device.run(effect, params, frame, layer, run.pixels, run.monitor);
      if (!state || !state->finished) return state;
    }
  }
  run.after(effect.name);
  return RunState();
}

/// The planes that a range of steps reads from a frame at reduced resolution, and whether the steps write `indirect`.
struct ReducedPlanes {
  std::vector<std::string> read;
  bool light = false;
};

/// Collects the planes of the steps in [first, last).
ReducedPlanes reduced_planes(const LookRun& run, const Steps& steps, std::size_t first, std::size_t last,
                             const PictureInfo& small_info) {
  ReducedPlanes planes;
  std::vector<std::string_view> made;  // by the technique; an earlier run's planes are not reused
  for (const Dispatch& dispatch : steps[first]->dispatches)
    if (runs(dispatch, params_of(run, *steps[first])))
      made.insert(made.end(), dispatch.outputs.begin(), dispatch.outputs.end());
  for (std::size_t step = first; step < last; ++step)
    for (const Dispatch& dispatch : steps[step]->dispatches) {
      const ParameterBytes& params = params_of(run, *steps[step]);
      if (!dispatch.for_all || !runs(dispatch, params)) continue;
      const bool once = !steps[step]->rounds || steps[step]->rounds(params, small_info) == 1;
      for (std::string_view input : dispatch.inputs) {
        if (once && contains(dispatch.later_inputs, input)) continue;
        // Downsampling a plane of the first layer also downsamples it on all other layers.
        if (layer_of_plane(input) == 0 && !contains(made, input) && !contains(planes.read, input))
          planes.read.emplace_back(input);
      }
      planes.light |= contains(dispatch.outputs, "indirect.r");
    }
  return planes;
}

/// Returns the effect that upsamples from reduced to full resolution.
const Effect& filling_effect() {
  const auto all = effects();
  return **std::find_if(all.begin(), all.end(), [](const Effect* effect) { return effect->set_reduction; });
}

/// Runs the steps in [first, last) at reduced resolution and upsamples their occlusion and indirect light to the frame.
/// At factor 2, a technique that supports it computes pixels that no reduced pixel covers at full resolution; at factor
/// 4 there are too many of them.
Result<RunState> run_reduced(const LookRun& run, const Steps& steps, std::size_t first, std::size_t last,
                             Device& device, Frame& frame) {
  const ReducedPlanes planes =
      reduced_planes(run, steps, first, last, reduced_info(frame.info, run.occlusion_downsampling));
  auto small = device.reduced(frame, run.occlusion_downsampling, planes.read);
  if (!small) return small.error();
  for (std::size_t step = first; step < last; ++step) {
    const auto state = run_step(run, steps, step, device, *small);
    if (!state || !state->finished) return state;
  }
  std::vector<std::string> upsampled_planes = {"ao"};
  if (planes.light) upsampled_planes.insert(upsampled_planes.end(), {"indirect.r", "indirect.g", "indirect.b"});
  if (auto status = device.place(*small, upsampled_planes, frame); !status) return status.error();
  const Effect& technique = *steps[first];
  const bool leave = fills_missing(run, technique);
  const Effect& filling = filling_effect();
  ParameterBytes params = params_of(run, filling);
  filling.set_reduction({run.occlusion_downsampling, planes.light, leave}, params);
  auto state = device.run(filling, params, frame, 0, PixelSet::kAll, run.monitor);
  if (state && state->finished && leave)
    state = device.run(technique, params_of(run, technique), frame, 0, PixelSet::kMissing, run.monitor);
  if (state && state->finished) run.after(filling.name);
  return state;
}

/// Runs the effect that exposes the picture, after metering if its parameters ask for it.
Result<LookDone> run_exposed(const LookRun& run, const Effect& effect, Device& device, Frame& frame) {
  ParameterBytes params = params_of(run, effect);
  LookDone state;
  if (const Exposure by = effect.exposure_source(params); by != Exposure::kAsSet) {
    std::optional<float> stops = run.stops;
    if (!stops && by == Exposure::kLights) stops = stops_from_lights(frame.info);
    if (!stops) {
      const auto metered = run.meter(device, frame, by);
      if (!metered) return metered.error();
      stops = *metered;
    }
    state.finished = stops.has_value();
    if (!stops) return state;
    state.stops = *stops;
    effect.add_stops(*stops, params);
  }
  const auto ran = device.run(effect, params, frame, 0, run.pixels, run.monitor);
  if (!ran) return ran.error();
  static_cast<RunState&>(state) = *ran;
  if (state.finished) run.after(effect.name);
  return state;
}

/// Returns the planes, by their names on the first layer, that steps from `next` on read, or that are read after the
/// run. Requires run.kept.
std::set<std::string, std::less<>> needed_planes(const LookRun& run, const Steps& steps, std::size_t next) {
  std::set<std::string, std::less<>> needed;
  const auto add = [&](const auto& names) {
    for (const auto& name : names) needed.emplace(name_on_first_layer(name));
  };
  // A dispatch may write only a part of an output, and then needs its other values.
  const auto add_effect = [&](const Effect& effect) {
    for (const Dispatch& dispatch : effect.dispatches) add(dispatch.inputs), add(dispatch.outputs);
    if (effect.exposure_source) add(kMeteredPlanes);
  };
  add(*run.kept);
  for (std::size_t step = next; step < steps.size(); ++step) {
    add_effect(*steps[step]);
    if (reduced_end(run, steps, step) > step) add_effect(filling_effect());
  }
  return needed;
}

/// Lets the device release planes during this step: those of it that no later step reads.
void release_within(const LookRun& run, const Steps& steps, std::size_t step, Device& device, Frame& frame) {
  if (!run.kept || runs_on_layers(run, steps, step) || find_named(run.external_effects, steps[step]->name)) return;
  const auto needed = needed_planes(run, steps, step + 1);
  std::vector<std::string> unread;
  for (const Dispatch& dispatch : steps[step]->dispatches)
    for (const auto* names : {&dispatch.inputs, &dispatch.outputs})
      for (const std::string_view name : *names)
        if (!needed.contains(name_on_first_layer(name))) unread.emplace_back(name);
  device.release_in_run(frame, std::move(unread));
}

/// Releases the planes that are read neither by steps from `next` on nor after the run.
void release_unread(const LookRun& run, const Steps& steps, std::size_t next, Device& device, Frame& frame) {
  if (!run.kept) return;
  const auto needed = needed_planes(run, steps, next);
  std::vector<std::string> unread = device.plane_names(frame);
  std::erase_if(unread, [&](const std::string& name) { return needed.contains(name_on_first_layer(name)); });
  device.release(frame, unread);
}

}  // namespace

std::vector<const Effect*> steps_of(const LookRun& run) {
  Steps steps;
  bool filtered = false;  // the technique is among the steps, and filters itself
  for (std::string_view name : run.look->effects) {
    if (name == kOcclusionStep) {
      if (run.occlusion == kNoOcclusion) continue;  // `ao` then has its neutral value 1
      name = run.occlusion;
    }
    const Effect* of_others = find_named(run.external_effects, name);
    steps.push_back(of_others ? of_others : find_effect(name));
    if (!steps.back()) fail_check(fmt::format("look {}: there is no effect '{}'", run.look->name, name));
    if (filtered && steps.back()->kind == EffectKind::kFilter)
      steps.pop_back();
    else
      filtered = filtered || steps.back()->filters_itself;
  }
  if (run.wanted) keep_needed(run, steps);
  return steps;
}

std::vector<const Effect*> steps_besides_technique(const LookRun& run) {
  Steps steps = steps_of(run);
  for (std::size_t step = 0; step < steps.size(); ++step)
    steps.erase(steps.begin() + long(step), steps.begin() + long(technique_end(run, steps, step)));
  return steps;
}

bool runs_on_marked(const LookRun& run, std::span<const std::string> planes) {
  const Steps others = steps_besides_technique(run);
  std::set<std::string_view> lacking;
  for (const Effect* effect : steps_of(run))
    if (!contains(others, effect))
      for (const Dispatch& dispatch : effect->dispatches)
        for (const std::string_view plane : dispatch.outputs)
          if (plane != "ao" && !plane.starts_with("indirect.")) lacking.insert(plane);
  for (const Effect* effect : others)
    for (const Dispatch& dispatch : effect->dispatches) {
      if (!runs(dispatch, params_of(run, *effect))) continue;
      if (dispatch.host || dispatch.reach != own_pixel) return false;
      for (const std::string_view input : dispatch.inputs)
        if (lacking.contains(input)) return false;
    }
  return std::none_of(planes.begin(), planes.end(), [&](const std::string& plane) { return lacking.contains(plane); });
}

std::set<std::string> planes_read(const LookRun& run, int layers) {
  std::set<std::string> read;
  const auto add = [&](const Effect& effect, int layer, bool Dispatch::*of_dispatch) {
    for (const Dispatch& dispatch : effect.dispatches)
      if (dispatch.*of_dispatch && runs(dispatch, params_of(run, effect)))
        for (const std::string_view input : dispatch.inputs) read.insert(layer_plane(layer, input));
  };
  const Steps steps = steps_of(run);
  for (std::size_t step = 0; step < steps.size(); ++step) {
    const Effect& effect = *steps[step];
    if (const std::size_t last = reduced_end(run, steps, step); last > step) {
      if (fills_missing(run, effect)) add(effect, 0, &Dispatch::for_missing);
      step = last - 1;
    } else if (!find_named(run.external_effects, effect.name)) {
      const int of_step = !effect.exposure_source && runs_on_layers(run, steps, step) ? layers : 1;
      for (int layer = 0; layer < of_step; ++layer) add(effect, layer, &Dispatch::for_all);
    }
  }
  return read;
}

Result<LookDone> run_look(const LookRun& run, Device& device, Frame& frame) {
  LookDone all;
  const Steps steps = run.pixels == PixelSet::kMarked ? steps_besides_technique(run) : steps_of(run);
  for (std::size_t step = 0; step < steps.size();) {
    const Effect& effect = *steps[step];
    const bool of_others = find_named(run.external_effects, effect.name) != nullptr;
    if (of_others && !run.run_external_effect)
      fail_check(fmt::format("LookRun::run_external_effect is not set; effect '{}' requires it", effect.name));
    std::size_t next = step + 1;
    if (effect.exposure_source) {
      const auto state = run_exposed(run, effect, device, frame);
      if (!state || !state->finished) return state;
      all.stops = state->stops;
    } else {
      const std::size_t last = reduced_end(run, steps, step);
      if (last > step)
        next = last;
      else
        release_within(run, steps, step, device, frame);
      const auto state =
          last > step ? run_reduced(run, steps, step, last, device, frame) : run_step(run, steps, step, device, frame);
      if (!state) return state.error();
      static_cast<RunState&>(all) = *state;
      if (!state->finished) return all;
    }
    step = next;
    release_unread(run, steps, step, device, frame);
  }
  return all;
}

}  // namespace umbrage
