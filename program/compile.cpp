// Compiles a run of a look to a program.
#include <algorithm>
#include <set>

#include "core/check.h"
#include "core/lists.h"
#include "effects/effects.h"
#include "program/program.h"

namespace umbrage {
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

const ParameterBytes& params_in(const LookRun& run, const Effect& effect) {
  return params_of(*run.settings, effect.name);
}

/// Removes steps that write neither a requested plane nor a plane that a later step reads.
void keep_needed(const LookRun& run, Steps& steps) {
  std::set<std::string_view> read;
  for (const std::string& plane : *run.wanted) read.insert(name_on_first_layer(plane));
  Steps kept;
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
    const ParameterBytes& params = params_in(run, **step);
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
    return reads_on_layers(*later, params_in(run, *later), *steps[step]);
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
  return run.occlusion_downsampling == 2 && runs_for_missing(technique, params_in(run, technique));
}

/// The planes that a range of steps reads from a frame at reduced resolution, and whether the steps write `indirect`.
struct ReducedPlanes {
  std::vector<std::string> read;
  bool light = false;
};

/// Collects the planes of the steps in [first, last).
ReducedPlanes reduced_planes(const LookRun& run, const Steps& steps, std::size_t first, std::size_t last,
                             const PictureInfo* small_info) {
  ReducedPlanes planes;
  std::vector<std::string_view> made;  // by these steps; an earlier run's planes of the technique are not reused
  for (const Dispatch& dispatch : steps[first]->dispatches)
    if (runs(dispatch, params_in(run, *steps[first])))
      made.insert(made.end(), dispatch.outputs.begin(), dispatch.outputs.end());
  for (std::size_t step = first; step < last; ++step)
    for (const Dispatch& dispatch : steps[step]->dispatches) {
      const ParameterBytes& params = params_in(run, *steps[step]);
      if (!dispatch.for_all || !runs(dispatch, params)) continue;
      const bool once = !steps[step]->rounds || (small_info && steps[step]->rounds(params, *small_info) == 1);
      for (std::string_view input : dispatch.inputs) {
        if (once && contains(dispatch.later_inputs, input)) continue;
        // Downsampling a plane of the first layer also downsamples it on all other layers.
        if (layer_of_plane(input) == 0 && !contains(made, input) && !contains(planes.read, input))
          planes.read.emplace_back(input);
      }
      planes.light |= contains(dispatch.outputs, "indirect.r");
      made.insert(made.end(), dispatch.outputs.begin(), dispatch.outputs.end());
    }
  return planes;
}

/// Returns the effect that upsamples from reduced to full resolution.
const Effect& filling_effect() {
  const auto all = effects();
  return **std::find_if(all.begin(), all.end(), [](const Effect* effect) { return effect->set_reduction; });
}

}  // namespace

