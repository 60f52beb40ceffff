// PNG, 8 and 16 bit, through libpng. Based on the PNG specification, third edition (W3C 2025).
//
// Row filter and deflate strategy are chosen for speed. Deflate alone, one core of an Intel Xeon, zlib 1.2.13, 1024 x
// 1024 RGB of 8 bit, best of 5; the bunny has a dithered background, in which run lengths are useless:
//   filter, strategy      bunny, studio      claw, hatching     Sponza, studio
//   up, run lengths       18.7 ms, 874 kB    11.6 ms, 1097 kB   27.7 ms, 1730 kB
//   sub, run lengths      18.3 ms, 828 kB    10.8 ms, 1078 kB   28.9 ms, 1768 kB
//   up, level 1           13.5 ms, 494 kB    12.5 ms,  650 kB   32.7 ms, 1742 kB    <- used
//   sub, level 1          13.0 ms, 472 kB    12.2 ms,  638 kB   35.0 ms, 1809 kB
// The test PngFile.EncodesSmoothShadingSmallAndFast prints time and size of such a sphere, including conversion and
// file.
#include <png.h>
#include <zlib.h>

#include <bit>
#include <csetjmp>
#include <cstdint>
#include <cstdlib>
#include <new>

#include "io/format.h"
#include "io/layer_format.h"
#include "io/samples.h"

