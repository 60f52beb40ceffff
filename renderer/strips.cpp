#include "renderer/strips.h"

#include <algorithm>
#include <optional>
#include <set>

#include "core/check.h"
#include "devices/shared/neutral.h"
#include "looks/metering.h"
#include "renderer/average.h"
#include "renderer/draw.h"
#include "renderer/lines.h"

namespace umbrage {
namespace {

/// Progress over all sweeps over all strips.
class StripProgress {
 public:
  StripProgress(const ProgressMonitor& monitor, int frames) : monitor_(monitor), frames_(frames) {}

  ProgressMonitor of_step() {
    return [this](double) { return tell(); };
  }
  /// Sets the finished fraction of a sweep.
  void show(double fraction) { share_ = fraction; }
  void sweep_done() {
    ++sweep_;
    share_ = 0.0;
  }
  /// Ends a sample. The next one needs as many sweeps as this one, or one less if one was for metering.
  void frame_done(bool metered) {
    usual_ = std::max(sweep_ - (metered ? 1 : 0), 1);
    ++frame_;
    sweep_ = 0;
  }
  /// Errors: kInterrupted.
  Result<void> end() const { return !monitor_ || monitor_(1.0) ? Result<void>() : interrupted(); }

 private:
  bool tell() {
    const double of_frame = std::min((sweep_ + share_) / usual_, 1.0);
    reported_ = std::max(reported_, (frame_ + of_frame) / frames_);
    return !monitor_ || monitor_(reported_);
  }

  const ProgressMonitor& monitor_;
  const int frames_;
  int frame_ = 0, sweep_ = 0, usual_ = 2;
  double share_ = 0.0, reported_ = 0.0;
};

/// Draws the strips of one sample of a picture.
class StripDrawer {
 public:
  StripDrawer(Device& device, Plan& plan, int rows, StripProgress& progress, StageTimes& times)
      : device_(device), plan_(plan), rows_(rows), progress_(progress), times_(times) {
    height_ = plan.capture.height + 2 * plan.capture.guard;
    run_ = look_run(plan.recipe);
    run_.after = [this](std::string_view name) { times_.done(name); };
    run_.monitor = progress.of_step();
    run_.meter = [this](Device& of, const Frame& frame) { return meter(of, frame); };
  }

  /// Receives the inner rows of a finished strip; `first` is the index of the first row.
  using Finish = std::function<Result<void>(const Frame& frame, const Image& rows, int first)>;

  /// Draws all strips in as many sweeps as needed and passes `planes` of the finished rows to `finish`. Returns the
  /// lines of the sample if `lines` is set.
  Result<Lines> draw_frame(const Camera& camera, const std::vector<std::string>& planes, bool lines,
                           const Finish& finish) {
    const auto wholes = std::make_shared<WholePlanes>();
    bool metered = false;
    sweep_ = 0;
    for (bool finished = false; !finished; ++sweep_) {
      metering_ = false;
      margins_.resize(std::max(margins_.size(), sweep_ + 1), margins_.empty() ? 0 : margins_.back());
      for (int begin = 0; begin < height_; begin += rows_) {
        const Rows strip{begin, std::min(begin + rows_, height_)};
        const auto done = draw_strip(camera, {strip, 0, wholes}, planes, finish);
        if (!done) return done.error();
        if (begin > 0 && finished != *done) fail_check("strips of one picture wait for different dispatches");
        finished = *done;
        progress_.show(double(strip.end) / height_);
      }
      for (auto& [key, entry] : wholes->planes) entry.complete = true;
      if (metering_) {
        run_.stops = seen_.stops(usual_);
        metered = true;
      }
      progress_.sweep_done();
    }
    progress_.frame_done(metered);
    return lines ? lines_of(*wholes) : Lines();
  }

 private:
  /// Traces the lines from the planes that the strips have gathered for the host step.
  Lines lines_of(WholePlanes& wholes) const {
    Image planes(info_.width, info_.height);
    for (const std::string_view name : edge_planes()) {
      planes.add(name) = Plane(info_.width, info_.height, neutral_value(name).value_or(0.0f));
      for (auto& [key, entry] : wholes.planes)
        if (std::get<0>(key) == info_.reduced && std::get<1>(key) == name) planes.plane(name) = std::move(entry.plane);
    }
    const ParameterBytes& params = plan_.lines.empty() ? params_of(plan_.recipe.settings, "outline") : plan_.lines;
    return traced_lines(info_, planes, params, device_.threads());
  }

