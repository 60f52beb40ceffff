#include "renderer/strips.h"

#include <algorithm>
#include <optional>
#include <span>

#include "core/lists.h"
#include "renderer/drawing.h"
#include "renderer/exposure.h"
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

/// Returns finished rows. `sum`: theirs, of all samples; `rows`: those of sample 0.
Result<Image> averaged_rows(Device& device, const Plan& plan, PictureSum sum, const PictureInfo& info,
                            const Image& rows, const std::vector<std::string>& planes) {
  PictureInfo inner = inner_info(info);
  inner.first_row = sum.first;
  inner.whole_rows = inner.height;
  inner.height = rows.height;
  const auto made = finished_average(device, std::move(sum), plan, planes_of(rows, line_planes(plan)), inner);
  if (!made) return made;
  Image finished(rows.width, rows.height);
  for (const std::string& name : planes) finished.add(name) = made->find(name) ? made->plane(name) : rows.plane(name);
  return finished;
}

/// Returns the source of the strips of a plan without frames.
StripSource source_of(const Plan& plan) {
  StripSource source{.run = look_run(plan.recipe),
                     .info = plan.info,
                     .lines = plan.lines.empty() ? stroke_parameters_or_none(plan.recipe) : plan.lines,
                     .given = plan.given};
  source.run.lines = plan.lines;
  if (meters_picture(plan)) source.run.stops = 0.0f;  // draw_strips has it before the first strip
  if (!plan.marked) return source;
  source.before.push_back(marking_step(plan, plan.info));
  add_margins_for_further(plan, plan.info, source.after);
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

}  // namespace

Result<StripSizes> plan_strips(const Device& device, const Plan& plan, double memory) {
  constexpr double kForPicture = 8.0;  // the finished picture and its inputs, besides those of lines
  constexpr double kMasks = 2.0;
  SumPlanes sum;
  if (plan.averages()) {
    const double averaged = double(averaged_planes(plan).size());
    sum.finished = averaged + kForPicture + double(line_planes(plan).size());
    sum.blended = plan.marked && plan.has_blended;
    if (plan.marked) {
      sum.marked = averaged + kMasks;
      sum.finished += kMasks;
      if (plan.recipe.kept) sum.released = double(averaged_picture(plan).size());
    } else {
      sum.held = averaged;
    }
  }
  return plan_strips(device, source_of(plan), sum, memory);
}

Result<Strokes> draw_strips(Device& device, const Plan& planned, int rows, const std::vector<std::string>& requested,
                            bool lines, const TakeRows& take, StageTimes& times, const ProgressMonitor& monitor) {
  Plan plan = planned;
  const std::vector<std::string> planes = with_background_planes(plan, requested);
  // Marked samples are drawn with the strips of the first one.
  DrawProgress progress(monitor, steps_of_picture(plan) * std::size_t(plan.marked ? plan.pictures() : 1));
  Drawing drawing{device, times, progress, look_run(plan.recipe)};
  report_to(progress, times, drawing.run);
  Camera camera;  // of the current picture
  StripSource source = source_of(plan);
  source.make_frame = [&](const Strip& strip) {
    plan.capture.strip = strip;
    return drawing.capture(plan, camera);
  };
  const auto stops = metered_exposure(drawing, plan);
  if (!stops) return stops.error();
  drawing.run.stops = source.run.stops = *stops;
  StripDrawer drawer(device, std::move(source), rows, progress, times);
  Average average;
  std::vector<std::string> wanted = planes;  // planes of the last picture
  if (plan.averages()) {
    if (!plan.marked) average = Average(device, plan, {0, plan.recipe.height});
    for (const auto& more : {averaged_planes(plan), line_planes(plan)})
      for (const std::string& name : more)
        if (!contains(wanted, name)) wanted.push_back(name);
  }
  const auto add = [&](const Frame&, Image& part, int first) -> Result<void> {
    average.add(plan, std::move(part), first);
    times.done("average");
    return {};
  };
  const auto finish = [&](Frame& frame, Image& part, int first) -> Result<void> {
    if (plan.averages()) {
      PictureSum sum;
      if (plan.marked) {
        auto of_strip = marked_average(drawing, plan, frame);
        if (!of_strip) return of_strip.error();
        sum = of_strip->take_sum();
      } else {
        average.add(plan, planes_of(part, averaged_planes(plan)), first);
        average.join_lines(part, first);
        sum = average.sum_of(first, part.height);
      }
      auto finished = averaged_rows(device, plan, std::move(sum), frame.info, part, planes);
      if (!finished) return finished.error();
      part = std::move(*finished);
      times.done("average");
    }
    set_background(part, frame.info.ground_object);
    return take(frame.info, part, first);
  };
  const std::vector<PictureIndex> pictures = pictures_of(plan);
  Strokes strokes;
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    const bool last = k + 1 == pictures.size();
    const DrawProgress::Part part(progress, double(k) / pictures.size(), double(k + 1) / pictures.size());
    camera = begin_picture(plan, pictures[k]);
    drawer.set_lines(pictures[k].sample == 0 ? plan.lines : std::vector<EffectStep>());
    auto traced = drawer.draw_picture(last ? wanted : Average::planes_of(plan), last && lines,
                                      last ? StripDrawer::Finish(finish) : add);
    if (!traced) return traced;
    strokes = std::move(*traced);
  }
  if (auto ended = progress.end(); !ended) return ended.error();
  return strokes;
}

}  // namespace umbrage
