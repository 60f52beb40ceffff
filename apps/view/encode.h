// Encoding of pictures for the page: JPEG while something moves, PNG at rest.
#pragma once
#include <string>

#include "core/image.h"
#include "core/result.h"

namespace umbrage::view {

/// Quality of the JPEG of a moving picture, 1 to 100: artefacts are not seen in motion, and decoding is fast.
inline constexpr int kMovingQuality = 80;

/// Returns a baseline JPEG with colour at half resolution (4:2:0), encoded for speed. `picture`: planes color.r, .g and
/// .b, or one plane, as grey; display values, clamped to [0, 1], NaN as 0; other planes are ignored. Errors:
/// kInternal if libjpeg fails.
Result<std::string> encode_jpeg(const Image& picture, int quality = kMovingQuality);

/// A picture as the page gets it.
struct Encoded {
  std::string bytes;
  const char* format = "";  ///< "image/jpeg" or "image/png"
};

/// Encodes a picture: PNG if it is `exact` or has alpha, else JPEG. A PNG has the pixels that write_image writes.
Result<Encoded> encode(const Image& picture, bool exact);

}  // namespace umbrage::view
