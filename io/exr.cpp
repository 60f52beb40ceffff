// OpenEXR images through the OpenEXR 3.1 library, float or half. Rests on "Technical Introduction to OpenEXR" (channel
// and layer names, windows, parts) and on ImfStandardAttributes.h (what the camera attributes mean).
//
// Names. Plane <-> channel: color.r <-> R (g, b, a alike), depth <-> depth.Z and layer1.depth <-> layer1.depth.Z,
// normal.x <-> normal.X (endings r, g, b, a, x, y, z alike); other names are the same in the file. In a file of several
// parts the channels of the first part and names with a dot are taken as they are, the others behind their part's name:
// Z of the part Depth is Depth.z. Windows. An image is as large as the display window. Where the data window does not
// reach, planes are 0 and depth is +infinity; what lies outside the display window is dropped. Values. Integer channels
// become floats, exact up to 2^24. Deep and subsampled channels are refused.
//
// Compression is chosen for speed at a usual size. Processor time of one core of an AMD EPYC (Zen 4), OpenEXR 3.1.5,
// 1024 x 1024, 12 planes (shaded colour, depth, normal, albedo, noisy occlusion, id), median of 5:
//                  float                            half
//   ZIP, level 1   write 394 ms,  read 214 ms,  15.6 MB     193 ms,   88 ms,   6.2 MB    <- used
//   ZIP, level 4   write 460 ms,  read 232 ms,  15.1 MB     286 ms,  111 ms,   5.9 MB
//   ZIPS, level 1  write 349 ms,  read 217 ms,  17.3 MB     178 ms,   92 ms,   6.6 MB
//   PIZ            write 535 ms,  read 264 ms,  18.8 MB     199 ms,  108 ms,   8.1 MB
//   RLE            write 136 ms,  read 185 ms,  37.5 MB      96 ms,   66 ms,  12.3 MB
//   none           write  40 ms,  read 120 ms,  50.3 MB      53 ms,   37 ms,  29.4 MB
// The library's two worker threads take ZIP, level 1, float from 429 to 284 ms of elapsed time.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfOutputFile.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <map>
#include <stdexcept>

#include "io/exr_camera.h"
#include "io/format.h"

namespace umbrage {
namespace fs = std::filesystem;
namespace {

constexpr Imf::Compression kCompression = Imf::ZIP_COMPRESSION;
constexpr int kZipLevel = 1;
constexpr int kThreads = 2;

constexpr std::string_view kColor = "color.";
constexpr std::string_view kDepth = "depth", kDepthEnding = ".Z";
constexpr std::string_view kSmallLetters = "rgbaxyz", kCapitals = "RGBAXYZ";

/// The letter after the last dot where that is all there is, or 0.
char last_letter(std::string_view name) { return name.size() > 2 && name[name.size() - 2] == '.' ? name.back() : '\0'; }

/// What follows the last dot.
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

/// Planes that half would spoil: ids above 2048 are no longer told apart, depth gets steps.
bool needs_float(std::string_view plane) {
  const std::string_view word = last_word(plane);
  return word == "depth" || word == "id" || word.ends_with("_id");
}

/// Settings of the library for the whole process, made once: the worker threads, if nobody has asked for some, and
/// the sizes of tiles and windows that it refuses before it makes tables for them.
void set_up() {
  static const bool done = [] {
    if (Imf::globalThreadCount() == 0) Imf::setGlobalThreadCount(kThreads);
    Imf::Header::setMaxImageSize(int(kMaxSide), int(kMaxSide));
    Imf::Header::setMaxTileSize(int(kMaxSide), int(kMaxSide));
    return true;
  }();
  static_cast<void>(done);
}

/// A text from a file, fit for a terminal.
std::string printable(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if ((unsigned char)(c) < 0x20 || c == 0x7f) c = '?';
  return out;
}

/// What the library says without its first sentence, which repeats the file's name.
std::string cause(const std::exception& exception) {
  const std::string text = exception.what();
  const std::size_t end = text.find("\". ");
  return printable(end == std::string::npos ? text : text.substr(end + 3));
}

/// A stream into an open file.
class Stream : public Imf::OStream {
 public:
  explicit Stream(std::FILE* file) : Imf::OStream("image"), file_(file) {}
  void write(const char* bytes, int count) override {
    if (std::fwrite(bytes, 1, count, file_) != std::size_t(count)) throw std::runtime_error(std::strerror(errno));
  }
  std::uint64_t tellp() override { return std::uint64_t(::ftello(file_)); }
  void seekp(std::uint64_t position) override {
    if (::fseeko(file_, off_t(position), SEEK_SET) != 0) throw std::runtime_error(std::strerror(errno));
  }

