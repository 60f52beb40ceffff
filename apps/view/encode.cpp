#include "apps/view/encode.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstdint>
#include <cstdio>
// jpeglib.h needs cstdio before it.
#include <jpeglib.h>

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdlib>
#include <vector>

#include "io/image_file.h"

namespace umbrage::view {
namespace {

/// libjpeg reports errors by a call that must not return; here longjmp, so functions that call setjmp own nothing with
/// a destructor.
struct JpegError {
  jpeg_error_mgr manager;
  std::jmp_buf jump;
  char text[JMSG_LENGTH_MAX] = "";
};

[[noreturn]] void on_error(j_common_ptr jpeg) {
  auto* error = reinterpret_cast<JpegError*>(jpeg->err);
  (*error->manager.format_message)(jpeg, error->text);
  std::longjmp(error->jump, 1);
}

struct Compressor {
  jpeg_compress_struct jpeg{};
  JpegError error;
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  ~Compressor() {
    jpeg_destroy_compress(&jpeg);
    std::free(bytes);
  }
};

/// Encodes 8-bit pixels of 1 or 3 channels. Returns false after an error.
bool compress(Compressor& encoder, const std::uint8_t* pixels, int width, int height, int channels, int quality) {
  jpeg_compress_struct& jpeg = encoder.jpeg;
  jpeg.err = jpeg_std_error(&encoder.error.manager);
  encoder.error.manager.error_exit = on_error;
  encoder.error.manager.output_message = [](j_common_ptr) {};
  if (setjmp(encoder.error.jump)) return false;
  jpeg_create_compress(&jpeg);
  jpeg_mem_dest(&jpeg, &encoder.bytes, &encoder.size);
  jpeg.image_width = JDIMENSION(width);
  jpeg.image_height = JDIMENSION(height);
  jpeg.input_components = channels;
  jpeg.in_color_space = channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_set_defaults(&jpeg);  // 4:2:0
  jpeg_set_quality(&jpeg, quality, TRUE);
  jpeg.dct_method = JDCT_IFAST;
  jpeg_start_compress(&jpeg, TRUE);
  for (int y = 0; y < height; ++y) {
    JSAMPROW row = const_cast<JSAMPROW>(pixels + std::size_t(y) * std::size_t(width) * std::size_t(channels));
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  return true;
}

/// Returns a value as 8 bits; NaN as 0.
std::uint8_t byte_of(float value) {
  const float clamped = value > 0.0f ? std::min(value, 1.0f) : 0.0f;
  return std::uint8_t(clamped * 255.0f + 0.5f);
}

}  // namespace

Result<std::string> encode_jpeg(const Image& picture, int quality) {
  const std::array colors = {picture.find("color.r"), picture.find("color.g"), picture.find("color.b")};
  const int channels = colors[0] && colors[1] && colors[2] ? 3 : 1;
  const int width = picture.width, height = picture.height;
  std::vector<std::uint8_t> pixels(std::size_t(width) * std::size_t(height) * std::size_t(channels));
  constexpr int kRowsAtOnce = 32;
  tbb::parallel_for(tbb::blocked_range<int>(0, height, kRowsAtOnce), [&](const tbb::blocked_range<int>& rows) {
    for (int y = rows.begin(); y < rows.end(); ++y) {
      std::uint8_t* out = pixels.data() + std::size_t(y) * std::size_t(width) * std::size_t(channels);
      for (int channel = 0; channel < channels; ++channel) {
        const float* in = (channels == 3 ? *colors[std::size_t(channel)] : picture.planes[0]).row(y);
        for (int x = 0; x < width; ++x) out[x * channels + channel] = byte_of(in[x]);
      }
    }
  });
  Compressor encoder;
  if (!compress(encoder, pixels.data(), width, height, channels, quality))
    return Error{ErrorKind::kInternal, fmt::format("the picture cannot be encoded: {}", encoder.error.text)};
  return std::string(reinterpret_cast<const char*>(encoder.bytes), encoder.size);
}

Result<Encoded> encode(const Image& picture, bool exact) {
  const bool is_png = exact || picture.find("color.a");
  auto bytes = is_png ? encode_png("the picture", picture) : encode_jpeg(picture);
  if (!bytes) return bytes.error();
  return Encoded{std::move(*bytes), is_png ? "image/png" : "image/jpeg"};
}

}  // namespace umbrage::view
