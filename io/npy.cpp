// NumPy arrays: NPY of the versions 1 to 3, and NPZ, a ZIP archive of them. Based on NumPy Enhancement Proposal 1 and
// its later versions.
//
// An array is a picture if it is H x W, H x W x C, or C x H x W with C of 1 to 4, after leading sides of 1. The
// channels are Y, R G, R G B or R G B A. An NPZ has the size of its first picture; each array of that size is a part.
// Other arrays are attributes: up to 16 numbers as text, larger ones by their shape.
#include <zip.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <memory>
#include <numeric>

#include "io/layer_format.h"
#include "io/samples.h"

namespace umbrage {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";

/// The header of an array.
struct Array {
  SampleType type;
  bool is_fortran = false;
  std::vector<std::int64_t> shape;
  std::int64_t start = 0;  // of the values, in bytes from the magic

  std::int64_t count() const {
    return std::accumulate(shape.begin(), shape.end(), std::int64_t(1), std::multiplies<>());
  }
};

/// An array as a picture; strides are in values.
struct Layout {
  std::int64_t width = 0, height = 0, channels = 0, x = 0, y = 0, channel = 0;
};

/// Reads bytes [offset, offset + count) of an array's file. Returns false if there are fewer.
using ReadBytes = std::function<bool(std::int64_t offset, void* to, std::size_t count)>;

/// Returns the text after `key` and its colon in the dictionary of a header; empty if it is missing.
std::string_view after_key(std::string_view text, std::string_view key) {
  const std::size_t at = text.find(key);
  const std::size_t colon = at == std::string_view::npos ? at : text.find(':', at + key.size());
  if (colon == std::string_view::npos) return {};
  text.remove_prefix(colon + 1);
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  return text;
}

Result<SampleType> type_of(const std::string& name, std::string_view descr) {
  if (!descr.empty() && (descr[0] == '\'' || descr[0] == '"')) descr.remove_prefix(1);
  descr = descr.substr(0, descr.find_first_of("'\""));
  SampleType type;
  const bool is_plain = descr.size() == 3 && descr[2] >= '1' && descr[2] <= '8';
  const std::string_view kinds = "buif";
  if (is_plain && kinds.find(descr[1]) != std::string_view::npos) {
    type.bytes = descr[2] - '0';
    type.kind = descr[1] == 'f' ? SampleKind::kFloat : descr[1] == 'i' ? SampleKind::kSigned : SampleKind::kUnsigned;
    const bool is_big = descr[0] == '>';
    type.is_swapped = type.bytes > 1 && is_big == (std::endian::native == std::endian::little);
    if (std::has_single_bit(unsigned(type.bytes)) && (descr[1] != 'f' || type.bytes > 1)) return type;
  }
  return file_error("'{}' has values of the type '{}': integers and floats of up to 8 bytes can be read", name,
                    printable(descr.substr(0, 32)));
}

/// Reads the header of an array in a file of `size` bytes. `name` is for messages. Errors: kFile.
Result<Array> read_array_header(const std::string& name, std::int64_t size, const ReadBytes& read) {
  const Error damaged = file_error("'{}' cannot be read as NPY: its header is cut short or damaged", name);
  unsigned char fixed[12] = {};
  constexpr std::int64_t kMaxHeader = 1 << 16;
  if (!read(0, fixed, 10) || std::memcmp(fixed, kMagic.data(), kMagic.size()) != 0) return damaged;
  const int version = fixed[6];
  if (version < 1 || version > 3) return file_error("'{}' has the NPY version {}: 1 to 3 can be read", name, version);
  const std::int64_t at = version == 1 ? 10 : 12;
  if (!read(0, fixed, std::size_t(at))) return damaged;
  const std::int64_t length =
      version == 1 ? fixed[8] | fixed[9] << 8
                   : std::int64_t(fixed[8] | fixed[9] << 8 | fixed[10] << 16) | std::int64_t(fixed[11]) << 24;
  if (length > kMaxHeader) return damaged;
  std::string text(std::size_t(length), '\0');
  if (!read(at, text.data(), text.size())) return damaged;
  Array array;
  array.start = at + length;
  const Result<SampleType> type = type_of(name, after_key(text, "'descr'"));
  if (!type) return type.error();
  array.type = *type;
  array.is_fortran = after_key(text, "'fortran_order'").starts_with("True");
  std::string_view shape = after_key(text, "'shape'");
  if (!shape.starts_with('(') || shape.find(')') == std::string_view::npos) return damaged;
  shape = shape.substr(1, shape.find(')') - 1);
  std::int64_t bytes = array.type.bytes;
  while (!shape.empty()) {
    shape.remove_prefix(std::min(shape.find_first_not_of(" ,"), shape.size()));
    if (shape.empty()) break;
    std::int64_t side = 0;
    const auto [end, error] = std::from_chars(shape.data(), shape.data() + shape.size(), side);
    if (error != std::errc() || side < 0) return damaged;
    shape.remove_prefix(std::size_t(end - shape.data()));
    if (shape.starts_with('L')) shape.remove_prefix(1);  // of Python 2
    array.shape.push_back(side);
    if (side > 0 && bytes > (std::int64_t(1) << 50) / side) return damaged;
    bytes *= std::max<std::int64_t>(side, 1);
  }
  if (array.count() * array.type.bytes > size - array.start)
    return file_error("'{}' is cut short: its {} values are {} bytes and it has {}", name, array.count(),
                      array.count() * array.type.bytes, std::max<std::int64_t>(size - array.start, 0));
  return array;
}

std::string shape_text(const Array& array) {
  std::string text;
  for (const std::int64_t side : array.shape) text += (text.empty() ? "" : " x ") + std::to_string(side);
  return text.empty() ? "a single value" : text;
}

/// Returns an array as a picture; `channels` is 0 if it is none.
Layout layout_of(const Array& array) {
  constexpr std::int64_t kMaxChannels = 4;
  std::vector<std::int64_t> shape = array.shape, strides(shape.size());
  std::int64_t stride = 1;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const std::size_t axis = array.is_fortran ? i : shape.size() - 1 - i;
    strides[axis] = stride;
    stride *= shape[axis];
  }
  while (shape.size() > 2 && shape[0] == 1) {
    shape.erase(shape.begin());
    strides.erase(strides.begin());
  }
  Layout layout;
  if (shape.size() == 2) {
    layout = {shape[1], shape[0], 1, strides[1], strides[0], 0};
  } else if (shape.size() == 3 && shape[2] >= 1 && shape[2] <= kMaxChannels) {
    layout = {shape[1], shape[0], shape[2], strides[1], strides[0], strides[2]};
  } else if (shape.size() == 3 && shape[0] >= 1 && shape[0] <= kMaxChannels) {
    layout = {shape[2], shape[1], shape[0], strides[2], strides[1], strides[0]};
  }
  return layout;
}

