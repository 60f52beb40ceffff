// TIFF through libtiff: integers of 1 to 32 bits, floats of 16 to 64 bits, strips or tiles, any compression of the
// library, interleaved or planar, BigTIFF; of several pictures in a file the first. Based on "TIFF Revision 6.0" and
// its supplements. Georeference: see geo_tags.h.
//
// Channels. The samples of an RGB picture are R, G, B; a single or first other sample is Y. An alpha sample is A.
// Others are band2, band3 and so on, counted from 1 as in geographic software.
//
// Sparse files omit strips and tiles without data: these have the value for missing data, or 0.
#include <tiffio.h>

#include <cstdarg>
#include <cstdint>
#include <memory>

#include "io/geo_tags.h"
#include "io/layer_format.h"
#include "io/samples.h"

namespace umbrage {
namespace fs = std::filesystem;
namespace {

struct CloseTiff {
  void operator()(TIFF* tiff) const { TIFFClose(tiff); }
};

/// An open TIFF and the layout of its first picture.
struct TiffReader {
  std::string message;  // the library's last error
  std::unique_ptr<TIFF, CloseTiff> tiff;
  std::uint32_t width = 0, height = 0, tile_width = 0, tile_height = 0, rows_per_strip = 0;
  std::uint16_t samples = 1, bits = 1, format = SAMPLEFORMAT_UINT, planar = PLANARCONFIG_CONTIG;
  std::uint16_t photometric = PHOTOMETRIC_MINISBLACK, compression = COMPRESSION_NONE;
  SampleType type;