namespace umbrage {
namespace fs = std::filesystem;
namespace {

/// The last error message of libpng. libpng reports errors by longjmp, so functions that call setjmp own nothing with a
/// destructor.
struct PngError {
  char text[128] = "";
};

[[noreturn]] void on_error(png_structp png, png_const_charp text) {
  auto* png_error = static_cast<PngError*>(png_get_error_ptr(png));
  std::snprintf(png_error->text, sizeof png_error->text, "%s", text);
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

/// Converts a row of Channels planes to interleaved Integers: [0, 1] rounded to nearest, NaN as 0.
template <class Integer, int Channels>
void quantise(const float* const* rows, int width, Integer* out) {
  constexpr float kMax = float(Integer(~Integer(0)));
  for (int x = 0; x < width; ++x)
    for (int c = 0; c < Channels; ++c) {
      const float v = rows[c][x] > 0.0f ? rows[c][x] : 0.0f;
      *out++ = Integer(std::int32_t((v < 1.0f ? v : 1.0f) * kMax + 0.5f));
    }
}

template <class Integer>
void quantise_row(const Plane* const* planes, int channels, int y, Integer* out) {
  const float* rows[4] = {};
  for (int c = 0; c < channels; ++c) rows[c] = planes[c]->row(y);
  const int width = planes[0]->width;
  if (channels == 1) quantise<Integer, 1>(rows, width, out);
  if (channels == 3) quantise<Integer, 3>(rows, width, out);
  if (channels == 4) quantise<Integer, 4>(rows, width, out);
}

/// A PNG being written.
struct PngWriter {
  png_structp png = nullptr;
  png_infop info = nullptr;
  PngError png_error;
  ~PngWriter() { png_destroy_write_struct(&png, &info); }
};

bool start(PngWriter& writer, std::FILE* stream, int width, int height, int channels, const WriteSettings& settings) {
  writer.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &writer.png_error, on_error, on_warning);
  if (writer.png) writer.info = png_create_info_struct(writer.png);
  if (!writer.info) {
    std::snprintf(writer.png_error.text, sizeof writer.png_error.text, "libpng cannot be started");
    return false;
  }
  png_structp png = writer.png;
  if (setjmp(png_jmpbuf(png))) return false;
  const int type = channels == 1 ? PNG_COLOR_TYPE_GRAY : channels == 3 ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGB_ALPHA;
  png_init_io(png, stream);
  png_set_IHDR(png, writer.info, width, height, settings.bits, type, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  constexpr double kInchesPerMetre = 1.0 / 0.0254;
  if (const auto per_metre = png_uint_32(std::lround(settings.dpi * kInchesPerMetre)))
    png_set_pHYs(png, writer.info, per_metre, per_metre, PNG_RESOLUTION_METER);
  if (channels > 1) png_set_sRGB(png, writer.info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, settings.small ? PNG_ALL_FILTERS : PNG_FILTER_UP);
  png_set_compression_level(png, settings.small ? Z_BEST_COMPRESSION : Z_BEST_SPEED);
  png_set_compression_strategy(png, settings.small ? Z_FILTERED : Z_DEFAULT_STRATEGY);
  constexpr int kChunkBytes = 1 << 16;  // libpng's default of 8 kB makes many small chunks
  png_set_compression_buffer_size(png, kChunkBytes);
  png_write_info(png, writer.info);
  if (settings.bits == 16 && std::endian::native == std::endian::little) png_set_swap(png);
  return true;
}

bool write_rows(PngWriter& writer, const Plane* const* planes, int channels, int bits, png_byte* row) {
  if (setjmp(png_jmpbuf(writer.png))) return false;
  for (int y = 0; y < planes[0]->height; ++y) {
    if (bits == 16)
      quantise_row(planes, channels, y, reinterpret_cast<std::uint16_t*>(row));
    else
      quantise_row(planes, channels, y, row);
    png_write_row(writer.png, row);
  }
  return true;
}

bool finish(PngWriter& writer) {
  if (setjmp(png_jmpbuf(writer.png))) return false;
  png_write_end(writer.png, writer.info);
  return true;
}

/// Writes a picture to an open file; `name` is its name in errors.
Result<void> write_to(std::FILE* stream, const fs::path& name, const ImageShape& shape, const WriteSettings& settings,
                      const MakeImageRows& make) {
  if (settings.bits != 8 && settings.bits != 16)
    return file_error("'{}' cannot be written with {} bits: PNG takes 8 or 16", name.string(), settings.bits);
  const Image bare = image_without_pixels(shape);
  const Result<std::vector<const Plane*>> picture = picture_planes(name, bare, true);
  if (!picture) return picture.error();
  const int channels = int(picture->size());
  PngWriter writer;
  const auto failed = [&] {
    return file_error("'{}' cannot be written as PNG: {}", name.string(), writer.png_error.text);
  };
  if (!start(writer, stream, shape.width, shape.height, channels, settings)) return failed();
  std::vector<png_byte> row(std::size_t(shape.width) * channels * (settings.bits / 8));
  Result<void> made = make([&](const Image& rows) -> Result<void> {
    const auto planes = picture_planes(name, rows, true);
    if (!planes) return planes.error();
    return write_rows(writer, planes->data(), channels, settings.bits, row.data()) ? Result<void>() : failed();
  });
  if (!made) return made;
  return finish(writer) ? Result<void>() : failed();
}

Result<void> write_png(const fs::path& file, const ImageShape& shape, const WriteSettings& settings,
                       const MakeImageRows& make) {
  const Image bare = image_without_pixels(shape);
  if (const auto planes = picture_planes(file, bare, true); !planes) return planes.error();
  return write_atomically(file, [&](std::FILE* stream) { return write_to(stream, file, shape, settings, make); });
}

/// A PNG being read: first the header, then the pixels.
struct PngReader {
  png_structp png = nullptr;
  png_infop info = nullptr;
  PngError png_error;
  int width = 0, height = 0, channels = 0, bits = 0;  // of the pixels as they are read
  std::size_t row_bytes = 0;
  bool is_interlaced = false;
  std::int64_t stored_bytes = 0;  // without compression
  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
};

/// Reads the header, up to the pixels. Palettes, fewer than 8 bits and a transparent colour are expanded.
bool start(PngReader& reader, std::FILE* stream) {
  reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reader.png_error, on_error, on_warning);
  if (reader.png) reader.info = png_create_info_struct(reader.png);
  if (!reader.info) {
    std::snprintf(reader.png_error.text, sizeof reader.png_error.text, "libpng cannot be started");
    return false;
  }
  if (setjmp(png_jmpbuf(reader.png))) return false;
  png_structp png = reader.png;
  png_init_io(png, stream);
  png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);             // check_sides applies the limits
  png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);  // texts and profiles, which may be bombs
  png_read_info(png, reader.info);
  reader.width = int(png_get_image_width(png, reader.info));
  reader.height = int(png_get_image_height(png, reader.info));
  reader.stored_bytes = std::int64_t(png_get_rowbytes(png, reader.info)) * reader.height;
  reader.is_interlaced = png_get_interlace_type(png, reader.info) != PNG_INTERLACE_NONE;
  return true;
}

bool expand(PngReader& reader) {
  if (setjmp(png_jmpbuf(reader.png))) return false;
  png_structp png = reader.png;
  png_set_expand(png);
  if (std::endian::native == std::endian::little) png_set_swap(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, reader.info);
  reader.channels = png_get_channels(png, reader.info);
  reader.bits = png_get_bit_depth(png, reader.info);
  reader.row_bytes = png_get_rowbytes(png, reader.info);
  return true;
}

bool read_row(PngReader& reader, png_bytep row) {
  if (setjmp(png_jmpbuf(reader.png))) return false;
  png_read_row(reader.png, row, nullptr);
  return true;
}

bool finish(PngReader& reader) {
  if (setjmp(png_jmpbuf(reader.png))) return false;
  png_read_end(reader.png, nullptr);
  return true;
}

