// The layers of OpenEXR files that other programs write: parts, views, windows, compressions, tiles, subsampled
// channels, luminance and chroma, deep samples.
#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputPart.h>
#include <ImfDeepTiledOutputPart.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>

#include <cmath>

#include "file_folder.h"
#include "io/layers.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;
using ExrLayers = test::FileFolder;

Imath::Box2i box(int x0, int y0, int x1, int y1) { return {{x0, y0}, {x1, y1}}; }

/// A channel to write: pixel (x, y) of the file's coordinates has the value base + x + 100 * y.
struct TestChannel {
  std::string name;
  float base = 0.0f;
  int sampling = 1;
};

/// A part to write.
struct TestPart {
  Imath::Box2i window;
  std::vector<TestChannel> channels;
  std::vector<std::vector<float>> values = {};

  Imf::Header header(Imath::Box2i display) const {
    Imf::Header header(display, window);
    for (const TestChannel& c : channels)
      header.channels().insert(c.name, Imf::Channel(Imf::FLOAT, c.sampling, c.sampling));
    return header;
  }
  Imf::FrameBuffer pixels() {
    Imf::FrameBuffer pixels;
    values.clear();
    for (const TestChannel& c : channels) {
      values.emplace_back();
      for (int y = window.min.y; y <= window.max.y; y += c.sampling)
        for (int x = window.min.x; x <= window.max.x; x += c.sampling)
          values.back().push_back(c.base + float(x + 100 * y));
      const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
      pixels.insert(c.name, Imf::Slice::Make(Imf::FLOAT, values.back().data(), window.min, width, height, sizeof(float),
                                             sizeof(float) * std::size_t(width / c.sampling), c.sampling, c.sampling));
    }
    return pixels;
  }
  int rows() const { return window.max.y - window.min.y + 1; }
};

void write_scanlines(const fs::path& file, const Imf::Header& header, TestPart part) {
  Imf::OutputFile out(file.c_str(), header);
  out.setFrameBuffer(part.pixels());
  out.writePixels(part.rows());
}

struct Read {
  LayeredFile header;
  Image image;
  const Plane& operator[](std::string_view name) const { return image.plane(name); }
};

/// Reads all channels, and checks that rows in small blocks are the same.
Read read_all(const fs::path& file) {
  auto header = read_header(file);
  EXPECT_TRUE(header) << header.error().message;
  if (!header) return {};
  std::vector<int> all;
  for (const Channel& channel : header->channels) all.push_back(channel.index);
  auto image = read_channels(*header, all);
  EXPECT_TRUE(image) << image.error().message;
  if (!image) return {};
  const auto rows = read_rows(*header, all, [&](const Image& block, int first) -> Result<void> {
    for (std::size_t c = 0; c < all.size(); ++c)
      for (int y = 0; y < block.height; ++y)
        for (int x = 0; x < block.width; ++x) {
          const float a = block.planes[c].at(x, y), b = image->planes[c].at(x, first + y);
          if (!(a == b || (a != a && b != b))) return usage_error("{} differs at {}, {}", block.names[c], x, first + y);
        }
    return {};
  });
  EXPECT_TRUE(rows) << rows.error().message;
  return {std::move(*header), std::move(*image)};
}

TEST_F(ExrLayers, EveryCompressionIsRead) {
  for (int compression = 0; compression < Imf::NUM_COMPRESSION_METHODS; ++compression) {
    const TestPart part{box(0, 0, 300, 520), {{"Y", 1}, {"depth.Z", 7}}};
    Imf::Header header = part.header(part.window);
    header.compression() = Imf::Compression(compression);
    write_scanlines(folder / "x.exr", header, part);
    const Read read = read_all(folder / "x.exr");
    // PXR24 keeps 24 bits; B44 is exact for floats; DWA is lossy for colours and luminance.
    const bool is_dwa = compression == Imf::DWAA_COMPRESSION || compression == Imf::DWAB_COMPRESSION;
    const float bound = is_dwa ? 0.02f : 1e-4f;
    for (const auto& [name, base] : {std::pair("Y", 1.0f), std::pair("depth.Z", 7.0f)})
      for (int y = 0; y <= 520; ++y)
        for (int x = 0; x <= 300; ++x) {
          const float expected = base + float(x + 100 * y);
          ASSERT_NEAR(read[name].at(x, y), expected, bound * expected) << compression << ": " << x << ", " << y;
        }
  }
}