  bool is_tiled() const { return tile_width > 0; }
  bool is_planar() const { return planar == PLANARCONFIG_SEPARATE && samples > 1; }
  double max_integer() const {
    if (type.kind != SampleKind::kUnsigned || bits > 16) return 0.0;
    return double((1u << bits) - 1);
  }
};

int on_error(TIFF*, void* user, const char*, const char* format, va_list arguments) {
  char text[256];
  std::vsnprintf(text, sizeof text, format, arguments);
  static_cast<TiffReader*>(user)->message = printable(text);
  return 1;
}

int on_warning(TIFF*, void*, const char*, const char*, va_list) { return 1; }

/// Returns the error for pixels that cannot be decoded. The library's own message counts rows of its buffers.
Error damaged_pixels(const fs::path& file, std::string_view what, int number) {
  return file_error("'{}' cannot be read as TIFF: {} {} is missing or damaged", file.string(), what, number);
}

Error read_error(const fs::path& file, const TiffReader& reader) {
  return file_error("'{}' cannot be read as TIFF: {}", file.string(),
                    reader.message.empty() ? "it is damaged" : reader.message);
}

/// Sets the type of samples. Errors: kFile for layouts that cannot be read.
Result<void> set_type(const fs::path& file, TiffReader& reader) {
  const bool is_real = reader.format == SAMPLEFORMAT_IEEEFP;
  const bool is_signed = reader.format == SAMPLEFORMAT_INT;
  const bool is_known =
      is_real || is_signed || reader.format == SAMPLEFORMAT_UINT || reader.format == SAMPLEFORMAT_VOID;
  const int bits = reader.bits;
  const bool is_whole = bits == 8 || bits == 16 || bits == 32 || bits == 64;
  const bool is_packed = bits == 1 || bits == 2 || bits == 4;
  if (!is_known || (is_real ? !is_whole || bits == 8 : is_signed ? !is_whole : !is_whole && !is_packed))
    return file_error(
        "'{}' has {}-bit samples of format {}: integers of 1, 2, 4, 8, 16, 32 or 64 bits and floats of 16, 32 or 64 "
        "bits can be read",
        file.string(), bits, reader.format);
  reader.type.kind = is_real ? SampleKind::kFloat : is_signed ? SampleKind::kSigned : SampleKind::kUnsigned;
  reader.type.bytes = std::max(bits / 8, 1);
  return {};
}

Result<void> check_layout(const fs::path& file, TiffReader& reader) {
  constexpr int kMaxSamples = 1024;
  constexpr std::int64_t kMaxBytes = std::int64_t(1) << 30;  // of a row or tile
  if (auto status = check_sides(file, reader.width, reader.height); !status) return status;
  if (reader.samples < 1 || reader.samples > kMaxSamples)
    return file_error("'{}' has {} samples per pixel: 1 to {} can be read", file.string(), reader.samples, kMaxSamples);
  if (!TIFFIsCODECConfigured(reader.compression))
    return file_error("'{}' has the compression {}, which libtiff cannot decode here: convert it to LZW or Deflate",
                      file.string(), reader.compression);
  const bool converts_jpeg = reader.compression == COMPRESSION_JPEG && reader.photometric == PHOTOMETRIC_YCBCR;
  const bool is_plain = reader.photometric == PHOTOMETRIC_MINISBLACK || reader.photometric == PHOTOMETRIC_MINISWHITE ||
                        reader.photometric == PHOTOMETRIC_RGB || reader.photometric == PHOTOMETRIC_PALETTE ||
                        reader.photometric == PHOTOMETRIC_MASK;
  if (!is_plain && !converts_jpeg)
    return file_error("'{}' has colours of photometric interpretation {}: only grey, RGB and indices can be read",
                      file.string(), reader.photometric);
  if (converts_jpeg) TIFFSetField(reader.tiff.get(), TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB);
  std::uint16_t orientation = ORIENTATION_TOPLEFT;
  TIFFGetFieldDefaulted(reader.tiff.get(), TIFFTAG_ORIENTATION, &orientation);
  if (orientation != ORIENTATION_TOPLEFT)
    return file_error("'{}' has the orientation {}: only 1 (top left) can be read, so rotate it first", file.string(),
                      orientation);
  if (reader.is_tiled() &&
      (reader.tile_width > kMaxFileSide || reader.tile_height < 1 || reader.tile_height > kMaxFileSide))
    return file_error("'{}' has tiles of {} x {} pixels: 1 to {} per side can be read", file.string(),
                      reader.tile_width, reader.tile_height, kMaxFileSide);
  const std::uint64_t bytes =
      reader.is_tiled() ? TIFFTileSize64(reader.tiff.get()) : TIFFScanlineSize64(reader.tiff.get());
  if (bytes < 1 || bytes > std::uint64_t(kMaxBytes))
    return file_error("'{}' has {} of {} bytes in its header: 1 to {} can be read", file.string(),
                      reader.is_tiled() ? "tiles" : "rows", bytes, kMaxBytes);
  return {};
}

Result<void> open(const fs::path& file, TiffReader& reader) {
  std::int64_t size = 0;
  if (const auto stream = open_to_read(file, size); !stream) return stream.error();
  const std::unique_ptr<TIFFOpenOptions, void (*)(TIFFOpenOptions*)> options(TIFFOpenOptionsAlloc(),
                                                                             TIFFOpenOptionsFree);
  constexpr std::int64_t kMaxAllocation = std::int64_t(1) << 31;  // a compressed strip may hold a whole picture
  TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(), kMaxAllocation);
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), on_error, &reader);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), on_warning, nullptr);
  reader.tiff.reset(TIFFOpenExt(file.c_str(), "rm", options.get()));  // m: a mapped file that shrinks ends the process
  TIFF* tiff = reader.tiff.get();
  if (!tiff) return read_error(file, reader);
  TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &reader.width);
  TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &reader.height);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &reader.samples);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &reader.bits);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &reader.format);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_PLANARCONFIG, &reader.planar);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_COMPRESSION, &reader.compression);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_ROWSPERSTRIP, &reader.rows_per_strip);
  TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &reader.photometric);
  if (TIFFIsTiled(tiff)) {
    TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &reader.tile_width);
    TIFFGetField(tiff, TIFFTAG_TILELENGTH, &reader.tile_height);
  }
  if (auto status = set_type(file, reader); !status) return status;
  return check_layout(file, reader);
}

void name_channels(const TiffReader& reader, LayeredFile& header) {
  std::uint16_t extra_count = 0;
  std::uint16_t* extras = nullptr;
  TIFFGetFieldDefaulted(reader.tiff.get(), TIFFTAG_EXTRASAMPLES, &extra_count, &extras);
  const bool is_rgb =
      reader.samples >= 3 && (reader.photometric == PHOTOMETRIC_RGB || reader.photometric == PHOTOMETRIC_YCBCR);
  const int colours = is_rgb ? 3 : 1;
  for (int s = 0; s < reader.samples; ++s) {
    Channel channel;
    channel.type = channel_type(reader.type);
    const int extra = s - (reader.samples - extra_count);
    const bool is_alpha = s == colours && extra >= 0 && extras && extras[extra] != EXTRASAMPLE_UNSPECIFIED;
    if (s < colours)
      channel.name = is_rgb ? std::string(1, "RGB"[s]) : "Y";
    else
      channel.name = is_alpha ? "A" : fmt::format("band{}", s + 1);
    header.channels.push_back(std::move(channel));
  }
}

