#include "looks/metering.h"

#include <algorithm>
#include <cmath>

#include "core/lists.h"

namespace umbrage {

float stops_from_lights(const PictureInfo& info) {
  return info.lit_white_luminance > 0.0f && std::isfinite(info.lit_white_luminance)
             ? -std::log2(info.lit_white_luminance)
             : 0.0f;
}

void Metering::add(const Image& rows, int first, int height) {
  constexpr int kEvery = 3;  // one pixel in 3, across and down, is enough
  const std::size_t count = std::size_t(rows.width / kEvery + 1) * std::size_t(height / kEvery + 1);
  brightness_.reserve(count);
  peaks_.reserve(count);
  int y = std::min(kEvery / 2, height - 1);
  if (y < first) y += (first - y + kEvery - 1) / kEvery * kEvery;
  for (y -= first; y < rows.height; y += kEvery)
    for (int x = std::min(kEvery / 2, rows.width - 1); x < rows.width; x += kEvery) {
      if (!std::isfinite(rows.planes[3].at(x, y))) continue;
      const float r = rows.planes[0].at(x, y), g = rows.planes[1].at(x, y), b = rows.planes[2].at(x, y);
      const float luminance = 0.2126f * r + 0.7152f * g + 0.0722f * b;
      if (!std::isfinite(luminance)) continue;
      const float peak = std::max({r, g, b, 0.0f});
      brightness_.push_back(0.5f * (std::max(luminance, 0.0f) + peak));
      peaks_.push_back(peak);
    }
}

float Metering::stops(float usual) {
  constexpr double kHighlights = 0.03;   // fraction of the surface pixels that may be brighter than kMeteredWhite
  constexpr float kBeyondWhite = 0.5f;   // fraction of the stops from there to the median's target that are added
  constexpr float kHalvedStops = 16.0f;  // correction of which half is applied; the smaller, the more of it
  const float median = quantile_of_reordered(brightness_, 0.5);
  const float highlight = quantile_of_reordered(peaks_, 1.0 - kHighlights);
  brightness_ = {}, peaks_ = {};
  if (!(median > 0.0f)) return usual;
  const float to_median = std::log2(kMeteredMedian / median), to_white = std::log2(kMeteredWhite / highlight);
  const float stops = std::min(to_median, to_white + kBeyondWhite * std::max(to_median - to_white, 0.0f)) - usual;
  return usual + stops / (1.0f + std::fabs(stops) / kHalvedStops);
}

Result<std::optional<float>> metered_stops(Device& device, const Frame& frame) {
  const auto image = device.view(frame, kMeteredPlanes);
  if (!image) return image.error();
  Metering metering;
  metering.add(*image, 0, image->height);
  return std::optional<float>(metering.stops(stops_from_lights(frame.info)));
}

}  // namespace umbrage