 private:
  std::FILE* file_;
};

Imath::M44f imath(const glm::dmat4& m) {
  Imath::M44f out;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) out[i][j] = float(m[i][j]);
  return out;
}

glm::dmat4 glm_from(const Imath::M44f& m) {
  glm::dmat4 out;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) out[i][j] = m[i][j];
  return out;
}

void add_camera(Imf::Header& header, const Camera& camera) {
  const ExrCamera matrices = exr_camera(camera);
  Imf::addWorldToCamera(header, imath(matrices.camera_from_world));
  Imf::addWorldToNDC(header, imath(matrices.ndc_from_world));
  if (camera.projection != Projection::kPerspective) return;
  // OpenEXR's screen window lies at distance 1, as ours does.
  header.screenWindowWidth() = camera.right - camera.left;
  header.screenWindowCenter() = Imath::V2f((camera.left + camera.right) / 2, (camera.bottom + camera.top) / 2);
}

/// Writes the next rows of an image, from row `first` on, as these channels.
void write_rows(Imf::OutputFile& output, const std::vector<std::string>& channels, const Image& rows, int first) {
  Imf::FrameBuffer pixels;
  std::vector<std::vector<Imath::half>> halves(rows.planes.size());
  const Imath::V2i origin(0, first);
  for (std::size_t p = 0; p < rows.planes.size(); ++p) {
    const Plane& plane = rows.planes[p];
    const void* start = plane.data();
    std::size_t step = sizeof(float), stride = plane.stride * sizeof(float);
    const Imf::PixelType type = output.header().channels()[channels[p]].type;
    if (type == Imf::HALF) {
      halves[p].reserve(std::size_t(plane.width) * plane.height);
      for (int y = 0; y < plane.height; ++y)
        halves[p].insert(halves[p].end(), plane.row(y), plane.row(y) + plane.width);
      start = halves[p].data();
      step = sizeof(Imath::half);
      stride = plane.width * step;
    }
    pixels.insert(channels[p], Imf::Slice::Make(type, start, origin, plane.width, plane.height, step, stride));
  }
  output.setFrameBuffer(pixels);
  output.writePixels(rows.height);
}

Result<void> write(const fs::path& file, const ImageShape& image, const WriteSettings& settings,
                   const MakeImageRows& make) {
  if (image.width < 1 || image.height < 1 || image.names.empty())
    return file_error("'{}' cannot be written: the image is {} x {} pixels in {} planes", file.string(), image.width,
                      image.height, image.names.size());
  Imf::Header header(image.width, image.height);
  header.compression() = kCompression;
  header.zipCompressionLevel() = kZipLevel;
  header.insert("software", Imf::StringAttribute("Umbrage"));
  if (settings.camera) add_camera(header, *settings.camera);
  std::vector<std::string> channels;
  for (const std::string& name : image.names) {
    const std::string channel = channel_of(name);
    if (channel.empty() || channel.size() > 255)  // the format's longest name
      return file_error("'{}' cannot be written: '{}' is no channel name, which has 1 to 255 bytes", file.string(),
                        name);
    if (header.channels().findChannel(channel))
      return file_error("'{}' cannot be written: '{}' and another plane would both be the channel '{}'", file.string(),
                        name, channel);
    const auto& whole = settings.whole_numbers;
    const Imf::PixelType type = std::find(whole.begin(), whole.end(), name) != whole.end() ? Imf::UINT
                                : settings.half && !needs_float(name)                      ? Imf::HALF
                                                                                           : Imf::FLOAT;
    header.channels().insert(channel, Imf::Channel(type));
    channels.push_back(channel);
  }
  set_up();
  return write_whole(file, [&](std::FILE* out) -> Result<void> {
    Stream stream(out);
    Imf::OutputFile output(stream, header, kThreads);
    int first = 0;
    return make([&](const Image& rows) -> Result<void> {
      write_rows(output, channels, rows, first);
      first += rows.height;
      return {};
    });
  });
}

