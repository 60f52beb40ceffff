// Layered image files: what holds for every format. Files that are cut short or damaged are errors, rows are the same
// in blocks and as a whole, requested channels are those that come, and limits of time and size hold.
#include "io/layers.h"

#include <ImfCompression.h>
#include <gtest/gtest.h>
// jpeglib.h needs cstdio before it.

#include <jpeglib.h>

#include <algorithm>
#include <limits>
#include <map>
#include <random>

#include "file_folder.h"
#include "io/format.h"
#include "layered_files.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;
using test::content_of;

constexpr int kWidth = 13, kHeight = 37;

/// One file of each format and kind, by name, with the value of channel c at (x, y).
struct Layers : test::FileFolder {
  std::map<std::string, std::string> files;

  static float value(int c, int x, int y) { return float((x * 7 + y * 3 + c * 50) % 200); }

  template <class Value>
  static std::string interleaved(int channels) {
    std::vector<Value> values;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        for (int c = 0; c < channels; ++c) values.push_back(Value(value(c, x, y)));
    return test::memory_of(values);
  }

  Image image(std::initializer_list<const char*> names, float scale) const {
    Image image(kWidth, kHeight);
    for (const char* name : names) {
      Plane& plane = image.add(name);
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) plane.at(x, y) = value(int(image.planes.size()) - 1, x, y) / scale;
    }
    return image;
  }

  void add_image(const std::string& name, const Image& picture, const WriteSettings& settings = {}) {
    const fs::path file = folder / ("own." + name.substr(name.rfind('.') + 1));
    ASSERT_TRUE(write_image(file, picture, settings));
    files[name] = content_of(file);
  }

  void SetUp() override {
    FileFolder::SetUp();
    // "c0", "c1" are in the order of the file.
    add_image("float.exr", image({"c0", "c1", "c2"}, 1));
    add_image("half.exr", image({"c0", "c1", "c2"}, 1), {.half = true});
    add_image("grey16.png", image({"grey"}, 65535), {.bits = 16});
    add_image("color.png", image({"color.r", "color.g", "color.b"}, 255));
    add_image("grey.pfm", image({"grey"}, 1));
    add_image("color.pfm", image({"color.r", "color.g", "color.b"}, 1));
    add_image("lossless.webp", image({"color.r", "color.g", "color.b"}, 255), {.quality = 100});
    add_tiffs();
    files["c.npy"] = test::npy_of("<f4", "37, 13, 3", interleaved<float>(3));
    files["grey.npy"] = test::npy_of("<u2", "37, 13", interleaved<std::uint16_t>(1));
    files["two.npz"] = test::zip_of({{"a.npy", test::npy_of("<f8", "1, 37, 13", interleaved<double>(1))}});
    files["bytes.pgm"] = "P5\n# a comment\n13 37 255\n" + interleaved<std::uint8_t>(1);
    files["bytes.ppm"] = "P6 13 37\n255\n" + interleaved<std::uint8_t>(3);
    std::string grid = "ncols 13\nnrows 37\nxllcorner 0\nyllcorner 0\ncellsize 30\nNODATA_value -9999\n",
                text = "P2 13 37 255\n";
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        grid += fmt::format("{} ", value(0, x, y));
        text += fmt::format("{}\n", int(value(0, x, y)));
      }
    files["grid.asc"] = grid;
    files["text.pgm"] = text;
    std::string pixels;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        for (int c = 0; c < 3; ++c) pixels += char(value(c, x, y));
        pixels += char(136);  // exponent 0
      }
    files["flat.hdr"] = test::hdr_of(kWidth, kHeight, pixels);
  }

  void add_tiffs() {
    for (const int compression : {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE})
      for (const int tile : {0, 16})
        for (const int planar : {PLANARCONFIG_CONTIG, PLANARCONFIG_SEPARATE})
          files[fmt::format("{}-{}-{}.tif", compression, tile, planar)] =
              test::tiff_of(folder, kWidth, kHeight, interleaved<float>(3),
                            {.samples = 3, .compression = compression, .planar = planar, .tile = tile});
  }
};

std::vector<int> all_of(const LayeredFile& header) {
  std::vector<int> all;
  for (const Channel& channel : header.channels) all.push_back(channel.index);
  return all;
}

