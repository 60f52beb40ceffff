// WebP through libwebp, only written. A WebP file without a profile is sRGB (WebP Container Specification).
#include <webp/encode.h>

#include <cstdio>
#include <vector>

#include "io/format.h"

namespace umbrage {
namespace fs = std::filesystem;
namespace {

constexpr int kLossless = 100;  ///< quality

/// A picture of libwebp.
struct Picture {
  WebPPicture data{};
  bool ready = WebPPictureInit(&data) != 0;
  ~Picture() { WebPPictureFree(&data); }
};

int write_bytes(const std::uint8_t* bytes, std::size_t count, const WebPPicture* picture) {
  return std::fwrite(bytes, 1, count, static_cast<std::FILE*>(picture->custom_ptr)) == count;
}

/// Encodes interleaved RGB or RGBA.
Result<void> encode(std::FILE* stream, const fs::path& name, const ImageShape& shape, int channels, int quality,
                    const std::vector<std::uint8_t>& pixels) {
  Picture picture;
  WebPConfig config;
  if (!picture.ready || !WebPConfigInit(&config)) return device_error("libwebp cannot be started");
  config.lossless = quality == kLossless;
  config.quality = float(quality);
  config.method = 4;
  config.exact = 1;          // keeps the colour of transparent pixels
  config.use_sharp_yuv = 1;  // keeps coloured lines sharp
  picture.data.use_argb = 1;
  picture.data.width = shape.width;
  picture.data.height = shape.height;
  picture.data.writer = write_bytes;
  picture.data.custom_ptr = stream;
  const int stride = shape.width * channels;
  const int imported = channels == 4 ? WebPPictureImportRGBA(&picture.data, pixels.data(), stride)
                                     : WebPPictureImportRGB(&picture.data, pixels.data(), stride);
  if (imported && WebPEncode(&config, &picture.data)) return {};
  if (!imported || picture.data.error_code == VP8_ENC_ERROR_OUT_OF_MEMORY ||
      picture.data.error_code == VP8_ENC_ERROR_BITSTREAM_OUT_OF_MEMORY)
    return device_error("not enough memory to write '{}'", name.string());
  return file_error("'{}' cannot be written as WebP (error {} of libwebp)", name.string(),
                    int(picture.data.error_code));
}

Result<void> write_webp(const fs::path& file, const ImageShape& shape, const WriteSettings& settings,
                        const MakeImageRows& make) {
  const Image bare = image_without_pixels(shape);
  const auto planes = picture_planes(file, bare, true);
  if (!planes) return planes.error();
  if (std::max(shape.width, shape.height) > WEBP_MAX_DIMENSION)
    return file_error("'{}' cannot be written: WebP has at most {} pixels per side, and the picture has {} x {}",
                      file.string(), WEBP_MAX_DIMENSION, shape.width, shape.height);
  const bool grey = planes->size() == 1;
  const int channels = grey ? 3 : int(planes->size());
  return write_atomically(file, [&](std::FILE* stream) -> Result<void> {
    std::vector<std::uint8_t> pixels(std::size_t(shape.width) * std::size_t(shape.height) * std::size_t(channels));
    std::uint8_t* row = pixels.data();
    Result<void> made = make([&](const Image& rows) -> Result<void> {
      auto taken = picture_planes(file, rows, true);
      if (!taken) return taken.error();
      if (grey) taken->resize(3, (*taken)[0]);
      for (int y = 0; y < rows.height; ++y, row += std::ptrdiff_t(shape.width) * channels) bytes_of_row(*taken, y, row);
      return {};
    });
    if (!made) return made;
    return encode(stream, file, shape, channels, settings.quality, pixels);
  });
}

bool is_webp(std::string_view start) {
  constexpr std::size_t kForm = 8;  // after the mark and a size; sound and video begin with RIFF, too
  return start.size() > kForm && start.starts_with("RIFF") && start.substr(kForm).starts_with("WEBP");
}

}  // namespace

const ImageFormat kWebp = {
    "webp", "8 bit RGB or RGBA pictures, sRGB, only written", write_webp, nullptr, is_webp, true, true, 8};

}  // namespace umbrage
