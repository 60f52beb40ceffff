#include "renderer/strips.h"

#include <algorithm>
#include <optional>
#include <set>
#include <span>

#include "core/lists.h"
#include "renderer/average.h"
#include "renderer/draw.h"
#include "renderer/marked_samples.h"
#include "renderer/strip_drawer.h"
#include "renderer/strokes.h"
#include "renderer/written_passes.h"

namespace umbrage {
namespace {

/// Memory for drawing, in units of one plane of the whole picture.
struct PlaneCount {
  double held = 0.0;      ///< planes of a frame
  double far = 0.0;       ///< planes that stay whole: dispatches read them at any distance, or host steps make them
  double averaged = 0.0;  ///< sums over the samples
};

/// Estimates the planes needed for drawing, with `captured` planes in each layer. Planes that later dispatches no
/// longer read are counted, too.
PlaneCount count_planes(const Recipe& recipe, int layers, int captured) {
  constexpr double kUniformAndOutput = 7.0;  // uniform planes, and output
  constexpr double kForAverage = 6.0;        // the finished picture and its inputs
  const double reduced = 1.0 / double(recipe.occlusion_downsampling * recipe.occlusion_downsampling);
  constexpr double kForHostStep = 3.0;  // temporary data of a host step: edges, chains and their positions
  double for_host_steps = 0.0;
  std::set<std::string> full, small, far_full, far_small;
  for (const Effect* effect : steps_of(look_run(recipe))) {
    const bool is_small = recipe.occlusion_downsampling > 1 &&
                          (effect->kind == EffectKind::kOcclusion || effect->kind == EffectKind::kFilter);
    const ParameterBytes& params = params_of(recipe.settings, effect->name);
    for (const Dispatch& dispatch : effect->dispatches) {
      if (!runs(dispatch, params)) continue;
      const auto is_drawn = [&](std::string_view plane) { return layer_of_plane(plane) < layers; };
      for (const std::string_view plane : dispatch.outputs)
        if (dispatch.for_all && is_drawn(plane)) (is_small ? small : full).emplace(plane);
      for (const std::string_view plane : dispatch.reach ? dispatch.unbounded_inputs : dispatch.inputs)
        if (is_drawn(plane)) (is_small && dispatch.for_all ? far_small : far_full).emplace(plane);
      if (dispatch.host) far_full.insert(dispatch.outputs.begin(), dispatch.outputs.end());
      if (dispatch.host) for_host_steps += kForHostStep;
    }
  }
  PlaneCount count;
  count.held = double(captured * layers) + kUniformAndOutput + double(full.size());
  if (!small.empty()) count.held += reduced * double(small.size() + std::size_t(captured * layers)) + 8.0;
  count.far = double(far_full.size()) + reduced * double(far_small.size()) + for_host_steps;
  constexpr double kColor = 4.0;
  if (recipe.frames > 1)
    count.averaged = kColor * double(picture_passes(recipe).size()) + double(recipe.averaged.size());
  count.held += recipe.frames > 1 ? kForAverage : 0.0;
  return count;
}

}  // namespace

Result<StripSizes> plan_strips(const Device& device, const Recipe& recipe, double memory, int captured) {
  constexpr double kBytes = sizeof(float);
  constexpr double kFixed = 60e6;               // the program and a scene of 100 000 triangles, bytes
  constexpr double kMargin = 64.0;              // rows above and below a strip, in high pictures
  constexpr double kMarginOfHeight = 0.05;      // the same in low ones, relative to the height
  constexpr int kMinRows = 64, kMaxRows = 512;  // rows of a strip: margins are 2/3 of what is drawn, or 1/5
  const int layers = *layer_count(recipe.capture);
  const PlaneCount count = count_planes(recipe, layers, captured);
  const double width = recipe.width + 2.0 * recipe.capture.guard, height = recipe.height + 2.0 * recipe.capture.guard;
  StripSizes plan;
  const double margins = 2.0 * std::min(kMargin, kMarginOfHeight * height);
  plan.bytes = kFixed + (count.held + count.averaged) * kBytes * width * height;
  const bool traced = find_named(external_effects(), recipe.occlusion);
  const bool fits = width * height * layers <= double(kMaxPixels);
  plan.exceeds = device.draws_strips() && plan.bytes > memory;
  if (fits && plan.bytes <= memory) return plan;
  if (!device.draws_strips() || traced) {
    if (fits) return plan;
    return usage_error(
        "{} of {} x {} pixels {} too large: at most {} pixels in total; "
        "larger pictures are drawn in strips, but not {}",
        layers == 1 ? "one layer" : fmt::format("{} layers", layers), width, height, layers == 1 ? "is" : "are",
        kMaxPixels,
        traced ? "with `occlusion` reference" : fmt::format("on the device {}: try `device` cpu", device.name()));
  }
  const double fixed = kFixed + (count.far + count.averaged) * kBytes * width * height;
  const double row = count.held * kBytes * width;
  const int rows = int(std::clamp((memory - fixed) / row - margins, double(kMinRows), double(kMaxRows)));
  StripSizes strips{.rows = rows / kMinRows * kMinRows};
  strips.bytes = fixed + row * std::min(strips.rows + margins, height);
  strips.exceeds = strips.bytes > memory;
  // Planes that dispatches read at arbitrary distance are whole ones in strips, too.
  return fits && strips.bytes >= plan.bytes ? plan : strips;
}

namespace {

/// Returns the planes `names` of an image.
Image planes_of(const Image& rows, const std::vector<std::string>& names) {
  Image chosen(rows.width, rows.height);
  for (const std::string& name : names) chosen.add(name) = rows.plane(name);
  return chosen;
}

/// Returns the sum of rows of all samples. `sum`: that of the samples before sample 0, whose rows are `rows`.
Result<PictureSum> completed(const Plan& plan, PictureSum sum, const Image& rows, const BlendedSample& blended,
                             int first) {
  Image weighted = planes_of(rows, averaged_planes(plan));
  if (plan.has_blended) blended.weigh_behind(weighted, first);
  add_rows(sum, weighted, 0, rows.height);
  sum.count = plan.pictures();
  return sum;
}

/// Returns the finished rows of an average. `rows`: those of sample 0.
Result<Image> averaged_rows(Device& device, const Plan& plan, PictureSum& sum, const PictureInfo& info,
                            const Image& rows, int first, const std::vector<std::string>& planes) {
  PictureInfo inner = inner_info(info);
  inner.first_row = first;
  inner.whole_rows = inner.height;
  inner.height = rows.height;
  const auto picture = finished_picture(device, sum, plan, planes_of(rows, line_planes(plan)), inner);
  if (!picture) return picture;
  const Image means = mean_planes(sum, other_averaged_planes(plan));
  Image finished(rows.width, rows.height);
  for (const std::string& name : planes) {
    const Plane* made = picture->find(name) ? picture->find(name) : means.find(name);
    finished.add(name) = made ? *made : rows.plane(name);
  }
  return finished;
}

/// Returns the source of the strips of a plan that are captured with `camera`, both as they are at the time.
StripSource scene_source(Device& device, Plan& plan, const Camera& camera, StageTimes& times) {
  const auto captured = [&](const Strip& strip, const ProgressMonitor& monitor) -> Result<Frame> {
    plan.capture.strip = strip;
    auto frame = device.capture(camera, plan.capture, monitor);
    if (!frame) return frame;
    times.done("capture");
    if (auto added = add_sky(device, plan, *frame); !added) return added.error();
    if (plan.recipe.hdri.shown()) times.done("sky");
    if (!plan.marked) return frame;
    if (auto marked = mark_pixels(device, plan, *frame, monitor); !marked) return marked.error();
    return frame;
  };
  return {.run = look_run(plan.recipe),
          .height = plan.capture.height + 2 * plan.capture.guard,
          .guard = plan.capture.guard,
          .lines = plan.lines.empty() ? stroke_parameters_or_none(plan.recipe) : plan.lines,
          .make_frame = captured,
          .after_look = [&](Frame& frame, const ProgressMonitor& monitor) -> Result<RunState> {
            auto state = draw_lines(device, plan, frame, monitor, times);
            if (!state || !state->finished || !plan.marked) return state;
            const int missing = missing_rows_for_marked(device, plan, frame);
            return RunState{missing == 0, missing};
          }};
}

/// Returns `planes` and those that set_background reads.
std::vector<std::string> with_background_planes(const Plan& plan, std::vector<std::string> planes) {
  const auto& captured = plan.capture.planes;
  const bool has_ids = !captured || contains(*captured, "object_id");
  for (const std::string& name : background_planes(planes, plan.has_ground && has_ids))
    if (!contains(planes, name)) planes.push_back(name);
  return planes;
}

/// Draws the further samples of a strip at the pixels that its frame of the first sample marks. Returns their sum.
Result<PictureSum> sum_of_strip(Device& device, const Plan& plan, float stops, const Frame& first, StageTimes& times,
                                const ProgressMonitor& monitor) {
  auto total = begin_sum(device, plan, first);
  LookRun run = look_run(plan.recipe);
  run.after = [&](std::string_view name) { times.done(name); };
  run.monitor = monitor;
  run.stops = stops;
  for (int sample = 1; total && sample < plan.recipe.frames; ++sample) {
    Plan further = plan;
    const Camera camera = begin_marked(further, sample);
    further.capture.strip->margin = 0;
    further.capture.strip->wholes = std::make_shared<WholePlanes>();  // those of sample 0 have the same keys
    auto frame = capture_sample(device, further, camera, &first, monitor);
    if (!frame) return frame.error();
    times.done("capture");
    if (auto shaded = shade_marked(device, further, run, first, *frame); !shaded) return shaded.error();
    if (auto added = add_marked(device, plan, *frame, *total); !added) return added.error();
    times.done("average");
  }
  return total;
}

}  // namespace

Result<Strokes> draw_strips(Device& device, const Plan& planned, int rows, const std::vector<std::string>& requested,
                            bool lines, const TakeRows& take, StageTimes& times, const ProgressMonitor& monitor) {
  Plan plan = planned;
  const std::vector<std::string> planes = with_background_planes(plan, requested);
  StripProgress progress(monitor, plan.marked ? 1 : plan.pictures());
  Camera camera;  // of the current picture
  StripDrawer drawer(device, scene_source(device, plan, camera, times), rows, progress, times);
  PictureSum total{.as_square_roots = plan.recipe.look->averages_square_roots,
                   .per_sample = plan.has_blended ? 2 : 1,
                   .threads = device.threads()};
  BlendedSample blended;
  const std::vector<std::string> averaged = averaged_planes(plan), drawn_lines = line_planes(plan);
  std::vector<std::string> wanted = planes;  // planes of the last picture
  if (plan.averages())
    for (const auto& more : {averaged, drawn_lines})
      for (const std::string& name : more)
        if (!contains(wanted, name)) wanted.push_back(name);
  const auto add = [&](const Frame&, Image& part, int first) -> Result<void> {
    const int height = plan.recipe.height;
    if (plan.capture.blended) {
      Image weighted = planes_of(part, with_blend_planes(averaged));
      blended.take_front(weighted, first, height);
      if (plan.capture.sample == 0) blended.take_lines(part, drawn_lines, first, height);
      part = std::move(weighted);
    } else if (plan.has_blended) {
      blended.weigh_behind(part, first);
    }
    add_rows(total, part, first, height);
    times.done("average");
    return {};
  };
  const auto finish = [&](const Frame& frame, Image& part, int first) -> Result<void> {
    if (plan.averages()) {
      blended.join_lines(part, first);
      auto sum = plan.marked ? sum_of_strip(device, plan, drawer.stops(), frame, times, progress.dispatch_monitor())
                             : completed(plan, rows_of(total, first, part.height), part, blended, first);
      if (!sum) return sum.error();
      auto finished = averaged_rows(device, plan, *sum, frame.info, part, first, planes);
      if (!finished) return finished.error();
      part = std::move(*finished);
      times.done("average");
    }
    set_background(part, frame.info.ground_object);
    return take(frame.info, part, first);
  };
  const std::vector<PictureIndex> pictures = pictures_of(plan);
  const std::size_t before = plan.marked ? 0 : pictures.size() - 1;  // pictures drawn before the last sweeps
  for (const PictureIndex& index : std::span(pictures).first(before)) {
    std::vector<std::string> names = index.blended ? with_blend_planes(averaged) : averaged;
    if (index.blended && index.sample == 0) names.insert(names.end(), drawn_lines.begin(), drawn_lines.end());
    camera = begin_picture(plan, index);
    if (auto status = drawer.draw_picture(names, false, add); !status) return status.error();
  }
  camera = begin_picture(plan, {});
  auto traced = drawer.draw_picture(wanted, lines, finish);
  if (!traced) return traced.error();
  if (auto ended = progress.end(); !ended) return ended.error();
  return traced;
}

}  // namespace umbrage
