// OpenEXR images through the OpenEXR 3.1 library, float or half. Based on "Technical Introduction to OpenEXR" (channel
// and layer names, windows, parts) and on ImfStandardAttributes.h (meaning of the camera attributes).
//
// Names. Plane <-> channel: color.r <-> R (the same for g, b, a), depth <-> depth.Z and layer1.depth <->
// layer1.depth.Z, normal.x <-> normal.X (the same for endings r, g, b, a, x, y, z); other names are unchanged. In a
// file of several parts the channels of the first part and names with a dot are unchanged; other names get the name of
// their part as a prefix: Z of the part Depth is Depth.z.
//
// Windows. An image has the size of the display window. Outside the data window, planes are 0 and depth is +infinity;
// pixels outside the display window are dropped.
//
// Values. Integer channels become floats, exact up to 2^24. For deep, subsampled and luminance-chroma channels see
// exr_layers.cpp.
//
// Compression is chosen for speed at a typical size. Processor time of one core of an AMD EPYC (Zen 4), OpenEXR 3.1.5,
// 1024 x 1024, 12 planes (shaded colour, depth, normal, albedo, noisy occlusion, id), median of 5:
//                  float                            half
//   ZIP, level 1   write 394 ms,  read 214 ms,  15.6 MB     193 ms,   88 ms,   6.2 MB    <- used
//   ZIP, level 4   write 460 ms,  read 232 ms,  15.1 MB     286 ms,  111 ms,   5.9 MB
//   ZIPS, level 1  write 349 ms,  read 217 ms,  17.3 MB     178 ms,   92 ms,   6.6 MB
//   PIZ            write 535 ms,  read 264 ms,  18.8 MB     199 ms,  108 ms,   8.1 MB
//   RLE            write 136 ms,  read 185 ms,  37.5 MB      96 ms,   66 ms,  12.3 MB
//   none           write  40 ms,  read 120 ms,  50.3 MB      53 ms,   37 ms,  29.4 MB
//
// Threads. The library has one thread pool per process, whose size the host sets. By default the pool has no threads,
// and the number of threads that a file requests has no effect. Therefore this file compresses with oneTBB's threads:
// each one writes a few blocks as a file in memory. Blocks have the same bytes there as in the complete file, so they
// are concatenated.
#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <set>
#include <stdexcept>

#include "core/lists.h"
#include "io/exr_support.h"
#include "io/layer_format.h"

namespace umbrage {
namespace fs = std::filesystem;
namespace {

constexpr Imf::Compression kCompression = Imf::ZIP_COMPRESSION;
constexpr int kZipLevel = 1;
constexpr int kBlockRows = 16;  // rows per block of ZIP

/// Returns whether half is too coarse for a plane: ids above 2048 become ambiguous, depth becomes stepped.
bool needs_float(std::string_view plane) {
  const std::string_view word = last_word(plane);
  return word == "depth" || word == "id" || word.ends_with("_id");
}

/// An output file in memory.
class Stream : public Imf::OStream {
 public:
  Stream() : Imf::OStream("image") {}
  void write(const char* from, int count) override {
    bytes.replace(at_, std::min(std::size_t(count), bytes.size() - at_), from, std::size_t(count));
    at_ += std::size_t(count);
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t position) override { at_ = std::size_t(position); }

  std::string bytes;

 private:
  std::size_t at_ = 0;
};

/// `count` rows of an image: row `row` of `image` is row `first` of the file, and so on.
struct Rows {
  const Image* image;
  int row, first, count;
};

/// Returns the bytes of a file that contains only these rows. `channels`: names of the planes in the file. `before`
/// receives the number of bytes of the header and the table before the blocks.
std::string file_of(const Rows& rows, const std::vector<std::string>& channels, Imf::Header header,
                    std::size_t& before) {
  header.dataWindow().min.y = rows.first;
  header.dataWindow().max.y = rows.first + rows.count - 1;
  Imf::FrameBuffer pixels;
  std::vector<std::vector<Imath::half>> halves(channels.size());
  const Imath::V2i origin(0, rows.first);
  for (std::size_t p = 0; p < channels.size(); ++p) {
    const Plane& plane = rows.image->planes[p];
    const void* start = plane.row(rows.row);
    std::size_t step = sizeof(float), stride = plane.stride * sizeof(float);
    const Imf::PixelType type = header.channels()[channels[p]].type;
    if (type == Imf::HALF) {
      halves[p].reserve(std::size_t(plane.width) * rows.count);
      for (int y = rows.row; y < rows.row + rows.count; ++y)
        halves[p].insert(halves[p].end(), plane.row(y), plane.row(y) + plane.width);
      start = halves[p].data();
      step = sizeof(Imath::half);
      stride = plane.width * step;
    }
    pixels.insert(channels[p], Imf::Slice::Make(type, start, origin, plane.width, rows.count, step, stride));
  }
  Stream stream;
  // Typical compression ratio of floats. It may be too low: reserved memory that is not used costs nothing.
  constexpr std::size_t kTypicalRatio = 2;
  stream.bytes.reserve(channels.size() * std::size_t(rows.image->width) * rows.count * sizeof(float) / kTypicalRatio);
  {
    Imf::OutputFile output(stream, header, 0);
    before = std::size_t(stream.tellp());
    output.setFrameBuffer(pixels);
    output.writePixels(rows.count);
  }
  return std::move(stream.bytes);
}

/// Takes an image's rows from top to bottom and writes the file; `threads` threads compress its blocks.
class BlockWriter {
 public:
  BlockWriter(std::FILE* out, const Imf::Header& header, const std::vector<std::string>& channels, int threads)
      : out_(out), header_(header), channels_(channels), arena_(exr_thread_count(threads)) {
    height_ = header.dataWindow().max.y + 1;
    width_ = header.dataWindow().max.x + 1;
    Stream stream;
    { const Imf::OutputFile without_pixels(stream, header, 0); }
    table_at_ = stream.bytes.size() - std::size_t((height_ + kBlockRows - 1) / kBlockRows) * sizeof(std::uint64_t);
    write_bytes(stream.bytes.data(), stream.bytes.size());
  }