  /// Draws a strip, with an increasing margin until it suffices. Returns whether the strip is finished; if not, it
  /// waits for other strips.
  Result<bool> draw_strip(const Camera& camera, Strip strip, const std::vector<std::string>& planes,
                          const Finish& finish) {
    int& margin = margins_[sweep_];
    for (;;) {
      keep_planes_of({std::max(strip.rows.begin - margin, 0), std::min(strip.rows.end + margin, height_)});
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

  /// Drops pooled planes of strips of another size, which cannot be reused.
  void keep_planes_of(const Rows& rows) {
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
    const auto looked = run_look(run_, device_, *frame);
    if (!looked) return looked.error();
    if (!looked->finished) return RunState{false, std::max(looked->missing_rows, metered_missing_)};
    const auto lined = draw_lines(device_, plan_, *frame, run_.monitor, times_);
    if (!lined || !lined->finished) return lined;
    if (const int missing = device_.missing_rows(*frame, planes); missing > 0) return RunState{false, missing};
    const auto rows = device_.download(*frame, planes);
    if (!rows) return rows.error();
    if (rows->height > 0)
      if (auto taken = finish(*frame, *rows, first_); !taken) return taken.error();
    return RunState();
  }

  /// Meters a strip. Metering reads all strips before any of them is finished.
  Result<std::optional<float>> meter(Device& device, const Frame& frame) {
    metered_missing_ = device.missing_rows(frame, kMeteredPlanes);
    if (metered_missing_ > 0) return std::optional<float>();
    const auto rows = device.download(frame, kMeteredPlanes);
    if (!rows) return rows.error();
    seen_.add(*rows, first_, plan_.capture.height);
    usual_ = stops_from_lights(frame.info);
    metering_ = true;
    return std::optional<float>();
  }

  Device& device_;
  Plan& plan_;
  const int rows_;
  StripProgress& progress_;
  StageTimes& times_;
  LookRun run_;
  Metering seen_;
  float usual_ = 0.0f;       // stops
  bool metering_ = false;    // in this sweep
  int metered_missing_ = 0;  // rows missing in the current strip
  PictureInfo info_;
  int height_ = 0;
  std::size_t sweep_ = 0;     // of the sample
  std::vector<int> margins_;  // of the strips of each sweep; the same for all samples
  std::optional<ScopedPlanePool> kept_;
  int kept_rows_ = 0;
  int first_ = 0;  // first inner row of the strip
};

/// Numbers of planes, in planes of the whole picture.
struct PlaneCount {
  double held = 0.0;  ///< held by a frame
  double far = 0.0;   ///< those of them that dispatches read at arbitrary distance, or that are made on the host
  double averaged = 0.0;
};

/// Estimates the planes needed for drawing. Planes that later dispatches no longer read are counted, too.
PlaneCount count_planes(const Recipe& recipe, int layers) {
  constexpr int kCaptured = 17;       // per layer: with a second shadow, and emission
  constexpr double kBesides = 7.0;    // uniform planes, and output
  constexpr double kOfAverage = 6.0;  // the finished picture and its inputs
  const double reduced = 1.0 / double(recipe.occlusion_downsampling * recipe.occlusion_downsampling);
  constexpr double kOfHostStep = 3.0;  // working set, for lines: edges, chains and their positions
  double of_host_steps = 0.0;
  std::set<std::string> full, small, far_full, far_small;
  for (const Effect* effect : steps_of(look_run(recipe))) {
    const bool is_small = recipe.occlusion_downsampling > 1 &&
                          (effect->kind == EffectKind::kOcclusion || effect->kind == EffectKind::kFilter);
    const ParameterBytes& params = params_of(recipe.settings, effect->name);
    for (const Dispatch& dispatch : effect->dispatches) {
      if (dispatch.needed && !dispatch.needed(params)) continue;
      const auto there = [&](std::string_view plane) { return layer_of_plane(plane) < layers; };
      for (const std::string_view plane : dispatch.outputs)
        if (dispatch.for_all && there(plane)) (is_small ? small : full).emplace(plane);
      for (const std::string_view plane : dispatch.reach ? dispatch.unbounded_inputs : dispatch.inputs)
        if (there(plane)) (is_small && dispatch.for_all ? far_small : far_full).emplace(plane);
      if (dispatch.host) far_full.insert(dispatch.outputs.begin(), dispatch.outputs.end());
      if (dispatch.host) of_host_steps += kOfHostStep;
    }
  }
  PlaneCount count;
  count.held = double(kCaptured * layers) + kBesides + double(full.size());
  if (!small.empty()) count.held += reduced * double(small.size() + std::size_t(kCaptured * layers)) + 8.0;
  count.far = double(far_full.size()) + reduced * double(far_small.size()) + of_host_steps;
  constexpr double kColor = 4.0;
  if (recipe.frames > 1) count.averaged = kColor + double(recipe.averaged.size());
  count.held += recipe.frames > 1 ? kOfAverage : 0.0;
  return count;
}

}  // namespace

Result<StripSizes> plan_strips(const Device& device, const Recipe& recipe, double memory) {
  constexpr double kBytes = sizeof(float);
  constexpr double kFixed = 150e6;              // the program and a scene
  constexpr double kMargin = 64.0;              // rows above and below a strip
  constexpr int kMinRows = 64, kMaxRows = 512;  // rows of a strip: fewer are mostly margin, more save no memory
  const int layers = *layer_count(recipe.capture);
  const PlaneCount count = count_planes(recipe, layers);
  const double width = recipe.width + 2.0 * recipe.capture.guard, height = recipe.height + 2.0 * recipe.capture.guard;
  StripSizes plan;
  plan.bytes = kFixed + (count.held + count.averaged) * kBytes * width * height;
  const bool traced = find_named(external_effects(), recipe.occlusion);
  const bool fits = width * height * layers <= double(kMaxPixels);
  if (fits && plan.bytes <= memory) return plan;
  if (!device.draws_strips() || traced) {
    if (fits) return plan;
    return usage_error(
        "{} of {} x {} pixels {} too many: at most {} pixels in total; larger pictures are drawn in strips, but not {}",
        layers == 1 ? "one layer" : fmt::format("{} layers", layers), width, height, layers == 1 ? "is" : "are",
        kMaxPixels,
        traced ? "with `occlusion` reference" : fmt::format("on the device {}: try `device` cpu", device.name()));
  }
  const double fixed = kFixed + (count.far + count.averaged) * kBytes * width * height;
  const double row = count.held * kBytes * width;
  const int rows = int(std::clamp((memory - fixed) / row - 2.0 * kMargin, double(kMinRows), double(kMaxRows)));
  plan.rows = rows / kMinRows * kMinRows;
  plan.bytes = fixed + row * (plan.rows + 2.0 * kMargin);
  return plan;
}

namespace {

/// Returns these planes of some rows.
Image chosen(const Image& rows, const std::vector<std::string>& names) {
  Image own(rows.width, rows.height);
  for (const std::string& name : names) own.add(name) = rows.plane(name);
  return own;
}

/// Returns the finished rows from the rows of sample 0 and the sum of the other samples.
Result<Image> averaged_rows(Device& device, const Plan& plan, const PictureSum& total, const PictureInfo& info,
                            const Image& rows, int first, const std::vector<std::string>& planes) {
  PictureSum sum = rows_of(total, first, rows.height);
  add_rows(sum, chosen(rows, averaged_planes(plan)), 0, rows.height);
  sum.count = plan.recipe.frames;
  PictureInfo inner = inner_info(info);
  inner.height = rows.height;
  Image color;
  if (plan.recipe.wants("color.r")) {
    auto made = finished_color(device, sum, plan, chosen(rows, line_planes(plan)), inner);
    if (!made) return made;
    color = std::move(*made);
  }
  const Image means = mean_planes(sum, other_averaged_planes(plan));
  Image finished(rows.width, rows.height);
  for (const std::string& name : planes) {
    const Plane* made = color.find(name) ? color.find(name) : means.find(name);
    finished.add(name) = made ? *made : rows.plane(name);
  }
  return finished;
}

}  // namespace

Result<Lines> draw_strips(Device& device, const Plan& planned, int rows, const std::vector<std::string>& planes,
                          bool lines, const TakeRows& take, StageTimes& times, const ProgressMonitor& monitor) {
  Plan plan = planned;
  StripProgress progress(monitor, plan.recipe.frames);
  StripDrawer drawer(device, plan, rows, progress, times);
  PictureSum total{.as_square_roots = plan.recipe.look->averages_square_roots};
  std::vector<std::string> wanted = planes;  // planes of sample 0
  if (plan.averages())
    for (const auto& more : {averaged_planes(plan), line_planes(plan)})
      for (const std::string& name : more)
        if (std::find(wanted.begin(), wanted.end(), name) == wanted.end()) wanted.push_back(name);
  const auto add = [&](const Frame&, const Image& part, int first) -> Result<void> {
    add_rows(total, part, first, plan.recipe.height);
    times.done("average");
    return {};
  };
  const auto finish = [&](const Frame& frame, const Image& part, int first) -> Result<void> {
    if (!plan.averages()) return take(frame.info, part, first);
    const auto finished = averaged_rows(device, plan, total, frame.info, part, first, planes);
    if (!finished) return finished.error();
    times.done("average");
    return take(frame.info, *finished, first);
  };
  for (int k = plan.recipe.frames - 1; k > 0; --k)
    if (auto drawn = drawer.draw_frame(begin_sample(plan, k), averaged_planes(plan), false, add); !drawn)
      return drawn.error();
  auto drawn = drawer.draw_frame(begin_sample(plan, 0), wanted, lines, finish);
  if (!drawn) return drawn.error();
  if (auto ended = progress.end(); !ended) return ended.error();
  return drawn;
}

}  // namespace umbrage
