#include "apps/job/bands.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>

#include "apps/job/drawing.h"
#include "core/check.h"
#include "effects/effects.h"
#include "looks/metering.h"

namespace umbrage {
namespace {

/// What is done of all sweeps over all bands. It listens to the device as long as it lives.
class BandProgress {
 public:
  BandProgress(Device& device, const std::function<bool(double)>& progress, int frames)
      : device_(device), progress_(progress), frames_(frames) {
    device_.go_on = [this](double) { return tell(); };
  }
  ~BandProgress() { device_.go_on = nullptr; }
  BandProgress(const BandProgress&) = delete;

  /// This share of a sweep is done.
  void show(double share) { share_ = share; }
  void sweep_done() {
    ++sweep_;
    share_ = 0.0;
  }
  /// The frame that follows takes as many sweeps as this one, or one less if that was for the metering.
  void frame_done(bool metered) {
    usual_ = std::max(sweep_ - (metered ? 1 : 0), 1);
    ++frame_;
    sweep_ = 0;
  }
  /// Errors: kInterrupted.
  Result<void> end() {
    if (progress_(1.0)) return {};
    return Error{ErrorKind::kInterrupted, "interrupted"};
  }

 private:
  bool tell() {
    const double of_frame = std::min((sweep_ + share_) / usual_, 1.0);
    told_ = std::max(told_, (frame_ + of_frame) / frames_);
    return progress_(told_);
  }

  Device& device_;
  const std::function<bool(double)>& progress_;
  const int frames_;
  int frame_ = 0, sweep_ = 0, usual_ = 2;
  double share_ = 0.0, told_ = 0.0;
};

bool is_unfinished(const Error& error) { return error.kind == ErrorKind::kUnfinished; }

/// Draws the bands of one frame of a picture.
class BandDrawer {
 public:
  BandDrawer(Device& device, const Scene& scene, Drawing& drawing, const DrawSettings& settings, StageTimes& times)
      : device_(device), scene_(scene), drawing_(drawing), settings_(settings), times_(times) {
    const CaptureSettings& capture = drawing.capture;
    height_ = capture.height + 2 * capture.guard;
    run_ = {.look = drawing.recipe.look,
            .occlusion = drawing.recipe.occlusion,
            .occlusion_every = drawing.recipe.occlusion_every,
            .settings = &drawing.recipe.settings,
            .after = [this](std::string_view name) { times_.done(name); },
            .stops = {},
            .meter = [this](Device& device_of, const Frame& frame) { return meter(device_of, frame); },
            .handed_in = handed_in(),
            .run_handed_in = {}};
  }

  /// What is finished of a band, its inner rows, the first of them `first`.
  using Finish = std::function<Result<void>(const Frame& frame, const Image& rows, int first)>;

  /// Draws all bands, as often as it takes; `planes` of what is finished go to `finish`.
  Result<void> draw_frame(const Camera& camera, int rows, const std::vector<std::string>& planes, const Finish& finish,
                          BandProgress& progress) {
    const auto wholes = std::make_shared<WholePlanes>();
    bool metered = false;
    sweep_ = 0;
    for (bool finished = false; !finished; ++sweep_) {
      finished = true;
      metering_ = false;
      margins_.resize(std::max(margins_.size(), sweep_ + 1), margins_.empty() ? 0 : margins_.back());
      for (int begin = 0; begin < height_; begin += rows) {
        const Rows band{begin, std::min(begin + rows, height_)};
        auto done = draw_band(camera, {band, 0, wholes}, planes, finish);
        if (!done && !is_unfinished(done.error())) return done;
        if (begin > 0 && finished != bool(done)) fail_check("bands of one picture wait for different things");
        finished = bool(done);
        progress.show(double(band.end) / height_);
      }
      for (auto& [key, entry] : wholes->planes) entry.complete = true;
      if (metering_) {
        run_.stops = seen_.stops(usual_);
        metered = true;
      }
      progress.sweep_done();
    }
    progress.frame_done(metered);
    return {};
  }

  /// Of exposure, that were added to the last band's.
  float stops() const { return stops_; }