void add_texts(const TiffReader& reader, LayeredFile& header) {
  constexpr std::pair<std::uint32_t, const char*> kTexts[] = {
      {TIFFTAG_IMAGEDESCRIPTION, "description"}, {TIFFTAG_SOFTWARE, "software"}, {TIFFTAG_DATETIME, "date"}};
  for (const auto& [tag, name] : kTexts) {
    const char* text = nullptr;
    if (!TIFFGetField(reader.tiff.get(), tag, &text) || !text) continue;
    header.attributes.emplace_back(name, printable(text));
  }
}

Result<LayeredFile> read_tiff_header(const fs::path& file) {
  TiffReader reader;
  if (auto opened = open(file, reader); !opened) return opened.error();
  LayeredFile header = plain_header(int(reader.width), int(reader.height));
  name_channels(reader, header);
  header.geo = geo_raster_of(reader.tiff.get(), header.width, header.height);
  for (Channel& channel : header.channels) {
    channel.max_integer = reader.max_integer();
    channel.is_srgb = channel.max_integer >= 255.0 && !header.geo;
  }
  add_texts(reader, header);
  return header;
}

/// Returns a sample of packed bits; the first is the highest of its byte.
std::uint8_t packed_sample(const unsigned char* row, std::size_t index, int bits) {
  const std::size_t bit = index * std::size_t(bits);
  return std::uint8_t(row[bit / 8] >> (8 - bits - int(bit % 8)) & ((1 << bits) - 1));
}

/// Converts `count` samples of a row; `sample` of `samples` interleaved ones.
void convert(const TiffReader& reader, const unsigned char* row, int sample, int samples, int count, float* out) {
  if (reader.bits < 8)
    for (int x = 0; x < count; ++x)
      out[x] = packed_sample(row, std::size_t(x) * std::size_t(samples) + std::size_t(sample), reader.bits);
  else
    to_floats(reader.type, row + std::ptrdiff_t(sample) * reader.type.bytes,
              std::ptrdiff_t(samples) * reader.type.bytes, count, out);
  if (reader.photometric != PHOTOMETRIC_MINISWHITE || reader.max_integer() == 0.0) return;
  for (int x = 0; x < count; ++x) out[x] = float(reader.max_integer()) - out[x];
}

/// Returns whether a strip or tile was omitted from a sparse file.
bool is_omitted(TIFF* tiff, std::uint32_t strile) {
  return TIFFGetStrileByteCount(tiff, strile) == 0 && TIFFGetStrileOffset(tiff, strile) == 0;
}

