// Reads textures and panoramas through stb_image, which is used only in this file.
//
// Radiance pictures are read after [Ward 1991] and Radiance's description of its picture format, not by stb_image,
// which ignores EXPOSURE, refuses pictures that are mirrored, upside down or without FORMAT, and takes files that are
// cut short; both take the same time.
#include "scene/readers/texture_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <string_view>
#include <vector>

#include "core/color.h"

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_FAILURE_USERMSG
#include <stb_image.h>

namespace umbrage {
namespace {

/// The size in an image's header.
struct ImageHeader {
  int width = 0, height = 0;
};

Result<ImageHeader> check_header(std::span<const std::uint8_t> bytes, const std::string& name, std::int64_t max) {
  if (bytes.empty()) return file_error("'{}' is empty", name);
  if (bytes.size() > std::size_t(std::numeric_limits<int>::max())) return file_error("'{}' is larger than 2 GB", name);
  ImageHeader header;
  int channels = 0;
  if (!stbi_info_from_memory(bytes.data(), int(bytes.size()), &header.width, &header.height, &channels)) {
    return file_error("'{}' is not an image of a known format (PNG, JPEG, TGA, BMP, GIF, PSD, HDR, PNM)", name);
  }
  if (std::int64_t(header.width) * header.height > max) {
    return file_error("'{}' has {} x {} pixels in its header; at most {} can be read", name, header.width,
                      header.height, max);
  }
  return header;
}

Error damaged_image_error(const std::string& name) {
  const char* reason = stbi_failure_reason();
  return file_error("'{}' is a damaged image: {}", name, reason ? reason : "it has no pixels");
}

Result<std::vector<std::uint8_t>> read_bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return file_error("'{}' cannot be opened", file.string());
  std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(stream), {}};
  if (stream.bad()) return file_error("'{}' cannot be read", file.string());
  return bytes;
}

constexpr int kChannels = 4;  // red, green, blue, exponent

/// A reader of bytes in sequence. After the last byte it returns 0, and `ended` is set.
struct Source {
  std::span<const std::uint8_t> bytes;
  std::size_t at = 0;
  bool ended = false;

  std::uint8_t next() {
    ended = ended || at >= bytes.size();
    return ended ? 0 : bytes[at++];
  }
  /// Returns the text up to the end of the line, without the line break.
  std::string_view line() {
    const std::size_t start = at;
    while (at < bytes.size() && bytes[at] != '\n') ++at;
    ended = ended || at >= bytes.size();
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()) + start, at - start);
    at += at < bytes.size();
    return text.ends_with('\r') ? text.substr(0, text.size() - 1) : text;
  }
};

struct Header {
  int width = 0, height = 0;
  bool bottom_up = false, mirrored = false;
  float exposure = 1.0f;
};

/// Parses a size such as "-Y 512 +X 1024": rows from the top, each from the left.
bool parse_size(std::string_view text, Header& header) {
  const auto number = [&](int& out) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
    text.remove_prefix(std::size_t(end - text.data()));
    return error == std::errc() && out > 0;
  };
  const auto word = [&](std::string_view minus, std::string_view plus, bool& is_plus) {
    is_plus = text.starts_with(plus);
    if (!is_plus && !text.starts_with(minus)) return false;
    text.remove_prefix(plus.size());
    return true;
  };
  bool to_the_right = false;
  const bool fine = word("-Y ", "+Y ", header.bottom_up) && number(header.height) &&
                    word(" -X ", " +X ", to_the_right) && number(header.width);
  header.mirrored = !to_the_right;
  return fine;
}

/// Reads the header. Returns the cause of an error, or an empty text.
std::string read_header(Source& source, Header& header) {
  for (std::string_view line = source.line(); !line.empty(); line = source.line()) {
    if (source.ended) return "its header is cut short";
    constexpr std::string_view kFormat = "FORMAT=", kExposure = "EXPOSURE=";
    if (line.starts_with(kFormat) && line.find("rgbe") == std::string_view::npos) return "its colours are not RGB";
    if (line.starts_with(kExposure)) {
      line.remove_prefix(kExposure.size());
      line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
      float factor = 0.0f;
      std::from_chars(line.data(), line.data() + line.size(), factor);
      if (!(factor > 0.0f) || !std::isfinite(factor)) return "its exposure is not a number above 0";
      header.exposure *= factor;
      if (!(header.exposure >= std::numeric_limits<float>::min()) || !std::isfinite(header.exposure))
        return "the product of its exposures is out of range";
    }
  }
  if (!parse_size(source.line(), header)) return "its size is missing or not valid";
  return "";
}