TEST_F(ExrLayers, EveryHalfAndIntegerIsExact) {
  // 257 columns, so that blocks of ZIP have an odd number of values; all bits of a half.
  constexpr int kColumns = 257, kRows = 256;
  std::vector<std::uint16_t> halves;
  std::vector<std::uint32_t> integers;
  for (int i = 0; i < kColumns * kRows; ++i) {
    halves.push_back(std::uint16_t(i));
    integers.push_back(std::uint32_t(i) * 65521u);
  }
  for (const Imf::Compression compression : {Imf::NO_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::ZIP_COMPRESSION}) {
    Imf::Header header(kColumns, kRows);
    header.compression() = compression;
    header.channels().insert("half", Imf::Channel(Imf::HALF));
    header.channels().insert("number", Imf::Channel(Imf::UINT));
    {
      Imf::FrameBuffer pixels;
      pixels.insert("half", Imf::Slice::Make(Imf::HALF, halves.data(), header.dataWindow()));
      pixels.insert("number", Imf::Slice::Make(Imf::UINT, integers.data(), header.dataWindow()));
      Imf::OutputFile out((folder / "x.exr").c_str(), header);
      out.setFrameBuffer(pixels);
      out.writePixels(kRows);
    }
    const Read read = read_all(folder / "x.exr");
    for (int i = 0; i < kColumns * kRows; ++i) {
      Imath::half expected;
      expected.setBits(halves[std::size_t(i)]);
      const float value = read["half"].at(i % kColumns, i / kColumns);
      ASSERT_EQ(std::isnan(value), expected.isNan()) << i;
      if (!expected.isNan()) {
        ASSERT_EQ(value, float(expected)) << i;
        ASSERT_EQ(std::signbit(value), expected.isNegative()) << i;
      }
      ASSERT_EQ(read["number"].at(i % kColumns, i / kColumns), float(integers[std::size_t(i)])) << i;
    }
  }
}

TEST_F(ExrLayers, RowsOfALargeFileComeInBlocks) {
  const TestPart part{box(0, 0, 2000, 1100), {{"a", 1}, {"b", 2}, {"c", 3}}};
  Imf::Header header = part.header(part.window);
  header.lineOrder() = Imf::DECREASING_Y;
  header.compression() = Imf::PIZ_COMPRESSION;
  write_scanlines(folder / "x.exr", header, part);
  const auto read = read_header(folder / "x.exr");
  ASSERT_TRUE(read);
  int blocks = 0;
  ASSERT_TRUE(read_rows(*read, std::vector<int>{0, 2}, [&](const Image& rows, int first) -> Result<void> {
    ++blocks;
    EXPECT_EQ(rows.names, (std::vector<std::string>{"a", "c"}));
    for (int y = 0; y < rows.height; ++y)
      for (int x = 0; x < rows.width; ++x)
        if (rows.planes[1].at(x, y) != 3.0f + float(x + 100 * (first + y))) return usage_error("{}, {}", x, first + y);
    return {};
  }));
  EXPECT_GT(blocks, 1);
}

TEST_F(ExrLayers, PartsAreSetInTheDisplayWindow) {
  TestPart parts[] = {{box(0, 0, 9, 7), {{"R", 1}}},
                      {box(2, 1, 5, 4), {{"Z", 2}, {"velocity.u", 3}}},
                      {box(-4, -3, 20, 30), {{"N.X", 4}, {"N.Y", 5}, {"N.Z", 6}}},
                      {box(40, 40, 50, 50), {{"depth", 7}}}};
  const char* names[] = {"beauty", "depth", "normals", "beside"};
  {
    std::vector<Imf::Header> headers;
    for (int p = 0; p < 4; ++p) {
      headers.push_back(parts[p].header(box(0, 0, 9, 7)));
      headers[p].setName(names[p]);
      headers[p].setType(Imf::SCANLINEIMAGE);
    }
    headers[1].setView("left");
    Imf::MultiPartOutputFile out((folder / "x.exr").c_str(), headers.data(), 4);
    for (int p = 0; p < 4; ++p) {
      Imf::OutputPart part(out, p);
      part.setFrameBuffer(parts[p].pixels());
      part.writePixels(parts[p].rows());
    }
  }
  const Read read = read_all(folder / "x.exr");
  ASSERT_EQ(read.image.names, (std::vector<std::string>{"beauty.R", "depth.Z", "depth.velocity.u", "normals.N.X",
                                                        "normals.N.Y", "normals.N.Z", "beside.depth"}));
  EXPECT_EQ(read.header.channels[1].view, "left");
  EXPECT_EQ(read.header.channels[2].layer, "velocity");
  EXPECT_EQ(read.header.data.x1, 10);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 10; ++x) {
      const float at = float(x + 100 * y);
      const bool inside = x >= 2 && x <= 5 && y >= 1 && y <= 4;
      EXPECT_EQ(read["beauty.R"].at(x, y), 1 + at);
      EXPECT_EQ(read["normals.N.Z"].at(x, y), 6 + at);
      EXPECT_EQ(read["depth.velocity.u"].at(x, y), inside ? 3 + at : 0.0f);
      EXPECT_TRUE(std::isnan(read["beside.depth"].at(x, y)));
      if (inside)
        EXPECT_EQ(read["depth.Z"].at(x, y), 2 + at);
      else
        EXPECT_TRUE(std::isnan(read["depth.Z"].at(x, y)));
    }
}

