#include "renderer/draw.h"

#include <algorithm>
#include <chrono>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <thread>

#include "core/check.h"
#include "core/reflection_map.h"
#include "effects/normals/normals.h"
#include "reference/reference.h"
#include "renderer/average.h"
#include "renderer/marked_samples.h"

namespace umbrage {

double TimeLimit::steady_clock() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

TimeLimit::TimeLimit(double seconds, Clock clock)
    : seconds_(seconds), clock_(std::move(clock)), begin_(clock_()), last_(begin_) {}

bool TimeLimit::fits_another(int samples) {
  const double now = clock_(), duration = now - last_;
  last_ = now;
  if (samples_ > 0) durations_.insert(std::upper_bound(durations_.begin(), durations_.end(), duration), duration);
  samples_ = samples;
  const double expected = durations_.empty() ? duration / samples : durations_[durations_.size() / 2];
  return now - begin_ + expected <= seconds_;
}

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

/// Converts the progress of single steps on a device to the progress of the whole drawing.
class DrawProgress {
 public:
  /// `steps`: number of steps per sample. Work between two steps counts as part of the second step.
  DrawProgress(const ProgressMonitor& monitor, std::size_t steps, int samples)
      : monitor_(monitor), steps_(double(steps)), samples_(samples) {}

  /// Returns the monitor to pass to each step.
  ProgressMonitor step_monitor() {
    return [this](double fraction) { return report(fraction); };
  }
  void step_done() { ++step_; }
  /// The steps that follow are those of a part of the sample, from one fraction of it to another.
  void begin_part(double begin, double end) {
    part_begin_ = begin;
    part_size_ = end - begin;
    step_ = 0;
  }
  void sample_done() {
    ++sample_;
    begin_part(0.0, 1.0);
  }
  /// Reports that all is drawn. Errors: kInterrupted.
  Result<void> end() const { return !monitor_ || monitor_(1.0) ? Result<void>() : interrupted(); }

 private:
  bool report(double fraction) {
    const double of_sample = part_begin_ + part_size_ * std::min((step_ + fraction) / steps_, 1.0);
    // An effect of several dispatches or on several layers restarts at 0 for each; reported progress never decreases.
    reported_ = std::max(reported_, std::min((sample_ + of_sample) / samples_, 1.0));
    return !monitor_ || monitor_(reported_);
  }