void add_channels(const Array& array, const Layout& layout, const std::string& part, LayeredFile& header) {
  const std::string_view names = layout.channels == 1 ? "Y" : "RGBA";
  for (std::int64_t c = 0; c < layout.channels; ++c) {
    Channel channel;
    channel.part = part;
    channel.name = names[std::size_t(c)];
    channel.type = channel_type(array.type);
    if (array.type.kind == SampleKind::kUnsigned && array.type.bytes <= 2)
      channel.max_integer = array.type.bytes == 1 ? 255.0 : 65535.0;
    channel.is_srgb = channel.max_integer == 255.0 && layout.channels >= 3;
    header.channels.push_back(std::move(channel));
  }
}

/// Converts a row of a channel to floats.
Result<void> read_array_row(const fs::path& file, const Array& array, const Layout& layout, int channel, int y,
                            const ReadBytes& read, std::vector<unsigned char>& bytes, float* out) {
  const std::int64_t size = array.type.bytes, step = layout.x * size;
  const std::int64_t at = array.start + (channel * layout.channel + y * layout.y) * size;
  bytes.resize(std::size_t((layout.width - 1) * step + size));
  if (!read(at, bytes.data(), bytes.size()))
    return file_error("'{}' cannot be read: row {} is missing", file.string(), y);
  to_floats(array.type, bytes.data(), std::ptrdiff_t(step), int(layout.width), out);
  return {};
}

