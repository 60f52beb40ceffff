// Reading of JPEG and WebP pictures as layers, through libjpeg-turbo and libwebp, and of Radiance pictures (.hdr),
// based on the description in Ward's "Real Pixels" and on the header of the Radiance distribution.
#include <cstdio>
// jpeglib.h needs cstdio before it.
#include <jpeglib.h>
#include <webp/decode.h>

#include <cmath>
#include <csetjmp>
#include <cstring>

#include "io/layer_format.h"
#include "io/samples.h"

namespace umbrage {
namespace fs = std::filesystem;
namespace {

constexpr SampleType kByte{SampleKind::kUnsigned, 1, false};

LayeredFile display_header(int width, int height, int channels) {
  LayeredFile header = plain_header(width, height);
  add_picture_channels(header, channels, ChannelType::kUint8, 255.0);
  return header;
}

// --- JPEG -----------------------------------------------------------------------------------------------------------

/// libjpeg reports errors by a call that must not return; here longjmp, so functions that call setjmp own nothing with
/// a destructor.
struct Jpeg {
  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr manager{};
  jpeg_progress_mgr progress{};
  std::jmp_buf jump{};
  char text[JMSG_LENGTH_MAX] = "";
  bool warned = false;
  fs::path file;
  InputFile stream;
  std::optional<Error> limit;  // that the file exceeds
  ~Jpeg() { jpeg_destroy_decompress(&jpeg); }
};

[[noreturn]] void on_decoding_error(j_common_ptr common) {
  auto* own = static_cast<Jpeg*>(common->client_data);
  (*own->manager.format_message)(common, own->text);
  std::longjmp(own->jump, 1);
}

/// Warnings are about damaged data, for which the library would make up pixels.
void on_message(j_common_ptr common, int level) {
  auto* own = static_cast<Jpeg*>(common->client_data);
  if (level >= 0 || own->warned) return;
  own->warned = true;
  (*own->manager.format_message)(common, own->text);
}

/// Ends reading that takes too long. Called for each row of blocks, in each scan of a progressive file.
void on_progress(j_common_ptr common) {
  auto* own = static_cast<Jpeg*>(common->client_data);
  constexpr int kMaxScans = 64;  // ten are usual
  if (own->jpeg.input_scan_number > kMaxScans)
    own->limit = file_error("'{}' has more than {} scans, which are too many", own->file.string(), kMaxScans);
  else if (auto in_time = check_reading_time(own->file); !in_time)
    own->limit = in_time.error();
  if (own->limit) std::longjmp(own->jump, 1);
}

bool start(Jpeg& own) {
  own.jpeg.err = jpeg_std_error(&own.manager);
  own.manager.error_exit = on_decoding_error;
  own.manager.emit_message = on_message;
  own.jpeg.client_data = &own;
  if (setjmp(own.jump)) return false;
  jpeg_create_decompress(&own.jpeg);
  own.progress.progress_monitor = on_progress;
  own.jpeg.progress = &own.progress;
  jpeg_stdio_src(&own.jpeg, own.stream.get());
  jpeg_read_header(&own.jpeg, TRUE);
  own.jpeg.out_color_space = own.jpeg.num_components == 1 ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_calc_output_dimensions(&own.jpeg);
  return true;
}

bool decompress(Jpeg& own) {
  if (setjmp(own.jump)) return false;
  return jpeg_start_decompress(&own.jpeg) != FALSE;
}

bool read_row(Jpeg& own, JSAMPROW row) {
  if (setjmp(own.jump)) return false;
  return jpeg_read_scanlines(&own.jpeg, &row, 1) == 1 && !own.warned;
}

Error jpeg_error(const fs::path& file, const Jpeg& own) {
  if (own.limit) return *own.limit;
  return file_error("'{}' cannot be read as JPEG: {}", file.string(),
                    own.text[0] ? printable(own.text) : "it is damaged");
}

Result<void> open(const fs::path& file, Jpeg& own) {
  std::int64_t size = 0;
  Result<InputFile> stream = open_to_read(file, size);
  if (!stream) return stream.error();
  own.stream = std::move(*stream);
  own.file = file;
  if (!start(own)) return jpeg_error(file, own);
  if (auto status = check_size(file, own.jpeg.image_width, own.jpeg.image_height); !status) return status;
  const std::int64_t blocks = std::int64_t(own.jpeg.image_width) * own.jpeg.image_height / 64;
  constexpr std::int64_t kBlocksPerByte = 1 << 15;  // runs of empty blocks in progressive files
  if (blocks / kBlocksPerByte > size)
    return file_error("'{}' is cut short: {} bytes cannot hold {} x {} pixels", file.string(), size,
                      own.jpeg.image_width, own.jpeg.image_height);
  return {};
}

Result<LayeredFile> read_jpeg_header(const fs::path& file) {
  Jpeg own;
  if (auto opened = open(file, own); !opened) return opened.error();
  return display_header(int(own.jpeg.image_width), int(own.jpeg.image_height), own.jpeg.num_components == 1 ? 1 : 3);
}

Result<void> read_jpeg_rows(const LayeredFile& file, std::span<const int> channels, RowTarget& target) {
  Jpeg own;
  if (auto opened = open(file.path, own); !opened) return opened;
  const double values = double(file.width) * file.height * own.jpeg.num_components;
  if (jpeg_has_multiple_scans(&own.jpeg))  // all coefficients are in memory
    if (auto fits = check_memory(file.path, values * sizeof(JCOEF)); !fits) return fits;
  if (!decompress(own)) return jpeg_error(file.path, own);
  const int count = own.jpeg.output_components;
  if (int(own.jpeg.output_width) != file.width || int(own.jpeg.output_height) != file.height ||
      count != int(file.channels.size()))
    return changed_file(file);
  std::vector<JSAMPLE> row(std::size_t(file.width) * std::size_t(count));
  return target.each_block(1, [&](int first, int end) -> Result<void> {
    for (int y = first; y < end; ++y) {
      if (!read_row(own, row.data())) return jpeg_error(file.path, own);
      for (std::size_t c = 0; c < channels.size(); ++c)
        to_floats(kByte, row.data() + channels[c], count, file.width, target.row(int(c), y));
    }
    return {};
  });
}

// --- WebP -----------------------------------------------------------------------------------------------------------

/// Reads a whole file that is decoded in memory.
Result<std::vector<std::uint8_t>> whole_file(const fs::path& file) {
  std::int64_t size = 0;
  const Result<InputFile> stream = open_to_read(file, size);
  if (!stream) return stream.error();
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size));
  if (std::fread(bytes.data(), 1, bytes.size(), stream->get()) != bytes.size())
    return file_error("'{}' cannot be read to its end", file.string());
  return bytes;
}

