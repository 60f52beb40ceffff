// Writing of a copy of an OpenEXR file with more layers. The only part of a file is decoded and compressed anew with
// the new channels, with its compression, tiles and pixel types. Several parts, and deep ones, are copied without
// decoding, and the new layers get a part of their own: its name is not put before theirs, and it is of no single view.
#include <ImfChannelList.h>
#include <ImfDeepScanLineInputPart.h>
#include <ImfDeepScanLineOutputPart.h>
#include <ImfDeepTiledInputPart.h>
#include <ImfDeepTiledOutputPart.h>
#include <ImfFrameBuffer.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfTiledInputPart.h>
#include <ImfTiledOutputPart.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <set>
#include <stdexcept>

#include "io/exr_part.h"
#include "io/exr_support.h"

namespace umbrage {
namespace fs = std::filesystem;
namespace {

/// An open file as the library writes to it.
class FileStream : public Imf::OStream {
 public:
  FileStream(std::FILE* out, const std::string& name) : Imf::OStream(name.c_str()), out_(out) {}
  void write(const char* from, int count) override {
    if (std::fwrite(from, 1, std::size_t(count), out_) != std::size_t(count))
      throw std::runtime_error(std::strerror(errno));
  }
  std::uint64_t tellp() override { return std::uint64_t(::ftello(out_)); }
  void seekp(std::uint64_t position) override {
    if (::fseeko(out_, off_t(position), SEEK_SET) != 0) throw std::runtime_error(std::strerror(errno));
  }

 private:
  std::FILE* out_;
};

std::string layer_of(const std::string& channel) {
  const std::size_t dot = channel.rfind('.');
  return dot == std::string::npos ? "" : channel.substr(0, dot);
}

/// A channel of the input as it is stored, or one of the new layers.
struct MergedChannel {
  std::string name;
  Imf::Channel stored;
  const Plane* plane = nullptr;  // null: of the input
};

/// The part that receives the new layers.
struct MergedPart {
  int index = 0;
  bool is_added = false;  // a part of its own, which the input does not have
  Imath::Box2i display;
  std::vector<MergedChannel> channels;
};

constexpr const char* kPartName = "umbrage";  // of the part for new layers

/// Returns the part for new layers: the only part of a file, or the part of an earlier merge; -1 if there is none that
/// is flat.
int part_for_layers(const Imf::MultiPartInputFile& input) {
  for (int p = 0; p < input.parts(); ++p) {
    const Imf::Header& header = input.header(p);
    if (!is_deep(header) && (input.parts() == 1 || (header.hasName() && header.name() == kPartName))) return p;
  }
  return -1;
}

/// Returns the header of a part of its own for new layers.
Imf::Header own_header(const Imf::Header& first) {
  Imf::Header own(first.displayWindow(), first.displayWindow());
  own.pixelAspectRatio() = first.pixelAspectRatio();
  own.compression() = Imf::ZIP_COMPRESSION;
  own.setType(Imf::SCANLINEIMAGE);
  own.setName(kPartName);
  for (const char* shared : {"chromaticities", "timeCode"})  // equal in all parts of a file
    if (const auto found = first.find(shared); found != first.end()) own.insert(shared, found.attribute());
  return own;
}

/// Makes the headers of the copy and the description of the part with new layers. Errors: kFile.
Result<MergedPart> plan_merge(const LayeredFile& file, const Imf::MultiPartInputFile& input, const Image& layers,
                              bool half, std::vector<Imf::Header>& headers) {
  MergedPart part;
  for (int p = 0; p < input.parts(); ++p) headers.push_back(input.header(p));
  part.display = headers[0].displayWindow();
  if (part.display.max.x - part.display.min.x + 1 != layers.width ||
      part.display.max.y - part.display.min.y + 1 != layers.height)
    return file_error("'{}' has {} x {} pixels and the new layers have {} x {}: both must be equal", file.path.string(),
                      part.display.max.x - part.display.min.x + 1, part.display.max.y - part.display.min.y + 1,
                      layers.width, layers.height);
  part.index = part_for_layers(input);
  part.is_added = part.index < 0;
  if (part.is_added) {
    part.index = int(headers.size());
    for (std::size_t p = 0; p < headers.size(); ++p)
      if (!headers[p].hasName()) headers[p].setName(fmt::format("part{}", p));
    headers.push_back(own_header(headers[0]));
  }
  std::set<std::string> new_names, new_layers;
  for (const std::string& plane : layers.names) {
    const std::string name = exr_channel_of(plane);
    constexpr std::size_t kMaxName = 255;  // the format's limit
    if (name.empty() || name.size() > kMaxName || !new_names.insert(name).second)
      return file_error("'{}' cannot be a new layer: its channel '{}' is empty, too long, or there twice", plane, name);
    new_layers.insert(layer_of(name));
  }
  new_layers.erase("");
  const Imf::ChannelList old = headers[std::size_t(part.index)].channels();
  Imf::ChannelList merged;
  for (auto it = old.begin(); it != old.end(); ++it) {
    if (new_names.count(it.name()) || new_layers.count(layer_of(it.name()))) continue;
    part.channels.push_back({it.name(), it.channel(), nullptr});
    merged.insert(it.name(), it.channel());
  }
  for (std::size_t i = 0; i < layers.planes.size(); ++i) {
    const std::string name = exr_channel_of(layers.names[i]);
    const bool is_fine = last_word(layers.names[i]) == "depth" || last_word(layers.names[i]).ends_with("id");
    const Imf::Channel stored(half && !is_fine ? Imf::HALF : Imf::FLOAT);
    part.channels.push_back({name, stored, &layers.planes[i]});
    merged.insert(name, stored);
  }
  headers[std::size_t(part.index)].channels() = merged;
  return part;
}

/// Memory for a rectangle of all channels, in the types of the file.
struct Rectangle {
  Imath::Box2i window;
  std::vector<std::vector<char>> values;
  Imf::FrameBuffer old_pixels, pixels;  // of the input's channels; of all

