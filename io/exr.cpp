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
// Values. Integer channels become floats, exact up to 2^24. Deep and subsampled channels are rejected.
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
// are concatenated. Rows are read through one file object per thread.
#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfOutputFile.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <limits>
#include <map>
#include <span>
#include <stdexcept>

#include "io/exr_camera.h"
#include "io/format.h"

namespace umbrage {
namespace fs = std::filesystem;
namespace {

constexpr Imf::Compression kCompression = Imf::ZIP_COMPRESSION;
constexpr int kZipLevel = 1;
constexpr int kBlockRows = 16;  // rows per block of ZIP
constexpr int kReadThreads = 2;
constexpr bool kNoRepair = false;  // an unfinished file is an error, not a picture with holes

constexpr std::string_view kColor = "color.";
constexpr std::string_view kDepth = "depth", kDepthEnding = ".Z";
constexpr std::string_view kSmallLetters = "rgbaxyz", kCapitals = "RGBAXYZ";

/// Returns the number of threads to use: `requested`, or all for 0; at most the number of the machine.
int thread_count(int requested) {
  const int max = tbb::info::default_concurrency();
  return requested > 0 ? std::min(requested, max) : max;
}

/// Returns the last letter if a dot precedes it, else 0.
char last_letter(std::string_view name) { return name.size() > 2 && name[name.size() - 2] == '.' ? name.back() : '\0'; }

/// Returns the text after the last dot.
std::string_view last_word(std::string_view name) { return name.substr(name.rfind('.') + 1); }

std::string channel_of(std::string_view plane) {
  std::string channel(plane);
  if (last_word(plane) == kDepth) return channel.append(kDepthEnding);
  const auto at = kSmallLetters.find(last_letter(plane));
  if (at == std::string_view::npos) return channel;
  channel.back() = kCapitals[at];
  return plane.size() == kColor.size() + 1 && plane.starts_with(kColor) && at < 4 ? channel.substr(kColor.size())
                                                                                  : channel;
}

std::string plane_of(std::string_view channel) {
  if (channel.ends_with(kDepthEnding)) {
    const std::string_view before = channel.substr(0, channel.size() - kDepthEnding.size());
    if (last_word(before) == kDepth) return std::string(before);
  }
  if (channel.size() == 1 && kCapitals.substr(0, 4).find(channel[0]) != std::string_view::npos)
    return std::string(kColor) + kSmallLetters[kCapitals.find(channel[0])];
  std::string plane(channel);
  const auto at = kCapitals.find(last_letter(channel));
  if (at != std::string_view::npos) plane.back() = kSmallLetters[at];
  return plane;
}

/// Returns whether half is too coarse for a plane: ids above 2048 become ambiguous, depth becomes stepped.
bool needs_float(std::string_view plane) {
  const std::string_view word = last_word(plane);
  return word == "depth" || word == "id" || word.ends_with("_id");
}

/// Replaces control characters, so that a text from a file is safe for a terminal.
std::string printable(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if ((unsigned char)(c) < 0x20 || c == 0x7f) c = '?';
  return out;
}

/// Returns the library's message without its first sentence, which repeats the file's name.
std::string cause(const std::exception& exception) {
  const std::string text = exception.what();
  const std::size_t end = text.find("\". ");
  return printable(end == std::string::npos ? text : text.substr(end + 3));
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

/// Names of the attributes that hold the matrices in double precision, for worlds whose coordinates exceed the
/// precision of the standard attributes.
constexpr const char *kWorldToCameraDouble = "worldToCameraDouble", *kWorldToNdcDouble = "worldToNDCDouble";

template <class T>
Imath::Matrix44<T> imath(const glm::dmat4& m) {
  Imath::Matrix44<T> out;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) out[i][j] = T(m[i][j]);
  return out;
}

template <class T>
glm::dmat4 glm_from(const Imath::Matrix44<T>& m) {
  glm::dmat4 out;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) out[i][j] = m[i][j];
  return out;
}

void add_camera(Imf::Header& header, const Camera& camera, const glm::dmat4* view_from_world) {
  const ExrCamera matrices =
      exr_camera(camera, view_from_world ? *view_from_world : glm::dmat4(camera.view_from_world));
  const Imath::M44f standard = imath<float>(matrices.camera_from_world);
  Imf::addWorldToCamera(header, standard);
  Imf::addWorldToNDC(header, imath<float>(matrices.ndc_from_world));
  if (glm_from(standard) != matrices.camera_from_world) {
    header.insert(kWorldToCameraDouble, Imf::M44dAttribute(imath<double>(matrices.camera_from_world)));
    header.insert(kWorldToNdcDouble, Imf::M44dAttribute(imath<double>(matrices.ndc_from_world)));
  }
  if (camera.projection != Projection::kPerspective) return;
  // OpenEXR's screen window is at distance 1, as in Camera.
  header.screenWindowWidth() = camera.right - camera.left;
  header.screenWindowCenter() = Imath::V2f((camera.left + camera.right) / 2, (camera.bottom + camera.top) / 2);
}

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
      : out_(out), header_(header), channels_(channels), arena_(thread_count(threads)) {
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
    const std::string channel = channel_of(name);
    if (channel.empty() || channel.size() > 255)  // the format's limit for names
      return file_error("'{}' cannot be written: '{}' is not a channel name; it must have 1 to 255 bytes",
                        file.string(), name);
    if (header.channels().findChannel(channel))
      return file_error("'{}' cannot be written: '{}' and another plane would both be the channel '{}'", file.string(),
                        name, channel);
    const auto& whole = settings.integer_planes;
    const Imf::PixelType type = std::find(whole.begin(), whole.end(), name) != whole.end() ? Imf::UINT
                                : settings.half && !needs_float(name)                      ? Imf::HALF
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

/// Returns whether a channel is depth: its name is depth, or Z and its layer has no channel X.
bool is_depth(std::string_view channel, const Imf::ChannelList& channels) {
  if (last_word(channel) == kDepth) return true;
  if (last_word(channel) != "Z") return false;
  std::string beside(channel);
  beside.back() = 'X';
  return !channels.findChannel(beside);
}

/// Returns a plane of the size of `display`: `plane`, which covers `data`, at its position, and `outside` elsewhere.
Plane placed(const Plane& plane, const Imath::Box2i& data, const Imath::Box2i& display, float outside) {
  Plane out(display.max.x - display.min.x + 1, display.max.y - display.min.y + 1, outside);
  const int x0 = std::max(data.min.x, display.min.x), x1 = std::min(data.max.x, display.max.x);
  const int y0 = std::max(data.min.y, display.min.y), y1 = std::min(data.max.y, display.max.y);
  for (int y = y0; y <= y1 && x0 <= x1; ++y)
    std::copy_n(plane.row(y - data.min.y) + (x0 - data.min.x), x1 - x0 + 1,
                out.row(y - display.min.y) + (x0 - display.min.x));
  return out;
}

Result<void> check_window(const fs::path& file, const Imath::Box2i& window) {
  return check_size(file, std::int64_t(window.max.x) - window.min.x + 1, std::int64_t(window.max.y) - window.min.y + 1);
}

/// Reads a part's rows with several threads, each through its own file object.
void read_rows(const fs::path& file, int index, const Imath::Box2i& data, const Imf::FrameBuffer& pixels,
               Imf::MultiPartInputFile& input) {
  constexpr int kMaxBlock = 256;  // max rows per block (DWAB); a block that two threads read is decompressed twice
  const auto read_from = [&](Imf::MultiPartInputFile& from, int first, int last) {
    Imf::InputPart reader(from, index);
    reader.setFrameBuffer(pixels);
    reader.readPixels(first, last);
  };
  const int blocks = (data.max.y - data.min.y) / kMaxBlock + 1;
  if (blocks < 2) return read_from(input, data.min.y, data.max.y);
  const auto first_row_of = [&](int thread) { return data.min.y + blocks * thread / kReadThreads * kMaxBlock; };
  tbb::task_arena arena(thread_count(kReadThreads));
  arena.execute([&] {
    tbb::parallel_for(0, kReadThreads, [&](int thread) {
      const int first = first_row_of(thread), last = std::min(first_row_of(thread + 1) - 1, data.max.y);
      if (thread == 0) return read_from(input, first, last);
      Imf::MultiPartInputFile input_of_thread(file.c_str(), 0, kNoRepair);
      read_from(input_of_thread, first, last);
    });
  });
}

/// Adds the channels of one part to the image.
Result<void> read_part(const fs::path& file, Imf::MultiPartInputFile& input, int index, Image& image) {
  const Imf::Header& header = input.header(index);
  const std::string part = header.hasName() ? header.name() : "";
  if (header.hasType() && header.type() != Imf::SCANLINEIMAGE && header.type() != Imf::TILEDIMAGE)
    return file_error("'{}' has {} data in its part '{}': only flat images can be read, so flatten it first",
                      file.string(), printable(header.type()), printable(part));
  const Imath::Box2i& data = header.dataWindow();
  const Imath::Box2i& display = input.header(0).displayWindow();  // common to all parts
  if (Result<void> fine = check_window(file, data); !fine) return fine;
  const int width = data.max.x - data.min.x + 1, height = data.max.y - data.min.y + 1;
  Imf::FrameBuffer pixels;
  std::map<std::string, Plane> planes;
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
    const Imf::Channel& channel = it.channel();
    if (channel.xSampling != 1 || channel.ySampling != 1)
      return file_error("'{}' has the channel '{}' at {} x {} subsampling: subsampled channels cannot be read",
                        file.string(), printable(it.name()), channel.xSampling, channel.ySampling);
    Plane& plane = planes.emplace(it.name(), Plane(width, height)).first->second;
    pixels.insert(it.name(),
                  Imf::Slice::Make(Imf::FLOAT, plane.data(), data, sizeof(float), plane.stride * sizeof(float)));
  }
  read_rows(file, index, data, pixels, input);
  for (auto& [channel, plane] : planes) {
    const std::string full = index > 0 ? part + "." + channel : channel;
    std::string name = plane_of(channel.find('.') == std::string::npos ? full : channel);
    // If a file has both forms of a name, such as N.X and N.x, or two parts with the same name, all of them are kept
    // under different names.
    if ((name != channel && header.channels().findChannel(name)) || image.find(printable(name))) name = full;
    name = printable(name);
    if (image.find(name))
      return file_error("'{}' has two channels for the name '{}': rename one of them", file.string(), name);
    const float outside = is_depth(channel, header.channels()) ? std::numeric_limits<float>::infinity() : 0.0f;
    image.names.push_back(name);
    image.planes.push_back(data == display ? std::move(plane) : placed(plane, data, display, outside));
  }
  return {};
}

/// Reads a name up to a zero byte. Returns false if the file ends before the zero byte, or if the name is too long.
bool read_name(std::FILE* stream, std::string& name) {
  constexpr int kMaxLength = 256;
  name.clear();
  for (int i = 0; i < kMaxLength; ++i) {
    const int c = std::fgetc(stream);
    if (c == EOF) return false;
    if (c == 0) return true;
    name += char(c);
  }
  return false;
}

/// Reads the next 4-byte numbers. Returns false if the file contains too few.
bool read_numbers(std::FILE* stream, std::span<std::int64_t> numbers) {
  for (std::int64_t& number : numbers) {
    unsigned char bytes[4];
    if (std::fread(bytes, 1, sizeof bytes, stream) != sizeof bytes) return false;
    number = std::int32_t(std::uint32_t(bytes[0]) | std::uint32_t(bytes[1]) << 8 | std::uint32_t(bytes[2]) << 16 |
                          std::uint32_t(bytes[3]) << 24);
  }
  return true;
}

/// Returns the size of a value of an attribute type, in bytes; 0 if it varies.
std::int64_t size_of(std::string_view type) {
  static constexpr std::pair<std::string_view, std::int64_t> kSizes[] = {{"box2f", 16},
                                                                         {"box2i", 16},
                                                                         {"chromaticities", 32},
                                                                         {"compression", 1},
                                                                         {"deepImageState", 1},
                                                                         {"double", 8},
                                                                         {"envmap", 1},
                                                                         {"float", 4},
                                                                         {"int", 4},
                                                                         {"keycode", 28},
                                                                         {"lineOrder", 1},
                                                                         {"m33d", 72},
                                                                         {"m33f", 36},
                                                                         {"m44d", 128},
                                                                         {"m44f", 64},
                                                                         {"rational", 8},
                                                                         {"tiledesc", 9},
                                                                         {"timecode", 8},
                                                                         {"v2d", 16},
                                                                         {"v2f", 8},
                                                                         {"v2i", 8},
                                                                         {"v3d", 24},
                                                                         {"v3f", 12},
                                                                         {"v3i", 12}};
  for (const auto& [name, size] : kSizes)
    if (name == type) return size;
  return 0;
}

/// Returns whether the value at the stream's position has the size that the header claims. For some types the library
/// relies on the claimed size, for others it reads what it needs. With a wrong claim it would find other attributes
/// than check_headers does.
bool has_claimed_size(std::FILE* stream, std::string_view type, std::int64_t claimed) {
  const std::int64_t end = std::ftell(stream) + claimed;
  if (type == "preview") {
    std::array<std::int64_t, 2> sides{};
    return read_numbers(stream, sides) && sides[0] >= 0 && sides[1] >= 0 && sides[0] <= kMaxSide &&
           sides[1] <= kMaxSide && 8 + 4 * sides[0] * sides[1] == claimed;
  }
  if (type == "chlist") {
    constexpr long kChannelBytes = 16;
    std::string name;
    while (read_name(stream, name) && std::ftell(stream) <= end) {
      if (name.empty()) return std::ftell(stream) == end;
      if (std::fseek(stream, kChannelBytes, SEEK_CUR) != 0) return false;
    }
    return false;
  }
  const std::int64_t size = size_of(type);
  return size == 0 || size == claimed;
}

/// Returns whether the value is a window or a tile size for which the library would allocate huge tables.
bool is_huge(std::FILE* stream, std::string_view name, std::string_view type) {
  std::array<std::int64_t, 4> numbers{};
  if (type == "box2i" && (name == "dataWindow" || name == "displayWindow"))
    return read_numbers(stream, numbers) &&
           (numbers[2] - numbers[0] >= kMaxSide || numbers[3] - numbers[1] >= kMaxSide);
  if (type != "tiledesc" || !read_numbers(stream, std::span(numbers).first(2))) return false;
  return std::uint32_t(numbers[0]) > kMaxSide || std::uint32_t(numbers[1]) > kMaxSide;
}

/// Checks the headers before the library reads them. The library allocates whatever a damaged header claims: up to 2 GB
/// for an attribute, and tables for windows of any size. Errors: kFile.
Result<void> check_headers(const fs::path& file, std::FILE* stream, std::int64_t size) {
  constexpr int kFlags = 5, kHeaders = 8;  // byte offsets
  constexpr int kSeveralParts = 0x10;      // in the second byte of the version
  const Error damaged = file_error("'{}' cannot be read as EXR: its header is cut short or damaged", file.string());
  std::fseek(stream, kFlags, SEEK_SET);
  const int flags = std::fgetc(stream);
  std::fseek(stream, kHeaders, SEEK_SET);
  // A header is a list of attributes that ends with an empty name. After several headers another empty name follows.
  std::string name, type;
  bool first = true;
  while (true) {
    if (flags == EOF || !read_name(stream, name)) return damaged;
    if (name.empty() && (first || (flags & kSeveralParts) == 0)) return {};
    first = name.empty();
    if (name.empty()) continue;
    std::array<std::int64_t, 1> claimed{};
    if (!read_name(stream, type) || !read_numbers(stream, claimed)) return damaged;
    const long value = std::ftell(stream);
    const std::int64_t bytes = std::uint32_t(claimed[0]);
    if (bytes > size - value || !has_claimed_size(stream, type, bytes)) return damaged;
    std::fseek(stream, value, SEEK_SET);
    if (is_huge(stream, name, type))
      return file_error(
          "'{}' has windows or tiles in its header that are larger than {} pixels per side, the maximum that can "
          "be read",
          file.string(), kMaxSide);
    if (std::fseek(stream, value + long(bytes), SEEK_SET) != 0) return damaged;
  }
}

/// Returns the maximum compression ratio: 1032 for deflate, times 64 for the preceding run-length step of DWA and PIZ.
/// A file that is shorter than this ratio permits cannot contain the pixels that its header claims.
std::int64_t max_ratio(Imf::Compression compression) {
  constexpr std::int64_t kDeflate = 1032, kRuns = 64;
  const bool has_runs = compression == Imf::PIZ_COMPRESSION || compression == Imf::DWAA_COMPRESSION ||
                        compression == Imf::DWAB_COMPRESSION;
  return has_runs ? kDeflate * kRuns : kDeflate;
}

Result<Image> read(const fs::path& file) {
  std::int64_t size = 0;
  const Result<InputFile> stream = open_to_read(file, size);
  if (!stream) return stream.error();
  if (auto fine = check_headers(file, stream->get(), size); !fine) return fine.error();
  try {
    Imf::MultiPartInputFile input(file.c_str(), 0, kNoRepair);
    const Imath::Box2i& display = input.header(0).displayWindow();
    if (Result<void> fine = check_window(file, display); !fine) return fine.error();
    Image image(display.max.x - display.min.x + 1, display.max.y - display.min.y + 1);
    std::int64_t values = 0, stored = 0;
    for (int part = 0; part < input.parts(); ++part) {
      const Imf::Header& header = input.header(part);
      const Imath::Box2i& data = header.dataWindow();
      if (Result<void> fine = check_window(file, data); !fine) return fine.error();
      const std::int64_t width = std::int64_t(data.max.x) - data.min.x + 1,
                         height = std::int64_t(data.max.y) - data.min.y + 1;
      std::int64_t bytes = 0;
      for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
        values += std::max(width * height, std::int64_t(image.width) * image.height);
        stored += width * height;
        bytes += width * height * (it.channel().type == Imf::HALF ? 2 : 4);
      }
      if (bytes / max_ratio(header.compression()) > size)
        return file_error("'{}' is cut short: {} bytes cannot hold {} x {} pixels", file.string(), size, width, height);
    }
    constexpr std::int64_t kMaxValues = std::int64_t(1) << 31;  // 8 GB
    if (values > kMaxValues)
      return file_error("'{}' has {} values in {} x {} pixels: at most {} can be read", file.string(), values,
                        image.width, image.height, kMaxValues);
    // The data window may be a small part of the display window. But if the display window is gigabytes in size and
    // there is almost no data, the header is damaged.
    constexpr std::int64_t kMaxEmpty = std::int64_t(1) << 27, kMaxRatio = 64;
    if (values > kMaxEmpty + kMaxRatio * stored)
      return file_error("'{}' has a frame of {} x {} pixels in its header, but data for too few of them", file.string(),
                        image.width, image.height);
    for (int part = 0; part < input.parts(); ++part)
      if (Result<void> done = read_part(file, input, part, image); !done) return done.error();
    if (image.planes.empty()) return file_error("'{}' has no channels", file.string());
    return image;
  } catch (const std::bad_alloc&) {
    throw;  // read_image turns it into an error
  } catch (const std::exception& exception) {
    return file_error("'{}' cannot be read as EXR: {}", file.string(), cause(exception));
  }
}

