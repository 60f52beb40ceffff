#include "renderer/draw.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "core/check.h"
#include "reference/reference.h"
#include "renderer/average.h"
#include "renderer/drawing.h"
#include "renderer/marked_samples.h"

namespace umbrage {

namespace {

/// Returns a callback for the ray tracer of the reference, which may call it from any thread. The callback forwards
/// only calls from the thread that created it, at most once per kMonitorInterval.
std::function<bool(double)> calling_thread_only(const ProgressMonitor& monitor) {
  using Clock = std::chrono::steady_clock;
  return [&monitor, caller = std::this_thread::get_id(), last = Clock::time_point()](double done) mutable {
    if (!monitor || std::this_thread::get_id() != caller || Clock::now() - last < kMonitorInterval) return true;
    last = Clock::now();
    return monitor(done);
  };
}

}  // namespace

RunExternalEffect reference_of(Device& device, const Scene& scene, const Plan& plan, const ProgressMonitor& monitor) {
  return [&, monitor, hierarchy = std::make_shared<TracedScenePtr>()](const Effect&, const ParameterBytes& params,
                                                                      Frame& frame) -> Result<void> {
    if (!*hierarchy) {
      auto traced = build_traced_scene(scene, device.threads(), [&](double) { return monitor(0.0); });
      if (!traced) return traced.error();
      *hierarchy = std::move(*traced);
    }
    const auto planes = trace_reference(**hierarchy, frame.info, params,
                                        {.threads = device.threads(),
                                         .progress = calling_thread_only(monitor),
                                         .min_opacity = plan.capture.blended ? kMinOpacity : kOpaque});
    return planes ? device.add(*planes, frame) : planes.error();
  };
}

namespace {

/// The samples of a plan while they are drawn.
struct Samples {
  Plan plan;  ///< set to the current picture
  PictureDrawing drawing;
  Average average = {};
  std::optional<Frame> first = {};  ///< the frame of sample 0, in the end
};

/// Draws the picture to which the plan is set. All samples have the exposure of the first one that is drawn.
Result<Frame> draw_picture(const PictureIndex& index, Samples& s) {
  const Camera camera = begin_picture(s.plan, index);
  auto frame = s.drawing.capture(s.plan, camera);
  if (!frame) return frame;
  LookRun run = s.drawing.run;
  if (index.sample == 0) run.lines = s.plan.lines;
  run.has_technique = s.drawing.has_technique && s.drawing.is_captured(s.plan);
  const auto state = run_look(run, s.drawing.device, *frame);
  if (!state) return state.error();
  s.drawing.run.stops = state->stops;
  return frame;
}

/// Adds a picture, or the strip to which the plan is set, to the average.
Result<void> add_picture(const Frame& frame, Samples& s) {
  const int begin = s.plan.capture.strip ? s.plan.capture.strip->rows.begin : 0;
  auto added = s.average.add(s.drawing.device, s.plan, frame, begin);
  s.drawing.times.done("average");
  return added;
}

/// Draws all samples of the plan.
Result<void> draw_samples(Samples& s) {
  const auto stops = metered_exposure(s.drawing, s.plan);
  if (!stops) return stops.error();
  s.drawing.run.stops = *stops;
  if (s.plan.averages() && !s.plan.marked) s.average = Average(s.drawing.device, s.plan, {0, s.plan.recipe.height});
  double done = 0.0;
  for (const PictureIndex& index : pictures_of(s.plan)) {
    s.first.reset();  // its memory is reused
    const DrawProgress::Part part(s.drawing.progress, done / s.plan.pictures(), (done + 1.0) / s.plan.pictures());
    auto frame = draw_picture(index, s);
    if (!frame) return frame.error();
    s.first = std::move(*frame);
    if (s.plan.averages() && !s.plan.marked)
      if (auto added = add_picture(*s.first, s); !added) return added;
    ++done;
  }
  if (!s.plan.marked) return {};
  auto average = marked_average(s.drawing, s.plan, *s.first);
  if (!average) return average.error();
  s.average = std::move(*average);
  return {};
}

/// Finishes the average so far in a copy, and passes it on.
Result<void> give_mean(const Samples& s, int samples, const Continuation& more) {
  Frame mean = s.drawing.device.branch(*s.first);
  if (auto finished = finish_average(s.drawing.device, s.average, s.plan, mean); !finished) return finished;
  s.drawing.times.done("average");
  return more.take_mean(mean, samples);
}

/// Draws a sample at all pixels, or its strip to which the plan is set, and adds it.
Result<void> draw_sample(int index, Samples& s) {
  for (const bool in_front : {true, false}) {
    if (in_front && !s.plan.has_blended) continue;
    const auto frame = draw_picture({index, in_front}, s);
    if (!frame) return frame.error();
    if (auto added = add_picture(*frame, s); !added) return added;
  }
  return {};
}

/// Returns the rows above and below a strip that a further sample needs; empty if it cannot be drawn in strips, since
/// it needs the whole picture.
std::optional<int> margin_of_further(const Samples& s) {
  const auto averaged = averaged_planes(s.plan);
  Margins after;
  for (const std::string& name : s.plan.has_blended ? with_blend_planes(averaged) : averaged) after[name] = {};
  const LookRun& run = s.drawing.run;
  const StripNeeds needs = needs_of_strips(run, s.plan.info, {}, s.plan.given.names, after);
  if (!s.drawing.device.draws_strips() || needs.sweeps.size() != 1 || find_named(run.external_effects, run.occlusion))
    return {};
  return std::min(s.plan.given.needed(needs.sweeps[0]).rows, s.plan.info.height);
}

/// Draws rows of a sample, from above, while `more` wants a further part of them. The rows below repeat their mean.
Result<void> draw_part(const Continuation& more, int index, Samples& s) {
  constexpr int kParts = 8, kRowStep = 64;  // min height of a part, since its margins are drawn, too
  const auto margin = margin_of_further(s);
  if (!margin) return {};
  const int height = s.first->info.height;
  const int rows = std::max(height / kParts / kRowStep, 1) * kRowStep;
  int begin = 0;
  for (int end = 0; begin < height; begin = end) {
    end = std::min(begin + rows, height);
    if (!more.wants_part(double(end - begin) / height)) break;
    if (begin == 0) s.average.count_as_one();
    s.plan.capture.strip = Strip{{begin, end}, *margin, std::make_shared<WholePlanes>()};
    if (auto drawn = draw_sample(index, s); !drawn) return drawn;
  }
  s.plan.capture.strip.reset();
  const int guard = s.first->info.guard;  // its rows count for nothing
  if (begin > guard) s.average.repeat_mean(begin - guard);
  return {};
}

/// Draws further samples at all pixels while `more` wants them.
Result<void> draw_further(const Continuation& more, Samples& s) {
  if (!s.plan.averages()) fail_check("further samples of a plan with one picture");
  int samples = s.plan.marked ? 1 : s.plan.recipe.frames;
  s.plan.marked = false;
  s.plan.capture.shadow_rays = s.plan.recipe.capture.shadow_rays;
  const DrawProgress::Part none(s.drawing.progress, 1.0, 1.0);
  for (int index = s.plan.recipe.frames;; ++index, ++samples) {
    if (more.take_mean && (!more.wants_mean || more.wants_mean(samples)))
      if (auto given = give_mean(s, samples, more); !given) return given;
    if (samples >= kMaxProgressiveSamples) return {};
    if (!more.wants_another(samples)) return more.wants_part ? draw_part(more, index, s) : Result<void>();
    s.average.count_as_one();
    if (auto drawn = draw_sample(index, s); !drawn) return drawn;
  }
}

/// Implements draw, draw_captured and draw_after_technique.
Result<Drawn> draw_with(const Frame* captured, bool has_technique, Device& device, const Scene& scene, const Plan& plan,
                        StageTimes& times, const ProgressMonitor& monitor, std::optional<float> stops,
                        const Continuation& more) {
  const ScopedPlanePool pool_scope(device.pool());
  DrawProgress progress(monitor, steps_of_picture(plan));
  Samples s{.plan = plan, .drawing = {device, times, progress, look_run(plan.recipe), captured, has_technique}};
  LookRun& run = s.drawing.run;
  report_to(progress, times, run);
  run.settings = &s.plan.recipe.settings;  // each sample has its own noise
  run.stops = stops;
  run.run_external_effect = reference_of(device, scene, s.plan, run.monitor);
  if (auto status = draw_samples(s); !status) return status.error();
  if (more.wants_another)
    if (auto status = draw_further(more, s); !status) return status.error();
  if (plan.averages()) {
    if (auto finished = finish_average(device, std::move(s.average), s.plan, *s.first); !finished)
      return finished.error();
    times.done("average");
  }
  if (auto ended = progress.end(); !ended) return ended.error();
  return Drawn{std::move(*s.first), run.stops};
}

}  // namespace

Result<Drawn> draw(Device& device, const Scene& scene, const Plan& plan, StageTimes& times,
                   const ProgressMonitor& monitor, std::optional<float> stops, const Continuation& more) {
  return draw_with(nullptr, false, device, scene, plan, times, monitor, stops, more);
}

Result<Frame> capture(Device& device, const Plan& planned, StageTimes& times, const ProgressMonitor& monitor) {
  const ScopedPlanePool pool_scope(device.pool());
  Plan plan = planned;
  auto frame = device.capture(begin_picture(plan, {}), plan.capture, monitor);
  if (!frame) return frame;
  times.done("capture");
  // Devices may defer work; errors appear when it finishes.
  if (auto status = device.finish(); !status) return status.error();
  return frame;
}

bool same_capture(const Plan& a, const Plan& b) {
  return a.camera == b.camera && a.capture == b.capture && !a.averages() && !b.averages() &&
         a.has_ground == b.has_ground;
}

Result<Drawn> draw_captured(Device& device, const Scene& scene, const Plan& plan, const Frame& captured,
                            StageTimes& times, const ProgressMonitor& monitor, std::optional<float> stops) {
  if (plan.averages()) fail_check("one capture for several pictures");
  return draw_with(&captured, false, device, scene, plan, times, monitor, stops, {});
}

const Effect* filtered_technique(const Recipe& recipe) {
  const Effect* technique = find_effect(recipe.occlusion);
  if (!technique || technique->joined_frames.empty()) return nullptr;
  const Parameter& filters = *find_parameter(*technique, technique->filter_switch);
  return int_value(filters, params_of(recipe.settings, technique->name)) != 0 ? technique : nullptr;
}

ParameterBytes params_of_filter(const Effect& technique, int frames, ParameterBytes params) {
  set_int(*find_parameter(technique, technique.joined_frames), frames, params);
  return params;
}

LookRun run_of_technique(Recipe& recipe, std::span<const std::string> given) {
  const Effect* technique = filtered_technique(recipe);
  ParameterBytes filtering;
  if (technique) {
    ParameterBytes& params = params_of(recipe.settings, technique->name);
    filtering = params_of_filter(*technique, 1, params);
    set_int(*find_parameter(*technique, technique->filter_switch), 0, params);
  }
  LookRun run = look_run(recipe);
  run.wanted = {"ao", "indirect.r", "indirect.g", "indirect.b"};
  if (!run.kept) return run;
  run.kept->insert(run.kept->end(), given.begin(), given.end());
  run.kept->insert(run.kept->end(), run.wanted->begin(), run.wanted->end());
  for (const Dispatch& dispatch : technique ? technique->dispatches : std::vector<Dispatch>())
    if (runs(dispatch, filtering)) run.kept->insert(run.kept->end(), dispatch.inputs.begin(), dispatch.inputs.end());
  return run;
}

Result<Frame> draw_technique(Device& device, const Scene& scene, const Plan& planned, StageTimes& times,
                             const ProgressMonitor& monitor) {
  const ScopedPlanePool pool_scope(device.pool());
  Plan plan = planned;
  plan.marked = false;
  const Camera camera = begin_picture(plan, {});
  DrawProgress progress(monitor, steps_of_picture(plan));
  LookRun run = run_of_technique(plan.recipe, plan.given.names);
  const PictureDrawing drawing{device, times, progress, look_run(plan.recipe)};
  report_to(progress, times, run);
  run.run_external_effect = reference_of(device, scene, plan, run.monitor);
  auto frame = drawing.capture(plan, camera);
  if (!frame) return frame;
  const auto state = run_look(run, device, *frame);
  return state ? frame : state.error();
}

Result<Drawn> draw_after_technique(Device& device, const Scene& scene, const Plan& plan, const Frame& frame,
                                   StageTimes& times, const ProgressMonitor& monitor, std::optional<float> stops,
                                   const Continuation& more) {
  return draw_with(&frame, true, device, scene, plan, times, monitor, stops, more);
}

Result<Frame> draw(Device& device, const Scene& scene, const Recipe& recipe, StageTimes& times) {
  const auto plan = make_plan(recipe, scene, device.threads());
  if (!plan) return plan.error();
  auto picture = draw(device, scene, *plan, times);
  return picture ? Result<Frame>(std::move(picture->frame)) : picture.error();
}

Result<Frame> draw(Device& device, const Scene& scene, const Request& request, StageTimes& times) {
  const auto recipe = make_recipe(request);
  return recipe ? draw(device, scene, *recipe, times) : recipe.error();
}

}  // namespace umbrage
