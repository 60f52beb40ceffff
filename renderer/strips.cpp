#include "renderer/strips.h"

#include <algorithm>
#include <optional>
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

/// Returns the source of the strips of a plan without frames.
StripSource source_of(const Plan& plan) {
  StripSource source{.run = look_run(plan.recipe),
                     .info = plan.info,
                     .lines = plan.lines.empty() ? stroke_parameters_or_none(plan.recipe) : plan.lines,
                     .given = plan.given};
  source.run.lines = plan.lines;
  if (!plan.marked) return source;
  source.before.push_back(marking_step(plan, plan.info));
  add_margins_for_further(plan, plan.info, source.after);
  return source;
}

/// Returns the source of the strips of a plan that are captured with `camera`, both as they are at the time.
StripSource scene_source(Device& device, Plan& plan, const Camera& camera, StageTimes& times) {
  StripSource source = source_of(plan);
  source.make_frame = [&](const Strip& strip, const ProgressMonitor& monitor) -> Result<Frame> {
    plan.capture.strip = strip;
    const GetFrame get = [&](const Plan& sample, const Camera& from) {
      return device.capture(from, sample.capture, monitor);
    };
    auto frame = plan.marked ? capture_first(device, plan, camera, get, monitor) : get(plan, camera);
    if (!frame) return frame;
    times.done("capture");
    if (auto added = add_sky(device, plan, *frame); !added) return added.error();
    if (plan.recipe.hdri.shown()) times.done("sky");
    return frame;
  };
  return source;
}

/// Returns `planes` and those that set_background reads.
std::vector<std::string> with_background_planes(const Plan& plan, std::vector<std::string> planes) {
  const auto& captured = plan.capture.planes;
  const bool has_ids = !captured || contains(*captured, "object_id");
  for (const std::string& name : background_planes(planes, plan.has_ground && has_ids))
    if (!contains(planes, name)) planes.push_back(name);
  return planes;
}

/// Draws the further samples of a strip, and the first one of its blended surfaces. `behind`: the first one without
/// them. Returns the sum of all samples.
Result<PictureSum> sum_of_strip(Device& device, const Plan& plan, float stops, const Frame& behind, StageTimes& times,
                                const ProgressMonitor& monitor) {
  LookRun run = look_run(plan.recipe);
  run.after = [&](std::string_view name) { times.done(name); };
  run.monitor = monitor;
  run.stops = stops;
  const GetFrame get = [&](const Plan& sample, const Camera& camera) {
    auto frame = device.capture(camera, sample.capture, monitor);
    times.done("capture");
    return frame;
  };
  Plan of_first = plan;
  of_first.capture.strip->wholes = std::make_shared<WholePlanes>();  // those of other frames have the same keys
  const auto first = complete_first(device, of_first, behind, true, get, &run);
  if (!first) return first.error();
  auto total = begin_sum(device, plan, *first);
  for (int sample = 1; total && sample < plan.recipe.frames; ++sample) {
    Plan further = of_first;
    const Camera camera = begin_marked(further, sample);
    further.capture.strip->margin = 0;
    if (auto drawn = draw_marked(device, further, camera, *first, get, run, &*total); !drawn) return drawn.error();
    times.done("average");
  }
  return total;
}

}  // namespace

Result<StripSizes> plan_strips(const Device& device, const Plan& plan, double memory) {
  constexpr double kForPicture = 8.0;  // the finished picture and its inputs, besides those of lines
  constexpr double kMasks = 2.0;
  SumPlanes sum;
  if (plan.averages()) {
    const double averaged = double(averaged_planes(plan).size());
    sum.finished = averaged + kForPicture + double(line_planes(plan).size());
    sum.blended = plan.marked && plan.has_blended;
    if (plan.marked)
      sum.marked = averaged + kMasks;
    else
      sum.held = averaged;
  }
  return plan_strips(device, source_of(plan), sum, memory);
}

Result<Strokes> draw_strips(Device& device, const Plan& planned, int rows, const std::vector<std::string>& requested,
                            bool lines, const TakeRows& take, StageTimes& times, const ProgressMonitor& monitor) {
  Plan plan = planned;
  const std::vector<std::string> planes = with_background_planes(plan, requested);
  StripProgress progress(monitor, plan.marked ? 1 : plan.pictures());
  Camera camera;  // of the current picture
  StripSource source = scene_source(device, plan, camera, times);
  if (plan.marked && plan.has_blended) {
    const GetFrame get = [&](const Plan& sample, const Camera& from) { return device.capture(from, sample.capture); };
    auto stops = metered_with_blended(device, plan, get, source.run);
    if (!stops) return stops.error();
    source.run.stops = *stops;
  }
  StripDrawer drawer(device, std::move(source), rows, progress, times);
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
    drawer.set_lines(index.sample == 0 ? plan.lines : std::vector<EffectStep>());
    if (auto status = drawer.draw_picture(names, false, add); !status) return status.error();
  }
  camera = begin_picture(plan, {});
  drawer.set_lines(plan.lines);
  auto traced = drawer.draw_picture(wanted, lines, finish);
  if (!traced) return traced.error();
  if (auto ended = progress.end(); !ended) return ended.error();
  return traced;
}

}  // namespace umbrage
