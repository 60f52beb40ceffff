#include "scene/readers/gzip.h"

#include <zlib.h>

#include <algorithm>
#include <limits>

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

}  // namespace

bool is_gzip(std::string_view bytes) { return bytes.starts_with(kMagic); }

Result<std::string> inflated(std::string_view bytes, const std::string& file, Poll* poll) {
  constexpr std::size_t kMaxUnchecked = std::size_t(64) << 20, kMaxRatio = 100, kBlockSize = std::size_t(8) << 20;
  const std::size_t max = std::max(kMaxUnchecked, kMaxRatio * bytes.size());
  Inflation inflation(bytes);
  if (!inflation.ready) return device_error("not enough memory to read '{}'", file);
  z_stream& stream = inflation.stream;
  const char* const end = bytes.data() + bytes.size();
  const auto rest = [&] {
    const char* at = reinterpret_cast<const char*>(stream.next_in);
    return std::string_view(at, std::size_t(end - at));
  };
  std::string content;
  std::size_t used = 0;  // bytes of it that are set; members may be tiny, so space for a block serves many of them
  while (true) {
    if (poll && poll->passing(0.0)) return interrupted();
    if (used > max)
      return file_error(
          "'{}' would be inflated from {:.3g} to more than {:.3g} MB: it is made to exhaust memory, or damaged; if "
          "not, inflate it with gunzip",
          file, 1e-6 * double(bytes.size()), 1e-6 * double(max));
    if (used == content.size()) {
      if (content.capacity() < used + kBlockSize) content.reserve(2 * used + kBlockSize);
      content.resize(used + kBlockSize);
    }
    stream.next_out = reinterpret_cast<Bytef*>(content.data() + used);
    stream.avail_out = uInt(content.size() - used);
    stream.avail_in = uInt(std::min<std::size_t>(rest().size(), std::numeric_limits<uInt>::max()));
    const int status = ::inflate(&stream, Z_NO_FLUSH);
    used = content.size() - stream.avail_out;
    if (status == Z_STREAM_END) {
      // Programs that ignore other bytes after the last member are the rule.
      if (!is_gzip(rest())) {
        content.resize(used);
        return content;
      }
      ::inflateReset(&stream);
    } else if (status == Z_BUF_ERROR || (status == Z_OK && rest().empty() && stream.avail_out > 0)) {
      return file_error("'{}' is cut short: its compressed data ends after {} bytes of content", file, used);
    } else if (status != Z_OK) {
      return file_error("'{}' is damaged: gzip cannot inflate it ({})", file, stream.msg ? stream.msg : "invalid data");
    }
  }
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

}  // namespace umbrage
