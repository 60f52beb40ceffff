// Metering: the exposure that suits a picture, from how bright the surfaces in view are.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "core/device.h"

namespace umbrage {

/// Stops that bring white which is turned to the light to about 1: 0 but for a light that came with a file.
float usual_stops(const PictureInfo& info);

/// What is seen of a picture, row by row.
class Metering {
 public:
  /// Adds rows of a picture of that height, the first of them `first`. Reads `lit`, linear, and `depth`.
  void add(const Image& rows, int first, int height);

  /// Stops to add. From `usual`, those of usual_stops, on: the brightest surfaces, highlights left aside, are brought
  /// towards kMeteredWhite, or beyond by up to a stop where most of the picture is far darker than they are and its
  /// middle, the geometric mean, below kMeteredGrey; though only so far: what is dark is to look dark. Those alone
  /// where nothing is in view. The rows are then forgotten.
  float stops(float usual);

 private:
  std::vector<float> seen_;  ///< luminance of surfaces
};

/// The planes that it reads.
inline const std::vector<std::string> kMeteredPlanes = {"lit.r", "lit.g", "lit.b", "depth"};

/// Stops to add to a whole picture.
Result<std::optional<float>> metered_stops(Device& device, const Frame& frame);

inline constexpr float kMeteredWhite = 0.72f;
inline constexpr float kMeteredGrey = 0.2f;

}  // namespace umbrage
