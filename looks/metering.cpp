#include "looks/metering.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/lists.h"

namespace umbrage {

float stops_from_lights(const PictureInfo& info) {
  return info.lit_white_luminance > 0.0f && std::isfinite(info.lit_white_luminance)
             ? -std::log2(info.lit_white_luminance)
             : 0.0f;
}

void Metering::add(const Image& rows, int first, int height) {
  constexpr int kEvery = 3;  // one pixel in 3, across and down, is enough
  seen_.reserve(std::size_t(rows.width / kEvery + 1) * std::size_t(height / kEvery + 1));
  int y = std::min(kEvery / 2, height - 1);
  if (y < first) y += (first - y + kEvery - 1) / kEvery * kEvery;
  for (y -= first; y < rows.height; y += kEvery)
    for (int x = std::min(kEvery / 2, rows.width - 1); x < rows.width; x += kEvery) {
      if (!std::isfinite(rows.planes[3].at(x, y))) continue;
      const float luminance =
          0.2126f * rows.planes[0].at(x, y) + 0.7152f * rows.planes[1].at(x, y) + 0.0722f * rows.planes[2].at(x, y);
      if (std::isfinite(luminance)) seen_.push_back(std::max(luminance, 0.0f));
    }
}

float Metering::stops(float usual, Exposure by) {
  const float stops = by == Exposure::kMedian ? stops_by_median(usual) : stops_by_picture(usual);
  seen_ = {};
  return stops;
}

float Metering::stops_by_median(float usual) {
  constexpr double kHighlights = 0.03;      // fraction of the surface pixels that may be brighter than kMeteredBright
  constexpr float kAppliedFraction = 0.9f;  // fraction of the correction, in stops, that is applied
  constexpr float kMaxStops = 2.5f;         // bound of the correction, up or down
  if (seen_.empty()) return usual;
  const float median = quantile_of_reordered(seen_, 0.5), bright = quantile_of_reordered(seen_, 1.0 - kHighlights);
  if (!(median > 0.0f)) return usual;
  const float stops = std::min(std::log2(kMeteredMedian / median), std::log2(kMeteredBright / bright)) - usual;
  return usual + std::clamp(kAppliedFraction * stops, -kMaxStops, kMaxStops);
}

float Metering::stops_by_picture(float usual) {
  constexpr double kHighlights = 0.03;      // fraction of the surface pixels that may be brighter than white
  constexpr float kAppliedFraction = 0.7f;  // fraction of the correction, in stops, that is applied
  constexpr float kMaxStops = 2.5f;         // bound of the correction, up or down
  constexpr float kMaxBeyond = 1.0f;        // stops beyond white
  constexpr float kBlack = 1e-4f;           // relative to the brightest; darker values are clamped
  std::vector<float>& seen = seen_;
  if (seen.empty()) return usual;
  const float bright = quantile_of_reordered(seen, 1.0 - kHighlights);
  if (!(bright > 0.0f)) return usual;
  double logs = 0.0;
  for (const float v : seen) logs += std::log2(std::max(v, kBlack * bright));
  const float to_white = std::log2(kMeteredWhite / bright) - usual;
  const float to_grey = std::log2(kMeteredGrey) - float(logs / double(seen.size())) - usual;
  const float stops = std::max(to_white, std::min(to_grey, to_white + kMaxBeyond));
  return usual + std::clamp(kAppliedFraction * stops, -kMaxStops, kMaxStops);
}

Result<std::optional<float>> metered_stops(Device& device, const Frame& frame, Exposure by) {
  const auto image = device.view(frame, kMeteredPlanes);
  if (!image) return image.error();
  Metering metering;
  metering.add(*image, 0, image->height);
  return std::optional<float>(metering.stops(stops_from_lights(frame.info), by));
}

}  // namespace umbrage