/// Converts rows [first, end) of a channel whose columns are contiguous.
Result<void> read_array_columns(const fs::path& file, const Array& array, const Layout& layout, int channel,
                                int target_channel, int first, int end, const ReadBytes& read, RowTarget& target) {
  const std::int64_t size = array.type.bytes, step = layout.y * size;
  std::vector<unsigned char> bytes(std::size_t((end - first - 1) * step + size));
  std::vector<float> column(std::size_t(end - first));
  for (int x = 0; x < int(layout.width); ++x) {
    const std::int64_t at = array.start + (channel * layout.channel + first * layout.y + x * layout.x) * size;
    if (!read(at, bytes.data(), bytes.size()))
      return file_error("'{}' cannot be read: column {} is missing", file.string(), x);
    to_floats(array.type, bytes.data(), std::ptrdiff_t(step), end - first, column.data());
    for (int y = first; y < end; ++y) target.row(target_channel, y)[x] = column[std::size_t(y - first)];
  }
  return {};
}

/// An array that channels are read from.
struct Source {
  Array array;
  Layout layout;
  ReadBytes read;
};

/// Reads rows of channels; `sources` and `channels` name the array and its channel for each.
Result<void> read_sources(const LayeredFile& file, const std::vector<const Source*>& sources,
                          const std::vector<int>& channels, RowTarget& target) {
  std::vector<unsigned char> bytes;
  return target.each_block(1, [&](int first, int end) -> Result<void> {
    for (std::size_t c = 0; c < sources.size(); ++c) {
      const Source& from = *sources[c];
      if (from.layout.x > from.layout.y) {
        auto read =
            read_array_columns(file.path, from.array, from.layout, channels[c], int(c), first, end, from.read, target);
        if (!read) return read;
        continue;
      }
      for (int y = first; y < end; ++y)
        if (auto read = read_array_row(file.path, from.array, from.layout, channels[c], y, from.read, bytes,
                                       target.row(int(c), y));
            !read)
          return read;
    }
    return {};
  });
}

ReadBytes bytes_of(std::FILE* stream) {
  return [stream](std::int64_t offset, void* to, std::size_t count) {
    return ::fseeko(stream, off_t(offset), SEEK_SET) == 0 && std::fread(to, 1, count, stream) == count;
  };
}

ReadBytes bytes_of(const std::string& content) {
  return [&content](std::int64_t offset, void* to, std::size_t count) {
    if (offset < 0 || std::size_t(offset) > content.size() || count > content.size() - std::size_t(offset))
      return false;
    std::memcpy(to, content.data() + offset, count);
    return true;
  };
}

Result<Source> open_npy(const fs::path& file, InputFile& stream) {
  std::int64_t size = 0;
  Result<InputFile> opened = open_to_read(file, size);
  if (!opened) return opened.error();
  stream = std::move(*opened);
  Source source;
  source.read = bytes_of(stream.get());
  Result<Array> array = read_array_header(file.string(), size, source.read);
  if (!array) return array.error();
  source.array = std::move(*array);
  source.layout = layout_of(source.array);
  if (source.layout.channels == 0)
    return file_error("'{}' has the shape {}: a picture is H x W, H x W x C or C x H x W, with C of 1 to 4",
                      file.string(), shape_text(source.array));
  if (auto status = check_sides(file, source.layout.width, source.layout.height); !status) return status.error();
  return source;
}

Result<LayeredFile> read_npy_header(const fs::path& file) {
  InputFile stream;
  const Result<Source> source = open_npy(file, stream);
  if (!source) return source.error();
  LayeredFile header = plain_header(int(source->layout.width), int(source->layout.height));
  add_channels(source->array, source->layout, "", header);
  return header;
}

Result<void> read_npy_rows(const LayeredFile& file, std::span<const int> channels, RowTarget& target) {
  InputFile stream;
  const Result<Source> source = open_npy(file.path, stream);
  if (!source) return source.error();
  if (source->layout.width != file.width || source->layout.height != file.height ||
      source->layout.channels != std::int64_t(file.channels.size()))
    return changed_file(file);
  return read_sources(file, std::vector<const Source*>(channels.size(), &*source),
                      std::vector<int>(channels.begin(), channels.end()), target);
}

// --- NPZ ------------------------------------------------------------------------------------------------------------

struct CloseZip {
  void operator()(zip_t* zip) const { zip_discard(zip); }
};
using Zip = std::unique_ptr<zip_t, CloseZip>;

/// An array in an archive.
struct Entry {
  std::string name;  // without .npy
  zip_uint64_t index = 0;
  std::int64_t size = 0;
  Array array;
  Layout layout;
};

