// Flattening of deep OpenEXR parts. Based on "Interpreting OpenEXR Deep Pixels": colours are multiplied by alpha, and
// samples are composited front to back by their Z with the over operator. Samples need not be sorted in the file.
// Differs: volume samples (Z to ZBack) that overlap are composited as points at Z, not split.
#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineInputPart.h>
#include <ImfDeepTiledInputPart.h>
#include <ImfPartType.h>

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "io/exr_part.h"
#include "io/exr_support.h"

namespace umbrage {
namespace {

/// The samples of a rectangle of pixels.
struct DeepBlock {
  Imath::Box2i window;
  std::vector<std::string> names;
  std::vector<std::uint32_t> counts;          // samples per pixel
  std::vector<std::size_t> starts;            // position of a pixel's first sample
  std::vector<std::vector<float>> samples;    // per channel
  std::vector<std::vector<float*>> pointers;  // per channel and pixel, for the library

  int width() const { return window.max.x - window.min.x + 1; }
  std::size_t pixels() const { return std::size_t(width()) * std::size_t(window.max.y - window.min.y + 1); }
};

/// How requested channels are made from the samples.
struct Flattening {
  int alpha = -1, depth = -1;  // channels of a block; -1: none
  std::vector<bool> is_composited;
};

/// Returns whether samples of a channel are composited: it is a colour or alpha, not a depth, number, or vector.
bool is_composited(const ExrChannel& channel, const Imf::ChannelList& channels) {
  const std::string_view word = last_word(channel.name);
  if (channel.is_depth || channel.type == Imf::UINT || word == "id" || word.ends_with("_id")) return false;
  if (word != "X" && word != "Y" && word != "Z") return true;
  const std::string layer = channel.name.substr(0, channel.name.size() - 1);
  return word == "Y" && !channels.findChannel(layer + 'X');
}

/// Makes the frame buffer of a block whose window and names are set.
Imf::DeepFrameBuffer frame_buffer(DeepBlock& block) {
  const auto at = [&](std::size_t size) {
    return (std::ptrdiff_t(block.window.min.x) + std::ptrdiff_t(block.window.min.y) * block.width()) *
           std::ptrdiff_t(size);
  };
  Imf::DeepFrameBuffer buffer;
  block.counts.assign(block.pixels(), 0);
  block.pointers.assign(block.names.size(), std::vector<float*>(block.pixels(), nullptr));
  buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT,
                                           reinterpret_cast<char*>(block.counts.data()) - at(sizeof(std::uint32_t)),
                                           sizeof(std::uint32_t), sizeof(std::uint32_t) * std::size_t(block.width())));
  for (std::size_t c = 0; c < block.names.size(); ++c)
    buffer.insert(block.names[c],
                  Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(block.pointers[c].data()) - at(sizeof(float*)),
                                 sizeof(float*), sizeof(float*) * std::size_t(block.width()), sizeof(float)));
  return buffer;
}

/// Makes room for the samples whose counts were read. Errors: kFile for more than a file can hold.
Result<void> make_room(const LayeredFile& file, DeepBlock& block) {
  constexpr std::size_t kMaxSamples = std::size_t(1) << 28;  // 1 GB per channel, for some rows
  block.starts.resize(block.pixels());
  std::size_t total = 0;
  for (std::size_t i = 0; i < block.pixels(); ++i) {
    block.starts[i] = total;
    total += block.counts[i];
    if (total * block.names.size() > kMaxSamples)
      return file_error("'{}' claims more than {} deep values from row {}: its sample counts are damaged",
                        file.path.string(), kMaxSamples, block.window.min.y);
  }
  const double bytes = double(total) * double(block.names.size()) * sizeof(float);
  if (auto fits = check_memory(file.path, bytes); !fits) return fits;
  block.samples.assign(block.names.size(), std::vector<float>(total));
  for (std::size_t c = 0; c < block.names.size(); ++c)
    for (std::size_t i = 0; i < block.pixels(); ++i) block.pointers[c][i] = block.samples[c].data() + block.starts[i];
  return {};
}