Result<LayeredFile> read_webp_header(const fs::path& file) {
  const auto bytes = whole_file(file);
  if (!bytes) return bytes.error();
  WebPBitstreamFeatures about;
  if (WebPGetFeatures(bytes->data(), bytes->size(), &about) != VP8_STATUS_OK)
    return file_error("'{}' cannot be read as WebP: its header is damaged", file.string());
  if (about.has_animation) return file_error("'{}' is an animation: only a single picture can be read", file.string());
  if (auto status = check_size(file, about.width, about.height); !status) return status.error();
  return display_header(about.width, about.height, about.has_alpha ? 4 : 3);
}

Result<void> read_webp_rows(const LayeredFile& file, std::span<const int> channels, RowTarget& target) {
  const auto bytes = whole_file(file.path);
  if (!bytes) return bytes.error();
  const int count = int(file.channels.size());
  constexpr double kBytes = 4.0 + 4.0;  // of a pixel, and of one within the library
  if (auto fits = check_memory(file.path, kBytes * file.width * file.height); !fits) return fits;
  int width = 0, height = 0;
  const auto decode = count == 4 ? WebPDecodeRGBA : WebPDecodeRGB;
  const std::unique_ptr<std::uint8_t, void (*)(void*)> pixels(decode(bytes->data(), bytes->size(), &width, &height),
                                                              WebPFree);
  if (!pixels) return file_error("'{}' cannot be read as WebP: it is damaged or cut short", file.path.string());
  if (width != file.width || height != file.height) return changed_file(file);
  return target.each_block(1, [&](int first, int end) -> Result<void> {
    for (int y = first; y < end; ++y)
      for (std::size_t c = 0; c < channels.size(); ++c)
        to_floats(kByte, pixels.get() + std::ptrdiff_t(y) * width * count + channels[c], count, width,
                  target.row(int(c), y));
    return {};
  });
}

// --- Radiance -------------------------------------------------------------------------------------------------------

/// A Radiance picture being read.
struct Radiance {
  InputFile stream;
  int width = 0, height = 0;
};

std::string next_line(std::FILE* stream) {
  constexpr std::size_t kMaxLength = 2048;
  std::string line;
  for (int c = std::fgetc(stream); c != EOF && c != '\n' && line.size() < kMaxLength; c = std::fgetc(stream))
    line += char(c);
  return line;
}