/// Reads one row into `row`, with the channels of a pixel adjacent. Returns false if the row is damaged.
bool read_row(Source& source, int width, std::vector<std::uint8_t>& row) {
  constexpr int kMinRunWidth = 8, kMaxRunWidth = 32767;  // width of rows that may be run-length encoded by channel
  std::uint8_t first[kChannels];
  for (std::uint8_t& byte : first) byte = source.next();
  if (width >= kMinRunWidth && width <= kMaxRunWidth && first[0] == 2 && first[1] == 2 && first[2] < 128) {
    if (first[2] * 256 + first[3] != width) return false;
    for (int c = 0; c < kChannels; ++c)
      for (int x = 0; x < width && !source.ended;) {
        const int code = source.next();
        const bool is_run = code > 128;
        const int count = is_run ? code - 128 : code;
        if (count == 0 || count > width - x) return false;
        std::uint8_t value = is_run ? source.next() : std::uint8_t(0);
        for (int k = 0; k < count; ++k, ++x) {
          if (!is_run) value = source.next();
          row[std::size_t(x) * kChannels + std::size_t(c)] = value;
        }
      }
    return true;
  }
  // The row is stored pixel by pixel. The bytes 1 1 1 n repeat the previous pixel n times. In consecutive repeats, the
  // values n are digits of one count, to base 256, lowest first.
  int shift = 0;
  for (int x = 0; x < width && !source.ended;) {
    if (x > 0 || shift > 0)
      for (std::uint8_t& byte : first) byte = source.next();
    if (first[0] == 1 && first[1] == 1 && first[2] == 1) {
      const std::int64_t count = std::int64_t(first[3]) << shift;
      if (x == 0 || count > width - x) return false;
      for (std::int64_t k = 0; k < count; ++k, ++x)
        std::copy_n(row.begin() + (x - 1) * kChannels, kChannels, row.begin() + x * kChannels);
      if (shift < 24) shift += 8;
      continue;
    }
    std::copy_n(first, kChannels, row.begin() + x * kChannels);
    ++x;
    shift = 0;
  }
  return true;
}

}  // namespace

Result<Texture> decode_texture(std::span<const std::uint8_t> bytes, const std::string& name) {
  if (const auto header = check_header(bytes, name, kMaxTexturePixels); !header) return header.error();
  const int size = int(bytes.size());
  int width = 0, height = 0, channels = 0;
  constexpr int kRgba = 4;
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, kRgba), stbi_image_free);
  if (!pixels || width <= 0 || height <= 0) return damaged_image_error(name);
  Texture texture;
  texture.name = name;
  texture.width = width;
  texture.height = height;
  texture.rgba.assign(pixels.get(), pixels.get() + std::size_t(width) * height * kRgba);
  return texture;
}

Result<Texture> read_texture(const std::filesystem::path& file) {
  const auto bytes = read_bytes(file);
  return bytes ? decode_texture(*bytes, file.string()) : bytes.error();
}

Result<Panorama> decode_panorama(std::span<const std::uint8_t> bytes, const std::string& name) {
  if (is_radiance(bytes)) return decode_radiance(bytes, name, kMaxPanoramaPixels);
  const auto header = check_header(bytes, name, kMaxPanoramaPixels);
  if (!header) return header.error();
  constexpr int kRgb = 3;
  const int size = int(bytes.size());
  Panorama panorama{name, header->width, header->height, {}};
  const std::size_t values = std::size_t(header->width) * std::size_t(header->height) * kRgb;
  int width = 0, height = 0, channels = 0;
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, kRgb), stbi_image_free);
  if (!pixels || width != header->width || height != header->height) return damaged_image_error(name);
  std::array<float, 256> linear;
  for (int v = 0; v < 256; ++v) linear[std::size_t(v)] = linear_from_srgb(float(v) / 255.0f);
  panorama.rgb.reserve(values);
  for (std::size_t k = 0; k < values; ++k) panorama.rgb.push_back(linear[pixels.get()[k]]);
  return panorama;
}

Result<Panorama> read_panorama(const std::filesystem::path& file) {
  const auto bytes = read_bytes(file);
  if (!bytes) return bytes.error();
  auto panorama = decode_panorama(*bytes, file.string());
  if (!panorama) return panorama;
  return reduced_panorama(*panorama, kMaxPanoramaWidth, kMaxPanoramaHeight);
}

bool is_radiance(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= 2 && bytes[0] == '#' && bytes[1] == '?';
}

Result<Panorama> decode_radiance(std::span<const std::uint8_t> bytes, const std::string& name,
                                 std::int64_t max_pixels) {
  Source source{bytes};
  Header header;
  if (const std::string cause = read_header(source, header); !cause.empty())
    return file_error("'{}' cannot be read as a Radiance picture: {}", name, cause);
  const int width = header.width, height = header.height;
  constexpr int kMaxWidth = 1 << 16;  // limits the memory of a row, which is allocated before any pixel is read
  if (std::int64_t(width) * height > max_pixels || width > kMaxWidth)
    return file_error("'{}' has {} x {} pixels in its header; at most {} can be read", name, width, height, max_pixels);
  std::vector<std::uint8_t> row(std::size_t(width) * kChannels);
  Panorama out{name, width, height, {}};
  for (int y = 0; y < height; ++y) {
    const bool is_valid = read_row(source, width, row);
    if (source.ended) return file_error("'{}' is cut short: row {} of {} is incomplete", name, y + 1, height);
    if (!is_valid) return file_error("'{}' is damaged in row {} of {}", name, y + 1, height);
    // Allocate after the first row, so that a header alone cannot cause a large allocation.
    if (y == 0) out.rgb.reserve(std::size_t(width) * std::size_t(height) * 3);
    for (int x = 0; x < width; ++x) {
      const std::uint8_t* pixel = row.data() + std::size_t(header.mirrored ? width - 1 - x : x) * kChannels;
      constexpr int kBias = 128 + 8;  // of the exponent, plus 8 bits of the mantissa
      const float scale = pixel[3] == 0 ? 0.0f : std::ldexp(1.0f, pixel[3] - kBias) / header.exposure;
      for (int c = 0; c < 3; ++c) out.rgb.push_back(float(pixel[c]) * scale);
    }
  }
  if (header.bottom_up) {
    const auto length = std::ptrdiff_t(width) * 3;
    for (int above = 0, below = height - 1; above < below; ++above, --below)
      std::swap_ranges(out.rgb.begin() + above * length, out.rgb.begin() + (above + 1) * length,
                       out.rgb.begin() + below * length);
  }
  return out;
}

}  // namespace umbrage