TEST_F(ExrLayers, ViewsOfASinglePartAreNamed) {
  const TestPart part{box(0, 0, 3, 3), {{"R", 1}, {"left.R", 2}, {"depth.Z", 3}, {"depth.left.Z", 4}}};
  Imf::Header header = part.header(part.window);
  Imf::addMultiView(header, {"right", "left"});
  write_scanlines(folder / "x.exr", header, part);
  const Read read = read_all(folder / "x.exr");
  ASSERT_EQ(read.header.channels.size(), 4u);
  for (const Channel& channel : read.header.channels) {
    const std::string name = channel.full_name();
    EXPECT_EQ(channel.view, name == "R" ? "right" : name == "depth.Z" ? "" : "left") << name;
  }
}

TEST_F(ExrLayers, HeaderTextsAndNumbersAreAttributes) {
  const TestPart part{box(0, 0, 3, 3), {{"Y", 1}}};
  Imf::Header header = part.header(part.window);
  header.pixelAspectRatio() = 2.0f;
  header.insert("cryptomatte/ab12cd3/manifest", Imf::StringAttribute("{\"a\":\"0001\n\"}"));
  header.insert("near", Imf::FloatAttribute(0.5f));
  Imf::addWorldToCamera(header, Imath::M44f());
  Imf::addWorldToNDC(header, Imath::M44f(0.5f, 0, 0, 0, 0, -0.5f, 0, 0, 0, 0, 1, 0, 0.5f, 0.5f, 0, 1));
  write_scanlines(folder / "x.exr", header, part);
  const auto read = read_header(folder / "x.exr");
  ASSERT_TRUE(read);
  ASSERT_TRUE(read->attribute("cryptomatte/ab12cd3/manifest"));
  EXPECT_EQ(*read->attribute("cryptomatte/ab12cd3/manifest"), "{\"a\":\"0001 \"}");
  ASSERT_TRUE(read->attribute("near"));
  EXPECT_EQ(*read->attribute("near"), "0.5");
  EXPECT_EQ(read->attribute("type"), nullptr);
  EXPECT_EQ(read->pixel_aspect, 2.0);
  ASSERT_TRUE(read->camera);
  EXPECT_EQ(read->camera->projection, Projection::kOrthographic);
}

TEST_F(ExrLayers, FirstLevelOfTilesIsRead) {
  for (const Imf::LevelMode mode : {Imf::ONE_LEVEL, Imf::MIPMAP_LEVELS, Imf::RIPMAP_LEVELS}) {
    TestPart part{box(-5, 3, 70, 90), {{"a", 1}}};
    Imf::Header header = part.header(box(0, 0, 60, 100));
    header.setTileDescription(Imf::TileDescription(16, 24, mode));
    {
      Imf::TiledOutputFile out((folder / "x.exr").c_str(), header);
      for (int ly = 0; ly < out.numYLevels(); ++ly)
        for (int lx = 0; lx < out.numXLevels(); ++lx) {
          if (!out.isValidLevel(lx, ly)) continue;
          out.setFrameBuffer(part.pixels());
          out.writeTiles(0, out.numXTiles(lx) - 1, 0, out.numYTiles(ly) - 1, lx, ly);
        }
    }
    const Read read = read_all(folder / "x.exr");
    for (int y = 0; y <= 100; ++y)
      for (int x = 0; x <= 60; ++x)
        ASSERT_EQ(read["a"].at(x, y), y >= 3 && y <= 90 ? 1 + float(x + 100 * y) : 0.0f)
            << mode << ": " << x << ", " << y;
  }
}