/// `size` becomes the size of the file, bytes.
Result<Zip> open_zip(const fs::path& file, std::int64_t& size) {
  if (const auto stream = open_to_read(file, size); !stream) return stream.error();
  int code = 0;
  Zip zip(zip_open(file.c_str(), ZIP_RDONLY, &code));
  if (zip) return zip;
  zip_error_t error;
  zip_error_init_with_code(&error, code);
  const std::string cause = zip_error_strerror(&error);
  zip_error_fini(&error);
  return file_error("'{}' cannot be read as NPZ: {}", file.string(), cause);
}

/// Decompresses the first `count` bytes of an entry. Returns fewer if it is damaged, or the time is up.
std::string inflate(const fs::path& file, zip_t* zip, const Entry& entry, std::int64_t count) {
  std::string content(std::size_t(std::min(count, entry.size)), '\0');
  std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> stream(zip_fopen_index(zip, entry.index, 0), zip_fclose);
  std::size_t filled = 0;
  while (stream && filled < content.size() && check_reading_time(file)) {
    constexpr std::size_t kBlock = std::size_t(1) << 24;
    const zip_int64_t got = zip_fread(stream.get(), content.data() + filled, std::min(content.size() - filled, kBlock));
    if (got <= 0) break;
    filled += std::size_t(got);
  }
  // libzip compares the checksum when it is asked for more.
  char none = 0;
  const bool has_failed = !stream || (std::int64_t(filled) == entry.size && zip_fread(stream.get(), &none, 1) != 0);
  content.resize(has_failed ? 0 : filled);
  return content;
}

/// `size`: of the archive, bytes.
Result<std::vector<Entry>> list_entries(const fs::path& file, std::int64_t size, zip_t* zip) {
  constexpr std::int64_t kMaxEntry = std::int64_t(1) << 33, kUsualHeader = 128, kBestRatio = 1032;
  std::vector<Entry> entries;
  const zip_int64_t count = zip_get_num_entries(zip, 0);
  for (zip_int64_t i = 0; i < count; ++i) {
    if (auto in_time = check_reading_time(file); !in_time) return in_time.error();
    zip_stat_t about;
    zip_stat_init(&about);
    if (zip_stat_index(zip, zip_uint64_t(i), 0, &about) != 0 || !(about.valid & ZIP_STAT_NAME)) continue;
    Entry entry;
    entry.name = printable(about.name);
    if (!entry.name.ends_with(".npy")) continue;
    entry.name.resize(entry.name.size() - 4);
    if (!(about.valid & ZIP_STAT_SIZE) || about.size > zip_uint64_t(kMaxEntry) || !(about.valid & ZIP_STAT_COMP_SIZE) ||
        about.comp_size > zip_uint64_t(size) || about.size / kBestRatio > about.comp_size + 1)
      return file_error("'{}' claims {} bytes for its array '{}', more than it can hold", file.string(), about.size,
                        entry.name);
    entry.index = zip_uint64_t(i);
    entry.size = std::int64_t(about.size);
    std::string start;
    const ReadBytes read = [&](std::int64_t offset, void* to, std::size_t bytes) {
      const std::int64_t end = offset + std::int64_t(bytes);
      if (std::int64_t(start.size()) < end) start = inflate(file, zip, entry, std::max(end, kUsualHeader));
      return bytes_of(start)(offset, to, bytes);
    };
    auto array = read_array_header(file.string() + ":" + entry.name, entry.size, read);
    if (!array) return array.error();
    entry.array = std::move(*array);
    entry.layout = layout_of(entry.array);
    entries.push_back(std::move(entry));
  }
  return entries;
}

/// Describes an array that is not a picture of the file's size.
std::string described(const fs::path& file, zip_t* zip, const Entry& entry) {
  constexpr std::int64_t kMaxNumbers = 16;
  const std::int64_t count = entry.array.count();
  const std::int64_t end = entry.array.start + count * entry.array.type.bytes;
  const std::string content = count > kMaxNumbers ? "" : inflate(file, zip, entry, end);
  if (std::int64_t(content.size()) < end) return "array of " + shape_text(entry.array);
  std::vector<float> numbers(std::size_t(count), 0.0f);
  to_floats(entry.array.type, content.data() + entry.array.start, entry.array.type.bytes, int(count), numbers.data());
  std::string text;
  for (const float number : numbers) text += (text.empty() ? "" : ",") + fmt::format("{}", number);
  return text;
}