TEST_F(Layers, EveryFormatGivesTheStoredValues) {
  for (const auto& [name, bytes] : files) {
    const auto header = read_header(write(name, bytes));
    ASSERT_TRUE(header) << header.error().message;
    EXPECT_EQ(header->width, kWidth) << name;
    EXPECT_EQ(header->height, kHeight) << name;
    const auto image = read_channels(*header, all_of(*header));
    ASSERT_TRUE(image) << image.error().message;
    ASSERT_EQ(image->planes.size(), header->channels.size()) << name;
    for (std::size_t c = 0; c < image->planes.size(); ++c) {
      EXPECT_EQ(image->names[c], header->channels[c].full_name());
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
          ASSERT_EQ(image->planes[c].at(x, y), value(int(c), x, y)) << name << ": " << c << " at " << x << ", " << y;
    }
  }
}

TEST_F(Layers, RequestedChannelsComeInTheirOrder) {
  for (const auto& [name, bytes] : files) {
    const auto header = read_header(write(name, bytes));
    ASSERT_TRUE(header) << header.error().message;
    const int last = int(header->channels.size()) - 1;
    for (const std::vector<int>& request :
         {std::vector<int>{last}, std::vector<int>{last, 0, last}, std::vector<int>{}}) {
      Image joined(kWidth, kHeight);
      for (std::size_t i = 0; i < request.size(); ++i) joined.planes.emplace_back(kWidth, kHeight);
      int next = 0;
      const auto status = read_rows(*header, request, [&](const Image& rows, int first) -> Result<void> {
        EXPECT_EQ(first, next) << name;
        EXPECT_EQ(rows.planes.size(), request.size()) << name;
        next += rows.height;
        for (std::size_t i = 0; i < request.size(); ++i)
          for (int y = 0; y < rows.height; ++y)
            std::copy_n(rows.planes[i].row(y), kWidth, joined.planes[i].row(first + y));
        return {};
      });
      ASSERT_TRUE(status) << status.error().message;
      EXPECT_EQ(next, request.empty() ? 0 : kHeight) << name;
      for (std::size_t i = 0; i < request.size(); ++i)
        for (int y = 0; y < kHeight; ++y)
          for (int x = 0; x < kWidth; ++x)
            ASSERT_EQ(joined.planes[i].at(x, y), value(request[i], x, y)) << name << " at " << x << ", " << y;
    }
    for (const int wrong : {-1, last + 1}) {
      const auto refused = read_channels(*header, std::vector<int>{wrong});
      ASSERT_FALSE(refused);
      EXPECT_EQ(refused.error().kind, ErrorKind::kFile);
    }
  }
}

TEST_F(Layers, ErrorsOfTheReceiverEndTheReading) {
  for (const auto& [name, bytes] : files) {
    const auto header = read_header(write(name, bytes));
    ASSERT_TRUE(header);
    int calls = 0;
    const auto status = read_rows(*header, std::vector<int>{0}, [&](const Image&, int) -> Result<void> {
      ++calls;
      return usage_error("enough");
    });
    ASSERT_FALSE(status) << name;
    EXPECT_EQ(status.error().message, "enough") << name;
    EXPECT_EQ(calls, 1) << name;
  }
}

/// Reads a file of any content. Errors must be of the kind for files, or of memory, in one line that names the file.
void expect_error_or_image(const fs::path& file, bool& failed) {
  const auto check = [&](const Error& error) {
    failed = true;
    EXPECT_TRUE(error.kind == ErrorKind::kFile || error.kind == ErrorKind::kDevice) << error.message;
    EXPECT_NE(error.message.find(file.filename().string()), std::string::npos) << error.message;
    EXPECT_EQ(error.message.find('\n'), std::string::npos) << error.message;
  };
  failed = false;
  const auto header = read_header(file);
  if (!header) return check(header.error());
  const auto image = read_channels(*header, all_of(*header));
  if (!image) return check(image.error());
  EXPECT_EQ(image->planes.size(), header->channels.size());
}

TEST_F(Layers, FilesThatAreCutShortAreErrors) {
  for (const auto& [name, bytes] : files)
    for (int part = 0; part < 32; ++part) {
      bool failed = false;
      expect_error_or_image(write(name, bytes.substr(0, bytes.size() * std::size_t(part) / 32)), failed);
      EXPECT_TRUE(failed) << name << " cut to " << part << "/32";
    }
}