std::vector<const Effect*> steps_of(const LookRun& run) {
  Steps steps;
  bool filtered = false;  // the technique is none or filters itself: the filters after it are left out
  for (std::string_view name : run.look->effects) {
    if (name == kOcclusionStep) {
      filtered = run.occlusion == kNoOcclusion;  // `ao` then has its neutral value 1
      if (filtered) continue;
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
      if (!runs(dispatch, params_in(run, *effect))) continue;
      if (dispatch.host || dispatch.reach != own_pixel) return false;
      for (const std::string_view input : dispatch.inputs)
        if (lacking.contains(input)) return false;
    }
  return std::none_of(planes.begin(), planes.end(), [&](const std::string& plane) { return lacking.contains(plane); });
}

namespace {

/// Collects the operations of a program.
class Compiler {
 public:
  Compiler(const LookRun& run, int layers, const PictureInfo* info) : run_(run), layers_(layers), info_(info) {}

  Program compile() {
    const Steps steps = run_.has_technique ? steps_besides_technique(run_) : steps_of(run_);
    for (std::size_t step = 0; step < steps.size();) {
      const std::size_t last = reduced_end(run_, steps, step);
      if (steps[step]->exposure_source) {
        add_exposed(*steps[step]);
        ++step;
      } else if (last > step) {
        add_reduced(steps, step, last);
        step = last;
      } else {
        add_step(steps, step, 1);
        ++step;
      }
    }
    for (const EffectStep& step : run_.lines)
      add_run({.effect = step.effect, .layer = step.layer, .line = int(&step - run_.lines.data())}, step.params).done =
          step.effect->name;
    std::set<std::string_view> kept;
    if (run_.kept)
      for (const std::string& name : *run_.kept) kept.insert(name_on_first_layer(name));
    for (ProgramPlane& plane : program_.planes)
      plane.kept = !run_.kept || (plane.reduced == 1 && kept.contains(name_on_first_layer(plane.name)));
    for (std::size_t k = 0; k < program_.operations.size(); ++k) {
      const Operation& operation = program_.operations[k];
      for (const auto* planes : {&operation.reads, &operation.writes})
        for (const int id : *planes) program_.planes[std::size_t(id)].last_user = int(k);
    }
    return std::move(program_);
  }

 private:
  int plane(std::string_view name, int reduced) {
    std::vector<ProgramPlane>& planes = program_.planes;
    const auto found = std::find_if(planes.begin(), planes.end(), [&](const ProgramPlane& each) {
      return each.name == name && each.reduced == reduced;
    });
    const int index = int(found - planes.begin());
    if (found == planes.end()) planes.push_back({.name = std::string(name), .reduced = reduced});
    return index;
  }

  Operation& add(Operation operation) { return program_.operations.emplace_back(std::move(operation)); }

  /// Adds an operation that runs the dispatches of its effect.
  Operation& add_run(Operation operation, const ParameterBytes& params) {
    for (const Dispatch& dispatch : operation.effect->dispatches) {
      const bool of_set = operation.pixels == PixelSet::kMissing ? dispatch.for_missing : dispatch.for_all;
      if (!of_set || !runs(dispatch, params)) continue;
      for (const auto& [names, planes] :
           {std::pair(&dispatch.inputs, &operation.reads), std::pair(&dispatch.outputs, &operation.writes)})
        for (const std::string_view name : *names) {
          const int id = operation.layer == 0 ? plane(name, operation.reduced)
                                              : plane(layer_plane(operation.layer, name), operation.reduced);
          if (!contains(*planes, id)) planes->push_back(id);
        }
    }
    return add(std::move(operation));
  }

  /// Adds a step: on every layer if a later step reads its outputs there, otherwise on the first.
  void add_step(const Steps& steps, std::size_t step, int reduced) {
    const Effect& effect = *steps[step];
    const ParameterBytes& params = params_in(run_, effect);
    Operation operation{.effect = &effect, .reduced = reduced};
    int layers = 1;
    if (find_named(run_.external_effects, effect.name))
      operation.kind = OperationKind::kExternal;
    else if (runs_on_layers(run_, steps, step))
      layers = layers_;
    for (operation.layer = 0; operation.layer < layers; ++operation.layer) add_run(operation, params);
    program_.operations.back().done = effect.name;
  }

  /// Adds the steps in [first, last) at reduced resolution, and the upsampling of their occlusion and indirect light.
  /// At factor 2, a technique that supports it computes pixels that no reduced pixel covers at full resolution; at
  /// factor 4 there are too many of them.
  void add_reduced(const Steps& steps, std::size_t first, std::size_t last) {
    const int factor = run_.occlusion_downsampling;
    const std::optional<PictureInfo> small = info_ ? std::optional(reduced_info(*info_, factor)) : std::nullopt;
    const ReducedPlanes planes = reduced_planes(run_, steps, first, last, small ? &*small : nullptr);
    Operation reduce{.kind = OperationKind::kReduce, .reduced = factor};
    for (const std::string& name : planes.read)
      for (int layer = 0; layer < layers_; ++layer) {
        reduce.reads.push_back(plane(layer_plane(layer, name), 1));
        reduce.writes.push_back(plane(layer_plane(layer, name), factor));
      }
    add(reduce);
    for (std::size_t step = first; step < last; ++step) add_step(steps, step, factor);
    Operation place{.kind = OperationKind::kPlace, .reduced = factor};
    for (const char* name : {"ao", "indirect.r", "indirect.g", "indirect.b"}) {
      if (name != std::string_view("ao") && !planes.light) continue;
      place.reads.push_back(plane(name, factor));
      place.writes.push_back(plane(reduced_plane(name), 1));
    }
    add(place);
    const Effect& technique = *steps[first];
    const Effect& filling = filling_effect();
    const bool leave = fills_missing(run_, technique);
    ParameterBytes params = params_in(run_, filling);
    const Reduction reduction{factor, planes.light, leave};
    filling.set_reduction(reduction, params);
    add_run({.effect = &filling, .upsampled = reduction}, params);
    if (leave) add_run({.effect = &technique, .pixels = PixelSet::kMissing}, params_in(run_, technique));
    program_.operations.back().done = filling.name;
  }

  /// Adds the effect that exposes the picture, after metering if its parameters ask for it.
  void add_exposed(const Effect& effect) {
    const ParameterBytes& params = params_in(run_, effect);
    const Exposure by = effect.exposure_source(params);
    if (by != Exposure::kAsSet) {
      Operation meter{.kind = OperationKind::kMeter, .effect = &effect, .exposure = by};
      for (const std::string& name : kMeteredPlanes) meter.reads.push_back(plane(name, 1));
      add(meter);
    }
    add_run({.effect = &effect, .exposure = by}, params).done = effect.name;
  }

  const LookRun& run_;
  const int layers_;
  const PictureInfo* info_;
  Program program_;
};

}  // namespace

Program compile(const LookRun& run, int layers, const PictureInfo* info) {
  return Compiler(run, layers, info).compile();
}

std::vector<std::string> Program::names_of(std::span<const int> indices) const {
  std::vector<std::string> names;
  for (const int plane : indices) names.push_back(planes[std::size_t(plane)].name);
  return names;
}

std::vector<std::string> Program::last_used(std::size_t operation) const {
  std::vector<std::string> names;
  for (const ProgramPlane& plane : planes)
    if (plane.reduced == 1 && !plane.kept && plane.last_user == int(operation) && layer_of_plane(plane.name) == 0)
      names.push_back(plane.name);
  return names;
}

std::set<std::string_view> Program::needed_after(std::size_t operation, std::span<const std::string> kept) const {
  std::set<std::string_view> needed;
  for (const std::string& name : kept) needed.insert(name_on_first_layer(name));
  for (const ProgramPlane& plane : planes)
    if (plane.reduced == 1 && plane.last_user > int(operation)) needed.insert(name_on_first_layer(plane.name));
  return needed;
}

ParameterBytes params_of_operation(const LookRun& run, const Operation& operation, float stops) {
  if (operation.line >= 0) return run.lines[std::size_t(operation.line)].params;
  const Effect& effect = *operation.effect;
  ParameterBytes params = params_in(run, effect);
  if (operation.upsampled) effect.set_reduction(*operation.upsampled, params);
  if (operation.exposure != Exposure::kAsSet) effect.add_stops(stops, params);
  return params;
}

std::set<std::string> planes_read(const Program& program) {
  std::set<std::string> read;
  for (const Operation& operation : program.operations)
    if (operation.kind == OperationKind::kRun && operation.reduced == 1 && !operation.upsampled)
      for (const std::string& name : program.names_of(operation.reads)) read.insert(name);
  return read;
}

}  // namespace umbrage