/// Writes the flattened pixels of rows [first, end) of the display window.
void flatten(const DeepBlock& block, const ExrPart& part, const Flattening& how, int first, int end,
             RowTarget& target) {
  std::vector<std::uint32_t> order;
  const int x0 = std::max(part.display.min.x, block.window.min.x),
            x1 = std::min(part.display.max.x, block.window.max.x);
  const int y0 = std::max(first + part.display.min.y, block.window.min.y);
  const int y1 = std::min(end - 1 + part.display.min.y, block.window.max.y);
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const std::size_t pixel =
          std::size_t(y - block.window.min.y) * std::size_t(block.width()) + std::size_t(x - block.window.min.x);
      const std::size_t start = block.starts[pixel];
      order.resize(block.counts[pixel]);
      std::iota(order.begin(), order.end(), 0u);
      if (how.depth >= 0) {
        const float* z = block.samples[std::size_t(how.depth)].data() + start;
        const auto is_nearer = [&](std::uint32_t a, std::uint32_t b) {
          return z[a] < z[b] || (z[a] == z[a] && z[b] != z[b]);
        };
        std::stable_sort(order.begin(), order.end(), is_nearer);
      }
      const auto alpha = [&](std::uint32_t sample) {
        const float a = how.alpha < 0 ? 1.0f : block.samples[std::size_t(how.alpha)][start + sample];
        return a > 0.0f ? std::min(a, 1.0f) : 0.0f;  // NaN is 0
      };
      const auto front = std::find_if(order.begin(), order.end(), [&](std::uint32_t s) { return alpha(s) > 0.0f; });
      for (std::size_t c = 0; c < part.channels.size(); ++c) {
        const float* samples = block.samples[c].data() + start;
        float value = 0.0f, visibility = 1.0f;
        if (!how.is_composited[c]) {
          value = front != order.end() ? samples[*front] : part.channels[c].is_depth ? target.outside_depth : 0.0f;
        } else {
          for (const std::uint32_t sample : order) {
            value += visibility * samples[sample];
            visibility *= 1.0f - alpha(sample);
            if (visibility <= 0.0f) break;
          }
        }
        target.row(part.target[c], y - part.display.min.y)[x - part.display.min.x] = value;
      }
    }
}

}  // namespace

Result<void> read_deep_rows(const LayeredFile& file, Imf::MultiPartInputFile& input, const ExrPart& part, int first,
                            int end, RowTarget& target) {
  const Imf::Header& header = input.header(part.index);
  DeepBlock block;
  Flattening how;
  for (const ExrChannel& channel : part.channels) {
    how.is_composited.push_back(is_composited(channel, header.channels()));
    block.names.push_back(channel.name);
  }
  const auto find = [&](const char* name) {
    if (!header.channels().findChannel(name)) return -1;
    const auto at = std::find(block.names.begin(), block.names.end(), name);
    const int index = int(at - block.names.begin());
    if (at == block.names.end()) block.names.emplace_back(name);
    return index;
  };
  how.alpha = find("A");
  how.depth = find("Z");
  const int y0 = std::max(first + part.display.min.y, part.data.min.y);
  const int y1 = std::min(end - 1 + part.display.min.y, part.data.max.y);
  block.window = part.data;
  const auto within_limits = [&]() -> Result<void> {
    if (auto in_time = check_reading_time(file.path); !in_time) return in_time;
    const std::size_t per_pixel = sizeof(std::uint32_t) + block.names.size() * sizeof(float*);
    return check_memory(file.path, double(block.pixels()) * double(per_pixel));
  };
  if (header.type() == Imf::DEEPTILE) {
    Imf::DeepTiledInputPart reader(input, part.index);
    const int tile_rows = int(reader.tileYSize()), last_column = reader.numXTiles() - 1;
    for (int tile = (y0 - part.data.min.y) / tile_rows; y0 <= y1 && tile <= (y1 - part.data.min.y) / tile_rows;
         ++tile) {
      const Imath::Box2i rows = reader.dataWindowForTile(0, tile);
      block.window.min.y = rows.min.y;
      block.window.max.y = rows.max.y;
      if (auto fine = within_limits(); !fine) return fine;
      reader.setFrameBuffer(frame_buffer(block));
      reader.readPixelSampleCounts(0, last_column, tile, tile);
      if (auto room = make_room(file, block); !room) return room;
      reader.readTiles(0, last_column, tile, tile);
      flatten(block, part, how, first, end, target);
    }
    return {};
  }
  Imf::DeepScanLineInputPart reader(input, part.index);
  constexpr int kRows = 16;  // few enough that the samples of a block fit in the cache
  for (int y = y0; y <= y1; y += kRows) {
    block.window.min.y = y;
    block.window.max.y = std::min(y + kRows - 1, y1);
    if (auto fine = within_limits(); !fine) return fine;
    reader.setFrameBuffer(frame_buffer(block));
    reader.readPixelSampleCounts(block.window.min.y, block.window.max.y);
    if (auto room = make_room(file, block); !room) return room;
    reader.readPixels(block.window.min.y, block.window.max.y);
    flatten(block, part, how, first, end, target);
  }
  return {};
}

}  // namespace umbrage
