#include "io/layers.h"

#include <algorithm>
#include <ctime>
#include <limits>
#include <new>

#include "core/suggest.h"
#include "io/layer_format.h"
#include "system/machine.h"

namespace umbrage {
namespace fs = std::filesystem;
namespace {

constexpr const LayerFormat* kFormats[] = {&kExrLayers,  &kPngLayers,  &kTiffLayers, &kPfmLayers,
                                           &kNpyLayers,  &kNpzLayers,  &kPnmLayers,  &kGridLayers,
                                           &kJpegLayers, &kWebpLayers, &kHdrLayers,  &kColmapLayers};

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr std::int64_t kMaxValues = std::int64_t(1) << 31;  // 8 GB, in memory at once

constexpr double kInfinity = std::numeric_limits<double>::infinity();
thread_local double reading_end_s = kInfinity, max_memory = kInfinity;  // the limits of ReadingLimits
thread_local double receivers_s = 0.0;                                  // processor time of receivers of rows

double thread_seconds() {
  std::timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

double reading_seconds() { return thread_seconds() - receivers_s; }

double bytes_in(const fs::path& file) {
  std::error_code missing;
  const auto size = fs::file_size(file, missing);
  return missing ? 0.0 : double(size);
}

Error no_memory_to_read(const fs::path& file) {
  return device_error("'{}' cannot be read: its pixels need more memory than is available", file.string());
}

/// Returns the format of a file. Errors: kFile.
Result<const LayerFormat*> format_of_content(const fs::path& file) {
  std::int64_t size = 0;
  const Result<InputFile> stream = open_to_read(file, size);
  if (!stream) return stream.error();
  char start[kLayerMagic] = {};
  const std::size_t count = std::fread(start, 1, sizeof start, stream->get());
  std::vector<std::string> extensions;
  for (const LayerFormat* format : kFormats) {
    if (format->recognises(std::string_view(start, count))) return format;
    extensions.push_back("." + std::string(format->extensions.substr(0, format->extensions.find(' '))));
  }
  return file_error("'{}' {}: its content must be that of {}", file.string(),
                    count == 0 ? "is empty" : "is not an image of a known format", joined_by_or(extensions));
}

Result<const LayerFormat*> format_named(const LayeredFile& file) {
  for (const LayerFormat* format : kFormats)
    if (format->name == file.format) return format;
  return changed_file(file);
}

/// Checks the channels that a caller requests, and that there are pixels for a sensible part of the frame: if the frame
/// is gigabytes in size and there is almost no data, the header is damaged, or the file is made to take long.
Result<void> check_request(const LayeredFile& file, std::span<const int> channels) {
  for (const int channel : channels)
    if (channel < 0 || std::size_t(channel) >= file.channels.size())
      return file_error("'{}' has no channel {}: it has {}", file.path.string(), channel, file.channels.size());
  // Pictures have up to a hundred values per byte, those of one colour 1032: with 16384 x 16384 pixels they are read.
  constexpr std::int64_t kMaxEmpty = std::int64_t(1) << 27, kMaxRatio = 64, kMaxPerByte = 640;
  const std::int64_t count = std::int64_t(channels.size()), values = count * file.width * file.height;
  const std::int64_t stored =
      count * std::max(file.data.x1 - file.data.x0, 0) * std::max(file.data.y1 - file.data.y0, 0);
  if (values > kMaxEmpty + kMaxRatio * stored)
    return file_error("'{}' has a frame of {} x {} pixels in its header, but data for too few of them",
                      file.path.string(), file.width, file.height);
  if (double(values) > double(kMaxEmpty) + double(kMaxPerByte) * bytes_in(file.path))
    return file_error("'{}' has {} values in {} x {} pixels, too many for its {} bytes", file.path.string(), values,
                      file.width, file.height, bytes_in(file.path));
  return {};
}

}  // namespace

ReadingLimits::ReadingLimits(double seconds, double memory)
    : outer_end_s_(std::exchange(reading_end_s, std::min(reading_end_s, reading_seconds() + seconds))),
      outer_memory_(std::exchange(max_memory, std::min(max_memory, memory))) {}

ReadingLimits::ReadingLimits(const fs::path& file) : ReadingLimits(8.0 + 2e-6 * bytes_in(file), kInfinity) {}

ReadingLimits::~ReadingLimits() {
  reading_end_s = outer_end_s_;
  max_memory = outer_memory_;
}

Result<void> check_reading_time(const fs::path& file) {
  if (reading_seconds() < reading_end_s) return {};
  return file_error("'{}' is damaged or too complex: reading it takes too long for its {} bytes", file.string(),
                    bytes_in(file));
}

Result<void> check_memory(const fs::path& file, double bytes) {
  constexpr double kUnchecked = 64e6, kMaxFraction = 0.5;
  if (bytes <= kUnchecked) return {};
  const double max = std::min(max_memory, kMaxFraction * available_memory());
  if (bytes <= max) return {};
  return file_error("'{}' cannot be read: its pixels need {:.1f} GB of memory at once, and {:.1f} GB can be used",
                    file.string(), 1e-9 * bytes, 1e-9 * max);
}

std::string layer_with_part(const std::string& part, const std::string& layer) {
  if (part.empty() || layer == part || layer.starts_with(part + ".")) return layer;
  return layer.empty() ? part : part + "." + layer;
}

std::string Channel::full_name() const {
  std::string text = layer_with_part(part, layer);
  if (!name.empty()) text += (text.empty() ? "" : ".") + name;
  return text;
}

const std::string* LayeredFile::attribute(std::string_view key) const {
  for (const auto& [name, value] : attributes)
    if (name == key) return &value;
  return nullptr;
}

RowTarget::RowTarget(const LayeredFile& file, Image& whole) : outside_depth(kNan), file_(file), image_(&whole) {}

RowTarget::RowTarget(const LayeredFile& file, std::vector<std::string> names, const TakeLayerRows& take)
    : outside_depth(kNan), file_(file), names_(std::move(names)), take_(&take) {}

Result<void> RowTarget::each_block(int unit, const std::function<Result<void>(int first, int end)>& fill) {
  constexpr std::int64_t kBlockValues = std::int64_t(1) << 22;  // 16 MB: more rows per block are no faster
  const std::size_t planes = take_ ? names_.size() : image_->planes.size();
  const std::int64_t row_values = std::int64_t(file_.width) * std::int64_t(planes);
  const std::int64_t at_once = std::clamp(unit, 1, file_.height);
  if (row_values * at_once > kMaxValues)
    return file_error("'{}' has {} values in blocks of {} rows: at most {} can be read", file_.path.string(),
                      row_values * at_once, at_once, kMaxValues);
  const std::int64_t blocks = std::max<std::int64_t>(kBlockValues / (row_values * at_once), 1);
  const int rows = int(std::min<std::int64_t>(blocks * at_once, file_.height));
  if (auto fits = check_memory(file_.path, double(row_values) * rows * sizeof(float)); !fits) return fits;
  for (int first = 0; first < file_.height; first += rows) {
    const int end = std::min(first + rows, file_.height);
    if (auto in_time = check_reading_time(file_.path); !in_time) return in_time;
    if (!take_) {
      if (auto filled = fill(first, end); !filled) return filled;
      continue;
    }
    image_ = &block_;
    first_ = first;
    if (block_.height != end - first_) {
      block_ = Image(file_.width, end - first_);
      block_.names = names_;
      for (std::size_t i = 0; i < names_.size(); ++i) block_.planes.emplace_back(block_.width, block_.height);
    }
    if (auto filled = fill(first_, end); !filled) return filled;
    const double begin_s = thread_seconds();
    auto taken = (*take_)(block_, first_);
    receivers_s += thread_seconds() - begin_s;
    if (!taken) return taken;
  }
  return {};
}

Error changed_file(const LayeredFile& file) {
  return file_error("'{}' has changed since its header was read: read it again", file.path.string());
}

LayeredFile plain_header(int width, int height) {
  LayeredFile file;
  file.width = width;
  file.height = height;
  file.data = {0, 0, width, height};
  return file;
}

void add_picture_channels(LayeredFile& file, int count, ChannelType type, double max_integer) {
  const std::string_view names = count == 1 ? "Y" : count == 2 ? "YA" : count == 3 ? "RGB" : "RGBA";
  for (const char name : names) {
    Channel channel;
    channel.name = name;
    channel.type = type;
    channel.max_integer = max_integer;
    channel.is_srgb = max_integer > 0.0;
    file.channels.push_back(std::move(channel));
  }
}

Result<LayeredFile> read_header_as(const LayerFormat& format, const fs::path& file) {
  const ReadingLimits limits(file);
  try {
    Result<LayeredFile> header = format.header(file);
    if (!header) return header;
    header->path = file;
    header->format = format.name;
    for (std::size_t i = 0; i < header->channels.size(); ++i) header->channels[i].index = int(i);
    if (header->channels.empty()) return file_error("'{}' has no channels", file.string());
    constexpr std::size_t kMaxChannels = 4096;
    if (header->channels.size() > kMaxChannels)
      return file_error("'{}' has {} channels: at most {} can be read", file.string(), header->channels.size(),
                        kMaxChannels);
    return header;
  } catch (const std::bad_alloc&) {
    return no_memory_to_read(file);
  }
}

Result<Image> read_channels_as(const LayerFormat& format, const LayeredFile& file, std::span<const int> channels,
                               float outside_depth) {
  if (auto status = check_size(file.path, file.width, file.height); !status) return status.error();
  const std::int64_t values = std::int64_t(file.width) * file.height * std::int64_t(channels.size());
  if (values > kMaxValues)
    return file_error("'{}' has {} values in {} x {} pixels: at most {} can be read", file.path.string(), values,
                      file.width, file.height, kMaxValues);
  if (auto status = check_request(file, channels); !status) return status.error();
  if (auto fits = check_memory(file.path, double(values) * sizeof(float)); !fits) return fits.error();
  const ReadingLimits limits(file.path);
  try {
    Image image(file.width, file.height);
    for (const int channel : channels) {
      image.names.push_back(file.channels[std::size_t(channel)].full_name());
      image.planes.emplace_back(file.width, file.height);
    }
    if (channels.empty()) return image;
    RowTarget target(file, image);
    target.outside_depth = outside_depth;
    if (auto read = format.rows(file, channels, target); !read) return read.error();
    return image;
  } catch (const std::bad_alloc&) {
    return no_memory_to_read(file.path);
  }
}

Result<Image> read_picture_as(const LayerFormat& format, const fs::path& file) {
  const Result<LayeredFile> header = read_header_as(format, file);
  if (!header) return header.error();
  std::vector<int> channels;
  for (const Channel& channel : header->channels) channels.push_back(channel.index);
  if (channels.size() == 2) channels = {0, 0, 0, 1};  // grey with alpha
  Result<Image> image = read_channels_as(format, *header, channels, kNan);
  if (!image) return image;
  constexpr std::string_view kNames[] = {"color.r", "color.g", "color.b", "color.a"};
  for (std::size_t c = 0; c < image->names.size(); ++c) image->names[c] = channels.size() == 1 ? "grey" : kNames[c];
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const double max = header->channels[std::size_t(channels[c])].max_integer;
    Plane& plane = image->planes[c];
    for (int y = 0; y < plane.height && max > 0.0; ++y)
      for (int x = 0; x < plane.width; ++x) plane.at(x, y) /= float(max);
  }
  return image;
}

bool has_image_extension(const fs::path& file) {
  const std::string wanted = " " + lowercase_extension(file) + " ";
  return wanted.size() > 2 && std::any_of(std::begin(kFormats), std::end(kFormats), [&](const LayerFormat* format) {
           return fmt::format(" {} ", format->extensions).find(wanted) != std::string::npos;
         });
}

Result<LayeredFile> read_header(const fs::path& file) {
  const Result<const LayerFormat*> format = format_of_content(file);
  return format ? read_header_as(**format, file) : format.error();
}

Result<void> read_rows(const LayeredFile& file, std::span<const int> channels, const TakeLayerRows& take) {
  const Result<const LayerFormat*> format = format_named(file);
  if (!format) return format.error();
  if (auto status = check_request(file, channels); !status) return status;
  if (channels.empty()) return {};
  std::vector<std::string> names;
  for (const int channel : channels) names.push_back(file.channels[std::size_t(channel)].full_name());
  const ReadingLimits limits(file.path);
  try {
    RowTarget target(file, std::move(names), take);
    return (*format)->rows(file, channels, target);
  } catch (const std::bad_alloc&) {
    return no_memory_to_read(file.path);
  }
}

Result<Image> read_channels(const LayeredFile& file, std::span<const int> channels) {
  const Result<const LayerFormat*> format = format_named(file);
  return format ? read_channels_as(**format, file, channels, kNan) : format.error();
}

}  // namespace umbrage
