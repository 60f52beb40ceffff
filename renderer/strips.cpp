#include "renderer/strips.h"

#include <algorithm>

#include "core/color.h"
#include "core/lists.h"
#include "effects/output/output.h"
#include "renderer/drawing.h"
#include "renderer/marked_samples.h"
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

/// How the pixels of a block become one.
enum class Reduced { kMean, kMeanOfLight, kMiddle };

Reduced reduced_by(std::string_view plane, bool is_srgb) {
  const std::string_view name = name_on_first_layer(plane);
  const std::string_view group = name.substr(0, name.find('.'));
  for (const std::string_view geometry : {"depth", "normal", "object_id", "material_id", "shininess", "roughness"})
    if (group == geometry) return Reduced::kMiddle;
  return group == "color" && is_srgb && name != "color.a" ? Reduced::kMeanOfLight : Reduced::kMean;
}

/// Adds up rows until a row of blocks is complete.
class Reducer {
 public:
  Reducer(int factor, bool is_srgb, TakeRows take) : factor_(factor), is_srgb_(is_srgb), take_(std::move(take)) {}

  Result<void> add(const PictureInfo& info, const Image& rows) {
    const PictureInfo reduced = reduced_picture_info(info, factor_);
    const int width = reduced.inner_width(), height = reduced.inner_height();
    const int complete = std::min((row_ + rows.height) / factor_, height) - std::min(row_ / factor_, height);
    Image finished(width, complete);
    for (const std::string& name : rows.names) finished.add(name) = Plane(width, complete);
    if (sums_.empty()) sums_.assign(rows.names.size(), std::vector<double>(std::size_t(width)));
    if (weights_.empty()) weights_.assign(std::size_t(width), 0.0);
    const int first = row_ / factor_;
    for (int y = 0; y < rows.height; ++y, ++row_) {
      if (row_ / factor_ >= height) continue;
      add_row(rows, y);
      if (row_ % factor_ == factor_ - 1) finish_row(rows.names, row_ / factor_ - first, finished);
    }
    return complete > 0 ? take_(reduced, finished, first) : Result<void>();
  }

 private:
  void add_row(const Image& rows, int y) {
    const Plane* alpha = rows.find("color.a");
    has_alpha_ = alpha != nullptr;
    const int width = int(weights_.size()), middle = factor_ / 2;
    for (std::size_t k = 0; k < rows.names.size(); ++k) {
      const Reduced by = reduced_by(rows.names[k], is_srgb_);
      const bool weighed = is_weighed(rows.names[k]);
      const float* values = rows.planes[k].row(y);
      for (int x = 0; x < width; ++x) {
        double& sum = sums_[k][std::size_t(x)];
        if (by == Reduced::kMiddle) {
          if (row_ % factor_ == middle) sum = values[x * factor_ + middle];
          continue;
        }
        for (int i = x * factor_; i < (x + 1) * factor_; ++i) {
          const float value = by == Reduced::kMeanOfLight ? linear_from_srgb(values[i]) : values[i];
          sum += double(value) * (weighed ? double(alpha->at(i, y)) : 1.0);
        }
      }
    }
    if (alpha)
      for (int x = 0; x < width; ++x)
        for (int i = x * factor_; i < (x + 1) * factor_; ++i) weights_[std::size_t(x)] += double(alpha->at(i, y));
  }

  void finish_row(const std::vector<std::string>& names, int to, Image& finished) {
    const double count = double(factor_) * factor_;
    for (std::size_t k = 0; k < names.size(); ++k) {
      const Reduced by = reduced_by(names[k], is_srgb_);
      const bool weighed = is_weighed(names[k]);
      for (std::size_t x = 0; x < weights_.size(); ++x) {
        const double of = by == Reduced::kMiddle ? 1.0 : weighed ? weights_[x] : count;
        const auto mean = float(of > 0.0 ? sums_[k][x] / of : 0.0);
        finished.planes[k].at(int(x), to) = by == Reduced::kMeanOfLight ? srgb_from_linear(mean) : mean;
        sums_[k][x] = 0.0;
      }
    }
    std::fill(weights_.begin(), weights_.end(), 0.0);
  }

  bool is_weighed(std::string_view name) const { return has_alpha_ && name.starts_with("color.") && name != "color.a"; }

  const int factor_;
  const bool is_srgb_;
  const TakeRows take_;
  int row_ = 0;  // rows received
  bool has_alpha_ = false;
  std::vector<std::vector<double>> sums_;  // of the current row of blocks, by plane
  std::vector<double> weights_;            // of that, the sums of alpha
};

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
  PictureDrawing drawing{device, times, progress, look_run(plan.recipe)};
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

PictureInfo reduced_picture_info(PictureInfo info, int factor) {
  info.width = info.inner_width() / factor;
  info.height = info.inner_height() / factor;
  info.guard = 0;
  return info;
}

TakeRows reduced_rows(int factor, const Recipe& recipe, const TakeRows& take) {
  if (factor == 1) return take;
  const bool is_srgb = params_of<OutputParams>(recipe.settings).transfer == kTransferSrgb;
  const auto reducer = std::make_shared<Reducer>(factor, is_srgb, take);
  return [reducer](const PictureInfo& info, const Image& rows, int) { return reducer->add(info, rows); };
}

}  // namespace umbrage