TEST_F(ExrLayers, SubsampledChannelsAreRepeated) {
  // The data window begins above and left of the display window, in the middle of a stored value of 4 x 4 pixels.
  const TestPart part{box(-8, -8, 39, 71), {{"BY", 5000, 4}, {"c", 9000, 1}, {"d", 7000, 2}}};
  write_scanlines(folder / "x.exr", part.header(box(-2, -3, 30, 60)), part);
  const Read read = read_all(folder / "x.exr");
  const auto stored = [](int at, int sampling) { return int(std::floor(float(at) / float(sampling))) * sampling; };
  for (int y = -3; y <= 60; ++y)
    for (int x = -2; x <= 30; ++x) {
      ASSERT_EQ(read["BY"].at(x + 2, y + 3), 5000 + float(stored(x, 4) + 100 * stored(y, 4))) << x << ", " << y;
      ASSERT_EQ(read["d"].at(x + 2, y + 3), 7000 + float(stored(x, 2) + 100 * stored(y, 2))) << x << ", " << y;
      ASSERT_EQ(read["c"].at(x + 2, y + 3), 9000 + float(x + 100 * y)) << x << ", " << y;
    }
}

TEST_F(ExrLayers, LuminanceAndChromaBecomeColour) {
  constexpr int kSide = 64;
  std::vector<Imf::Rgba> pixels(kSide * kSide);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      pixels[std::size_t(y * kSide + x)] = Imf::Rgba(0.2f + 0.005f * float(x), 0.5f, 0.3f + 0.004f * float(y), 1.0f);
  {
    Imf::RgbaOutputFile out((folder / "x.exr").c_str(), kSide, kSide, Imf::WRITE_YC);
    out.setFrameBuffer(pixels.data(), 1, kSide);
    out.writePixels(kSide);
  }
  const Read read = read_all(folder / "x.exr");
  ASSERT_EQ(read.image.names, (std::vector<std::string>{"R", "G", "B"}));
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      // Chroma has half the resolution, and half floats 11 bits.
      EXPECT_NEAR(read["R"].at(x, y), 0.2f + 0.005f * float(x), 0.01f) << x << ", " << y;
      EXPECT_NEAR(read["G"].at(x, y), 0.5f, 0.01f);
      EXPECT_NEAR(read["B"].at(x, y), 0.3f + 0.004f * float(y), 0.01f);
    }
}

/// A deep sample; pixels list theirs.
struct Sample {
  float z, alpha, red;
  std::uint32_t id;
};

/// Writes a deep part of 6 x 20 pixels, at (1, 2) of a display window of 8 x 24.
void write_deep(const fs::path& file, bool is_tiled, const std::vector<std::vector<Sample>>& samples) {
  const Imath::Box2i window = box(1, 2, 6, 21);
  Imf::Header header(box(0, 0, 7, 23), window);
  for (const char* name : {"A", "R", "Z"}) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
  header.channels().insert("id", Imf::Channel(Imf::UINT));
  header.compression() = Imf::ZIPS_COMPRESSION;
  header.setType(is_tiled ? Imf::DEEPTILE : Imf::DEEPSCANLINE);
  header.setName("deep");
  if (is_tiled) header.setTileDescription(Imf::TileDescription(4, 7, Imf::ONE_LEVEL));
  const std::ptrdiff_t width = 6, origin = 1 + 2 * width;
  std::vector<std::uint32_t> counts;
  std::vector<std::vector<float>> reals[3];
  std::vector<std::vector<std::uint32_t>> ids;
  for (const auto& pixel : samples) {
    counts.push_back(std::uint32_t(pixel.size()));
    for (auto& list : reals) list.emplace_back();
    ids.emplace_back();
    for (const Sample& sample : pixel) {
      reals[0].back().push_back(sample.alpha);
      reals[1].back().push_back(sample.red);
      reals[2].back().push_back(sample.z);
      ids.back().push_back(sample.id);
    }
  }
  std::vector<const void*> pointers[4];
  for (std::size_t i = 0; i < samples.size(); ++i) {
    for (int c = 0; c < 3; ++c) pointers[c].push_back(reals[c][i].data());
    pointers[3].push_back(ids[i].data());
  }
  Imf::DeepFrameBuffer buffer;
  buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data() - origin), 4, 4 * width));
  const char* names[] = {"A", "R", "Z", "id"};
  for (int c = 0; c < 4; ++c)
    buffer.insert(names[c],
                  Imf::DeepSlice(c < 3 ? Imf::FLOAT : Imf::UINT, reinterpret_cast<char*>(pointers[c].data() - origin),
                                 sizeof(void*), sizeof(void*) * width, 4));
  Imf::MultiPartOutputFile out(file.c_str(), &header, 1);
  if (is_tiled) {
    Imf::DeepTiledOutputPart part(out, 0);
    part.setFrameBuffer(buffer);
    part.writeTiles(0, part.numXTiles() - 1, 0, part.numYTiles() - 1);
  } else {
    Imf::DeepScanLineOutputPart part(out, 0);
    part.setFrameBuffer(buffer);
    part.writePixels(20);
  }
}

