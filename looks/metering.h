// Metering: computes the exposure of a picture from the luminance of its visible surfaces.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "core/device.h"

namespace umbrage {

/// Returns the stops that bring a white surface facing the light to about 1: -log2(info.lit_white_luminance). 0 unless
/// the light comes from a file.
float stops_from_lights(const PictureInfo& info);

/// Collects the luminance of the visible surfaces of a picture, row by row.
class Metering {
 public:
  /// Adds rows of a picture that is `height` pixels high; `first` is the number of the first of these rows. The planes
  /// are those of kMeteredPlanes, in that order: linear `lit`, and `depth`.
  void add(const Image& rows, int first, int height);

  /// Returns the stops to add to the exposure, and clears the collected rows. `usual` is the result of
  /// stops_from_lights. The correction of `usual` is partial and limited, so that a dark scene still looks dark.
  /// Returns `usual` if no surface is visible.
  /// kPicture: the brightest surfaces, without highlights, approach kMeteredWhite; up to one stop beyond if most of the
  /// picture is far darker than they are and the geometric mean is below kMeteredGrey.
  /// kMedian: the median of the luminance approaches kMeteredMedian, unless that makes more than a few highlights
  /// brighter than kMeteredBright.
  float stops(float usual, Exposure by);

 private:
  float stops_by_picture(float usual);
  float stops_by_median(float usual);

  std::vector<float> seen_;  ///< luminance of one surface pixel each, linear
};

/// The planes that Metering reads.
inline const std::vector<std::string> kMeteredPlanes = {"lit.r", "lit.g", "lit.b", "depth"};

/// Returns the stops to add to the exposure of a whole picture.
Result<std::optional<float>> metered_stops(Device& device, const Frame& frame, Exposure by);

inline constexpr float kMeteredWhite = 0.72f;   ///< target luminance of the brightest surfaces
inline constexpr float kMeteredGrey = 0.2f;     ///< target of the geometric mean of the luminance
inline constexpr float kMeteredBright = 1.0f;   ///< bound of the brightest surfaces, without highlights
inline constexpr float kMeteredMedian = 0.38f;  ///< target of the median: 159 of 255 after output.tone=neutral

}  // namespace umbrage