TEST_F(Layers, DamagedFilesDoNotCrash) {
  std::mt19937 random(1);
  for (const auto& [name, bytes] : files) {
    int failures = 0;
    for (int i = 0; i < 150; ++i) {
      std::string damaged = bytes;
      const std::size_t range = i % 4 ? std::min<std::size_t>(bytes.size(), 400) : bytes.size();
      for (int k = i % 3; k >= 0; --k) damaged[random() % range] = char(random());
      bool failed = false;
      expect_error_or_image(write(name, damaged), failed);
      failures += failed;
    }
    EXPECT_GT(failures, 0) << name;
  }
}

TEST_F(Layers, FilesThatChangeBetweenHeaderAndPixelsAreErrors) {
  for (const auto& [name, bytes] : files) {
    const auto header = read_header(write(name, bytes));
    ASSERT_TRUE(header);
    LayeredFile other = *header;
    other.width += 1;
    const auto image = read_channels(other, std::vector<int>{0});
    ASSERT_FALSE(image) << name;
    EXPECT_NE(image.error().message.find("has changed"), std::string::npos) << image.error().message;
  }
}

TEST_F(Layers, OtherContentsAreNamed) {
  for (const auto& [name, bytes, words] :
       {std::tuple("empty.exr", "", "is empty"),
        std::tuple("text.tif", "This is no picture.", "not an image of a known format"),
        std::tuple("short.png", "\x89PNG", "not an image")}) {
    const auto header = read_header(write(name, bytes));
    ASSERT_FALSE(header);
    EXPECT_EQ(header.error().kind, ErrorKind::kFile);
    EXPECT_NE(header.error().message.find(words), std::string::npos) << header.error().message;
  }
  EXPECT_FALSE(read_header(folder / "none.exr"));
  EXPECT_FALSE(read_header(folder));
}

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

TEST_F(Layers, ReadingEndsWhenItsTimeIsUp) {
  for (const auto& [name, bytes] : files) {
    const auto header = read_header(write(name, bytes));
    ASSERT_TRUE(header);
    const ReadingLimits none(0.0, kNoLimit);
    const auto image = read_channels(*header, all_of(*header));
    ASSERT_FALSE(image) << name;
    EXPECT_EQ(image.error().kind, ErrorKind::kFile);
    EXPECT_NE(image.error().message.find(name + "' is damaged or too complex"), std::string::npos)
        << image.error().message;
    bool called = false;
    EXPECT_FALSE(read_rows(*header, all_of(*header), [&](const Image&, int) { return called = true, Result<void>(); }));
    EXPECT_FALSE(called) << name;
  }
}

TEST_F(Layers, TheTimeOfReceiversDoesNotCount) {
  // Two blocks: the receiver uses up the time of the file during the first.
  const auto header = read_header(write("long.pgm", "P5 2048 4096 255\n" + std::string(2048 * 4096, 'a')));
  ASSERT_TRUE(header);
  constexpr double kSeconds = 0.5;
  const ReadingLimits limits(kSeconds, kNoLimit);
  int calls = 0;
  const auto status = read_rows(*header, std::vector<int>{0}, [&](const Image&, int) -> Result<void> {
    const std::clock_t begin = std::clock();
    while (++calls == 1 && double(std::clock() - begin) < 2.0 * kSeconds * CLOCKS_PER_SEC) --calls;
    return {};
  });
  EXPECT_TRUE(status) << status.error().message;
  EXPECT_EQ(calls, 2);
}

/// Expects that a file is refused, with these words, in less than half a second of processor time.
void expect_refused(const fs::path& file, const std::string& words) {
  constexpr double kMax_s = 0.5;
  const ReadingLimits limits(kMax_s, kNoLimit);
  const auto header = read_header(file);
  const auto image = header ? read_channels(*header, all_of(*header)) : Result<Image>(header.error());
  ASSERT_FALSE(image);
  EXPECT_EQ(image.error().kind, ErrorKind::kFile);
  EXPECT_NE(image.error().message.find(words), std::string::npos) << image.error().message;
}