/// Returns the first entry that is a picture, by size: the others must have the same.
const Entry* first_picture(const std::vector<Entry>& entries) {
  const Entry* first = nullptr;
  for (const Entry& entry : entries) {
    constexpr std::int64_t kMinSide = 8;  // smaller arrays are matrices and vectors
    const bool is_picture = entry.layout.channels > 0 && std::min(entry.layout.width, entry.layout.height) >= kMinSide;
    if (is_picture && !first) first = &entry;
  }
  for (const Entry& entry : entries)
    if (!first && entry.layout.channels > 0) first = &entry;
  return first;
}

/// An archive that was opened, with its pictures.
struct OpenNpz {
  Zip zip;
  std::vector<Entry> pictures, others;
};

Result<OpenNpz> open_npz(const fs::path& file) {
  std::int64_t bytes = 0;
  Result<Zip> zip = open_zip(file, bytes);
  if (!zip) return zip.error();
  Result<std::vector<Entry>> entries = list_entries(file, bytes, zip->get());
  if (!entries) return entries.error();
  const Entry* first = first_picture(*entries);
  if (!first)
    return file_error("'{}' has no array that is a picture: one is H x W, H x W x C or C x H x W, with C of 1 to 4",
                      file.string());
  const Layout size = first->layout;
  if (auto status = check_size(file, size.width, size.height); !status) return status.error();
  OpenNpz npz;
  npz.zip = std::move(*zip);
  for (Entry& entry : *entries) {
    const bool fits =
        entry.layout.channels > 0 && entry.layout.width == size.width && entry.layout.height == size.height;
    (fits ? npz.pictures : npz.others).push_back(std::move(entry));
  }
  return npz;
}

Result<LayeredFile> read_npz_header(const fs::path& file) {
  const Result<OpenNpz> npz = open_npz(file);
  if (!npz) return npz.error();
  LayeredFile header = plain_header(int(npz->pictures[0].layout.width), int(npz->pictures[0].layout.height));
  for (const Entry& entry : npz->pictures) add_channels(entry.array, entry.layout, entry.name, header);
  for (const Entry& entry : npz->others)
    header.attributes.emplace_back(entry.name, described(file, npz->zip.get(), entry));
  return header;
}

Result<void> read_npz_rows(const LayeredFile& file, std::span<const int> channels, RowTarget& target) {
  const Result<OpenNpz> npz = open_npz(file.path);
  if (!npz) return npz.error();
  std::vector<std::pair<std::size_t, int>> listed;  // picture of each channel, and which one of its channels it is
  for (std::size_t k = 0; k < npz->pictures.size(); ++k)
    for (int c = 0; c < int(npz->pictures[k].layout.channels); ++c) listed.emplace_back(k, c);
  if (npz->pictures[0].layout.width != file.width || npz->pictures[0].layout.height != file.height ||
      listed.size() != file.channels.size())
    return changed_file(file);
  // A compressed array can only be read from its start, so requested arrays are in memory.
  const std::size_t count = npz->pictures.size();
  std::vector<std::string> contents(count);
  std::vector<Source> sources(count);
  std::vector<const Source*> from;
  std::vector<int> own_channels;
  double bytes = 0.0;
  for (const int requested : channels) {
    const auto [k, channel] = listed[std::size_t(requested)];
    const Entry& entry = npz->pictures[k];
    if (contents[k].empty()) {
      bytes += double(entry.size);
      if (auto fits = check_memory(file.path, bytes); !fits) return fits;
      contents[k] = inflate(file.path, npz->zip.get(), entry, entry.size);
      if (auto in_time = check_reading_time(file.path); !in_time) return in_time;
      if (std::int64_t(contents[k].size()) < entry.size)
        return file_error("'{}' cannot be read: its array '{}' is damaged", file.path.string(), entry.name);
      sources[k] = {entry.array, entry.layout, bytes_of(contents[k])};
    }
    from.push_back(&sources[k]);
    own_channels.push_back(channel);
  }
  return read_sources(file, from, own_channels, target);
}

}  // namespace

const LayerFormat kNpyLayers = {"NPY", "npy", [](std::string_view start) { return start.starts_with(kMagic); },
                                read_npy_header, read_npy_rows};
const LayerFormat kNpzLayers = {"NPZ", "npz", [](std::string_view start) { return start.starts_with("PK\x03\x04"); },
                                read_npz_header, read_npz_rows};

}  // namespace umbrage
