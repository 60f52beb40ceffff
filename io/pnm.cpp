// PGM and PPM, grey and RGB, as text (P2, P3) or bytes (P5, P6), with 8 or 16 bits per value. Based on the manual pages
// pgm(5) and ppm(5) of Netpbm: 16-bit values are big-endian; comments begin with # and end with the line.
#include <bit>

#include "io/layer_format.h"
#include "io/samples.h"

namespace umbrage {
namespace fs = std::filesystem;
namespace {

/// A file being read.
struct PnmReader {
  InputFile stream;
  bool is_text = false;
  int width = 0, height = 0, channels = 0, max = 0;
};

bool is_space(int c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/// Reads the next integer and one character after it. Returns -1 if there is none, or it is too large.
std::int64_t next_number(std::FILE* stream) {
  constexpr std::int64_t kTooLarge = std::int64_t(1) << 40;
  int c = std::fgetc(stream);
  while (is_space(c) || c == '#') {
    if (c == '#')
      while (c != '\n' && c != '\r' && c != EOF) c = std::fgetc(stream);
    else
      c = std::fgetc(stream);
  }
  if (c < '0' || c > '9') return -1;
  std::int64_t number = 0;
  for (; c >= '0' && c <= '9'; c = std::fgetc(stream))
    if ((number = number * 10 + (c - '0')) > kTooLarge) return -1;
  return is_space(c) || c == EOF ? number : c == '#' ? (std::ungetc(c, stream), number) : -1;
}

Result<void> open(const fs::path& file, PnmReader& reader) {
  std::int64_t size = 0;
  Result<InputFile> stream = open_to_read(file, size);
  if (!stream) return stream.error();
  reader.stream = std::move(*stream);
  std::FILE* in = reader.stream.get();
  std::fgetc(in);
  const int kind = std::fgetc(in);
  reader.is_text = kind == '2' || kind == '3';
  reader.channels = kind == '3' || kind == '6' ? 3 : 1;
  const std::int64_t width = next_number(in), height = next_number(in), max = next_number(in);
  if (width < 0 || height < 0 || max < 1 || max > 65535)
    return file_error("'{}' cannot be read as PNM: its header must have width, height and a maximum of 1 to 65535",
                      file.string());
  if (auto status = check_sides(file, width, height); !status) return status;
  // A value of a text has a digit and a space.
  const std::int64_t values = width * height * reader.channels;
  const std::int64_t needed = reader.is_text ? 2 * values - 1 : values * (max > 255 ? 2 : 1);
  if (size - ::ftello(in) < needed)
    return file_error("'{}' is cut short: {} x {} pixels are {} bytes or more and it has {}", file.string(), width,
                      height, needed, size - ::ftello(in));
  reader.width = int(width);
  reader.height = int(height);
  reader.max = int(max);
  return {};
}

Result<LayeredFile> read_pnm_header(const fs::path& file) {
  PnmReader reader;
  if (auto opened = open(file, reader); !opened) return opened.error();
  LayeredFile header = plain_header(reader.width, reader.height);
  add_picture_channels(header, reader.channels, reader.max > 255 ? ChannelType::kUint16 : ChannelType::kUint8,
                       reader.max);
  return header;
}

Result<void> read_pnm_rows(const LayeredFile& file, std::span<const int> channels, RowTarget& target) {
  PnmReader reader;
  if (auto opened = open(file.path, reader); !opened) return opened;
  if (reader.width != file.width || reader.height != file.height || reader.channels != int(file.channels.size()))
    return changed_file(file);
  const bool is_little = std::endian::native == std::endian::little;
  const SampleType type = reader.is_text ? SampleType{SampleKind::kUnsigned, 2, false}
                                         : SampleType{SampleKind::kUnsigned, reader.max > 255 ? 2 : 1, is_little};
  const std::size_t values = std::size_t(reader.width) * std::size_t(reader.channels);
  std::vector<char> row(values * std::size_t(type.bytes));
  std::vector<std::uint16_t> numbers(reader.is_text ? values : 0);
  const auto read_row = [&] {
    if (!reader.is_text) return std::fread(row.data(), 1, row.size(), reader.stream.get()) == row.size();
    for (std::uint16_t& number : numbers) {
      const std::int64_t next = next_number(reader.stream.get());
      if (next < 0 || next > reader.max) return false;
      number = std::uint16_t(next);
    }
    return true;
  };
  const char* bytes = reader.is_text ? reinterpret_cast<const char*>(numbers.data()) : row.data();
  return target.each_block(1, [&](int first, int end) -> Result<void> {
    for (int y = first; y < end; ++y) {
      if (!read_row())
        return file_error("'{}' cannot be read: row {} is missing, or has a value above {}", file.path.string(), y,
                          reader.max);
      for (std::size_t c = 0; c < channels.size(); ++c)
        to_floats(type, bytes + std::ptrdiff_t(channels[c]) * type.bytes, std::ptrdiff_t(reader.channels) * type.bytes,
                  file.width, target.row(int(c), y));
    }
    return {};
  });
}

bool is_pnm(std::string_view start) {
  constexpr std::string_view kKinds = "2356";
  return start.size() > 2 && start[0] == 'P' && kKinds.find(start[1]) != std::string_view::npos &&
         (is_space(start[2]) || start[2] == '#');
}

}  // namespace

const LayerFormat kPnmLayers = {"PNM", "ppm pgm pnm", is_pnm, read_pnm_header, read_pnm_rows};

}  // namespace umbrage
