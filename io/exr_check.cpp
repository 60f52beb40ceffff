// A check of OpenEXR headers before the OpenEXR library reads them.
#include "io/exr_support.h"

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "io/format.h"

namespace umbrage {
namespace fs = std::filesystem;
namespace {

/// Reads a name up to a zero byte. Returns false if the file ends before the zero byte, or if the name is too long.
bool read_name(std::FILE* stream, std::string& name) {
  constexpr int kMaxLength = 256;
  name.clear();
  for (int i = 0; i < kMaxLength; ++i) {
    const int c = std::fgetc(stream);
    if (c == EOF) return false;
    if (c == 0) return true;
    name += char(c);
  }
  return false;
}

/// Reads the next 4-byte numbers. Returns false if the file contains too few.
bool read_numbers(std::FILE* stream, std::span<std::int64_t> numbers) {
  for (std::int64_t& number : numbers) {
    unsigned char bytes[4];
    if (std::fread(bytes, 1, sizeof bytes, stream) != sizeof bytes) return false;
    number = std::int32_t(std::uint32_t(bytes[0]) | std::uint32_t(bytes[1]) << 8 | std::uint32_t(bytes[2]) << 16 |
                          std::uint32_t(bytes[3]) << 24);
  }
  return true;
}

/// Returns the size of a value of an attribute type, in bytes; 0 if it varies.
std::int64_t size_of(std::string_view type) {
  static constexpr std::pair<std::string_view, std::int64_t> kSizes[] = {{"box2f", 16},
                                                                         {"box2i", 16},
                                                                         {"chromaticities", 32},
                                                                         {"compression", 1},
                                                                         {"deepImageState", 1},
                                                                         {"double", 8},
                                                                         {"envmap", 1},
                                                                         {"float", 4},
                                                                         {"int", 4},
                                                                         {"keycode", 28},
                                                                         {"lineOrder", 1},
                                                                         {"m33d", 72},
                                                                         {"m33f", 36},
                                                                         {"m44d", 128},
                                                                         {"m44f", 64},
                                                                         {"rational", 8},
                                                                         {"tiledesc", 9},
                                                                         {"timecode", 8},
                                                                         {"v2d", 16},
                                                                         {"v2f", 8},
                                                                         {"v2i", 8},
                                                                         {"v3d", 24},
                                                                         {"v3f", 12},
                                                                         {"v3i", 12}};
  for (const auto& [name, size] : kSizes)
    if (name == type) return size;
  return 0;
}

/// Returns whether the value at the stream's position has the size that the header claims. For some types the library
/// relies on the claimed size, for others it reads what it needs. With a wrong claim it would find other attributes
/// than check_headers does.
bool has_claimed_size(std::FILE* stream, std::string_view type, std::int64_t claimed) {
  const std::int64_t end = std::ftell(stream) + claimed;
  if (type == "preview") {
    std::array<std::int64_t, 2> sides{};
    return read_numbers(stream, sides) && sides[0] >= 0 && sides[1] >= 0 && sides[0] <= kMaxFileSide &&
           sides[1] <= kMaxFileSide && 8 + 4 * sides[0] * sides[1] == claimed;
  }
  if (type == "chlist") {
    constexpr long kChannelBytes = 16;
    std::string name;
    while (read_name(stream, name) && std::ftell(stream) <= end) {
      if (name.empty()) return std::ftell(stream) == end;
      if (std::fseek(stream, kChannelBytes, SEEK_CUR) != 0) return false;
    }
    return false;
  }
  const std::int64_t size = size_of(type);
  return size == 0 || size == claimed;
}

/// Returns whether the value is a window or a tile size for which the library would allocate huge tables.
bool is_huge(std::FILE* stream, std::string_view name, std::string_view type) {
  std::array<std::int64_t, 4> numbers{};
  if (type == "box2i" && (name == "dataWindow" || name == "displayWindow"))
    return read_numbers(stream, numbers) &&
           (numbers[2] - numbers[0] >= kMaxFileSide || numbers[3] - numbers[1] >= kMaxFileSide);
  if (type != "tiledesc" || !read_numbers(stream, std::span(numbers).first(2))) return false;
  return std::uint32_t(numbers[0]) > kMaxFileSide || std::uint32_t(numbers[1]) > kMaxFileSide;
}

}  // namespace

Result<void> check_exr_headers(const fs::path& file, std::FILE* stream, std::int64_t size) {
  constexpr int kFlags = 5, kHeaders = 8;  // byte offsets
  constexpr int kSeveralParts = 0x10;      // in the second byte of the version
  const Error damaged = file_error("'{}' cannot be read as EXR: its header is cut short or damaged", file.string());
  std::fseek(stream, kFlags, SEEK_SET);
  const int flags = std::fgetc(stream);
  std::fseek(stream, kHeaders, SEEK_SET);
  // A header is a list of attributes that ends with an empty name. After several headers another empty name follows.
  std::string name, type;
  bool first = true;
  while (true) {
    if (flags == EOF || !read_name(stream, name)) return damaged;
    if (name.empty() && (first || (flags & kSeveralParts) == 0)) return {};
    first = name.empty();
    if (name.empty()) continue;
    std::array<std::int64_t, 1> claimed{};
    if (!read_name(stream, type) || !read_numbers(stream, claimed)) return damaged;
    const long value = std::ftell(stream);
    const std::int64_t bytes = std::uint32_t(claimed[0]);
    if (bytes > size - value || !has_claimed_size(stream, type, bytes)) return damaged;
    std::fseek(stream, value, SEEK_SET);
    if (is_huge(stream, name, type))
      return file_error(
          "'{}' has windows or tiles in its header that are larger than {} pixels per side, the maximum that can "
          "be read",
          file.string(), kMaxFileSide);
    if (std::fseek(stream, value + long(bytes), SEEK_SET) != 0) return damaged;
  }
}

}  // namespace umbrage