  const ProgressMonitor& monitor_;
  const double steps_;
  const int samples_;
  int step_ = 0, sample_ = 0;
  double part_begin_ = 0.0, part_size_ = 1.0;  // fractions of a sample
  double reported_ = 0.0;
};

/// Returns the run of the recipe's look. It reports finished effects to `times` and `progress`.
LookRun timed_look_run(const Recipe& recipe, StageTimes& times, DrawProgress& progress) {
  LookRun run = look_run(recipe);
  run.after = [&times, &progress](std::string_view name) {
    times.done(name);
    progress.step_done();
  };
  run.monitor = progress.step_monitor();
  return run;
}

/// Returns the number of effects of a picture.
std::size_t effect_count(const Plan& plan) { return steps_of(look_run(plan.recipe)).size() + plan.lines.size(); }

/// Adds a picture with its weights.
Result<void> add_weighted(Device& device, const Plan& plan, const Frame& frame, BlendedSample& blended,
                          PictureSum& total) {
  const bool front = plan.capture.blended;
  auto picture = device.download(frame, front ? with_blend_planes(averaged_planes(plan)) : averaged_planes(plan));
  if (!picture) return picture.error();
  if (front)
    blended.take_front(*picture, 0, picture->height);
  else if (plan.has_blended)
    blended.weigh_behind(*picture, 0);
  add_picture(total, *picture);
  return {};
}

/// The samples of a plan while they are drawn.
struct Samples {
  Plan plan;  ///< set to the current picture
  LookRun run;
  const GetFrame& get_frame;
  const bool in_strips;  ///< get_frame can return strips of further samples
  DrawProgress& progress;
  StageTimes& times;
  PictureSum sum;
  BlendedSample blended = {};       ///< of sample 0 in the end
  std::optional<Frame> first = {};  ///< the frame of sample 0, in the end
};

/// Draws a further sample, `plan` and `camera` being set to it, and adds it to the sum. It is drawn in strips if the
/// device can, unless it is captured already: then its planes take little memory beside those of the first sample.
Result<void> draw_further_marked(Device& device, const Plan& plan, const Camera& camera, const FirstSample& first,
                                 Samples& s) {
  constexpr int kStrips = 8;               // in most pictures: an eighth of the memory of a frame
  constexpr int kPixelsOfStrip = 1 << 19;  // in large pictures: memory that is small beside that of the program
  constexpr int kRowStep = 64;             // min height, since rows beside a strip are captured with it, too
  const int height = first.behind.info.height;
  const int wanted_rows = std::min(height / kStrips, kPixelsOfStrip / first.behind.info.width);
  const int rows = s.in_strips ? std::max(wanted_rows / kRowStep, 1) * kRowStep : height;
  for (int begin = 0; begin < height; begin += rows) {
    Plan part = plan;
    const int end = std::min(begin + rows, height);
    s.progress.begin_part(double(begin) / height, double(end) / height);
    if (rows < height) part.capture.strip = Strip{{begin, end}, 0, std::make_shared<WholePlanes>()};
    if (auto drawn = draw_marked(device, part, camera, first, s.get_frame, s.run, &s.sum); !drawn) return drawn;
    s.times.done("average");
  }
  return {};
}

/// Draws the samples of a plan at the pixels that its first sample marks.
Result<void> draw_marked_samples(Device& device, Samples& s) {
  if (s.plan.has_blended) {
    const auto stops = metered_with_blended(device, s.plan, s.get_frame, s.run);
    if (!stops) return stops.error();
    if (*stops) s.run.stops = *stops;
  }
  LookRun look = s.run;
  look.lines = s.plan.lines;
  auto behind = capture_first(device, s.plan, begin_picture(s.plan, {}), s.get_frame, s.run.monitor);
  if (!behind) return behind.error();
  const auto state = run_look(look, device, *behind);
  if (!state) return state.error();
  s.run.stops = state->stops;
  s.progress.sample_done();
  auto first = complete_first(device, s.plan, std::move(*behind), s.in_strips, s.get_frame, &s.run);
  if (!first) return first.error();
  auto sum = begin_sum(device, s.plan, *first);
  if (!sum) return sum.error();
  s.sum = std::move(*sum);
  if (s.plan.has_blended) s.progress.sample_done();
  // finish_average adds the picture again.
  if (s.run.kept) device.release(first->behind, averaged_picture(s.plan));
  if (s.run.kept && first->front) device.release(*first->front, averaged_picture(s.plan));
  for (int sample = 1; sample < s.plan.recipe.frames; ++sample) {
    Plan further = s.plan;
    const Camera camera = begin_marked(further, sample);
    if (auto added = draw_further_marked(device, further, camera, *first, s); !added) return added;
    s.progress.sample_done();
    if (s.plan.has_blended) s.progress.sample_done();
  }
  s.first = std::move(first->behind);
  return {};
}

/// Draws a picture of the plan, and adds it if there are several.
Result<Frame> draw_picture(Device& device, const PictureIndex& index, BlendedSample& blended, Samples& s) {
  const Camera camera = begin_picture(s.plan, index);
  auto frame = s.get_frame(s.plan, camera);
  if (!frame) return frame;
  if (auto added = add_sky(device, s.plan, *frame); !added) return added.error();
  if (s.plan.recipe.hdri.shown()) s.times.done("sky");
  LookRun run = s.run;
  if (index.sample == 0) run.lines = s.plan.lines;
  const auto state = run_look(run, device, *frame);
  if (!state) return state.error();
  s.run.stops = state->stops;  // one exposure for all samples
  if (!s.plan.averages()) return frame;
  if (auto added = add_weighted(device, s.plan, *frame, blended, s.sum); !added) return added.error();
  s.times.done("average");
  if (index.blended && index.sample == 0) {
    const auto lines = device.download(*frame, line_planes(s.plan));
    if (!lines) return lines.error();
    blended.take_lines(*lines, lines->names, 0, lines->height);
  }
  s.progress.sample_done();
  return frame;
}

/// Draws all pixels of the samples of a plan.
Result<void> draw_whole(Device& device, Samples& s) {
  for (const PictureIndex& index : pictures_of(s.plan)) {
    s.first.reset();  // its memory is reused
    auto frame = draw_picture(device, index, s.blended, s);
    if (!frame) return frame.error();
    s.first = std::move(*frame);
  }
  return {};
}

/// Finishes the average so far in a copy, and passes it on.
Result<void> give_mean(Device& device, const Samples& s, int samples, const Continuation& more) {
  PictureSum sum = s.sum;
  Frame mean = device.branch(*s.first);
  if (auto finished = finish_average(device, sum, s.plan, s.blended, mean); !finished) return finished;
  s.times.done("average");
  return more.take_mean(mean, samples);
}

/// Draws further samples at all pixels while `more` wants them.
Result<void> draw_further(Device& device, const Continuation& more, Samples& s) {
  if (!s.plan.averages()) fail_check("further samples of a plan with one picture");
  int samples = s.plan.marked ? 1 : s.plan.recipe.frames;
  s.plan.marked = false;
  s.plan.capture.shadow_rays = s.plan.recipe.capture.shadow_rays;
  for (int index = s.plan.recipe.frames;; ++index, ++samples) {
    if (more.take_mean && (!more.wants_mean || more.wants_mean(samples)))
      if (auto given = give_mean(device, s, samples, more); !given) return given;
    if (!more.wants_another(samples) || samples >= kMaxProgressiveSamples) return {};
    count_as_one(s.sum);
    BlendedSample blended;
    for (const bool in_front : {true, false})
      if (s.plan.has_blended || !in_front)
        if (auto frame = draw_picture(device, {index, in_front}, blended, s); !frame) return frame.error();
  }
}

/// Draws all samples and averages them. `in_strips`: get_frame can return strips of further samples.
Result<Drawn> draw_samples(Device& device, const Scene& scene, const Plan& plan, const GetFrame& get_frame,
                           bool in_strips, DrawProgress& progress, StageTimes& times, std::optional<float> stops,
                           const Continuation& more = {}) {
  const ProgressMonitor step_monitor = progress.step_monitor();
  TracedScenePtr hierarchy;  // for the reference; built once for all samples
  Samples s{.plan = plan,
            .run = timed_look_run(plan.recipe, times, progress),
            .get_frame = get_frame,
            .in_strips = in_strips,
            .progress = progress,
            .times = times,
            .sum = {.as_square_roots = plan.recipe.look->averages_square_roots,
                    .per_sample = plan.has_blended ? 2 : 1,
                    .threads = device.threads()}};
  s.run.settings = &s.plan.recipe.settings;  // each sample has its own noise
  s.run.stops = stops;
  s.run.run_external_effect = [&](const Effect&, const ParameterBytes& params, Frame& current) -> Result<void> {
    if (!hierarchy) {
      auto traced = build_traced_scene(scene, device.threads(), [&](double) { return step_monitor(0.0); });
      if (!traced) return traced.error();
      hierarchy = std::move(*traced);
    }
    const auto planes = trace_reference(*hierarchy, current.info, params,
                                        {.threads = device.threads(),
                                         .progress = calling_thread_only(step_monitor),
                                         .min_opacity = s.plan.capture.blended ? kMinOpacity : kOpaque});
    return planes ? device.add(*planes, current) : planes.error();
  };
  if (auto status = s.plan.marked ? draw_marked_samples(device, s) : draw_whole(device, s); !status)
    return status.error();
  if (more.wants_another)
    if (auto status = draw_further(device, more, s); !status) return status.error();
  if (s.plan.averages()) {
    if (auto finished = finish_average(device, s.sum, s.plan, s.blended, *s.first); !finished) return finished.error();
    times.done("average");
  }
  if (auto ended = progress.end(); !ended) return ended.error();
  return Drawn{std::move(*s.first), s.run.stops};
}

}  // namespace