  Rectangle(const MergedPart& part, const Imath::Box2i& window_) : window(window_) {
    const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
    for (const MergedChannel& channel : part.channels) {
      const int xs = channel.stored.xSampling, ys = channel.stored.ySampling;
      const std::size_t size = channel.stored.type == Imf::HALF ? 2 : 4, columns = std::size_t((width - 1) / xs + 1);
      values.emplace_back(columns * std::size_t((height - 1) / ys + 1) * size);
      const Imf::Slice slice = Imf::Slice::Make(channel.stored.type, values.back().data(), window.min, width, height,
                                                size, columns * size, xs, ys);
      pixels.insert(channel.name, slice);
      if (!channel.plane) old_pixels.insert(channel.name, slice);
    }
  }

  /// Returns whether any channel is of the input.
  bool keeps_any() const { return old_pixels.begin() != old_pixels.end(); }

  /// Sets the pixels of new channels; pixel (x, y) of the rectangle is `level` (x, y) of the data window. Those outside
  /// the display window are 0.
  template <class AtLevel0>
  void fill_new(const MergedPart& part, AtLevel0&& at_level_0) {
    for (std::size_t c = 0; c < part.channels.size(); ++c) {
      const Plane* plane = part.channels[c].plane;
      if (!plane) continue;
      std::size_t at = 0;
      for (int y = window.min.y; y <= window.max.y; ++y)
        for (int x = window.min.x; x <= window.max.x; ++x, ++at) {
          const Imath::V2i pixel = at_level_0(x, y) - part.display.min;
          const bool inside = pixel.x >= 0 && pixel.y >= 0 && pixel.x < plane->width && pixel.y < plane->height;
          const float value = inside ? plane->at(pixel.x, pixel.y) : 0.0f;
          if (part.channels[c].stored.type == Imf::HALF) {
            const Imath::half rounded(value);
            std::memcpy(values[c].data() + 2 * at, &rounded, sizeof rounded);
          } else {
            std::memcpy(values[c].data() + 4 * at, &value, sizeof value);
          }
        }
    }
  }
};

/// Writes the scanlines of the part. Blocks come in the order of the file.
void merge_scanlines(const MergedPart& part, Imf::MultiPartInputFile& input, Imf::MultiPartOutputFile& output) {
  Imf::OutputPart writer(output, part.index);
  const Imath::Box2i data = writer.header().dataWindow();
  const bool is_upward = writer.header().lineOrder() == Imf::DECREASING_Y;
  constexpr int kMaxRows = 256;  // a multiple of the rows per block of every compression
  const int height = data.max.y - data.min.y + 1, blocks = (height - 1) / kMaxRows + 1;
  for (int i = 0; i < blocks; ++i) {
    const int first = data.min.y + (is_upward ? blocks - 1 - i : i) * kMaxRows;
    Rectangle rows(part, {{data.min.x, first}, {data.max.x, std::min(first + kMaxRows - 1, data.max.y)}});
    if (rows.keeps_any()) {
      Imf::InputPart reader(input, part.index);
      reader.setFrameBuffer(rows.old_pixels);
      reader.readPixels(rows.window.min.y, rows.window.max.y);
    }
    rows.fill_new(part, [](int x, int y) { return Imath::V2i(x, y); });
    writer.setFrameBuffer(rows.pixels);
    writer.writePixels(rows.window.max.y - rows.window.min.y + 1);
  }
}

/// Writes the tiles of one level of the part. A pixel of a smaller level has the value of the pixel of the first level
/// at its centre, so that numbers of objects stay what they are.
void merge_level(const MergedPart& part, Imf::TiledInputPart& reader, Imf::TiledOutputPart& writer, int lx, int ly) {
  const Imath::Box2i data = writer.header().dataWindow();
  const auto at_level_0 = [&](int x, int y) {
    const auto along = [](int at, int from, std::int64_t size, std::int64_t level_size) {
      return from + int(((2 * std::int64_t(at - from) + 1) * size) / (2 * level_size));
    };
    return Imath::V2i(along(x, data.min.x, data.max.x - data.min.x + 1, writer.levelWidth(lx)),
                      along(y, data.min.y, data.max.y - data.min.y + 1, writer.levelHeight(ly)));
  };
  const bool is_upward = writer.header().lineOrder() == Imf::DECREASING_Y;
  const int rows = writer.numYTiles(ly);
  for (int i = 0; i < rows; ++i)
    for (int dx = 0; dx < writer.numXTiles(lx); ++dx) {
      const int dy = is_upward ? rows - 1 - i : i;
      Rectangle tile(part, writer.dataWindowForTile(dx, dy, lx, ly));
      if (tile.keeps_any()) {
        reader.setFrameBuffer(tile.old_pixels);
        reader.readTile(dx, dy, lx, ly);
      }
      tile.fill_new(part, at_level_0);
      writer.setFrameBuffer(tile.pixels);
      writer.writeTile(dx, dy, lx, ly);
    }
}

void merge_tiles(const MergedPart& part, Imf::MultiPartInputFile& input, Imf::MultiPartOutputFile& output) {
  Imf::TiledInputPart reader(input, part.index);
  Imf::TiledOutputPart writer(output, part.index);
  for (int ly = 0; ly < writer.numYLevels(); ++ly)
    for (int lx = 0; lx < writer.numXLevels(); ++lx)
      if (writer.isValidLevel(lx, ly)) merge_level(part, reader, writer, lx, ly);
}

template <class In, class Out>
void copy_part(Imf::MultiPartInputFile& input, Imf::MultiPartOutputFile& output, int index) {
  In from(input, index);
  Out to(output, index);
  to.copyPixels(from);
}

void write_parts(const MergedPart& part, Imf::MultiPartInputFile& input, Imf::MultiPartOutputFile& output) {
  for (int p = 0; p < output.parts(); ++p) {
    const Imf::Header& header = output.header(p);
    const bool is_tiled = header.hasTileDescription();
    if (p == part.index)
      is_tiled ? merge_tiles(part, input, output) : merge_scanlines(part, input, output);
    else if (is_deep(header))
      is_tiled ? copy_part<Imf::DeepTiledInputPart, Imf::DeepTiledOutputPart>(input, output, p)
               : copy_part<Imf::DeepScanLineInputPart, Imf::DeepScanLineOutputPart>(input, output, p);
    else
      is_tiled ? copy_part<Imf::TiledInputPart, Imf::TiledOutputPart>(input, output, p)
               : copy_part<Imf::InputPart, Imf::OutputPart>(input, output, p);
  }
}

}  // namespace

Result<void> write_merged(const LayeredFile& file, const Image& layers, bool half, const fs::path& to) {
  if (file.format != kExrLayers.name)
    return file_error("'{}' is a {} file: layers can only be added to an EXR file", file.path.string(), file.format);
  return catching_exr(file.path, [&]() -> Result<void> {
    const auto input = open_exr(file.path);
    if (!input) return input.error();
    std::vector<Imf::Header> headers;
    const Result<MergedPart> part = plan_merge(file, **input, layers, half, headers);
    if (!part) return part.error();
    return write_atomically(to, [&](std::FILE* out) -> Result<void> {
      // The cause of a failed write is in errno, so an exception here is about the input.
      return catching_exr(file.path, [&]() -> Result<void> {
        FileStream stream(out, to.string());
        Imf::MultiPartOutputFile output(stream, headers.data(), int(headers.size()), false, 0);
        write_parts(*part, **input, output);
        return {};
      });
    });
  });
}

}  // namespace umbrage
