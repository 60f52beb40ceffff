// Depth and normal maps of COLMAP (*.geometric.bin, *.photometric.bin): a text "width&height&channels&", then floats,
// little-endian, one channel after the other, each by rows from the top. Based on COLMAP's description of its output
// format, "Dense Reconstruction".
#include <bit>
#include <charconv>

#include "io/layer_format.h"
#include "io/samples.h"

namespace umbrage {
namespace fs = std::filesystem;
namespace {

/// The numbers at the start of a file.
struct Sizes {
  std::int64_t width = 0, height = 0, channels = 0;
  std::int64_t start = 0;  ///< of the values, in bytes; 0: the text is none of a map
};

Sizes sizes_of(std::string_view text) {
  Sizes sizes;
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::int64_t* number : {&sizes.width, &sizes.height, &sizes.channels}) {
    const auto [next, error] = std::from_chars(at, end, *number);
    if (error != std::errc() || next == end || *next != '&' || *number < 0) return {};
    at = next + 1;
  }
  sizes.start = at - text.data();
  return sizes;
}

Result<Sizes> open(const fs::path& file, InputFile& stream) {
  std::int64_t size = 0;
  Result<InputFile> opened = open_to_read(file, size);
  if (!opened) return opened.error();
  stream = std::move(*opened);
  char text[kLayerMagic] = {};
  const Sizes sizes = sizes_of({text, std::fread(text, 1, sizeof text, stream.get())});
  if (sizes.channels != 1 && sizes.channels != 3)
    return file_error("'{}' has {} channels: a map of COLMAP has 1, depth, or 3, normals", file.string(),
                      sizes.channels);
  if (auto status = check_sides(file, sizes.width, sizes.height); !status) return status.error();
  const std::int64_t needed = sizes.width * sizes.height * sizes.channels * std::int64_t(sizeof(float));
  if (size - sizes.start < needed)
    return file_error("'{}' is cut short: its values are {} bytes and it has {}", file.string(), needed,
                      size - sizes.start);
  return sizes;
}

Result<LayeredFile> read_colmap_header(const fs::path& file) {
  InputFile stream;
  const auto sizes = open(file, stream);
  if (!sizes) return sizes.error();
  LayeredFile header = plain_header(int(sizes->width), int(sizes->height));
  for (const char letter : std::string_view(sizes->channels == 1 ? "Z" : "XYZ")) {
    Channel channel;
    channel.layer = sizes->channels == 1 ? "depth" : "normal";
    channel.name = letter;
    header.channels.push_back(std::move(channel));
  }
  return header;
}

Result<void> read_colmap_rows(const LayeredFile& file, std::span<const int> channels, RowTarget& target) {
  InputFile stream;
  const auto sizes = open(file.path, stream);
  if (!sizes) return sizes.error();
  if (sizes->width != file.width || sizes->height != file.height ||
      sizes->channels != std::int64_t(file.channels.size()))
    return changed_file(file);
  const SampleType type{SampleKind::kFloat, int(sizeof(float)), std::endian::native == std::endian::big};
  std::vector<char> row(std::size_t(file.width) * sizeof(float));
  return target.each_block(1, [&](int first, int end) -> Result<void> {
    for (std::size_t c = 0; c < channels.size(); ++c)
      for (int y = first; y < end; ++y) {
        const std::int64_t at = sizes->start + (sizes->height * channels[c] + y) * std::int64_t(row.size());
        if (::fseeko(stream.get(), off_t(at), SEEK_SET) != 0 ||
            std::fread(row.data(), 1, row.size(), stream.get()) != row.size())
          return file_error("'{}' cannot be read: row {} is missing", file.path.string(), y);
        to_floats(type, row.data(), sizeof(float), file.width, target.row(int(c), y));
      }
    return {};
  });
}

}  // namespace

const LayerFormat kColmapLayers = {"COLMAP", "bin", [](std::string_view start) { return sizes_of(start).start > 0; },
                                   read_colmap_header, read_colmap_rows};

}  // namespace umbrage