Result<void> add_sky(Device& device, const Plan& plan, Frame& frame) {
  if (!plan.recipe.hdri.shown()) return {};
  const int height = frame.info.height;
  const Rows rows = plan.capture.strip ? rows_with_margin(*plan.capture.strip, height) : Rows{0, height};
  return device.add(sky_planes(plan.recipe.hdri, plan.up, plan.sky_gain, frame.info, rows), frame);
}

Result<Drawn> draw(Device& device, const Scene& scene, const Plan& plan, StageTimes& times,
                   const ProgressMonitor& monitor, std::optional<float> stops, const Continuation& more) {
  const ScopedPlanePool pool_scope(device.pool());
  DrawProgress progress(monitor, 1 + effect_count(plan), plan.pictures());
  const ProgressMonitor step_monitor = progress.step_monitor();
  const auto captured = [&](const Plan& sample, const Camera& camera) {
    auto frame = device.capture(camera, sample.capture, step_monitor);
    times.done("capture");
    progress.step_done();
    return frame;
  };
  return draw_samples(device, scene, plan, captured, device.draws_strips(), progress, times, stops, more);
}

namespace {

/// Captures all pixels of the samples of a plan.
Result<void> capture_whole(Plan plan, const GetFrame& get) {
  for (const PictureIndex& index : pictures_of(plan)) {
    const Camera camera = begin_picture(plan, index);
    if (auto frame = get(plan, camera); !frame) return frame.error();
  }
  return {};
}

/// Captures the samples of a plan at the pixels that its first sample marks.
Result<void> capture_marked(Device& device, Plan plan, const GetFrame& get) {
  if (plan.has_blended)
    if (auto small = metered_with_blended(device, plan, get, look_run(plan.recipe)); !small) return small.error();
  auto behind = capture_first(device, plan, begin_picture(plan, {}), get, {});
  if (!behind) return behind.error();
  const auto first = complete_first(device, plan, std::move(*behind), false, get, nullptr);
  if (!first) return first.error();
  for (int sample = 1; sample < plan.recipe.frames; ++sample) {
    Plan further = plan;
    const Camera camera = begin_marked(further, sample);
    if (auto captured = draw_marked(device, further, camera, *first, get, {}, nullptr); !captured) return captured;
  }
  return {};
}

}  // namespace