TEST_F(Layers, FilesTooSmallForTheirPixelsAreRefused) {
  using std::string_literals::operator""s;
  expect_refused(write("one.webp", "RIFF\x20\0\0\0WEBPVP8L\x14\0\0\0\x2f\xfe\xbf\xff\x0f\xa8\x42\x29\xea\xd1\xff"s +
                                       std::string(9, '\0')),
                 "16383 pixels, too many for its 40 bytes");
}

/// Returns a progressive file of one colour with `bands` scans per component, and one of all.
std::string progressive_jpeg(int bands) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr manager{};
  jpeg.err = jpeg_std_error(&manager);
  jpeg_create_compress(&jpeg);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &bytes, &size);
  jpeg.image_width = jpeg.image_height = 16;
  jpeg.input_components = 3;
  jpeg.in_color_space = JCS_RGB;
  jpeg_set_defaults(&jpeg);
  std::vector<jpeg_scan_info> scans = {{3, {0, 1, 2}, 0, 0, 0, 0}};
  for (int component = 0; component < 3; ++component)
    for (int band = 1; band <= bands; ++band) scans.push_back({1, {component}, band, band, 0, 0});
  jpeg.scan_info = scans.data();
  jpeg.num_scans = int(scans.size());
  jpeg_start_compress(&jpeg, TRUE);
  std::vector<JSAMPLE> row(16 * 3, 77);
  JSAMPROW rows[] = {row.data()};
  while (jpeg.next_scanline < jpeg.image_height) jpeg_write_scanlines(&jpeg, rows, 1);
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  std::string out(reinterpret_cast<char*>(bytes), size);
  std::free(bytes);
  return out;
}

TEST_F(Layers, JpegFilesOfManyScansAreRefused) {
  const auto few = read_header(write("few.jpg", progressive_jpeg(20)));
  ASSERT_TRUE(few);
  EXPECT_TRUE(read_channels(*few, all_of(*few)));
  expect_refused(write("many.jpg", progressive_jpeg(63)), "more than 64 scans");
}

TEST_F(Layers, PixelsThatNeedTooMuchMemoryAreRefused) {
  Image picture(4200, 4200);
  picture.add("grey");
  ASSERT_TRUE(write_image(folder / "large.png", picture));
  const auto header = read_header(folder / "large.png");
  ASSERT_TRUE(header);
  const ReadingLimits limits(kNoLimit, 60e6);  // bytes
  const auto image = read_channels(*header, std::vector<int>{0});
  ASSERT_FALSE(image);
  EXPECT_EQ(image.error().kind, ErrorKind::kFile);
  EXPECT_NE(image.error().message.find("need 0.1 GB of memory"), std::string::npos) << image.error().message;
  EXPECT_TRUE(read_rows(*header, std::vector<int>{0}, [](const Image&, int) { return Result<void>(); }));
}

TEST_F(Layers, FilesOfTooManyChannelsAreRefused) {
  std::vector<std::pair<std::string, std::string>> arrays;
  for (int i = 0; i <= 4096; ++i)
    arrays.emplace_back(fmt::format("a{}.npy", i), test::npy_of("|u1", "8, 8", std::string(64, 'x')));
  expect_refused(write("many.npz", test::zip_of(arrays)), "has 4097 channels: at most 4096 can be read");
  arrays.pop_back();
  EXPECT_TRUE(read_header(write("fewer.npz", test::zip_of(arrays))));
}

TEST(LayerNames, PartLayerAndNameAreJoinedOnce) {
  const auto full = [](const char* part, const char* layer, const char* name) {
    Channel channel;
    channel.part = part;
    channel.layer = layer;
    channel.name = name;
    return channel.full_name();
  };
  EXPECT_EQ(full("", "", "R"), "R");
  EXPECT_EQ(full("", "ViewLayer.Depth", "Z"), "ViewLayer.Depth.Z");
  EXPECT_EQ(full("depth", "", "Z"), "depth.Z");
  EXPECT_EQ(full("depth", "depth", "Z"), "depth.Z");
  EXPECT_EQ(full("ViewLayer", "ViewLayer.Depth", "Z"), "ViewLayer.Depth.Z");
  EXPECT_EQ(full("main", "depth", "Z"), "main.depth.Z");
  EXPECT_EQ(full("", "", ""), "");
  EXPECT_EQ(full("dep", "depth", "Z"), "dep.depth.Z");
}

}  // namespace
}  // namespace umbrage