Result<void> read_strips(const LayeredFile& file, TiffReader& reader, std::span<const int> channels, float no_data,
                         RowTarget& target) {
  const int samples = reader.is_planar() ? 1 : reader.samples;
  // The library decodes the rows of a strip one after the other. Therefore each plane has its own file object, with its
  // own tables of positions and sizes, unless blocks consist of whole strips.
  constexpr std::uint32_t kFewRows = 16;
  const bool by_planes = reader.is_planar() && reader.rows_per_strip <= kFewRows;
  const bool is_separate = reader.is_planar() && !by_planes;
  std::vector<std::unique_ptr<TiffReader>> planes;
  for (std::size_t c = 1; is_separate && c < channels.size(); ++c) {
    constexpr double kMaxTables = 1e9;  // bytes
    if (2.0 * sizeof(std::uint64_t) * TIFFNumberOfStrips(reader.tiff.get()) * double(c) > kMaxTables)
      return file_error("'{}' has too many strips in {} planes", file.path.string(), channels.size());
    if (auto in_time = check_reading_time(file.path); !in_time) return in_time;
    planes.push_back(std::make_unique<TiffReader>());
    if (auto opened = open(file.path, *planes.back()); !opened) return opened;
  }
  std::vector<unsigned char> row(std::size_t(TIFFScanlineSize64(reader.tiff.get())));
  return target.each_block(by_planes ? int(reader.rows_per_strip) : 1, [&](int first, int end) -> Result<void> {
    const int rows = end - first, count = int(channels.size());
    for (int i = 0; i < rows * count; ++i) {
      // One row of all channels after the other, or all rows of one plane after the other.
      const int y = first + (by_planes ? i % rows : i / count);
      const auto c = std::size_t(by_planes ? i / rows : i % count);
      TiffReader& from = is_separate && c > 0 ? *planes[c - 1] : reader;
      const auto plane = std::uint16_t(reader.is_planar() ? channels[c] : 0);
      float* out = target.row(int(c), y);
      if (is_omitted(from.tiff.get(), TIFFComputeStrip(from.tiff.get(), std::uint32_t(y), plane))) {
        std::fill_n(out, file.width, no_data);
        continue;
      }
      const bool is_read = !reader.is_planar() && c > 0;
      if (!is_read && TIFFReadScanline(from.tiff.get(), row.data(), std::uint32_t(y), plane) < 0)
        return damaged_pixels(file.path, "row", y);
      convert(reader, row.data(), reader.is_planar() ? 0 : channels[c], samples, file.width, out);
    }
    return {};
  });
}

Result<void> read_tiles(const LayeredFile& file, TiffReader& reader, std::span<const int> channels, float no_data,
                        RowTarget& target) {
  TIFF* tiff = reader.tiff.get();
  const int samples = reader.is_planar() ? 1 : reader.samples;
  const int tile_width = int(reader.tile_width), tile_height = int(reader.tile_height);
  std::vector<unsigned char> tile(std::size_t(TIFFTileSize64(tiff)));
  const std::size_t row_bytes = std::size_t(TIFFTileRowSize64(tiff));
  const auto read_tile = [&](int x, int y, std::size_t c, int first, int end) -> Result<void> {
    const auto plane = std::uint16_t(reader.is_planar() ? channels[c] : 0);
    const std::uint32_t index = TIFFComputeTile(tiff, std::uint32_t(x), std::uint32_t(y), 0, plane);
    const bool omitted = is_omitted(tiff, index), is_read = !reader.is_planar() && c > 0;
    if (!omitted && !is_read && TIFFReadEncodedTile(tiff, index, tile.data(), tmsize_t(tile.size())) < 0)
      return damaged_pixels(file.path, "the tile at row", y);
    const int count = std::min(tile_width, file.width - x);
    for (int row = std::max(y, first); row < std::min(y + tile_height, end); ++row) {
      float* out = target.row(int(c), row) + x;
      if (omitted)
        std::fill_n(out, count, no_data);
      else
        convert(reader, tile.data() + std::size_t(row - y) * row_bytes, reader.is_planar() ? 0 : channels[c], samples,
                count, out);
    }
    return {};
  };
  return target.each_block(tile_height, [&](int first, int end) -> Result<void> {
    for (int y = first / tile_height * tile_height; y < end; y += tile_height)
      for (int x = 0; x < file.width; x += tile_width)
        for (std::size_t c = 0; c < channels.size(); ++c)
          if (auto read = read_tile(x, y, c, first, end); !read) return read;
    return {};
  });
}

Result<void> read_tiff_rows(const LayeredFile& file, std::span<const int> channels, RowTarget& target) {
  TiffReader reader;
  if (auto opened = open(file.path, reader); !opened) return opened;
  if (int(reader.width) != file.width || int(reader.height) != file.height || reader.samples != file.channels.size())
    return changed_file(file);
  const float no_data = file.geo && file.geo->no_data ? float(*file.geo->no_data) : 0.0f;
  return reader.is_tiled() ? read_tiles(file, reader, channels, no_data, target)
                           : read_strips(file, reader, channels, no_data, target);
}

bool is_tiff(std::string_view start) {
  using std::string_view_literals::operator""sv;
  for (const std::string_view magic : {"II*\0"sv, "MM\0*"sv, "II+\0"sv, "MM\0+"sv})
    if (start.starts_with(magic)) return true;
  return false;
}

}  // namespace

const LayerFormat kTiffLayers = {"TIFF", "tif tiff", is_tiff, read_tiff_header, read_tiff_rows};

}  // namespace umbrage