Result<Captures> capture(Device& device, const Plan& plan, StageTimes& times, const ProgressMonitor& monitor) {
  const ScopedPlanePool pool_scope(device.pool());
  DrawProgress progress(monitor, 1, plan.pictures());
  const ProgressMonitor step_monitor = progress.step_monitor();
  Captures captures;
  const GetFrame get = [&](const Plan& sample, const Camera& camera) {
    auto frame = device.capture(camera, sample.capture, step_monitor);
    if (frame) captures.push_back(*frame);
    times.done("capture");
    progress.sample_done();
    return frame;
  };
  if (auto status = plan.marked ? capture_marked(device, plan, get) : capture_whole(plan, get); !status)
    return status.error();
  // Devices may defer work; errors appear when it finishes.
  if (auto status = device.finish(); !status) return status.error();
  if (auto ended = progress.end(); !ended) return ended.error();
  return captures;
}

bool same_captures(const Plan& a, const Plan& b) {
  const auto marking = [](const Plan& plan) {
    return plan.marked ? marking_step(plan, plan.info).params : ParameterBytes();
  };
  return marking(a) == marking(b) && a.camera == b.camera && a.capture == b.capture &&
         a.recipe.frames == b.recipe.frames && a.has_blended == b.has_blended && a.marked == b.marked &&
         a.has_ground == b.has_ground;
}

