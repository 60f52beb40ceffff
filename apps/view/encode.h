// Encoding of pictures for the page: JPEG while something moves, PNG at rest.
#pragma once
#include <string>

#include "core/image.h"
#include "core/result.h"

namespace umbrage::view {

/// Quality of the JPEG of a moving picture, 1 to 100: artefacts are not seen in motion, and decoding is fast.
inline constexpr int kMovingQuality = 80;

/// A picture as the page gets it.
struct Encoded {
  std::string bytes;
  const char* format = "";  ///< "image/jpeg" or "image/png"
};

/// Encodes a picture: PNG if it is `exact` or has alpha, else JPEG. A PNG has the pixels that write_image writes.
Result<Encoded> encode(const Image& picture, bool exact);

}  // namespace umbrage::view
