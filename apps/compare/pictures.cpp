#include "apps/compare/pictures.h"

#include <algorithm>
#include <cmath>

#include "effects/effects.h"
#include "reference/reference.h"
#include "renderer/times.h"

namespace umbrage {
namespace {

constexpr float kTurnDeg = 120.0f;  // angle between neighbouring cameras around a scene without views
constexpr int kTurns = 3;           // number of such cameras: 3 * 120 degrees is a full turn
// Seeds of the two halves of the ground truth. Users are unlikely to choose them for the technique `reference`.
constexpr std::uint32_t kFirstSeed = 0x51ed2701u, kSecondSeed = 0x0b5e77edu;

}  // namespace

const std::array<std::vector<std::string>, kQuantities> kQuantityPlanes = {{{"ao"},
                                                                            {"indirect.r", "indirect.g", "indirect.b"},
                                                                            {"sky0.r", "sky0.g", "sky0.b"},
                                                                            {"sky1.r", "sky1.g", "sky1.b"},
                                                                            {"sky2.r", "sky2.g", "sky2.b"}}};

Result<Truth> trace_truth(Quantity quantity, const PictureInfo& info, const ClassMap& classes,
                          const std::function<Result<Image>(std::uint32_t seed)>& trace) {
  const auto first = trace(kFirstSeed);
  if (!first) return first.error();
  const auto second = trace(kSecondSeed);
  if (!second) return second.error();
  Truth truth;
  truth.quantity = quantity;
  truth.planes = Image(info.inner_width(), info.inner_height());
  double squared_errors = 0.0;
  long values = 0;
  for (const std::string& name : kQuantityPlanes[int(quantity)]) {
    const bool is_first_plane = truth.planes.planes.empty();
    Plane& mean = truth.planes.add(name);
    const Plane a = cropped(first->plane(name), info.guard), b = cropped(second->plane(name), info.guard);
    for (int y = 0; y < mean.height; ++y)
      for (int x = 0; x < mean.width; ++x) {
        mean.at(x, y) = 0.5f * (a.at(x, y) + b.at(x, y));
        if (classes.row(y)[x] == PixelClass::kBackground) continue;
        const double half_difference = 0.5 * (double(a.at(x, y)) - double(b.at(x, y)));
        squared_errors += half_difference * half_difference;
        ++values;
        if (!is_first_plane) continue;
        truth.sum += mean.at(x, y);
        ++truth.pixels;
      }
  }
  truth.error = values > 0 ? squared_errors / double(values) : 0.0;
  return truth;
}

std::vector<CameraShot> shots_of(const Scene& scene, const Framing& requested, int cameras) {
  if (requested.position || requested.focal_point || requested.direction) return {{"given", requested, {}}};
  std::vector<CameraShot> shots;
  const int count = std::min(cameras, scene.views.empty() ? kTurns : int(scene.views.size()));
  for (int k = 0; k < count; ++k) {
    CameraShot shot{fmt::format("{}", k + 1), requested, {}};
    if (scene.views.empty())
      shot.framing.azimuth_deg += kTurnDeg * float(k);
    else
      shot.views = {scene.views[k]};
    shots.push_back(shot);
  }
  return shots;
}

Result<GBuffer> download_gbuffer(Device& device, const Frame& frame) {
  auto planes = device.download(frame, {"depth", "normal.x", "normal.y", "normal.z"});
  if (!planes) return planes.error();
  return GBuffer{inner_info(frame.info), {std::move(*planes)}};
}

Result<double> median_time(const LookRun& run, Device& device, Frame& frame, int runs, bool warms_up) {
  std::vector<double> ms;
  for (int k = warms_up ? 0 : 1; k <= runs; ++k) {
    StageTimes times;
    if (auto status = run_look(run, device, frame); !status) return status.error();
    if (auto finished = device.finish(); !finished) return finished.error();
    times.done("run");
    if (k > 0) ms.push_back(times.total());
  }
  std::sort(ms.begin(), ms.end());
  return ms[ms.size() / 2];
}

const Effect* look_filter(const Look& look) {
  for (const std::string_view name : look.effects)
    if (const Effect* effect = find_effect(name); effect && effect->kind == EffectKind::kFilter) return effect;
  return nullptr;
}

double covered_rmse(const Image& a, const Image& b, const ClassMap& classes) {
  const Plane &ao_a = a.plane("ao"), &ao_b = b.plane("ao");
  double sum = 0.0;
  long pixels = 0;
  for (int y = 0; y < ao_a.height; ++y)
    for (int x = 0; x < ao_a.width; ++x) {
      if (classes.row(y)[x] == PixelClass::kBackground) continue;
      const double difference = double(ao_a.at(x, y)) - double(ao_b.at(x, y));
      sum += difference * difference;
      ++pixels;
    }
  return pixels > 0 ? std::sqrt(sum / double(pixels)) : 0.0;
}

void clamp_occlusion(Image& image) {
  Plane& ao = image.plane("ao");
  for (int y = 0; y < ao.height; ++y)
    for (int x = 0; x < ao.width; ++x) ao.at(x, y) = std::clamp(ao.at(x, y), 0.0f, 1.0f);
}

Result<void> check_picture_options(const std::vector<std::string>& models, int cameras, int samples, int runs) {
  if (!kCameras.has(cameras))
    return field_error("--cameras", cameras, "{} cannot be '{}': it takes {}", kCameras.words());
  if (!kRuns.has(runs)) return field_error("--runs", runs, "{} cannot be '{}': it takes {}", kRuns.words());
  if (!kSamples.has(samples))
    return field_error("--samples", samples, "{} cannot be '{}': it takes {}", kSamples.words());
  for (const std::string& model : models)
    if (std::count(models.begin(), models.end(), model) > 1) return usage_error("the model '{}' is given twice", model);
  return {};
}

std::string reference_radius() {
  const Effect& reference = reference_effect();
  return parameter_text(*find_parameter(reference, "radius"),
                        initial_parameters(reference.parameters, reference.params_size));
}

}  // namespace umbrage
