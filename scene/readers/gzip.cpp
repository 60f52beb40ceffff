#include "scene/readers/gzip.h"

#include <zlib.h>

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

namespace umbrage {
namespace {

constexpr std::string_view kMagic("\x1f\x8b\x08", 3);

/// A stream of zlib that inflates gzip members from `bytes`.
struct Inflation {
  z_stream stream{};
  bool ready = false;
  explicit Inflation(std::string_view bytes) {
    constexpr int kGzip = 16;  // added to the window's size: the data has a gzip header
    ready = ::inflateInit2(&stream, MAX_WBITS + kGzip) == Z_OK;
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  }
  ~Inflation() { ::inflateEnd(&stream); }
  Inflation(const Inflation&) = delete;
};

/// The max size of a file's content, and why larger content is refused.
struct Bound {
  std::size_t bytes;
  const char* reason;
};

/// Returns the bound for a file of `size` bytes, if so much `memory` is available.
Bound bound_of(std::size_t size, double memory) {
  constexpr std::size_t kMaxUnchecked = std::size_t(64) << 20, kMaxRatio = 100;
  constexpr double kMaxFraction = 0.5;  // what is made of the content needs memory, too
  const std::size_t by_ratio = std::max(kMaxUnchecked, kMaxRatio * size);
  const double by_memory = kMaxFraction * memory;
  if (double(by_ratio) > by_memory) return {std::size_t(by_memory), "that is more than half of the memory available"};
  return {by_ratio, "it is made to exhaust memory, or damaged; if not, inflate it with gunzip"};
}

/// Inflates all members of a gzip file. Calls `next_block` for space, also before the first byte; returns the number of
/// bytes of content.
template <class NextBlock>
Result<std::size_t> inflate_members(std::string_view bytes, const std::string& file, const Bound& max, Poll* poll,
                                    NextBlock next_block) {
  Inflation inflation(bytes);
  if (!inflation.ready) return device_error("not enough memory to read '{}'", file);
  z_stream& stream = inflation.stream;
  const char* const end = bytes.data() + bytes.size();
  const auto rest = [&] {
    const char* at = reinterpret_cast<const char*>(stream.next_in);
    return std::string_view(at, std::size_t(end - at));
  };
  std::size_t used = 0;  // members may be tiny, so a block serves many of them
  while (true) {
    if (poll && poll->passing(0.0)) return interrupted();
    if (stream.avail_out == 0) {
      const std::span<char> block = next_block();
      stream.next_out = reinterpret_cast<Bytef*>(block.data());
      stream.avail_out = uInt(block.size());
    }
    const std::size_t space = stream.avail_out;
    stream.avail_in = uInt(std::min<std::size_t>(rest().size(), std::numeric_limits<uInt>::max()));
    const int status = ::inflate(&stream, Z_NO_FLUSH);
    used += space - stream.avail_out;
    if (used > max.bytes)
      return file_error("'{}' would be inflated from {:.3g} to more than {:.3g} MB: {}", file,
                        1e-6 * double(bytes.size()), 1e-6 * double(max.bytes), max.reason);
    if (status == Z_STREAM_END) {
      // Programs that ignore other bytes after the last member are the rule.
      if (!is_gzip(rest())) return used;
      ::inflateReset(&stream);
    } else if (status == Z_BUF_ERROR || (status == Z_OK && rest().empty() && stream.avail_out > 0)) {
      return file_error("'{}' is cut short: its compressed data ends after {} bytes of content", file, used);
    } else if (status != Z_OK) {
      return file_error("'{}' is damaged: gzip cannot inflate it ({})", file, stream.msg ? stream.msg : "invalid data");
    }
  }
}

constexpr std::size_t kBlockSize = std::size_t(8) << 20;

}  // namespace

bool is_gzip(std::string_view bytes) { return bytes.starts_with(kMagic); }

Result<std::string> inflated(std::string_view bytes, const std::string& file, Poll* poll, double memory) {
  const Bound max = bound_of(bytes.size(), memory);
  std::string content;
  constexpr std::size_t kMinMeasured = std::size_t(1) << 20;
  if (bytes.size() > kMinMeasured) {
    // Memory for content that is refused, or that is copied as it grows, takes several times as long as to inflate it.
    std::vector<char> block(kBlockSize);
    const auto measured = inflate_members(bytes, file, max, poll, [&] { return std::span(block); });
    if (!measured) return measured.error();
    content.reserve(*measured + kBlockSize);
  }
  const auto size = inflate_members(bytes, file, max, poll, [&] {
    const std::size_t used = content.size();
    if (content.capacity() < used + kBlockSize) content.reserve(2 * used + kBlockSize);
    content.resize(used + kBlockSize);
    return std::span(content).subspan(used);
  });
  if (!size) return size.error();
  content.resize(*size);
  return content;
}

Result<std::size_t> inflated_size(std::string_view bytes, const std::string& file, double memory) {
  std::vector<char> block(kBlockSize);
  return inflate_members(bytes, file, bound_of(bytes.size(), memory), nullptr, [&] { return std::span(block); });
}

std::string inflated_start(std::string_view bytes, std::size_t count) {
  Inflation inflation(bytes);
  if (!inflation.ready) return "";
  std::string content(count, '\0');
  inflation.stream.avail_in = uInt(std::min<std::size_t>(bytes.size(), std::numeric_limits<uInt>::max()));
  inflation.stream.next_out = reinterpret_cast<Bytef*>(content.data());
  inflation.stream.avail_out = uInt(count);
  ::inflate(&inflation.stream, Z_SYNC_FLUSH);
  content.resize(count - inflation.stream.avail_out);
  return content;
}

std::string inflated_to(std::string_view bytes, std::size_t size) {
  std::string content(size, '\0');
  uLongf count = uLongf(size);
  const int status = ::uncompress(reinterpret_cast<Bytef*>(content.data()), &count,
                                  reinterpret_cast<const Bytef*>(bytes.data()), uLong(bytes.size()));
  content.resize(status == Z_OK ? count : 0);
  return content;
}

}  // namespace umbrage