Result<Drawn> draw_captured(Device& device, const Scene& scene, const Plan& plan, const Captures& captures,
                            StageTimes& times, const ProgressMonitor& monitor, std::optional<float> stops) {
  const ScopedPlanePool pool_scope(device.pool());
  DrawProgress progress(monitor, std::max<std::size_t>(effect_count(plan), 1), plan.pictures());
  std::size_t next = 0;
  const auto branch_of_capture = [&](const Plan&, const Camera&) {
    return Result<Frame>(device.branch(captures.at(next++)));
  };
  return draw_samples(device, scene, plan, branch_of_capture, false, progress, times, stops);
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

namespace {

/// Uploads a G-buffer and reconstructs missing normals.
Result<Frame> upload_with_normals(Device& device, GBuffer gbuffer, const EffectSettings& settings) {
  std::vector<bool> has_normals;
  for (const Image& layer : gbuffer.layers) has_normals.push_back(layer.find("normal.x") != nullptr);
  auto frame = device.upload(std::move(gbuffer));
  if (!frame) return frame;
  const Effect& normals = effect_with<NormalsParams>();
  for (std::size_t layer = 0; layer < has_normals.size(); ++layer)
    if (!has_normals[layer])
      if (auto status = device.run(normals, params_of(settings, normals.name), *frame, {.layer = int(layer)}); !status)
        return status.error();
  return frame;
}

/// Places the default lights of a look for a G-buffer, in view space, where they do not depend on the camera's
/// position.
void place_default_lights(const Recipe& recipe, PictureInfo& info) {
  Camera at_origin = info.camera;
  at_origin.view_from_world = glm::mat4(1.0f);
  // Seen from above, the vertical points towards the camera.
  const glm::vec3 up = recipe.from_above ? glm::vec3(0.0f, 0.0f, 1.0f) : glm::vec3(0.0f, 1.0f, 0.0f);
  const bool studio = recipe.look->studio_lights;
  const Lighting lighting = studio ? studio_lighting(at_origin, up) : default_lighting(at_origin, up);
  info.lights = lighting.lights;
  if (recipe.from_above) info.lights.resize(1);  // the fill and the rim light would fill its shadows with other slopes
  info.ambient = lighting.ambient;
  info.ambient_shape = lighting.ambient_shape;
  const glm::mat3 world_from_view = glm::transpose(glm::mat3(info.camera.view_from_world));
  if (studio && info.has_roughness) info.reflections = studio_reflections(world_from_view[1]);
  adjust_lights(recipe, at_origin, recipe.look->studio_lights, info.lights);
}

}  // namespace

Result<Recipe> complete_shading(const Recipe& requested, PictureInfo& info) {
  Recipe recipe = requested;
  if (info.lights.empty() && !recipe.effects_look) place_default_lights(recipe, info);
  if (recipe.radius) {
    const auto radius = radius_in_scene("`occlusion_radius`", *recipe.radius, info);
    if (!radius) return with_field(radius.error(), "occlusion_radius");
    apply_radius(*radius, info, recipe);
  }
  return recipe;
}

Result<Drawn> shade_planes(Device& device, GBuffer gbuffer, const Recipe& requested, StageTimes& times,
                           const ProgressMonitor& monitor, std::optional<float> stops) {
  gbuffer.info = info_of(gbuffer);
  const auto recipe = complete_shading(requested, gbuffer.info);
  if (!recipe) return recipe.error();
  DrawProgress progress(monitor, 1 + recipe->look->effects.size(), 1);
  auto frame = upload_with_normals(device, std::move(gbuffer), recipe->settings);
  if (!frame) return frame.error();
  progress.step_done();
  times.done("upload");
  LookRun run = timed_look_run(*recipe, times, progress);
  run.stops = stops;
  const auto state = run_look(run, device, *frame);
  if (!state) return state.error();
  if (auto ended = progress.end(); !ended) return ended.error();
  return Drawn{std::move(*frame), state->stops};
}

}  // namespace umbrage
