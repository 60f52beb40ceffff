#include "renderer/bands.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>

#include "core/check.h"
#include "devices/shared/neutral.h"
#include "effects/effects.h"
#include "looks/metering.h"
#include "renderer/drawing.h"
#include "renderer/lines.h"

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

  /// Draws all bands, as often as it takes; `planes` of what is finished go to `finish`. `lines`, if not null, gets the
  /// frame's lines.
  Result<void> draw_frame(const Camera& camera, int rows, const std::vector<std::string>& planes, const Finish& finish,
                          BandProgress& progress, Lines* lines) {
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
    if (lines) *lines = lines_of(*wholes);
    return {};
  }

 private:
  /// From the planes that the bands have gathered for the host step.
  Lines lines_of(WholePlanes& wholes) const {
    Image planes(info_.width, info_.height);
    for (const std::string_view name : edge_planes()) {
      planes.add(name) = Plane(info_.width, info_.height, neutral_value(name).value_or(0.0f));
      for (auto& [key, entry] : wholes.planes)
        if (std::get<0>(key) == info_.reduced && std::get<1>(key) == name) planes.plane(name) = std::move(entry.plane);
    }
    const ParameterBytes& params =
        drawing_.lines.empty() ? drawing_.recipe.settings.find("outline")->second : drawing_.lines;
    return traced_lines(info_, planes, params, device_.threads());
  }

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
    info_ = frame->info;
    const auto stops = run_look(run_, device_, *frame);
    if (!stops) return stops.error();
    if (auto done = draw_lines(device_, drawing_, *frame, times_); !done) return done;
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
  bool metering_ = false;  // in this sweep
  PictureInfo info_;
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
  double far = 0.0;   ///< of these, what passes read anywhere, and what they make on the host
  double averaged = 0.0;
};

/// What drawing takes, about: what a pass does not need any more is kept all the same.
PlaneCount count_planes(const DrawSettings& settings, const Recipe& recipe, int layers) {
  constexpr int kCaptured = 17;       // of each layer: with a second shadow, and emission
  constexpr double kBesides = 7.0;    // planes of one value, and what is handed out
  constexpr double kOfAverage = 6.0;  // the picture that is finished, and what that is made of
  const double reduced = 1.0 / double(recipe.occlusion_every * recipe.occlusion_every);
  constexpr double kOfHostStep = 3.0;  // what it works on: of lines edges, chains and where they lie
  double of_host_steps = 0.0;
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
      if (pass.host) far_full.insert(pass.outputs.begin(), pass.outputs.end());
      if (pass.host) of_host_steps += kOfHostStep;
    }
  }
  PlaneCount count;
  count.held = double(kCaptured * layers) + kBesides + double(full.size());
  if (!small.empty()) count.held += reduced * double(small.size() + std::size_t(kCaptured * layers)) + 8.0;
  count.far = double(far_full.size()) + reduced * double(far_small.size()) + of_host_steps;
  constexpr double kColor = 4.0;
  if (recipe.frames > 1) count.averaged = kColor + double(settings.averaged.size());
  count.held += recipe.frames > 1 ? kOfAverage : 0.0;
  return count;
}

}  // namespace

Result<BandPlan> plan_bands(const Device& device, const DrawSettings& settings, double memory) {
  constexpr double kBytes = sizeof(float);
  constexpr double kFixed = 150e6;         // the program and a scene
  constexpr double kMargin = 64.0;         // rows above and below a band
  constexpr int kLeast = 64, kMost = 512;  // rows of a band: of fewer most would be margin, more spare nothing
  const auto recipe = make_recipe(settings);
  if (!recipe) return recipe.error();
  const auto capture = capture_settings(settings, *recipe->look, kMostShadows, kMostBandPixels);
  if (!capture) return capture.error();
  const int layers = *layer_count(*capture);
  const PlaneCount count = count_planes(settings, *recipe, layers);
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
  const double fixed = kFixed + (count.far + count.averaged) * kBytes * width * height;
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
  PictureSum total{.for_eye = drawing->recipe.look->averages_for_eye};
  const std::vector<std::string> averaged = averaged_planes(settings, *drawing);
  const std::vector<std::string> also = also_averaged(settings, *drawing), of_lines = line_planes(*drawing);
  std::vector<std::string> wanted = plan.planes;  // of the frame that stays
  const auto want = [&](const std::string& name) {
    if (std::find(wanted.begin(), wanted.end(), name) == wanted.end()) wanted.push_back(name);
  };
  if (drawing->averages()) {
    std::for_each(averaged.begin(), averaged.end(), want);
    std::for_each(of_lines.begin(), of_lines.end(), want);
  }
  const auto chosen = [](const Image& rows, const std::vector<std::string>& names) {
    Image own(rows.width, rows.height);
    for (const std::string& name : names) own.add(name) = rows.plane(name);
    return own;
  };
  for (int k = drawing->recipe.frames - 1; k >= 0; --k) {
    const Camera camera = begin_frame(*drawing, k, settings);
    const auto add = [&](const Frame&, const Image& rows, int first) -> Result<void> {
      add_rows(total, rows, first, settings.height);
      times.done("average");
      return {};
    };
    const auto finish = [&](const Frame& frame, const Image& rows, int first) -> Result<void> {
      if (!drawing->averages()) return take(frame.info, rows, first);
      PictureSum sum = rows_of(total, first, rows.height);
      add_rows(sum, chosen(rows, averaged), 0, rows.height);
      sum.count = drawing->recipe.frames;
      PictureInfo info = inner_info(frame.info);
      info.height = rows.height;
      const auto color = finished_color(device, sum, *drawing, chosen(rows, of_lines), info);
      if (!color) return color.error();
      const Image means = mean_planes(sum, also);
      Image finished(rows.width, rows.height);
      for (const std::string& name : plan.planes) {
        const Plane* made = color->find(name) ? color->find(name) : means.find(name);
        finished.add(name) = made ? *made : rows.plane(name);
      }
      times.done("average");
      return take(frame.info, finished, first);
    };
    const bool last = k == 0;
    BandDrawer::Finish each = add;
    if (last) each = finish;
    Lines* const lines = last ? plan.lines : nullptr;
    if (auto done = drawer.draw_frame(camera, plan.rows, last ? wanted : averaged, each, progress, lines); !done)
      return done;
  }
  return progress.end();
}

}  // namespace umbrage