bool recognises(std::string_view start) { return start.starts_with("\x76\x2f\x31\x01"); }

}  // namespace

Result<std::optional<Camera>> read_camera(const fs::path& file) {
  std::int64_t size = 0;
  Result<InputFile> stream = open_to_read(file, size);
  if (!stream) return stream.error();
  char start[4] = {};
  const std::size_t byte_count = std::fread(start, 1, sizeof start, stream->get());
  if (!recognises(std::string_view(start, byte_count))) return std::optional<Camera>();
  if (auto fine = check_headers(file, stream->get(), size); !fine) return fine.error();
  try {
    const Imf::MultiPartInputFile input(file.c_str(), 0, kNoRepair);
    const Imf::Header& header = input.header(0);
    if (!Imf::hasWorldToCamera(header) || !Imf::hasWorldToNDC(header)) return std::optional<Camera>();
    const auto* exact_camera = header.findTypedAttribute<Imf::M44dAttribute>(kWorldToCameraDouble);
    const auto* exact_ndc = header.findTypedAttribute<Imf::M44dAttribute>(kWorldToNdcDouble);
    if (exact_camera && exact_ndc) return camera_from({glm_from(exact_camera->value()), glm_from(exact_ndc->value())});
    return camera_from({glm_from(Imf::worldToCamera(header)), glm_from(Imf::worldToNDC(header))});
  } catch (const std::exception& exception) {
    return file_error("'{}' cannot be read as EXR: {}", file.string(), cause(exception));
  }
}

const ImageFormat kExr = {"exr", "any planes as float or half channels, with the camera", write, read, recognises};

}  // namespace umbrage