  void take(const Image& image) {
    for (int row = 0; row < image.height;) {
      const int in_block = next_ % kBlockRows, remaining = image.height - row;
      const int in_last_block = (next_ + remaining) % kBlockRows;
      const int complete = next_ + remaining == height_ ? remaining : remaining - in_last_block;
      if (in_block == 0 && complete > 0) {
        compress({&image, row, next_, complete});
        next_ += complete;
        row += complete;
        continue;
      }
      // Keep an incomplete block until its remaining rows arrive.
      const int count = std::min(remaining, std::min(kBlockRows - in_block, height_ - next_));
      if (in_block == 0) incomplete_block_ = Image(width_, kBlockRows);
      for (std::size_t p = 0; p < channels_.size(); ++p) {
        Plane& to = incomplete_block_.add(channels_[p]);
        for (int y = 0; y < count; ++y) std::copy_n(image.planes[p].row(row + y), width_, to.row(in_block + y));
      }
      next_ += count;
      row += count;
      if (next_ % kBlockRows == 0 || next_ == height_)
        compress({&incomplete_block_, 0, next_ - in_block - count, in_block + count});
    }
  }

  /// Writes the table of offsets. Call it after all rows have been taken.
  void finish() {
    if (::fseeko(out_, off_t(table_at_), SEEK_SET) != 0) throw std::runtime_error(std::strerror(errno));
    std::string table;
    for (const std::uint64_t offset : offsets_)
      for (unsigned byte = 0; byte < sizeof offset; ++byte) table += char(offset >> (8 * byte) & 0xff);
    write_bytes(table.data(), table.size());
  }

 private:
  void write_bytes(const char* bytes, std::size_t count) {
    if (std::fwrite(bytes, 1, count, out_) != count) throw std::runtime_error(std::strerror(errno));
    at_ += count;
  }

  /// Compresses and appends complete blocks, or the image's last block.
  void compress(const Rows& rows) {
    struct Part {
      std::string file;
      std::size_t before = 0;
    };
    // The library allocates buffers for each file, so several blocks share one file.
    constexpr int kParts = 8, kMaxBlocks = 8;  // kParts: per thread
    const int blocks = (rows.count + kBlockRows - 1) / kBlockRows;
    const int rows_per_file = kBlockRows * std::clamp(blocks / (kParts * arena_.max_concurrency()), 1, kMaxBlocks);
    int started = 0;
    const auto next = tbb::make_filter<void, Rows>(tbb::filter_mode::serial_in_order, [&](tbb::flow_control& control) {
      const Rows part{rows.image, rows.row + started, rows.first + started,
                      std::min(rows_per_file, rows.count - started)};
      if (started >= rows.count) control.stop();
      started += rows_per_file;
      return part;
    });
    const auto file = tbb::make_filter<Rows, Part>(tbb::filter_mode::parallel, [&](const Rows& rows_of_file) {
      Part part;
      part.file = file_of(rows_of_file, channels_, header_, part.before);
      return part;
    });
    const auto append = tbb::make_filter<Part, void>(tbb::filter_mode::serial_in_order, [&](const Part& part) {
      add(std::string_view(part.file).substr(part.before));
    });
    arena_.execute([&] { tbb::parallel_pipeline(2 * std::size_t(arena_.max_concurrency()), next & file & append); });
  }

