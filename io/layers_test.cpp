// Layered image files: what holds for every format. Files that are cut short or damaged are errors, rows are the same
// in blocks and as a whole, and requested channels are those that come.
#include "io/layers.h"

#include <ImfCompression.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "file_folder.h"
#include "io/image_file.h"
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
