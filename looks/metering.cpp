#include "looks/metering.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace umbrage {

float usual_stops(const PictureInfo& info) {
  return info.usual_light > 0.0f && std::isfinite(info.usual_light) ? -std::log2(info.usual_light) : 0.0f;
}

Result<float> metered_stops(Device& device, const Frame& frame) {
  constexpr int kEvery = 3;             // pixels across and down: a tenth of them tells as much
  constexpr double kHighlights = 0.03;  // share of the surfaces that may be brighter than white
  constexpr float kHowFar = 0.7f;       // of the way to white, in stops
  constexpr float kMostStops = 2.5f;    // up or down
  constexpr float kMostBeyond = 1.0f;   // stops
  constexpr float kBlack = 1e-4f;       // of the brightest: what is darker tells nothing
  const auto image = device.download(frame, {"lit.r", "lit.g", "lit.b", "depth"});
  if (!image) return image.error();
  std::vector<float> seen;
  seen.reserve(std::size_t(image->width / kEvery + 1) * std::size_t(image->height / kEvery + 1));
  for (int y = std::min(kEvery / 2, image->height - 1); y < image->height; y += kEvery)
    for (int x = std::min(kEvery / 2, image->width - 1); x < image->width; x += kEvery) {
      if (!std::isfinite(image->planes[3].at(x, y))) continue;
      const float luminance = 0.2126f * image->planes[0].at(x, y) + 0.7152f * image->planes[1].at(x, y) +
                              0.0722f * image->planes[2].at(x, y);
      if (std::isfinite(luminance)) seen.push_back(std::max(luminance, 0.0f));
    }
  const float usual = usual_stops(frame.info);
  if (seen.empty()) return usual;
  const auto bright = seen.begin() + long(double(seen.size() - 1) * (1.0 - kHighlights));
  std::nth_element(seen.begin(), bright, seen.end());
  if (!(*bright > 0.0f)) return usual;
  double logs = 0.0;
  for (const float v : seen) logs += std::log2(std::max(v, kBlack * *bright));
  const float to_white = std::log2(kMeteredWhite / *bright) - usual;
  const float to_grey = std::log2(kMeteredGrey) - float(logs / double(seen.size())) - usual;
  const float stops = std::max(to_white, std::min(to_grey, to_white + kMostBeyond));
  return usual + std::clamp(kHowFar * stops, -kMostStops, kMostStops);
}

}  // namespace umbrage