TEST_F(ExrLayers, DeepSamplesAreFlattened) {
  // Every pixel: nothing; one sample; two, of which the nearer is second; a front sample without coverage; an opaque
  // one before another.
  const std::vector<std::vector<Sample>> kinds = {{},
                                                  {{5, 0.5f, 0.25f, 7}},
                                                  {{9, 1, 0.8f, 1}, {4, 0.25f, 0.2f, 2}},
                                                  {{1, 0, 0, 3}, {6, 1, 0.75f, 4}},
                                                  {{3, 1, 0.5f, 5}, {8, 1, 0.9f, 6}}};
  const float red[] = {0, 0.25f, 0.2f + 0.75f * 0.8f, 0.75f, 0.5f}, alpha[] = {0, 0.5f, 1, 1, 1};
  const float depth[] = {0, 5, 4, 6, 3}, id[] = {0, 7, 2, 4, 5};
  std::vector<std::vector<Sample>> samples;
  for (std::size_t i = 0; i < 6 * 20; ++i) samples.push_back(kinds[i % 5]);
  for (const bool is_tiled : {false, true}) {
    write_deep(folder / "x.exr", is_tiled, samples);
    const Read read = read_all(folder / "x.exr");
    EXPECT_TRUE(read.header.is_deep);
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 8; ++x) {
        const bool inside = x >= 1 && x <= 6 && y >= 2 && y <= 21;
        const int kind = inside ? ((y - 2) * 6 + x - 1) % 5 : 0;
        ASSERT_FLOAT_EQ(read["R"].at(x, y), red[kind]) << is_tiled << ": " << x << ", " << y;
        ASSERT_FLOAT_EQ(read["A"].at(x, y), alpha[kind]) << x << ", " << y;
        ASSERT_EQ(read["id"].at(x, y), id[kind]) << x << ", " << y;
        if (kind == 0)
          ASSERT_TRUE(std::isnan(read["Z"].at(x, y)));
        else
          ASSERT_EQ(read["Z"].at(x, y), depth[kind]) << x << ", " << y;
      }
    // Channels that are requested alone are composited with the alpha and depth that are not.
    const auto only_red = read_channels(read.header, std::vector<int>{1});
    ASSERT_TRUE(only_red);
    EXPECT_FLOAT_EQ(only_red->planes[0].at(3, 2), red[2]);
  }
}

TEST_F(ExrLayers, DamagedDeepFilesDoNotCrash) {
  const std::vector<std::vector<Sample>> samples(120, {{5, 0.5f, 0.25f, 7}, {6, 0.5f, 0.25f, 8}});
  for (const bool is_tiled : {false, true}) {
    write_deep(folder / "x.exr", is_tiled, samples);
    std::string whole(fs::file_size(folder / "x.exr"), '\0');
    std::ifstream(folder / "x.exr", std::ios::binary).read(whole.data(), std::streamsize(whole.size()));
    int failures = 0;
    for (std::size_t i = 0; i < 300; ++i) {
      std::string bytes = whole;
      if (i < 32)
        bytes.resize(whole.size() * i / 32);
      else
        for (std::size_t k = 0; k < i % 3 + 1; ++k) bytes[i * 7919 * (k + 1) % bytes.size()] = char(255 - i % 7);
      const auto header = read_header(write("y.exr", bytes));
      const auto image = header ? read_channels(*header, std::vector<int>{0}) : header.error();
      if (!image) {
        EXPECT_EQ(image.error().kind, ErrorKind::kFile);
      }
      failures += !image;
    }
    EXPECT_GT(failures, 32);
  }
}

}  // namespace
}  // namespace umbrage