  /// Appends blocks as they are in a file: row number, size, and as many bytes.
  void add(std::string_view blocks) {
    constexpr std::size_t kSizeAt = 4, kBytesAt = 8;
    for (std::size_t at = 0; at + kBytesAt <= blocks.size();) {
      offsets_.push_back(at_ + at);
      std::size_t size = 0;
      for (unsigned byte = 0; byte < 4; ++byte)
        size |= std::size_t(static_cast<unsigned char>(blocks[at + kSizeAt + byte])) << (8 * byte);
      at += kBytesAt + size;
    }
    write_bytes(blocks.data(), blocks.size());
  }

  std::FILE* out_;
  const Imf::Header& header_;
  const std::vector<std::string>& channels_;
  tbb::task_arena arena_;
  int width_ = 0, height_ = 0;
  int next_ = 0;            // next row
  Image incomplete_block_;  // rows that wait for the rest of their block
  std::uint64_t at_ = 0;    // position in the file
  std::size_t table_at_ = 0;
  std::vector<std::uint64_t> offsets_;
};

Result<void> write(const fs::path& file, const ImageShape& image, const WriteSettings& settings,
                   const MakeImageRows& make) {
  if (image.width < 1 || image.height < 1 || image.names.empty())
    return file_error("'{}' cannot be written: the image is {} x {} pixels in {} planes", file.string(), image.width,
                      image.height, image.names.size());
  Imf::Header header(image.width, image.height);
  header.compression() = kCompression;
  header.zipCompressionLevel() = kZipLevel;
  header.insert("software", Imf::StringAttribute("Umbrage"));
  Imf::addChromaticities(header, Imf::Chromaticities());  // those of Rec.709 and sRGB, with white D65
  if (settings.camera) add_camera(header, *settings.camera, settings.view_from_world);
  std::vector<std::string> channels;
  for (const std::string& name : image.names) {
    const std::string channel = exr_channel_of(name);
    if (channel.empty() || channel.size() > 255)  // the format's limit for names
      return file_error("'{}' cannot be written: '{}' is not a channel name; it must have 1 to 255 bytes",
                        file.string(), name);
    if (header.channels().findChannel(channel))
      return file_error("'{}' cannot be written: '{}' and another plane would both be the channel '{}'", file.string(),
                        name, channel);
    const auto& whole = settings.integer_planes;
    const Imf::PixelType type = contains(whole, name)                 ? Imf::UINT
                                : settings.half && !needs_float(name) ? Imf::HALF
                                                                      : Imf::FLOAT;
    header.channels().insert(channel, Imf::Channel(type));
    channels.push_back(channel);
  }
  return write_atomically(file, [&](std::FILE* out) -> Result<void> {
    BlockWriter writer(out, header, channels, settings.threads);
    const auto made = make([&](const Image& rows) -> Result<void> {
      writer.take(rows);
      return {};
    });
    if (!made) return made;
    writer.finish();
    return {};
  });
}

/// Reads all channels of all parts. Names: see above.
Result<Image> read(const fs::path& file) {
  const Result<LayeredFile> header = read_header_as(kExrLayers, file);
  if (!header) return header.error();
  std::vector<int> all;
  for (const Channel& channel : header->channels) all.push_back(channel.index);
  Result<Image> image = read_channels_as(kExrLayers, *header, all, std::numeric_limits<float>::infinity());
  if (!image) return image;
  const auto stored_name = [](const Channel& channel) {
    return channel.layer.empty() ? channel.name : channel.layer + "." + channel.name;
  };
  std::set<std::pair<std::string, std::string>> stored_names;  // with their parts
  for (const Channel& channel : header->channels) stored_names.emplace(channel.part, stored_name(channel));
  const std::string first_part = header->channels[0].part;
  image->names.clear();
  std::set<std::string> taken;
  for (const Channel& channel : header->channels) {
    const std::string stored = stored_name(channel);
    const std::string full = channel.part == first_part ? stored : channel.part + "." + stored;
    std::string name = exr_plane_of(channel.layer.empty() ? full : stored);
    // If a file has both forms of a name, such as N.X and N.x, or two parts with the same name, all of them are kept
    // under different names.
    if ((name != stored && stored_names.contains({channel.part, name})) || taken.contains(name)) name = full;
    if (!taken.insert(name).second)
      return file_error("'{}' has two channels for the name '{}': rename one of them", file.string(), name);
    image->names.push_back(name);
  }
  return image;
}

}  // namespace

Result<std::optional<Camera>> read_camera(const fs::path& file) {
  std::int64_t size = 0;
  Result<InputFile> stream = open_to_read(file, size);
  if (!stream) return stream.error();
  char start[4] = {};
  const std::size_t byte_count = std::fread(start, 1, sizeof start, stream->get());
  if (!is_exr(std::string_view(start, byte_count))) return std::optional<Camera>();
  return catching_exr(file, [&]() -> Result<std::optional<Camera>> {
    const auto input = open_exr(file);
    if (!input) return input.error();
    return camera_of((*input)->header(0));
  });
}

const ImageFormat kExr = {"exr", "any planes as float or half channels, with the camera", write, read, is_exr};

}  // namespace umbrage