Result<void> open(const fs::path& file, Radiance& reader) {
  std::int64_t size = 0;
  Result<InputFile> stream = open_to_read(file, size);
  if (!stream) return stream.error();
  reader.stream = std::move(*stream);
  std::string line = next_line(reader.stream.get());
  for (int i = 0; i < 256 && !line.empty(); ++i) {
    line = next_line(reader.stream.get());
    if (line.starts_with("FORMAT=") && !line.starts_with("FORMAT=32-bit_rle_rgbe"))
      return file_error("'{}' has the colours '{}': only 32-bit_rle_rgbe can be read", file.string(),
                        printable(line.substr(7, 32)));
  }
  line = next_line(reader.stream.get());
  long long width = 0, height = 0;
  if (std::sscanf(line.c_str(), "-Y %lld +X %lld", &height, &width) != 2)
    return file_error("'{}' cannot be read as HDR: its size must be given as -Y height +X width", file.string());
  if (auto status = check_size(file, width, height); !status) return status;
  constexpr std::int64_t kBestRatio = 64;  // a run of 127 pixels takes 8 bytes
  if (width * height * 4 / kBestRatio > size)
    return file_error("'{}' is cut short: {} bytes cannot hold {} x {} pixels", file.string(), size, width, height);
  reader.width = int(width);
  reader.height = int(height);
  return {};
}

/// Reads a row of pixels, 4 bytes each. Returns false if it is damaged.
bool read_radiance_row(Radiance& reader, std::vector<unsigned char>& row, std::vector<unsigned char>& plane) {
  std::FILE* in = reader.stream.get();
  const auto width = std::size_t(reader.width);
  constexpr std::size_t kMinRuns = 8, kMaxRuns = 0x7fff;  // widths of rows that may be compressed
  if (std::fread(row.data(), 1, 4, in) != 4) return false;
  const bool is_compressed = width >= kMinRuns && width <= kMaxRuns && row[0] == 2 && row[1] == 2 && row[2] < 128;
  if (!is_compressed) return std::fread(row.data() + 4, 1, 4 * width - 4, in) == 4 * width - 4;
  if ((std::size_t(row[2]) << 8 | row[3]) != width) return false;
  for (std::size_t c = 0; c < 4; ++c) {
    for (std::size_t x = 0; x < width;) {
      const int code = std::fgetc(in);
      const auto count = std::size_t(code > 128 ? code - 128 : code);
      if (code <= 0 || x + count > width) return false;
      if (code > 128) {
        const int value = std::fgetc(in);
        if (value == EOF) return false;
        std::memset(plane.data() + x, value, count);
      } else if (std::fread(plane.data() + x, 1, count, in) != count) {
        return false;
      }
      x += count;
    }
    for (std::size_t x = 0; x < width; ++x) row[4 * x + c] = plane[x];
  }
  return true;
}

Result<LayeredFile> read_radiance_header(const fs::path& file) {
  Radiance reader;
  if (auto opened = open(file, reader); !opened) return opened.error();
  LayeredFile header = plain_header(reader.width, reader.height);
  add_picture_channels(header, 3, ChannelType::kFloat, 0.0);
  return header;
}

Result<void> read_radiance_rows(const LayeredFile& file, std::span<const int> channels, RowTarget& target) {
  Radiance reader;
  if (auto opened = open(file.path, reader); !opened) return opened;
  if (reader.width != file.width || reader.height != file.height) return changed_file(file);
  std::vector<unsigned char> row(std::size_t(file.width) * 4), plane(static_cast<std::size_t>(file.width));
  return target.each_block(1, [&](int first, int end) -> Result<void> {
    for (int y = first; y < end; ++y) {
      if (!read_radiance_row(reader, row, plane))
        return file_error("'{}' cannot be read: row {} is missing or damaged", file.path.string(), y);
      for (std::size_t c = 0; c < channels.size(); ++c)
        for (int x = 0; x < file.width; ++x) {
          const unsigned char* pixel = row.data() + std::ptrdiff_t(4) * x;
          constexpr int kBias = 128 + 8;  // of the exponent; mantissas have 8 bits
          target.row(int(c), y)[x] = pixel[3] == 0 ? 0.0f : std::ldexp(float(pixel[channels[c]]), pixel[3] - kBias);
        }
    }
    return {};
  });
}

}  // namespace

const LayerFormat kJpegLayers = {"JPEG", "jpg jpeg",
                                 [](std::string_view start) { return start.starts_with("\xff\xd8\xff"); },
                                 read_jpeg_header, read_jpeg_rows};
const LayerFormat kWebpLayers = {"WebP", "webp",
                                 [](std::string_view start) {
                                   return start.starts_with("RIFF") && start.size() > 8 &&
                                          start.substr(8).starts_with("WEBP");
                                 },
                                 read_webp_header, read_webp_rows};
const LayerFormat kHdrLayers = {"HDR", "hdr", [](std::string_view start) { return start.starts_with("#?"); },
                                read_radiance_header, read_radiance_rows};

}  // namespace umbrage
