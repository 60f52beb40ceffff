#include "apps/view/quality.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "looks/presets.h"
#include "reference/reference.h"
#include "renderer/options.h"

namespace umbrage::view {
namespace {

constexpr double kMinScale = 0.2, kFirstScale = 0.5;      // fractions of the width and of the height
constexpr std::string_view kRays = "reference.samples=";  // per pixel
constexpr int kFewRays = 4;
constexpr int kStep = 8;  // sizes are multiples of this, pixels

/// Rounds a side to a multiple of kStep; a side that is nearly full size becomes it.
int rounded_side(double side, int full) {
  const int rounded = std::max(int(std::lround(side / kStep)) * kStep, 2 * kStep);
  return std::min(rounded, full);
}

}  // namespace

Result<Request> request_of(const View& view, int width, int height, bool is_gbuffer) {
  Request request;
  for (const auto& [name, values] : view.options) {
    const Option* row = find_option(name, is_gbuffer ? kShade : kRender);
    // A view may switch between a model and a G-buffer: options of the other one are ignored.
    if (!row && find_option(name, is_gbuffer ? kRender : kShade)) continue;
    if (!row) return usage_error("there is no option --{}", name);
    for (const std::string& value : values)
      if (auto set = set_option(*row, value, request); !set) {
        set.error().message = with_option_names(set.error().message);
        return set.error();
      }
  }
  request.width = width;
  request.height = height;
  request.passes.clear();
  request.values = PictureValues::kDisplay8;  // PNG and JPEG
  if (view.show == "reference")
    request.occlusion = "reference";
  else if (view.show != "picture" && view.show != "error")
    request.passes = {view.show};
  return request;
}

Request moving_request(Request request) {
  request.quality = qualities().front().name;
  request.anti_aliasing = 1;
  return request;
}

bool is_traced(const Request& request) { return request.occlusion == reference_effect().name; }

bool averages_few_rays(const Request& request) {
  const auto& settings = request.settings;
  return is_traced(request) && !request.anti_aliasing && request.quality.empty() && request.passes.empty() &&
         std::none_of(settings.begin(), settings.end(), [](const auto& s) { return s.starts_with(kRays); });
}

Request with_few_rays(Request request) {
  request.settings.push_back(fmt::format("{}{}", kRays, kFewRays));
  request.anti_aliasing = 1;
  return request;
}

bool gets_averaged(const Request& request, bool is_gbuffer) {
  if (averages_few_rays(request)) return true;
  if (is_gbuffer || request.anti_aliasing || !request.quality.empty() || !request.passes.empty()) return false;
  const auto recipe = make_recipe(request);
  return recipe && recipe->frames == 1;
}

void simplify_moving(Plan& plan) {
  plan.capture.shadow_rays = 0;
  plan.recipe.capture.shadow_rays = 0;
}

std::pair<int, int> ResolutionControl::size(const std::string& key, int width, int height) {
  const double full = double(width) * height;
  Known& known = known_[key];
  const double wanted =
      known.ms_per_pixel > 0.0 ? kMovingFrame_ms / known.ms_per_pixel : full * kFirstScale * kFirstScale;
  // Sizes change only where it matters, so that the picture does not pump.
  constexpr double kTooSlow = 1.25, kTooFast = 0.65;  // relative numbers of pixels
  if (known.pixels <= 0.0 || wanted < known.pixels / kTooSlow || wanted > known.pixels / kTooFast)
    known.pixels = wanted;
  const double scale = std::clamp(std::sqrt(known.pixels / full), kMinScale, 1.0);
  constexpr double kNearlyFull = 0.95;
  if (scale >= kNearlyFull) return {width, height};
  return {rounded_side(width * scale, width), rounded_side(height * scale, height)};
}

void ResolutionControl::add(const std::string& key, int width, int height, double ms) {
  Known& known = known_[key];
  const double measured = ms / (double(width) * height);
  constexpr double kWeight = 0.35;  // of the last frame
  known.ms_per_pixel = known.ms_per_pixel > 0.0
                           ? std::exp((1.0 - kWeight) * std::log(known.ms_per_pixel) + kWeight * std::log(measured))
                           : measured;
}

double ResolutionControl::expected_ms(const std::string& key, int width, int height) const {
  const auto found = known_.find(key);
  return found != known_.end() ? found->second.ms_per_pixel * width * height : 0.0;
}

}  // namespace umbrage::view
