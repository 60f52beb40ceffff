#include "renderer/strips.h"

#include <algorithm>
#include <optional>
#include <set>
#include <span>

#include "core/check.h"
#include "devices/shared/neutral.h"
#include "looks/metering.h"
#include "renderer/average.h"
#include "renderer/background.h"
#include "renderer/draw.h"
#include "renderer/lines.h"

namespace umbrage {
namespace {

/// Progress of drawing all samples. Drawing a sample takes one or more sweeps, each over all strips.
class StripProgress {
 public:
  StripProgress(const ProgressMonitor& monitor, int samples) : monitor_(monitor), samples_(samples) {}

  ProgressMonitor dispatch_monitor() {
    return [this](double) { return report(); };
  }
  /// Sets the finished fraction of a sweep.
  void show(double fraction) { fraction_ = fraction; }
  void sweep_done() {
    ++sweep_;
    fraction_ = 0.0;
  }
  /// Ends a sample. The next sample is expected to need as many sweeps; one fewer if this sample was `metered`.
  void sample_done(bool metered) {
    expected_sweeps_ = std::max(sweep_ - (metered ? 1 : 0), 1);
    ++sample_;
    sweep_ = 0;
  }
  /// Reports that all is drawn. Errors: kInterrupted.
  Result<void> end() const { return !monitor_ || monitor_(1.0) ? Result<void>() : interrupted(); }

 private:
  bool report() {
    const double of_sample = std::min((sweep_ + fraction_) / expected_sweeps_, 1.0);
    reported_ = std::max(reported_, (sample_ + of_sample) / samples_);
    return !monitor_ || monitor_(reported_);
  }

  const ProgressMonitor& monitor_;
  const int samples_;
  int sample_ = 0, sweep_ = 0, expected_sweeps_ = 2;
  double fraction_ = 0.0, reported_ = 0.0;
};

/// Draws the strips of one sample of a picture.
class StripDrawer {
 public:
  StripDrawer(Device& device, Plan& plan, int rows, StripProgress& progress, StageTimes& times)
      : device_(device), plan_(plan), rows_(rows), progress_(progress), times_(times) {
    height_ = plan.capture.height + 2 * plan.capture.guard;
    run_ = look_run(plan.recipe);
    run_.after = [this](std::string_view name) { times_.done(name); };
    run_.monitor = progress.dispatch_monitor();
    run_.meter = [this](Device& of, const Frame& frame, Exposure by) { return meter(of, frame, by); };
  }

  /// Receives the inner rows of a finished strip; `first` is the index of the first row.
  using Finish = std::function<Result<void>(const Frame& frame, Image& rows, int first)>;

  /// Draws all strips in as many sweeps as needed and passes `planes` of the finished rows to `finish`. Returns the
  /// lines of the sample if `lines` is set.
  Result<Lines> draw_sample(const Camera& camera, const std::vector<std::string>& planes, bool lines,
                            const Finish& finish) {
    const auto whole_planes = std::make_shared<WholePlanes>();
    bool metered = false;
    sweep_ = 0;
    for (bool finished = false; !finished; ++sweep_) {
      metered_in_sweep_ = false;
      margins_.resize(std::max(margins_.size(), sweep_ + 1), margins_.empty() ? 0 : margins_.back());
      for (int begin = 0; begin < height_; begin += rows_) {
        const Rows strip{begin, std::min(begin + rows_, height_)};
        const auto done = draw_strip(camera, {strip, 0, whole_planes}, planes, finish);
        if (!done) return done.error();
        if (begin > 0 && finished != *done) fail_check("strips of one picture wait for different dispatches");
        finished = *done;
        progress_.show(double(strip.end) / height_);
      }
      for (auto& [key, entry] : whole_planes->planes) entry.complete = true;
      if (metered_in_sweep_) {
        run_.stops = metering_.stops(stops_from_lights_, metered_by_);
        metered = true;
      }
      progress_.sweep_done();
    }
    progress_.sample_done(metered);
    return lines ? lines_of(*whole_planes) : Lines();
  }

 private:
  /// Traces the lines from the planes that the strips have gathered for the host step.
  Lines lines_of(WholePlanes& whole_planes) const {
    Image planes(info_.width, info_.height);
    for (const std::string_view name : edge_planes()) {
      planes.add(name) = Plane(info_.width, info_.height, neutral_value(name).value_or(0.0f));
      for (auto& [key, entry] : whole_planes.planes)
        if (std::get<0>(key) == info_.reduced && std::get<1>(key) == name) planes.plane(name) = std::move(entry.plane);
    }
    const ParameterBytes& params = plan_.lines.empty() ? params_of(plan_.recipe.settings, "outline") : plan_.lines;
    return traced_lines(info_, planes, params, device_.threads());
  }

