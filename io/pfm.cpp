// PFM, float maps: a text header ("PF" colour or "Pf" grey, width, height, scale), then rows of floats, the bottom row
// first. A negative scale means little-endian. Its magnitude is not applied: writers store arbitrary values there, and
// for depth the stored numbers are needed. Based on Debevec's description (HDR Shop).
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "core/numbers.h"
#include "io/format.h"
#include "io/layer_format.h"
#include "io/samples.h"

namespace umbrage {
namespace fs = std::filesystem;
namespace {

static_assert(sizeof(float) == 4);

Result<void> write_pfm(const fs::path& file, const ImageShape& shape, const WriteSettings&, const MakeImageRows& make) {
  const Image empty_image = image_without_pixels(shape);
  const Result<std::vector<const Plane*>> picture = picture_planes(file, empty_image, false);
  if (!picture) return picture.error();
  const std::size_t channels = picture->size();
  return write_atomically(file, [&](std::FILE* stream) -> Result<void> {
    const bool little = std::endian::native == std::endian::little;
    fmt::print(stream, "{}\n{} {}\n{}\n", channels == 1 ? "Pf" : "PF", shape.width, shape.height,
               little ? "-1.0" : "1.0");
    const off_t start = ::ftello(stream);
    std::vector<float> row(std::size_t(shape.width) * channels);
    int first = 0;
    return make([&](const Image& rows) -> Result<void> {
      const auto planes = picture_planes(file, rows, false);
      if (!planes) return planes.error();
      first += rows.height;
      // Rows arrive in groups from the top; the file starts with the bottom row. Pipes, which cannot seek, get all rows
      // at once.
      const off_t position = start + off_t(row.size() * sizeof(float)) * (shape.height - first);
      if (rows.height < shape.height && ::fseeko(stream, position, SEEK_SET) != 0)
        return file_error("'{}' cannot be written: {}", file.string(), std::strerror(errno));
      for (int y = rows.height - 1; y >= 0; --y) {
        for (std::size_t c = 0; c < channels; ++c)
          for (int x = 0; x < rows.width; ++x) row[std::size_t(x) * channels + c] = (*planes)[c]->at(x, y);
        if (std::fwrite(row.data(), sizeof(float), row.size(), stream) != row.size())
          return file_error("'{}' cannot be written: {}", file.string(), std::strerror(errno));
      }
      return {};
    });
  });
}

/// Returns the next word of the header. Skips white space before it and one character after it.
std::string word(std::FILE* stream) {
  constexpr std::size_t kMaxLength = 32;
  std::string text;
  for (int c = std::fgetc(stream); c != EOF && text.size() <= kMaxLength; c = std::fgetc(stream)) {
    const bool space = c == ' ' || (c >= '\t' && c <= '\r');
    if (space && !text.empty()) break;
    if (!space) text.push_back(char(c));
  }
  return text;
}

/// Returns the value of a word, or NaN if the word is not a number.
double number(std::string_view text) {
  const auto value = take_number(text);
  return value && text.empty() ? *value : std::nan("");
}

/// A PFM being read.
struct PfmReader {
  InputFile stream;
  int width = 0, height = 0, channels = 0;
  bool is_swapped = false;
  off_t start = 0;  // of the pixels, in bytes
};

Result<void> open(const fs::path& file, PfmReader& reader) {
  std::int64_t size = 0;
  Result<InputFile> stream = open_to_read(file, size);
  if (!stream) return stream.error();
  std::FILE* in = stream->get();
  const std::string kind = word(in);
  if (kind != "PF" && kind != "Pf")
    return file_error("'{}' is not a PFM file: it must begin with PF or Pf", file.string());
  const std::string words[3] = {word(in), word(in), word(in)};
  const double width = number(words[0]), height = number(words[1]), scale = number(words[2]);
  if (!(std::abs(width) < 1e9 && width == std::floor(width)) ||
      !(std::abs(height) < 1e9 && height == std::floor(height)))
    return file_error("'{}' has the size '{} {}' in its header: it must be two integers", file.string(), words[0],
                      words[1]);
  if (!(std::isfinite(scale) && scale != 0.0))
    return file_error("'{}' has the scale '{}' in its header: it must be a number other than 0", file.string(),
                      words[2]);
  if (Result<void> status = check_sides(file, std::int64_t(width), std::int64_t(height)); !status) return status;
  reader.channels = kind == "PF" ? 3 : 1;
  reader.start = ::ftello(in);
  const std::int64_t needed = std::int64_t(width) * std::int64_t(height) * reader.channels * 4;
  const std::int64_t available = size - reader.start;
  if (available < needed)
    return file_error("'{}' is cut short: {} x {} pixels are {} bytes and it has {}", file.string(), width, height,
                      needed, available);
  reader.stream = std::move(*stream);
  reader.width = int(width);
  reader.height = int(height);
  reader.is_swapped = (scale < 0.0) != (std::endian::native == std::endian::little);
  return {};
}

Result<LayeredFile> read_pfm_header(const fs::path& file) {
  PfmReader reader;
  if (auto opened = open(file, reader); !opened) return opened.error();
  LayeredFile header = plain_header(reader.width, reader.height);
  add_picture_channels(header, reader.channels, ChannelType::kFloat, 0.0);
  return header;
}

Result<void> read_pfm_rows(const LayeredFile& file, std::span<const int> channels, RowTarget& target) {
  PfmReader reader;
  if (auto opened = open(file.path, reader); !opened) return opened;
  if (reader.width != file.width || reader.height != file.height || reader.channels != int(file.channels.size()))
    return changed_file(file);
  const SampleType type{SampleKind::kFloat, sizeof(float), reader.is_swapped};
  const std::ptrdiff_t step = reader.channels * type.bytes;
  std::vector<char> row(std::size_t(step) * std::size_t(reader.width));
  return target.each_block(1, [&](int first, int end) -> Result<void> {
    ::fseeko(reader.stream.get(), reader.start + off_t(row.size()) * (reader.height - end), SEEK_SET);
    for (int y = end - 1; y >= first; --y) {
      if (std::fread(row.data(), 1, row.size(), reader.stream.get()) != row.size())
        return file_error("'{}' cannot be read: row {} is missing", file.path.string(), y);
      for (std::size_t c = 0; c < channels.size(); ++c)
        to_floats(type, row.data() + channels[c] * type.bytes, step, file.width, target.row(int(c), y));
    }
    return {};
  });
}

Result<Image> read_pfm(const fs::path& file) { return read_picture_as(kPfmLayers, file); }

bool is_pfm(std::string_view start) { return start.starts_with("PF") || start.starts_with("Pf"); }

}  // namespace

const ImageFormat kPfm = {"pfm", "float maps, grey or RGB", write_pfm, read_pfm, is_pfm};
const LayerFormat kPfmLayers = {"PFM", "pfm", is_pfm, read_pfm_header, read_pfm_rows};

}  // namespace umbrage
