// JPEG through libjpeg-turbo, PNG through libpng, WebP through libwebp, other formats through stb_image. What libjpeg
// and libpng refuse, such as CMYK, interlaced or damaged files, is left to stb_image, too: it reads more, and its
// errors name the cause.
#include "importer/decode_image.h"

#include <cstdio>
// jpeglib.h needs cstdio before it.
#include <jpeglib.h>
#include <png.h>
#include <webp/decode.h>

#include <algorithm>
#include <csetjmp>
#include <cstring>
#include <vector>

#include "core/byte_transfer.h"
#include "scene/readers/texture_file.h"

namespace umbrage {
namespace {

constexpr std::size_t kRgba = 4;
constexpr int kMaxBlock = 8;  // libjpeg's largest

/// Takes the rows of an image and averages blocks of texels, each channel by itself.
class Rows {
 public:
  /// `width` and `height`: of the rows; `block`: see block_side.
  Rows(int width, int height, int block, bool linear, Texture& texture)
      : block_(std::size_t(block)), transfer_(byte_transfer(linear)), texture_(texture) {
    texture.width = width / block;
    texture.height = height / block;
    texture.rgba.reserve(std::size_t(texture.width) * std::size_t(texture.height) * kRgba);
    if (block == 1) return;
    row_.resize(std::size_t(width) * kRgba);
    sums_.resize(std::size_t(texture.width));
  }

  /// Returns where the next row must be written before the call of `decoded`.
  std::uint8_t* next() { return block_ == 1 ? add_texels() : row_.data(); }
  void decoded() {
    if (block_ > 1) {
      add_row();
      if ((count_ + 1) % block_ == 0) write_row();
    }
    ++count_;
  }

 private:
  struct Sum {
    std::uint32_t color[3] = {}, alpha = 0;
  };

  /// Adds a row to the texture: while it is in the cache, setting it to 0 takes no time.
  std::uint8_t* add_texels() {
    const std::size_t begin = texture_.rgba.size();
    texture_.rgba.resize(begin + std::size_t(texture_.width) * kRgba);
    return &texture_.rgba[begin];
  }

  void add_row() {
    const std::uint8_t* texel = row_.data();
    for (Sum& sum : sums_) {
      for (std::size_t k = 0; k < block_; ++k, texel += kRgba) {
        for (std::size_t c = 0; c < 3; ++c) sum.color[c] += transfer_.linear[texel[c]];
        sum.alpha += texel[3];
      }
    }
  }

  void write_row() {
    const auto count = std::uint32_t(block_ * block_);
    std::uint8_t* to = add_texels();
    for (Sum& sum : sums_) {
      for (std::size_t c = 0; c < 3; ++c) *to++ = transfer_.byte[(sum.color[c] + count / 2) / count];
      *to++ = std::uint8_t((sum.alpha + count / 2) / count);
      sum = {};
    }
  }

  std::size_t block_, count_ = 0;
  const ByteTransfer& transfer_;
  Texture& texture_;
  std::vector<std::uint8_t> row_;
  std::vector<Sum> sums_;
};

bool can_be_decoded(std::int64_t width, std::int64_t height) {
  return width > 0 && height > 0 && width * height <= kMaxTexturePixels;
}

// ---- JPEG. libjpeg and libpng report errors by a call that must not return; here longjmp, so functions that call
// setjmp own nothing with a destructor.

struct JpegReader {
  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr manager{};
  std::jmp_buf jump;
  ~JpegReader() { jpeg_destroy_decompress(&jpeg); }
};

[[noreturn]] void on_jpeg_error(j_common_ptr jpeg) {
  std::longjmp(static_cast<JpegReader*>(jpeg->client_data)->jump, 1);
}

bool start(JpegReader& reader, std::span<const std::uint8_t> bytes) {
  jpeg_decompress_struct& jpeg = reader.jpeg;
  jpeg.err = jpeg_std_error(&reader.manager);
  jpeg.client_data = &reader;
  reader.manager.error_exit = on_jpeg_error;
  reader.manager.emit_message = [](j_common_ptr about, int level) {
    if (level < 0) on_jpeg_error(about);  // the data are damaged
  };
  if (setjmp(reader.jump)) return false;
  jpeg_create_decompress(&jpeg);
  jpeg_mem_src(&jpeg, bytes.data(), static_cast<unsigned long>(bytes.size()));
  jpeg_read_header(&jpeg, TRUE);
  jpeg.out_color_space = JCS_EXT_RGBA;
  return jpeg.num_components != 4 && can_be_decoded(jpeg.image_width, jpeg.image_height);
}

/// Averages linear values by inverse transforms of fewer coefficients, which takes the least time.
bool start_rows(JpegReader& reader, int block, bool linear) {
  if (setjmp(reader.jump)) return false;
  if (linear) reader.jpeg.scale_denom = unsigned(block);
  return jpeg_start_decompress(&reader.jpeg);
}

bool read_row(JpegReader& reader, std::uint8_t* row) {
  if (setjmp(reader.jump)) return false;
  return jpeg_read_scanlines(&reader.jpeg, &row, 1) == 1;
}

bool decode_jpeg(std::span<const std::uint8_t> bytes, const ImageUse& use, Texture& texture) {
  JpegReader reader;
  if (!start(reader, bytes)) return false;
  const int block = block_side(int(reader.jpeg.image_width), int(reader.jpeg.image_height), use.footprint);
  if (!start_rows(reader, block, use.linear)) return false;
  const int height = int(reader.jpeg.output_height);
  Rows rows(int(reader.jpeg.output_width), height, use.linear ? 1 : block, use.linear, texture);
  for (int y = 0; y < height; ++y, rows.decoded())
    if (!read_row(reader, rows.next())) return false;
  return true;
}

// ---- PNG

struct PngReader {
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::span<const std::uint8_t> bytes;
  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
};

[[noreturn]] void on_png_error(png_structp png, png_const_charp) { png_longjmp(png, 1); }

void read_png_bytes(png_structp png, png_bytep to, std::size_t count) {
  auto& bytes = static_cast<PngReader*>(png_get_io_ptr(png))->bytes;
  if (count > bytes.size()) on_png_error(png, "");
  std::memcpy(to, bytes.data(), count);
  bytes = bytes.subspan(count);
}

/// Reads the header, and sets the texels to 8-bit RGBA, as stb_image converts them.
bool start(PngReader& reader) {
  reader.png =
      png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, on_png_error, [](png_structp, png_const_charp) {});
  if (reader.png) reader.info = png_create_info_struct(reader.png);
  if (!reader.info) return false;
  if (setjmp(png_jmpbuf(reader.png))) return false;
  png_structp png = reader.png;
  png_set_read_fn(png, &reader, read_png_bytes);
  png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);             // can_be_decoded applies the limits
  png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);  // texts and profiles, which may be bombs
  png_set_crc_action(png, PNG_CRC_QUIET_USE, PNG_CRC_QUIET_USE);          // checksums take a tenth of the time
  png_read_info(png, reader.info);
  if (png_get_interlace_type(png, reader.info) != PNG_INTERLACE_NONE) return false;
  if (!can_be_decoded(png_get_image_width(png, reader.info), png_get_image_height(png, reader.info))) return false;
  png_set_expand(png);
  png_set_strip_16(png);
  png_set_gray_to_rgb(png);
  png_set_add_alpha(png, 255, PNG_FILLER_AFTER);
  png_read_update_info(png, reader.info);
  return png_get_rowbytes(png, reader.info) == png_get_image_width(png, reader.info) * kRgba;
}