  /// Draws a strip, again with a larger margin until the margin suffices. Returns whether the strip is finished; if
  /// not, its next dispatch reads planes that other strips must complete first.
  Result<bool> draw_strip(const Camera& camera, Strip strip, const std::vector<std::string>& planes,
                          const Finish& finish) {
    int& margin = margins_[sweep_];
    for (;;) {
      prepare_plane_pool({std::max(strip.rows.begin - margin, 0), std::min(strip.rows.end + margin, height_)});
      strip.margin = margin;
      const int guard = plan_.capture.guard;
      first_ = std::clamp(strip.rows.begin, guard, height_ - guard) - guard;
      const auto done = try_strip(camera, strip, planes, finish);
      if (!done) return done.error();
      if (done->finished || done->missing_rows == 0) return done->finished;
      if (margin > height_)
        fail_check(fmt::format("a strip of a picture {} pixels high needs too large a margin", height_));
      margin += done->missing_rows;
    }
  }

  /// Prepares the plane pool for strips with this number of rows: drops planes of other sizes, which cannot be reused.
  void prepare_plane_pool(const Rows& rows) {
    if (kept_ && kept_rows_ == rows.count()) return;
    kept_.reset();
    kept_.emplace(device_.pool());
    kept_rows_ = rows.count();
  }

  Result<RunState> try_strip(const Camera& camera, const Strip& strip, const std::vector<std::string>& planes,
                             const Finish& finish) {
    plan_.capture.strip = strip;
    auto frame = device_.capture(camera, plan_.capture, run_.monitor);
    if (!frame) return frame.error();
    times_.done("capture");
    if (auto added = add_sky(device_, plan_, *frame); !added) return added.error();
    if (plan_.recipe.hdri.shown()) times_.done("sky");
    info_ = frame->info;
    metered_missing_ = 0;
    const auto look_state = run_look(run_, device_, *frame);
    if (!look_state) return look_state.error();
    if (!look_state->finished) return RunState{false, std::max(look_state->missing_rows, metered_missing_)};
    const auto lines_state = draw_lines(device_, plan_, *frame, run_.monitor, times_);
    if (!lines_state || !lines_state->finished) return lines_state;
    if (const int missing = device_.missing_rows(*frame, planes); missing > 0) return RunState{false, missing};
    auto rows = device_.download(*frame, planes);
    if (!rows) return rows.error();
    if (rows->height > 0)
      if (auto taken = finish(*frame, *rows, first_); !taken) return taken.error();
    return RunState();
  }

  /// Adds a strip to the metering. Returns no exposure: it is known only after a sweep over all strips, and the next
  /// sweep uses it.
  Result<std::optional<float>> meter(Device& device, const Frame& frame, Exposure by) {
    metered_missing_ = device.missing_rows(frame, kMeteredPlanes);
    if (metered_missing_ > 0) return std::optional<float>();
    const auto rows = device.download(frame, kMeteredPlanes);
    if (!rows) return rows.error();
    metering_.add(*rows, first_, plan_.capture.height);
    stops_from_lights_ = stops_from_lights(frame.info);
    metered_by_ = by;
    metered_in_sweep_ = true;
    return std::optional<float>();
  }