 private:
  /// Draws a band, with more margin as long as that lacks. Errors: kUnfinished where it waits for others.
  Result<void> draw_band(const Camera& camera, Band band, const std::vector<std::string>& planes,
                         const Finish& finish) {
    int& margin = margins_[sweep_];
    for (;;) {
      keep_planes_of({std::max(band.rows.begin - margin, 0), std::min(band.rows.end + margin, height_)});
      band.margin = margin;
      band.wholes->lacking = 0;
      first_ = std::clamp(band.rows.begin, drawing_.capture.guard, height_ - drawing_.capture.guard) -
               drawing_.capture.guard;
      auto done = try_band(camera, band, planes, finish);
      const int lacking = band.wholes->lacking;
      if (done || !is_unfinished(done.error()) || lacking == 0) return done;
      if (margin > height_) fail_check(fmt::format("a band of a picture {} pixels high wants more margin", height_));
      margin += lacking;
    }
  }

  /// Planes of bands of other sizes serve no more.
  void keep_planes_of(const Rows& rows) {
    if (kept_ && kept_rows_ == rows.count()) return;
    kept_.reset();
    kept_.emplace();
    kept_rows_ = rows.count();
  }

  Result<void> try_band(const Camera& camera, const Band& band, const std::vector<std::string>& planes,
                        const Finish& finish) {
    drawing_.capture.band = band;
    auto frame = device_.capture(camera, drawing_.capture);
    if (!frame) return frame.error();
    times_.done("capture");
    if (auto added = add_sky(device_, scene_, drawing_, settings_, *frame); !added) return added;
    if (settings_.hdri.shown()) times_.done("sky");
    if (auto known = know_picture(drawing_, frame->info, settings_); !known) return known;
    const auto stops = run_look(run_, device_, *frame);
    if (!stops) return stops.error();
    stops_ = *stops;
    const auto rows = device_.download(*frame, planes);
    if (!rows) return rows.error();
    return rows->height > 0 ? finish(*frame, *rows, first_) : Result<void>();
  }

  /// Metering sees all bands before any of them is finished.
  Result<float> meter(Device& device, const Frame& frame) {
    const auto rows = device.download(frame, kMeteredPlanes);
    if (!rows) return rows.error();
    seen_.add(*rows, first_, drawing_.capture.height);
    usual_ = usual_stops(frame.info);
    metering_ = true;
    return Error{ErrorKind::kUnfinished, "a band waits for the exposure"};
  }

