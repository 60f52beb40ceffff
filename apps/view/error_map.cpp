#include "apps/view/error_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include "looks/looks.h"
#include "reference/reference.h"

namespace umbrage::view {
namespace {

constexpr std::size_t kMaxTruths = 2;  // two views may show two cameras
// Samples of the reference per pixel and run. At rest one run takes about as long as a picture.
constexpr int kSamplesPerRun = 16, kMovingSamples = 4;

/// Returns the request for the ground truth of a technique with its radius.
Request truth_request(Request request, const Recipe& recipe, int samples) {
  request.occlusion = reference_effect().name;
  const Effect* technique = find_named<Effect>(effects_with_external(), recipe.occlusion);
  const Parameter* radius = technique ? find_parameter(*technique, "radius") : nullptr;
  auto& settings = request.settings;
  const bool is_set = std::any_of(settings.begin(), settings.end(),
                                  [](const std::string& s) { return s.starts_with("reference.radius="); });
  if (request.occlusion_radius.empty() && radius && !is_set)
    settings.push_back("reference.radius=" + parameter_text(*radius, params_of(recipe.settings, recipe.occlusion)));
  settings.push_back(fmt::format("reference.samples={}", samples));
  settings.emplace_back("reference.light=off");
  return request;
}

/// Returns a key of what the ground truth depends on.
std::string truth_key(const std::string& model, const Request& request) {
  const CameraSettings& c = request.camera;
  const auto vector = [](const auto& v) { return v ? fmt::format("{}", fmt::join(*v, ",")) : std::string("-"); };
  std::string key = fmt::format("{} {}x{} {} {} {} {} {} {} {} {} {} {} {} {}", model, request.width, request.height,
                                c.index.value_or(-1), vector(c.position), vector(c.focal_point), vector(c.view_up),
                                vector(c.direction), c.view_angle_deg.value_or(0.0f), c.azimuth_deg, c.elevation_deg,
                                c.zoom, c.orthographic, request.occlusion_radius, request.ground);
  for (const std::string& setting : request.settings)
    if (setting.starts_with("reference.")) key += " " + setting;
  return key + " " + request.look;
}

}  // namespace

Image error_picture(const Plane& ao, const Plane& truth, const Plane& depth, ErrorNumbers& numbers) {
  constexpr glm::vec3 kRight(0.96f), kBright(0.78f, 0.16f, 0.04f), kDark(0.05f, 0.28f, 0.66f), kNothing(0.42f);
  Image picture(ao.width, ao.height);
  for (const char* name : {"color.r", "color.g", "color.b"}) picture.add(name) = Plane(ao.width, ao.height);
  double sum = 0.0, squares = 0.0;
  long pixels = 0;
  for (int y = 0; y < ao.height; ++y)
    for (int x = 0; x < ao.width; ++x) {
      glm::vec3 color = kNothing;
      if (std::isfinite(depth.at(x, y))) {
        const float error = std::clamp(ao.at(x, y), 0.0f, 1.0f) - truth.at(x, y);
        color = glm::mix(kRight, error > 0.0f ? kBright : kDark, std::min(std::abs(error) / kErrorRange, 1.0f));
        sum += error;
        squares += double(error) * error;
        ++pixels;
      }
      for (int channel = 0; channel < 3; ++channel) picture.planes[std::size_t(channel)].at(x, y) = color[channel];
    }
  numbers = pixels > 0 ? ErrorNumbers{std::sqrt(squares / double(pixels)), sum / double(pixels)} : ErrorNumbers{};
  return picture;
}

Result<ErrorMap::Drawn> ErrorMap::draw(ViewModel& model, DrawingDevice& device, const Request& request,
                                       const std::string& key, int runs, const DrawControl& control,
                                       StageTimes& times) {
  Request of_technique = request;
  of_technique.passes = {"ao"};
  of_technique.anti_aliasing = 1;  // averages of edges differ from those of the reference
  const auto recipe = make_recipe(of_technique);
  if (!recipe) return recipe.error();
  if (recipe->occlusion == kNoOcclusion || recipe->occlusion == reference_effect().name)
    return usage_error("the error is that of an occlusion technique, and `occlusion` is {}", recipe->occlusion);
  const Request of_truth = truth_request(of_technique, *recipe, control.moving ? kMovingSamples : kSamplesPerRun);
  const std::string full_key = truth_key(key, of_truth);
  auto truth = std::find_if(truths_.begin(), truths_.end(), [&](const Truth& t) { return t.key == full_key; });
  if (truth == truths_.end()) {
    truths_.push_front({.key = full_key, .sum = {}, .runs = 0});
    if (truths_.size() > kMaxTruths) truths_.pop_back();
    truth = truths_.begin();
  } else {
    truths_.splice(truths_.begin(), truths_, truth);
  }
  while (truth->runs < runs) {
    Request seeded = of_truth;
    seeded.settings.push_back(fmt::format("reference.seed={}", truth->runs));
    auto traced = model.planes(device, seeded, {"ao"}, control, times);
    if (!traced) return traced.error();
    Plane& ao = traced->plane("ao");
    if (truth->runs == 0) {
      truth->sum = std::move(ao);
    } else {
      for (int y = 0; y < ao.height; ++y)
        for (int x = 0; x < ao.width; ++x) truth->sum.at(x, y) += ao.at(x, y);
    }
    ++truth->runs;
  }
  const auto planes = model.planes(device, of_technique, {"ao", "depth"}, control, times);
  if (!planes) return planes.error();
  Plane mean = truth->sum;
  for (int y = 0; y < mean.height; ++y)
    for (int x = 0; x < mean.width; ++x) mean.at(x, y) /= float(truth->runs);
  Drawn drawn{.picture = {}, .error = {}, .runs = truth->runs};
  drawn.picture = error_picture(planes->plane("ao"), mean, planes->plane("depth"), drawn.error);
  times.done("compare");
  return drawn;
}

}  // namespace umbrage::view