/// Whether a channel is depth: one of that name, or Z without X beside it.
bool is_depth(std::string_view channel, const Imf::ChannelList& channels) {
  if (last_word(channel) == kDepth) return true;
  if (last_word(channel) != "Z") return false;
  std::string beside(channel);
  beside.back() = 'X';
  return !channels.findChannel(beside);
}

/// `plane`, which covers `data`, moved to where it lies in `display`.
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

/// Adds the channels of one part to the image.
Result<void> read_part(const fs::path& file, Imf::MultiPartInputFile& input, int index, Image& image) {
  const Imf::Header& header = input.header(index);
  const std::string part = header.hasName() ? header.name() : "";
  if (header.hasType() && header.type() != Imf::SCANLINEIMAGE && header.type() != Imf::TILEDIMAGE)
    return file_error("'{}' has {} data in its part '{}': only flat images can be read, so flatten it first",
                      file.string(), printable(header.type()), printable(part));
  const Imath::Box2i& data = header.dataWindow();
  const Imath::Box2i& display = input.header(0).displayWindow();  // all parts share it
  if (Result<void> sane = check_window(file, data); !sane) return sane;
  const int width = data.max.x - data.min.x + 1, height = data.max.y - data.min.y + 1;
  Imf::FrameBuffer pixels;
  std::map<std::string, Plane> planes;
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
    const Imf::Channel& channel = it.channel();
    if (channel.xSampling != 1 || channel.ySampling != 1)
      return file_error("'{}' has the channel '{}' at {} x {} subsampling: every pixel needs its value", file.string(),
                        printable(it.name()), channel.xSampling, channel.ySampling);
    Plane& plane = planes.emplace(it.name(), Plane(width, height)).first->second;
    pixels.insert(it.name(),
                  Imf::Slice::Make(Imf::FLOAT, plane.data(), data, sizeof(float), plane.stride * sizeof(float)));
  }
  Imf::InputPart reader(input, index);
  reader.setFrameBuffer(pixels);
  reader.readPixels(data.min.y, data.max.y);
  for (auto& [channel, plane] : planes) {
    const std::string full = index > 0 ? part + "." + channel : channel;
    std::string name = plane_of(channel.find('.') == std::string::npos ? full : channel);
    // Where a file has both forms of a name, as N.X and N.x, or two parts the same name, all are kept apart.
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

/// Reads up to a zero byte; false where the file ends before or the text is no name.
bool skip_name(std::FILE* stream, bool& empty) {
  constexpr int kLongest = 256;
  for (int i = 0; i < kLongest; ++i) {
    const int c = std::fgetc(stream);
    if (c == EOF) return false;
    if (c != 0) continue;
    empty = i == 0;
    return true;
  }
  return false;
}

/// Whether all attributes of the headers end within the file. The library makes room for what a damaged one claims, up
/// to 2 GB, before it looks.
bool attributes_end(std::FILE* stream, std::int64_t size) {
  constexpr int kFlags = 5, kHeaders = 8;  // where they stand
  constexpr int kSeveralParts = 0x10;      // in the second byte of the version
  std::fseek(stream, kFlags, SEEK_SET);
  const int flags = std::fgetc(stream);
  std::fseek(stream, kHeaders, SEEK_SET);
  // A header is attributes and an empty name; several headers end with an empty one.
  bool first = true;
  while (true) {
    bool empty = false;
    if (flags == EOF || !skip_name(stream, empty)) return false;
    if (empty && (first || (flags & kSeveralParts) == 0)) return true;
    first = empty;
    if (empty) continue;
    unsigned char length[4];
    bool no_type = false;
    if (!skip_name(stream, no_type) || std::fread(length, 1, sizeof length, stream) != sizeof length) return false;
    const std::int64_t bytes = std::int64_t(length[0]) | std::int64_t(length[1]) << 8 | std::int64_t(length[2]) << 16 |
                               std::int64_t(length[3]) << 24;
    if (bytes > size - std::ftell(stream) || std::fseek(stream, long(bytes), SEEK_CUR) != 0) return false;
  }
}

Error cut_header(const fs::path& file) {
  return file_error("'{}' cannot be read as EXR: its header is cut short or damaged", file.string());
}

/// How often smaller a compression can make pixels at best: deflate 1032 times, and DWA and PIZ what run lengths have
/// shortened 64 times before. A shorter file cannot hold what a damaged header promises.
std::int64_t best_ratio(Imf::Compression compression) {
  constexpr std::int64_t kDeflate = 1032, kRuns = 64;
  const bool runs_first = compression == Imf::PIZ_COMPRESSION || compression == Imf::DWAA_COMPRESSION ||
                          compression == Imf::DWAB_COMPRESSION;
  return runs_first ? kDeflate * kRuns : kDeflate;
}

Result<Image> read(const fs::path& file) {
  std::int64_t size = 0;
  const Result<InputFile> stream = open_to_read(file, size);
  if (!stream) return stream.error();
  if (!attributes_end(stream->get(), size)) return cut_header(file);
  set_up();
  try {
    constexpr bool kNoRepair = false;  // an unfinished file is an error, not a picture with holes
    Imf::MultiPartInputFile input(file.c_str(), kThreads, kNoRepair);
    const Imath::Box2i& display = input.header(0).displayWindow();
    if (Result<void> sane = check_window(file, display); !sane) return sane.error();
    Image image(display.max.x - display.min.x + 1, display.max.y - display.min.y + 1);
    std::int64_t values = 0, stored = 0;
    for (int part = 0; part < input.parts(); ++part) {
      const Imf::Header& header = input.header(part);
      const Imath::Box2i& data = header.dataWindow();
      if (Result<void> sane = check_window(file, data); !sane) return sane.error();
      const std::int64_t width = std::int64_t(data.max.x) - data.min.x + 1,
                         height = std::int64_t(data.max.y) - data.min.y + 1;
      std::int64_t bytes = 0;
      for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
        values += std::max(width * height, std::int64_t(image.width) * image.height);
        stored += width * height;
        bytes += width * height * (it.channel().type == Imf::HALF ? 2 : 4);
      }
      if (bytes / best_ratio(header.compression()) > size)
        return file_error("'{}' is cut short: {} bytes cannot hold {} x {} pixels", file.string(), size, width, height);
    }
    constexpr std::int64_t kMaxValues = std::int64_t(1) << 31;  // 8 GB
    if (values > kMaxValues)
      return file_error("'{}' has {} values in {} x {} pixels: at most {} can be read", file.string(), values,
                        image.width, image.height, kMaxValues);
    // A crop may be a small part of its frame, but a frame of gigabytes with next to nothing in it is a damaged header.
    constexpr std::int64_t kMostEmpty = std::int64_t(1) << 27, kMostTimes = 64;
    if (values > kMostEmpty + kMostTimes * stored)
      return file_error("'{}' says that its frame is {} x {} pixels, of which it holds too few", file.string(),
                        image.width, image.height);
    for (int part = 0; part < input.parts(); ++part)
      if (Result<void> done = read_part(file, input, part, image); !done) return done.error();
    if (image.planes.empty()) return file_error("'{}' has no channels", file.string());
    return image;
  } catch (const std::bad_alloc&) {
    throw;  // read_image has a sentence for that
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
  const std::size_t got = std::fread(start, 1, sizeof start, stream->get());
  if (!recognises(std::string_view(start, got))) return std::optional<Camera>();
  if (!attributes_end(stream->get(), size)) return cut_header(file);
  set_up();
  try {
    constexpr bool kNoRepair = false;
    const Imf::MultiPartInputFile input(file.c_str(), 0, kNoRepair);
    const Imf::Header& header = input.header(0);
    if (!Imf::hasWorldToCamera(header) || !Imf::hasWorldToNDC(header)) return std::optional<Camera>();
    return camera_from({glm_from(Imf::worldToCamera(header)), glm_from(Imf::worldToNDC(header))});
  } catch (const std::exception& exception) {
    return file_error("'{}' cannot be read as EXR: {}", file.string(), cause(exception));
  }
}

const ImageFormat kExr = {"exr", "any planes as float or half channels, with the camera", write, read, recognises};

}  // namespace umbrage