Error read_error(const fs::path& file, const PngReader& reader) {
  return file_error("'{}' cannot be read as PNG: {}", file.string(), reader.png_error.text);
}

/// Opens a file and reads its header.
Result<void> open(const fs::path& file, InputFile& stream, PngReader& reader) {
  std::int64_t size = 0;
  Result<InputFile> opened = open_to_read(file, size);
  if (!opened) return opened.error();
  stream = std::move(*opened);
  if (!start(reader, stream.get())) return read_error(file, reader);
  if (auto sane = check_sides(file, reader.width, reader.height); !sane) return sane;
  // Deflate compresses by a factor of at most 1032, so a short file cannot contain the size in a damaged header.
  constexpr std::int64_t kBestRatio = 1032;
  if (reader.stored_bytes / kBestRatio > size)
    return file_error("'{}' is cut short: {} bytes cannot hold {} x {} pixels", file.string(), size, reader.width,
                      reader.height);
  return expand(reader) ? Result<void>() : read_error(file, reader);
}

Result<LayeredFile> read_png_header(const fs::path& file) {
  InputFile stream;
  PngReader reader;
  if (auto opened = open(file, stream, reader); !opened) return opened.error();
  LayeredFile header = plain_header(reader.width, reader.height);
  const bool is_wide = reader.bits == 16;
  add_picture_channels(header, reader.channels, is_wide ? ChannelType::kUint16 : ChannelType::kUint8,
                       is_wide ? 65535.0 : 255.0);
  return header;
}

Result<void> read_png_rows(const LayeredFile& file, std::span<const int> channels, RowTarget& target) {
  InputFile stream;
  PngReader reader;
  if (auto opened = open(file.path, stream, reader); !opened) return opened;
  if (reader.width != file.width || reader.height != file.height || reader.channels != int(file.channels.size()))
    return changed_file(file);
  // Rows of an interlaced file are complete only at its end.
  std::vector<png_byte> whole;
  if (reader.is_interlaced) {
    if (auto fits = check_size(file.path, reader.width, reader.height); !fits) return fits;
    if (auto fits = check_memory(file.path, double(reader.row_bytes) * reader.height); !fits) return fits;
    whole.resize(reader.row_bytes * std::size_t(reader.height));
    for (int i = 0; i < PNG_INTERLACE_ADAM7_PASSES * reader.height; ++i) {
      if (auto in_time = check_reading_time(file.path); !in_time) return in_time;
      if (!read_row(reader, whole.data() + std::size_t(i % reader.height) * reader.row_bytes))
        return read_error(file.path, reader);
    }
  }
  const SampleType type{SampleKind::kUnsigned, reader.bits / 8, false};
  std::vector<png_byte> row(reader.row_bytes);
  auto status = target.each_block(1, [&](int first, int end) -> Result<void> {
    for (int y = first; y < end; ++y) {
      if (!reader.is_interlaced && !read_row(reader, row.data())) return read_error(file.path, reader);
      const png_byte* from = reader.is_interlaced ? whole.data() + std::size_t(y) * reader.row_bytes : row.data();
      for (std::size_t c = 0; c < channels.size(); ++c)
        to_floats(type, from + channels[c] * type.bytes, std::ptrdiff_t(reader.channels) * type.bytes, file.width,
                  target.row(int(c), y));
    }
    return {};
  });
  if (!status) return status;
  return finish(reader) ? Result<void>() : read_error(file.path, reader);
}

Result<Image> read_png(const fs::path& file) { return read_picture_as(kPngLayers, file); }

bool is_png(std::string_view start) { return start.starts_with("\x89PNG\r\n\x1a\n"); }

}  // namespace

Result<std::string> encode_png(const std::string& name, const Image& image, const WriteSettings& settings) {
  return encode_png_rows(name, shape_of(image), settings, rows_of(image));
}

Result<std::string> encode_png_rows(const std::string& name, const ImageShape& shape, const WriteSettings& settings,
                                    const MakeImageRows& make) {
  char* bytes = nullptr;
  std::size_t size = 0;
  std::string out;
  const Result<void> written = write_and_close(name, open_memstream(&bytes, &size), [&](std::FILE* to) -> Result<void> {
    if (auto status = write_to(to, name, shape, settings, make); !status) return status;
    if (std::fflush(to) != 0) throw std::bad_alloc();  // the only cause for a stream in memory
    out.assign(bytes, size);
    return {};
  });
  std::free(bytes);
  return written ? Result<std::string>(std::move(out)) : written.error();
}

const ImageFormat kPng = {
    "png", "8 or 16 bit grey, RGB or RGBA pictures, sRGB", write_png, read_png, is_png, true, true, 16};
const LayerFormat kPngLayers = {"PNG", "png", is_png, read_png_header, read_png_rows};

}  // namespace umbrage