  Device& device_;
  Plan& plan_;
  const int rows_;
  StripProgress& progress_;
  StageTimes& times_;
  LookRun run_;
  Metering metering_;
  float stops_from_lights_ = 0.0f;  // exposure that metering starts from
  Exposure metered_by_ = Exposure::kPicture;
  bool metered_in_sweep_ = false;  // whether the sweep collects values for metering
  int metered_missing_ = 0;        // rows that metering lacks in the current strip
  PictureInfo info_;
  int height_ = 0;
  std::size_t sweep_ = 0;     // index of the sweep within the sample
  std::vector<int> margins_;  // rows above and below the strips of each sweep, kept for all samples
  std::optional<ScopedPlanePool> kept_;
  int kept_rows_ = 0;
  int first_ = 0;  // first inner row of the strip
};

/// Memory for drawing, in units of one plane of the whole picture.
struct PlaneCount {
  double held = 0.0;      ///< planes of a frame
  double far = 0.0;       ///< planes that stay whole: dispatches read them at any distance, or host steps make them
  double averaged = 0.0;  ///< sums over the samples
};

/// Estimates the planes needed for drawing. Planes that later dispatches no longer read are counted, too.
PlaneCount count_planes(const Recipe& recipe, int layers) {
  constexpr int kCaptured =
      21;  // planes of a captured layer, with two further shadows, emission and those of materials
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
      if (dispatch.needed && !dispatch.needed(params)) continue;
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
  count.held = double(kCaptured * layers) + kUniformAndOutput + double(full.size());
  if (!small.empty()) count.held += reduced * double(small.size() + std::size_t(kCaptured * layers)) + 8.0;
  count.far = double(far_full.size()) + reduced * double(far_small.size()) + for_host_steps;
  constexpr double kColor = 4.0;
  if (recipe.frames > 1)
    count.averaged = kColor * double(picture_passes(recipe).size()) + double(recipe.averaged.size());
  count.held += recipe.frames > 1 ? kForAverage : 0.0;
  return count;
}

}  // namespace

Result<StripSizes> plan_strips(const Device& device, const Recipe& recipe, double memory) {
  constexpr double kBytes = sizeof(float);
  constexpr double kFixed = 60e6;               // the program and a scene of 100 000 triangles, bytes
  constexpr double kMargin = 64.0;              // rows above and below a strip, in high pictures
  constexpr double kMarginOfHeight = 0.05;      // the same in low ones, relative to the height
  constexpr int kMinRows = 64, kMaxRows = 512;  // rows of a strip: margins are 2/3 of what is drawn, or 1/5
  const int layers = *layer_count(recipe.capture);
  const PlaneCount count = count_planes(recipe, layers);
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

/// Averages rows of sample 0 and the sum of the other samples. Returns the finished rows.
Result<Image> averaged_rows(Device& device, const Plan& plan, const PictureSum& total, const BlendedSample& blended,
                            const PictureInfo& info, const Image& rows, int first,
                            const std::vector<std::string>& planes) {
  PictureSum sum = rows_of(total, first, rows.height);
  Image weighted = planes_of(rows, averaged_planes(plan));
  if (plan.has_blended) blended.weigh_behind(weighted, first);
  add_rows(sum, weighted, 0, rows.height);
  sum.count = plan.pictures();
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

/// Returns `planes` and those that set_background reads.
std::vector<std::string> with_background_planes(const Plan& plan, std::vector<std::string> planes) {
  const auto& captured = plan.capture.planes;
  const bool has_ids = !captured || std::find(captured->begin(), captured->end(), "object_id") != captured->end();
  for (const std::string& name : background_planes(planes, plan.has_ground && has_ids))
    if (std::find(planes.begin(), planes.end(), name) == planes.end()) planes.push_back(name);
  return planes;
}

}  // namespace

Result<Lines> draw_strips(Device& device, const Plan& planned, int rows, const std::vector<std::string>& requested,
                          bool lines, const TakeRows& take, StageTimes& times, const ProgressMonitor& monitor) {
  Plan plan = planned;
  const std::vector<std::string> planes = with_background_planes(plan, requested);
  StripProgress progress(monitor, plan.pictures());
  StripDrawer drawer(device, plan, rows, progress, times);
  PictureSum total{.as_square_roots = plan.recipe.look->averages_square_roots, .per_sample = plan.has_blended ? 2 : 1};
  BlendedSample blended;
  const std::vector<std::string> averaged = averaged_planes(plan), drawn_lines = line_planes(plan);
  std::vector<std::string> wanted = planes;  // planes of the last picture
  if (plan.averages())
    for (const auto& more : {averaged, drawn_lines})
      for (const std::string& name : more)
        if (std::find(wanted.begin(), wanted.end(), name) == wanted.end()) wanted.push_back(name);
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
      auto finished = averaged_rows(device, plan, total, blended, frame.info, part, first, planes);
      if (!finished) return finished.error();
      part = std::move(*finished);
      times.done("average");
    }
    set_background(part, frame.info.ground_object);
    return take(frame.info, part, first);
  };
  const std::vector<PictureIndex> pictures = pictures_of(plan);
  for (const PictureIndex& index : std::span(pictures).first(pictures.size() - 1)) {
    std::vector<std::string> names = index.blended ? with_blend_planes(averaged) : averaged;
    if (index.blended && index.sample == 0) names.insert(names.end(), drawn_lines.begin(), drawn_lines.end());
    if (auto drawn = drawer.draw_sample(begin_picture(plan, index), names, false, add); !drawn) return drawn.error();
  }
  auto drawn = drawer.draw_sample(begin_picture(plan, pictures.back()), wanted, lines, finish);
  if (!drawn) return drawn.error();
  if (auto ended = progress.end(); !ended) return ended.error();
  return drawn;
}

}  // namespace umbrage
