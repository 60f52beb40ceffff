// Metering: computes the exposure of a picture from the brightness of its visible surfaces.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "core/device.h"

namespace umbrage {

/// Returns the stops that bring a white surface facing the light to about 1: -log2(info.lit_white_luminance). 0 unless
/// the light comes from a file.
float stops_from_lights(const PictureInfo& info);

/// Collects the brightness of the visible surfaces of a picture, row by row: the mean of the luminance and of the
/// brightest channel, since saturated colours look brighter than their luminance. Grey has both alike.
class Metering {
 public:
  /// Adds rows of a picture that is `height` pixels high; `first` is the number of the first of these rows. The planes
  /// are those of kMeteredPlanes, in that order: linear `lit`, and `depth`.
  void add(const Image& rows, int first, int height);

  /// Returns the stops to add to the exposure, and clears the collected rows. `usual` is the result of
  /// stops_from_lights. The median of the brightness approaches kMeteredMedian. If more than a few highlights would
  /// then have a channel beyond kMeteredWhite, where the tone curve makes colours pale, the exposure goes only half
  /// the way from there to the median: what is in the sun gets paler, what is in shade readable. Of a large correction
  /// of `usual` less is applied, so that a dark scene still looks dark. Returns `usual` if no surface is visible.
  float stops(float usual);

 private:
  std::vector<float> brightness_, peaks_;  ///< of one surface pixel each, linear; peak: the brightest channel
};

/// The planes that Metering reads.
inline const std::vector<std::string> kMeteredPlanes = {"lit.r", "lit.g", "lit.b", "depth"};

/// Returns the stops to add to the exposure of a whole picture.
Result<std::optional<float>> metered_stops(Device& device, const Frame& frame);

inline constexpr float kMeteredWhite = 1.05f;    ///< bound of the brightest channel, without highlights
inline constexpr float kMeteredMedian = 0.395f;  ///< target of the median: 161 of 255 after output.tone=neutral

}  // namespace umbrage