  Device& device_;
  const Scene& scene_;
  Drawing& drawing_;
  const DrawSettings& settings_;
  StageTimes& times_;
  LookRun run_;
  Metering seen_;
  float usual_ = 0.0f;     // stops
  float stops_ = 0.0f;     // that were added to the last band's exposure
  bool metering_ = false;  // in this sweep
  int height_ = 0;
  std::size_t sweep_ = 0;     // of the frame
  std::vector<int> margins_;  // of the bands of each sweep: the same in all frames
  std::optional<KeptPlanes> kept_;
  int kept_rows_ = 0;
  int first_ = 0;  // the band's first inner row
};

/// Numbers of planes, in sizes of the whole picture.
struct PlaneCount {
  double held = 0.0;  ///< by a frame
  double far = 0.0;   ///< of these, what passes read anywhere
  double averaged = 0.0;
  double waiting = 0.0;  ///< of the frame that stays, until frames agree; in bands alone
};

/// What drawing takes, about: what a pass does not need any more is kept all the same.
/// `passes`: planes besides what is averaged that are wanted.
PlaneCount count_planes(const DrawSettings& settings, const Recipe& recipe, int layers, int passes) {
  constexpr int kCaptured = 17;       // of each layer: with a second shadow, and emission
  constexpr double kBesides = 7.0;    // planes of one value, and what is handed out
  constexpr double kOfAverage = 6.0;  // the picture that is finished, and what that is made of
  const double reduced = 1.0 / double(recipe.occlusion_every * recipe.occlusion_every);
  std::set<std::string> full, small, far_full, far_small;
  for (std::string_view name : recipe.look->effects) {
    if (name == "occlusion") name = recipe.occlusion;
    const Effect* effect = find_effect(name);
    if (!effect) continue;
    const bool is_small =
        recipe.occlusion_every > 1 && (effect->kind == EffectKind::kOcclusion || effect->kind == EffectKind::kFilter);
    const ParameterBytes& params = recipe.settings.find(effect->name)->second;
    for (const Pass& pass : effect->passes) {
      if (pass.needed && !pass.needed(params)) continue;
      const auto there = [&](std::string_view plane) { return layer_of_plane(plane) < layers; };
      for (const std::string_view plane : pass.outputs)
        if (pass.for_all && there(plane)) (is_small ? small : full).emplace(plane);
      for (const std::string_view plane : pass.reach ? pass.far_inputs : pass.inputs)
        if (there(plane)) (is_small && pass.for_all ? far_small : far_full).emplace(plane);
    }
  }
  PlaneCount count;
  count.held = double(kCaptured * layers) + kBesides + double(full.size());
  if (!small.empty()) count.held += reduced * double(small.size() + std::size_t(kCaptured * layers)) + 8.0;
  count.far = double(far_full.size()) + reduced * double(far_small.size());
  if (recipe.frames > 1) {
    const PictureSum sum = empty_sum(recipe, settings.height);
    count.averaged = double(averaged_planes(settings, sum).size());
    // Lines of single frames, a byte each; what they agree on, and three bytes on the way there.
    constexpr double kOfAgreement = 1.0 + 3.0 / sizeof(float);
    if (sum.opacity > 0.0f) {
      count.averaged += std::min(recipe.frames, kMostLinePictures) / double(sizeof(float)) + kOfAgreement;
      count.waiting = passes;
    }
  }
  count.held += recipe.frames > 1 ? kOfAverage : 0.0;
  return count;
}

void put_rows(const Plane& rows, Plane& whole, int first) {
  for (int y = 0; y < rows.height; ++y) std::copy_n(rows.row(y), rows.width, whole.row(first + y));
}

}  // namespace

Result<BandPlan> plan_bands(const Device& device, const DrawSettings& settings, double memory, int passes) {
  constexpr double kBytes = sizeof(float);
  constexpr double kFixed = 150e6;         // the program and a scene
  constexpr double kMargin = 64.0;         // rows above and below a band
  constexpr int kLeast = 64, kMost = 512;  // rows of a band: of fewer most would be margin, more spare nothing
  const auto recipe = make_recipe(settings);
  if (!recipe) return recipe.error();
  const auto capture = capture_settings(settings, *recipe->look, kMostShadows, kMostBandPixels);
  if (!capture) return capture.error();
  const int layers = *layer_count(*capture);
  const PlaneCount count = count_planes(settings, *recipe, layers, passes);
  const double width = capture->width + 2.0 * capture->guard, height = capture->height + 2.0 * capture->guard;
  BandPlan plan;
  plan.bytes = kFixed + (count.held + count.averaged) * kBytes * width * height;
  const bool traced = !find_effect(recipe->occlusion) && recipe->occlusion != kNoOcclusion;
  const auto fits = capture_settings(settings, *recipe->look, kMostShadows);
  if (fits && plan.bytes <= memory) return plan;
  if (!device.draws_bands() || traced) {
    if (fits) return plan;
    return usage_error(
        "{}; larger pictures are drawn in bands, but not {}", fits.error().message,
        traced ? "with --ao reference" : fmt::format("on the device {}: try --device cpu", device.name()));
  }
  const double fixed = kFixed + (count.far + count.averaged + count.waiting) * kBytes * width * height;
  const double row = count.held * kBytes * width;
  const int rows = int(std::clamp((memory - fixed) / row - 2.0 * kMargin, double(kLeast), double(kMost)));
  plan.rows = rows / kLeast * kLeast;
  plan.bytes = fixed + row * (plan.rows + 2.0 * kMargin);
  return plan;
}

Result<void> draw_bands(Device& device, Scene& scene, const DrawSettings& settings, const BandPlan& plan,
                        const TakeRows& take, StageTimes& times) {
  auto drawing = begin_drawing(device, scene, settings, kMostBandPixels);
  if (!drawing) return drawing.error();
  BandProgress progress(device, settings.progress, drawing->recipe.frames);
  BandDrawer drawer(device, scene, *drawing, settings, times);
  PictureSum total = empty_sum(drawing->recipe, settings.height);
  const std::vector<std::string> averaged = averaged_planes(settings, total);
  const auto is_finished = [&](const std::string& name) {
    const auto& also = settings.averaged;
    return name.starts_with("color.") || std::find(also.begin(), also.end(), name) != also.end();
  };
  std::vector<std::string> wanted = plan.planes, single;  // of the frame that stays; and those of it alone
  for (const std::string& name : averaged)
    if (drawing->averages() && std::find(wanted.begin(), wanted.end(), name) == wanted.end()) wanted.push_back(name);
  std::copy_if(plan.planes.begin(), plan.planes.end(), std::back_inserter(single),
               [&](const std::string& name) { return !is_finished(name); });
  // Of averaged frames, so many rows of the picture; `rows`: what of them is of one frame.
  const auto take_average = [&](const PictureInfo& of_frame, const PictureSum& sum, const Image& rows,
                                int first) -> Result<void> {
    PictureInfo info = inner_info(of_frame);
    info.height = sum.sum.height;
    const auto color = finished_color(device, sum, *drawing, drawer.stops(), info);
    if (!color) return color.error();
    const Image means = mean_planes(sum, settings.averaged);
    Image finished(sum.sum.width, sum.sum.height);
    for (const std::string& name : plan.planes) {
      const Plane* made = color->find(name) ? color->find(name) : means.find(name);
      finished.add(name) = made ? *made : rows.plane(name);
    }
    times.done("average");
    return take(of_frame, finished, first);
  };
  // Where frames are to agree on lines, all of them must be there before any row is finished.
  const bool waits = drawing->averages() && total.opacity > 0.0f;
  Image kept(settings.width, settings.height);
  for (const std::string& name : single)
    if (waits) kept.add(name) = Plane(kept.width, kept.height);
  std::optional<PictureInfo> last_info;
  for (int k = drawing->recipe.frames - 1; k >= 0; --k) {
    const Camera camera = begin_frame(*drawing, k, settings);
    const bool last = k == 0;
    const auto averaged_of = [&](const Image& rows) {
      Image own(rows.width, rows.height);
      for (const std::string& name : averaged) own.add(name) = rows.plane(name);
      return own;
    };
    const auto add = [&](const Frame& frame, const Image& rows, int first) -> Result<void> {
      add_rows(total, last ? averaged_of(rows) : rows, first, settings.height, frame_offset(k, drawing->recipe.frames));
      if (last)
        for (std::size_t i = 0; i < kept.names.size(); ++i) put_rows(rows.plane(kept.names[i]), kept.planes[i], first);
      last_info = frame.info;
      times.done("average");
      return {};
    };
    const auto finish = [&](const Frame& frame, const Image& rows, int first) -> Result<void> {
      if (!drawing->averages()) return take(frame.info, rows, first);
      PictureSum sum = rows_of(total, first, rows.height);
      add_rows(sum, averaged_of(rows), 0, rows.height, glm::vec2(0.0f));
      sum.count = drawing->recipe.frames;
      return take_average(frame.info, sum, rows, first);
    };
    BandDrawer::Finish each = add;
    if (last && !waits) each = finish;
    if (auto done = drawer.draw_frame(camera, plan.rows, last ? wanted : averaged, each, progress); !done) return done;
  }
  if (waits) {
    agree_on_lines(total);
    times.done("average");
    for (int first = 0; first < settings.height; first += plan.rows) {
      const int count = std::min(plan.rows, settings.height - first);
      Image rows(settings.width, count);
      for (std::size_t i = 0; i < kept.names.size(); ++i)
        rows.add(kept.names[i]) = some_rows(kept.planes[i], first, count);
      if (auto done = take_average(*last_info, rows_of(total, first, count), rows, first); !done) return done;
    }
  }
  return progress.end();
}

}  // namespace umbrage