bool read_row(PngReader& reader, std::uint8_t* row) {
  if (setjmp(png_jmpbuf(reader.png))) return false;
  png_read_row(reader.png, row, nullptr);
  return true;
}

bool decode_png(std::span<const std::uint8_t> bytes, const ImageUse& use, Texture& texture) {
  PngReader reader;
  reader.bytes = bytes;
  if (!start(reader)) return false;
  const int width = int(png_get_image_width(reader.png, reader.info)),
            height = int(png_get_image_height(reader.png, reader.info));
  Rows rows(width, height, block_side(width, height, use.footprint), use.linear, texture);
  for (int y = 0; y < height; ++y, rows.decoded())
    if (!read_row(reader, rows.next())) return false;
  return true;
}

// ---- other formats

Result<Texture> decode_webp(std::span<const std::uint8_t> bytes, const std::string& name) {
  Texture texture;
  texture.name = name;
  // A WebP image has at most 16383 x 16383 pixels.
  if (!WebPGetInfo(bytes.data(), bytes.size(), &texture.width, &texture.height) || texture.width <= 0 ||
      texture.height <= 0)
    return file_error("'{}' is a damaged WebP image", name);
  texture.rgba.resize(std::size_t(texture.width) * std::size_t(texture.height) * kRgba);
  if (!WebPDecodeRGBAInto(bytes.data(), bytes.size(), texture.rgba.data(), texture.rgba.size(),
                          int(kRgba) * texture.width))
    return file_error("'{}' is a damaged WebP image", name);
  return texture;
}

/// Averages blocks of texels of a decoded texture.
void reduce(const ImageUse& use, Texture& texture) {
  const int block = block_side(texture.width, texture.height, use.footprint);
  if (block == 1) return;
  const Texture whole = std::move(texture);
  texture = {.name = whole.name};
  Rows rows(whole.width, whole.height, block, use.linear, texture);
  const std::size_t row_size = std::size_t(whole.width) * kRgba;
  for (std::size_t at = 0; at < whole.rgba.size(); at += row_size, rows.decoded())
    std::memcpy(rows.next(), &whole.rgba[at], row_size);
}

bool starts_with(std::span<const std::uint8_t> bytes, std::size_t at, const char* text, std::size_t length) {
  return bytes.size() >= at + length && std::memcmp(bytes.data() + at, text, length) == 0;
}

}  // namespace

int block_side(int width, int height, float footprint) {
  int block = 1;
  const float texels = footprint * float(std::min(width, height));
  while (block < kMaxBlock && float(2 * block) <= texels && width % (2 * block) == 0 && height % (2 * block) == 0)
    block *= 2;
  return block;
}

Result<Texture> decode_texture_image(std::span<const std::uint8_t> bytes, const std::string& name,
                                     const ImageUse& use) {
  {
    Texture texture;
    texture.name = name;
    const bool is_jpeg = starts_with(bytes, 0, "\xff\xd8\xff", 3),
               is_png = starts_with(bytes, 0, "\x89PNG\r\n\x1A\n", 8);
    if ((is_jpeg && decode_jpeg(bytes, use, texture)) || (is_png && decode_png(bytes, use, texture))) return texture;
  }
  if (starts_with(bytes, 0, "\xABKTX 20\xBB\r\n\x1A\n", 12))
    return file_error("'{}' is a KTX2 image (KHR_texture_basisu), which is not read", name);
  const bool is_webp = starts_with(bytes, 0, "RIFF", 4) && starts_with(bytes, 8, "WEBP", 4);
  Result<Texture> texture = is_webp ? decode_webp(bytes, name) : decode_texture(bytes, name);
  if (texture) reduce(use, *texture);
  return texture;
}

}  // namespace umbrage
