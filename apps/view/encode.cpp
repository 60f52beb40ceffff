#include "apps/view/encode.h"

#include "io/image_file.h"

namespace umbrage::view {

Result<Encoded> encode(const Image& picture, bool exact) {
  const bool is_png = exact || picture.find("color.a");
  auto bytes = is_png ? encode_png("the picture", picture) : encode_fast_jpeg("the picture", picture, kMovingQuality);
  if (!bytes) return bytes.error();
  return Encoded{std::move(*bytes), is_png ? "image/png" : "image/jpeg"};
}

}  // namespace umbrage::view
