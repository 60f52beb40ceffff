// The layers of OpenEXR files: every channel of all parts, scanlines or tiles, flat or deep, in any compression.
// Based on "Technical Introduction to OpenEXR" and on ImfMultiView.h (names of views).
//
// Names. A channel's layer is the name before its last dot. `view` is that of its part, or, in a single part with
// several views, the part of its name that says so: R is in the default view, left.R and depth.left.Z in the view left.
// The layer keeps the view's name.
//
// Windows. Parts may have data windows of different position and size. Each is placed in the common display window.
//
// Values. Subsampled channels are repeated. A part with luminance and chroma (Y, RY, BY) has R, G and B instead.
#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfInputPart.h>
#include <ImfIntAttribute.h>
#include <ImfMultiView.h>
#include <ImfPartType.h>
#include <ImfRationalAttribute.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfStringVectorAttribute.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "core/lists.h"
#include "io/exr_part.h"
#include "io/exr_support.h"

namespace umbrage {
namespace fs = std::filesystem;
namespace {

constexpr int kReadThreads = 2;

/// Returns whether a channel is depth: its name is depth, or Z and its layer has no channel X.
bool is_depth(std::string_view channel, const Imf::ChannelList& channels) {
  if (last_word(channel) == "depth") return true;
  if (last_word(channel) != "Z" && last_word(channel) != "ZBack") return false;
  std::string beside(channel.substr(0, channel.size() - last_word(channel).size()));
  return !channels.findChannel(beside + 'X');
}

/// Returns whether a part has luminance and chroma. The library converts those of the first part only.
bool has_luminance(int part, const Imf::Header& header) {
  const Imf::ChannelList& channels = header.channels();
  return part == 0 && !is_deep(header) && channels.findChannel("Y") && channels.findChannel("RY") &&
         channels.findChannel("BY") && !channels.findChannel("R") && !channels.findChannel("G") &&
         !channels.findChannel("B");
}

ChannelType type_of(Imf::PixelType type) {
  return type == Imf::HALF ? ChannelType::kHalf : type == Imf::UINT ? ChannelType::kUint32 : ChannelType::kFloat;
}

/// Adds the texts and numbers of a header whose names are not in `known`, without those that describe the file's
/// structure.
void add_attributes(const Imf::Header& header, LayeredFile& file, std::set<std::string>& known) {
  constexpr std::string_view kStructure[] = {"chunkCount", "maxSamplesPerPixel", "name", "type", "version", "view"};
  for (auto it = header.begin(); it != header.end(); ++it) {
    const std::string name = printable(it.name());
    if (known.contains(name) || contains(kStructure, name)) continue;
    const Imf::Attribute& any = it.attribute();
    std::string text;
    if (const auto* words = dynamic_cast<const Imf::StringAttribute*>(&any))
      text = printable(words->value());
    else if (const auto* list = dynamic_cast<const Imf::StringVectorAttribute*>(&any))
      for (const std::string& word : list->value()) text += (text.empty() ? "" : ",") + printable(word);
    else if (const auto* whole = dynamic_cast<const Imf::IntAttribute*>(&any))
      text = fmt::format("{}", whole->value());
    else if (const auto* real = dynamic_cast<const Imf::FloatAttribute*>(&any))
      text = fmt::format("{}", real->value());
    else if (const auto* exact = dynamic_cast<const Imf::DoubleAttribute*>(&any))
      text = fmt::format("{}", exact->value());
    else if (const auto* ratio = dynamic_cast<const Imf::RationalAttribute*>(&any))
      text = fmt::format("{}", double(ratio->value()));
    else
      continue;
    known.insert(name);
    file.attributes.emplace_back(name, text);
  }
}

std::string view_of(const Imf::Header& header, const std::string& channel) {
  if (header.hasView()) return printable(header.view());
  if (!Imf::hasMultiView(header)) return {};
  return printable(Imf::viewFromChannelName(channel, Imf::multiView(header)));
}

Result<LayeredFile> read_exr_header(const fs::path& file) {
  return catching_exr(file, [&]() -> Result<LayeredFile> {
    const auto opened = open_exr(file);
    if (!opened) return opened.error();
    Imf::MultiPartInputFile& input = **opened;
    const Imath::Box2i display = input.header(0).displayWindow();  // common to all parts
    LayeredFile header = plain_header(display.max.x - display.min.x + 1, display.max.y - display.min.y + 1);
    header.data = {header.width, header.height, 0, 0};
    std::set<std::string> known;
    for (int part = 0; part < input.parts(); ++part) {
      if (auto in_time = check_reading_time(file); !in_time) return in_time.error();
      const Imath::Box2i data = input.header(part).dataWindow();
      header.data.x0 = std::min(header.data.x0, std::max(data.min.x - display.min.x, 0));
      header.data.y0 = std::min(header.data.y0, std::max(data.min.y - display.min.y, 0));
      header.data.x1 = std::max(header.data.x1, std::min(data.max.x - display.min.x + 1, header.width));
      header.data.y1 = std::max(header.data.y1, std::min(data.max.y - display.min.y + 1, header.height));
      header.is_deep = header.is_deep || is_deep(input.header(part));
      add_attributes(input.header(part), header, known);
      if (Imf::hasEnvmap(input.header(part))) header.attributes.emplace_back("envmap", "");
    }
    if (header.data.x1 <= header.data.x0 || header.data.y1 <= header.data.y0) header.data = {};
    for (const ExrChannel& channel : exr_channels_of(input)) {
      if (auto in_time = check_reading_time(file); !in_time) return in_time.error();
      const Imf::Header& own = input.header(channel.part);
      Channel listed;
      if (input.parts() > 1 && own.hasName()) listed.part = printable(own.name());
      listed.view = view_of(own, channel.name);
      const std::size_t dot = channel.name.rfind('.');
      const bool has_layer = dot != std::string::npos && dot > 0;
      if (has_layer) listed.layer = printable(channel.name.substr(0, dot));
      listed.name = printable(has_layer ? channel.name.substr(dot + 1) : channel.name);
      listed.type = type_of(channel.type);
      header.channels.push_back(std::move(listed));
    }
    const float aspect = input.header(0).pixelAspectRatio();
    if (std::isfinite(aspect) && aspect > 0.0f) header.pixel_aspect = aspect;
    header.camera = camera_of(input.header(0));
    return header;
  });
}

/// Where a channel's values go: into the target's rows, or into a scratch plane of the width of the data window if they
/// must be cut or repeated.
struct Placement {
  int target = 0;
  int x_sampling = 1, y_sampling = 1;
  std::vector<float> scratch = {};
};

/// Rows [first, last] of a data window that one thread decodes. Those before `wanted`, which share stored rows of
/// subsampled channels with it, are not used.
struct Span {
  int first, last, wanted;
};

/// Returns the slice for a channel and rows of the data window. Values go directly to the target if the data window is
/// within the display window and the channel is not subsampled.
Imf::Slice slice_of(const ExrPart& part, const Span& rows, Placement& to, RowTarget& target) {
  const int width = part.data.max.x - part.data.min.x + 1;
  if (to.x_sampling == 1 && to.y_sampling == 1 && rows.first == rows.wanted && part.data.min.x >= part.display.min.x &&
      part.data.max.x <= part.display.max.x) {
    float* start = target.row(to.target, rows.first - part.display.min.y) + (part.data.min.x - part.display.min.x);
    return Imf::Slice::Make(Imf::FLOAT, start, {part.data.min.x, rows.first}, width, rows.last - rows.first + 1,
                            sizeof(float), std::size_t(target.stride()) * sizeof(float));
  }
  const std::size_t stored_width = std::size_t((width - 1) / to.x_sampling + 1);
  to.scratch.resize(stored_width * std::size_t((rows.last - rows.first) / to.y_sampling + 1));
  return Imf::Slice::Make(Imf::FLOAT, to.scratch.data(), {part.data.min.x, rows.first}, width,
                          rows.last - rows.first + 1, sizeof(float), stored_width * sizeof(float), to.x_sampling,
                          to.y_sampling);
}

/// Copies the values of a scratch plane into the target.
void place(const ExrPart& part, const Span& rows, const Placement& from, RowTarget& target) {
  const int width = part.data.max.x - part.data.min.x + 1;
  const std::size_t stored_width = std::size_t((width - 1) / from.x_sampling + 1);
  const int x0 = std::max(part.data.min.x, part.display.min.x), x1 = std::min(part.data.max.x, part.display.max.x);
  for (int y = rows.wanted; y <= rows.last; ++y) {
    const float* stored = from.scratch.data() + std::size_t((y - rows.first) / from.y_sampling) * stored_width;
    float* out = target.row(from.target, y - part.display.min.y);
    for (int x = x0; x <= x1; ++x) out[x - part.display.min.x] = stored[(x - part.data.min.x) / from.x_sampling];
  }
}

/// Reads channels of rows of a part that read_exr_blocks can read.
void read_plain(Imf::MultiPartInputFile& input, const ExrPart& part, const Span& rows, RowTarget& target) {
  const int x0 = std::max(part.data.min.x, part.display.min.x), x1 = std::min(part.data.max.x, part.display.max.x);
  if (x0 > x1) return;
  std::vector<ExrRows> to;
  for (std::size_t c = 0; c < part.channels.size(); ++c)
    to.push_back({part.channels[c].name,
                  target.row(part.target[c], rows.first - part.display.min.y) + (x0 - part.display.min.x),
                  target.stride()});
  Imf::InputPart reader(input, part.index);
  read_exr_blocks(reader, rows.first, rows.last, x0, x1, to);
}

/// Reads stored channels of rows that one thread decodes.
void read_stored(Imf::MultiPartInputFile& input, const ExrPart& part, const Span& rows, RowTarget& target) {
  if (has_plain_blocks(input.header(part.index))) return read_plain(input, part, rows, target);
  Imf::FrameBuffer pixels;
  std::vector<Placement> placements;
  placements.reserve(part.channels.size());
  for (std::size_t c = 0; c < part.channels.size(); ++c) {
    const ExrChannel& channel = part.channels[c];
    if (channel.source != ExrSource::kStored) continue;
    placements.push_back({part.target[c], channel.x_sampling, channel.y_sampling});
    pixels.insert(channel.name, slice_of(part, rows, placements.back(), target));
  }
  if (placements.empty()) return;
  Imf::InputPart reader(input, part.index);
  reader.setFrameBuffer(pixels);
  reader.readPixels(rows.first, rows.last);
  for (const Placement& from : placements)
    if (!from.scratch.empty()) place(part, rows, from, target);
}

/// Reads R, G and B of rows of a part with luminance and chroma. The library converts them, as half.
void read_luminance(const fs::path& file, const ExrPart& part, const Span& rows, RowTarget& target) {
  const bool needed = std::any_of(part.channels.begin(), part.channels.end(),
                                  [](const ExrChannel& c) { return c.source == ExrSource::kLuminance; });
  if (!needed) return;
  const int width = part.data.max.x - part.data.min.x + 1;
  std::vector<Imf::Rgba> pixels(std::size_t(width) * std::size_t(rows.last - rows.first + 1));
  Imf::RgbaInputFile input(file.c_str(), 0);
  input.setFrameBuffer(pixels.data() - part.data.min.x - std::ptrdiff_t(rows.first) * width, 1, std::size_t(width));
  input.readPixels(rows.first, rows.last);
  const int x0 = std::max(part.data.min.x, part.display.min.x), x1 = std::min(part.data.max.x, part.display.max.x);
  for (std::size_t c = 0; c < part.channels.size(); ++c) {
    if (part.channels[c].source != ExrSource::kLuminance) continue;
    const char letter = part.channels[c].name[0];
    const auto value = letter == 'R' ? &Imf::Rgba::r : letter == 'G' ? &Imf::Rgba::g : &Imf::Rgba::b;
    for (int y = rows.first; y <= rows.last; ++y)
      for (int x = x0; x <= x1; ++x)
        target.row(part.target[c], y - part.display.min.y)[x - part.display.min.x] =
            pixels[std::size_t(y - rows.first) * std::size_t(width) + std::size_t(x - part.data.min.x)].*value;
  }
}

/// Returns the number of rows from which a block may begin anew: no stored row and no block of the file is split.
int unit_of(const ExrPart& part, const Imf::Header& header) {
  std::int64_t unit = rows_per_block(header);
  for (const ExrChannel& channel : part.channels)
    unit = std::min(std::lcm(unit, std::int64_t(channel.y_sampling)), std::int64_t(kMaxFileSide));
  return int(unit);
}

/// Reads a flat part's rows [first, end) of the display window with several threads, each with its own file object: the
/// library decodes one block of a file at a time.
void read_flat_rows(const LayeredFile& file, const ExrPart& part, int unit,
                    std::vector<std::unique_ptr<Imf::MultiPartInputFile>>& inputs, int first, int end,
                    RowTarget& target) {
  const int wanted = std::max(first + part.display.min.y, part.data.min.y);
  const Span rows{wanted, std::min(end - 1 + part.display.min.y, part.data.max.y), wanted};
  if (rows.first > rows.last) return;
  // Units begin at the data window. The first may begin above the display window.
  const auto units_before = [&](int y) { return (y - part.data.min.y) / unit; };
  const int first_unit = units_before(rows.first), units = units_before(rows.last) - first_unit + 1;
  const auto first_row_of = [&](int thread) {
    return part.data.min.y + (first_unit + int(std::int64_t(units) * thread / kReadThreads)) * unit;
  };
  const bool is_subsampled = std::any_of(part.channels.begin(), part.channels.end(), [](const ExrChannel& channel) {
    return channel.x_sampling > 1 || channel.y_sampling > 1;
  });
  tbb::task_arena arena(exr_thread_count(kReadThreads));
  arena.execute([&] {
    tbb::parallel_for(0, kReadThreads, [&](int thread) {
      Span own{first_row_of(thread), thread + 1 < kReadThreads ? first_row_of(thread + 1) - 1 : rows.last, 0};
      own.wanted = std::max(own.first, rows.first);
      if (!is_subsampled) own.first = own.wanted;
      if (own.wanted > own.last) return;
      auto& input = inputs[std::size_t(thread)];
      if (!input) input = std::make_unique<Imf::MultiPartInputFile>(file.path.c_str(), 0, kNoRepair);
      read_stored(*input, part, own, target);
    });
  });
  read_luminance(file.path, part, rows, target);
}

/// Fills the pixels of a part's channels in rows [first, end) that its data window does not cover.
void fill_outside(const ExrPart& part, int first, int end, int width, RowTarget& target) {
  const int y0 = part.data.min.y - part.display.min.y, y1 = part.data.max.y - part.display.min.y;
  const int x0 = std::clamp(part.data.min.x - part.display.min.x, 0, width);
  const int x1 = std::clamp(part.data.max.x - part.display.min.x + 1, x0, width);
  for (std::size_t c = 0; c < part.channels.size(); ++c) {
    const float value = part.channels[c].is_depth ? target.outside_depth : 0.0f;
    for (int y = first; y < end; ++y) {
      float* row = target.row(part.target[c], y);
      const bool has_data = y >= y0 && y <= y1;
      std::fill(row, row + (has_data ? x0 : width), value);
      if (has_data) std::fill(row + x1, row + width, value);
    }
  }
}

Result<void> read_exr_rows(const LayeredFile& file, std::span<const int> channels, RowTarget& target) {
  return catching_exr(file.path, [&]() -> Result<void> {
    auto opened = open_exr(file.path);
    if (!opened) return opened.error();
    std::vector<std::unique_ptr<Imf::MultiPartInputFile>> inputs(kReadThreads);
    inputs[0] = std::move(*opened);
    Imf::MultiPartInputFile& input = *inputs[0];
    const Imath::Box2i display = input.header(0).displayWindow();
    const std::vector<ExrChannel> listed = exr_channels_of(input);
    if (display.max.x - display.min.x + 1 != file.width || display.max.y - display.min.y + 1 != file.height ||
        listed.size() != file.channels.size())
      return changed_file(file);
    std::vector<ExrPart> parts;
    // A channel that is requested twice is decoded once: a frame buffer has one slice per name.
    std::vector<std::pair<int, int>> copies;  // from, to
    for (std::size_t i = 0; i < channels.size(); ++i) {
      const auto before = std::find(channels.begin(), channels.begin() + std::ptrdiff_t(i), channels[i]);
      if (before != channels.begin() + std::ptrdiff_t(i)) {
        copies.emplace_back(int(before - channels.begin()), int(i));
        continue;
      }
      const ExrChannel& channel = listed[std::size_t(channels[i])];
      auto part = std::find_if(parts.begin(), parts.end(), [&](const ExrPart& p) { return p.index == channel.part; });
      if (part == parts.end())
        part = parts.insert(part, {channel.part, input.header(channel.part).dataWindow(), display, {}, {}});
      part->channels.push_back(channel);
      part->target.push_back(int(i));
    }
    std::int64_t unit = 1;
    for (const ExrPart& part : parts) {
      // The library decodes all channels of a block, which may be far wider than the display window.
      const Imf::ChannelList& stored = input.header(part.index).channels();
      double values = 0.0;
      for (auto it = stored.begin(); it != stored.end(); ++it)
        values += (double(part.data.max.x) - part.data.min.x + 1.0) * unit_of(part, input.header(part.index));
      if (auto fits = check_memory(file.path, values * sizeof(float)); !fits) return fits;
      unit =
          std::min(std::lcm(unit, std::int64_t(unit_of(part, input.header(part.index)))), std::int64_t(kMaxFileSide));
    }
    return target.each_block(int(unit), [&](int first, int end) -> Result<void> {
      for (const ExrPart& part : parts) {
        if (auto in_time = check_reading_time(file.path); !in_time) return in_time;
        fill_outside(part, first, end, file.width, target);
        if (is_deep(input.header(part.index))) {
          if (auto read = read_deep_rows(file, input, part, first, end, target); !read) return read;
        } else {
          read_flat_rows(file, part, unit_of(part, input.header(part.index)), inputs, first, end, target);
        }
      }
      for (const auto& [from, to] : copies)
        for (int y = first; y < end; ++y) std::copy_n(target.row(from, y), file.width, target.row(to, y));
      return {};
    });
  });
}

}  // namespace

bool is_deep(const Imf::Header& header) {
  return header.hasType() && (header.type() == Imf::DEEPSCANLINE || header.type() == Imf::DEEPTILE);
}

int rows_per_block(const Imf::Header& header) {
  if (header.hasTileDescription()) return int(std::min<std::int64_t>(header.tileDescription().ySize, kMaxFileSide));
  switch (header.compression()) {
    case Imf::ZIP_COMPRESSION:
    case Imf::PXR24_COMPRESSION:
      return 16;
    case Imf::PIZ_COMPRESSION:
    case Imf::B44_COMPRESSION:
    case Imf::B44A_COMPRESSION:
    case Imf::DWAA_COMPRESSION:
      return 32;
    case Imf::DWAB_COMPRESSION:
      return 256;
    default:
      return 1;
  }
}

std::vector<ExrChannel> exr_channels_of(const Imf::MultiPartInputFile& input) {
  std::vector<ExrChannel> all;
  for (int part = 0; part < input.parts(); ++part) {
    const Imf::Header& header = input.header(part);
    const bool luminance = has_luminance(part, header);
    if (luminance)
      for (const char* name : {"R", "G", "B"})
        all.push_back({name, part, header.channels().findChannel("Y")->type, 1, 1, ExrSource::kLuminance, false});
    for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
      const std::string_view name = it.name();
      if (luminance && (name == "Y" || name == "RY" || name == "BY")) continue;
      const Imf::Channel& channel = it.channel();
      all.push_back({it.name(), part, channel.type, channel.xSampling, channel.ySampling, ExrSource::kStored,
                     is_depth(name, header.channels())});
    }
  }
  return all;
}

const LayerFormat kExrLayers = {"EXR", "exr", is_exr, read_exr_header, read_exr_rows};

}  // namespace umbrage
