// Copies of OpenEXR files with more layers: everything else is kept.
#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputPart.h>
#include <ImfFrameBuffer.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <ImfTiledInputPart.h>
#include <ImfTiledOutputPart.h>
#include <gtest/gtest.h>

#include "file_folder.h"
#include "io/layers.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 40, kHeight = 70;

Imath::Box2i box(int x0, int y0, int x1, int y1) { return {{x0, y0}, {x1, y1}}; }

/// Values of a channel that the tests write, exact in half: at (x, y) of the file's coordinates.
float stored(float base, int x, int y) { return base + float(x) + float(y) / 128.0f; }

/// Writes a part whose channels are half, float and integer: R, Z and id, unless `names` has others.
struct TestPart {
  Imath::Box2i window;
  std::vector<std::string> names = {"R", "Z", "id"};
  std::vector<std::vector<Imath::half>> halves = {};
  std::vector<std::vector<float>> floats = {};
  std::vector<std::vector<std::uint32_t>> integers = {};

  static Imf::PixelType type_of(const std::string& name) {
    return name == "id" ? Imf::UINT : name.ends_with("Z") ? Imf::FLOAT : Imf::HALF;
  }
  Imf::Header header(Imf::Compression compression) const {
    Imf::Header header(box(0, 0, kWidth - 1, kHeight - 1), window);
    for (const std::string& name : names) header.channels().insert(name, Imf::Channel(type_of(name)));
    header.compression() = compression;
    return header;
  }
  Imf::FrameBuffer pixels() {
    halves.resize(names.size());
    floats.resize(names.size());
    integers.resize(names.size());
    Imf::FrameBuffer pixels;
    for (std::size_t c = 0; c < names.size(); ++c) {
      for (int y = window.min.y; y <= window.max.y; ++y)
        for (int x = window.min.x; x <= window.max.x; ++x) {
          halves[c].push_back(Imath::half(stored(float(c), x, y)));
          floats[c].push_back(stored(float(c), x, y));
          integers[c].push_back(0xf0000000u + std::uint32_t(x + 100 * y));
        }
      const Imf::PixelType type = type_of(names[c]);
      const void* start = type == Imf::HALF    ? static_cast<const void*>(halves[c].data())
                          : type == Imf::FLOAT ? static_cast<const void*>(floats[c].data())
                                               : integers[c].data();
      pixels.insert(names[c], Imf::Slice::Make(type, start, window));
    }
    return pixels;
  }
};

struct ExrMerge : test::FileFolder {
  fs::path in() const { return folder / "in.exr"; }
  fs::path out() const { return folder / "out.exr"; }

  static float added(int x, int y) { return float(x) / 64.0f + float(y); }

  static Image layers(std::initializer_list<const char*> names) {
    Image image(kWidth, kHeight);
    for (const char* name : names) {
      Plane& plane = image.add(name);
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) plane.at(x, y) = added(x, y) + float(image.planes.size());
    }
    return image;
  }

  void merge(const Image& image, bool half = false) {
    const auto header = read_header(in());
    ASSERT_TRUE(header) << header.error().message;
    const auto status = write_merged(*header, image, half, out());
    ASSERT_TRUE(status) << status.error().message;
  }

  /// Expects that a channel of the copy has the same values as in the input.
  void expect_kept(const std::string& name) const {
    const Plane before = plane_of(in(), name), after = plane_of(out(), name);
    ASSERT_EQ(before.width, after.width) << name;
    for (int y = 0; y < before.height; ++y)
      for (int x = 0; x < before.width; ++x) {
        const float a = before.at(x, y), b = after.at(x, y);
        ASSERT_TRUE(a == b || (a != a && b != b)) << name << ": " << x << ", " << y << ": " << a << ", " << b;
      }
  }

  /// Expects the values of the `number`th new plane (from 1) where the data window has pixels.
  void expect_added(const std::string& name, int number, const Imath::Box2i& window) const {
    const Plane plane = plane_of(out(), name);
    ASSERT_EQ(plane.width, kWidth) << name;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        if (window.intersects(Imath::V2i(x, y))) {
          ASSERT_EQ(plane.at(x, y), added(x, y) + float(number)) << name << ": " << x << ", " << y;
        }
  }

  static Plane plane_of(const fs::path& file, const std::string& name) {
    const auto header = read_header(file);
    if (!header) return {};
    for (const Channel& channel : header->channels)
      if (channel.full_name() == name) {
        auto image = read_channels(*header, std::vector<int>{channel.index});
        EXPECT_TRUE(image) << image.error().message;
        return image ? std::move(image->planes[0]) : Plane();
      }
    ADD_FAILURE() << "no channel " << name;
    return {};
  }
};

TEST_F(ExrMerge, LosslessChannelsTypesAndAttributesAreKept) {
  for (const Imf::Compression compression :
       {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION})
    for (const Imf::LineOrder order : {Imf::INCREASING_Y, Imf::DECREASING_Y}) {
      TestPart part{box(-3, 5, kWidth + 9, kHeight + 250)};
      {
        Imf::Header header = part.header(compression);
        header.lineOrder() = order;
        header.insert("owner", Imf::StringAttribute("somebody"));
        Imf::OutputFile file(in().c_str(), header);
        file.setFrameBuffer(part.pixels());
        file.writePixels(part.window.max.y - part.window.min.y + 1);
      }
      merge(layers({"umbrage.ao", "umbrage.depth"}));
      const Imf::MultiPartInputFile file(out().c_str());
      ASSERT_EQ(file.parts(), 1);
      const Imf::Header& header = file.header(0);
      EXPECT_EQ(header.compression(), compression);
      EXPECT_EQ(header.lineOrder(), order);
      EXPECT_EQ(header.dataWindow(), part.window);
      EXPECT_EQ(header.findTypedAttribute<Imf::StringAttribute>("owner")->value(), "somebody");
      EXPECT_EQ(header.channels()["R"].type, Imf::HALF);
      EXPECT_EQ(header.channels()["Z"].type, Imf::FLOAT);
      EXPECT_EQ(header.channels()["id"].type, Imf::UINT);
      EXPECT_EQ(header.channels()["umbrage.ao"].type, Imf::FLOAT);
      for (const char* name : {"R", "Z", "id"}) expect_kept(name);
      expect_added("umbrage.ao", 1, part.window);
      expect_added("umbrage.depth.Z", 2, part.window);
    }
}

TEST_F(ExrMerge, HalfIsForLayersThatCanBeCoarse) {
  TestPart part{box(0, 0, kWidth - 1, kHeight - 1)};
  {
    Imf::OutputFile file(in().c_str(), part.header(Imf::ZIP_COMPRESSION));
    file.setFrameBuffer(part.pixels());
    file.writePixels(kHeight);
  }
  merge(layers({"umbrage.color.r", "umbrage.depth", "umbrage.object_id"}), true);
  const Imf::MultiPartInputFile file(out().c_str());
  EXPECT_EQ(file.header(0).channels()["umbrage.color.R"].type, Imf::HALF);
  EXPECT_EQ(file.header(0).channels()["umbrage.depth.Z"].type, Imf::FLOAT);
  EXPECT_EQ(file.header(0).channels()["umbrage.object_id"].type, Imf::FLOAT);
}

TEST_F(ExrMerge, ALayerThatIsThereIsReplaced) {
  TestPart part{box(0, 0, kWidth - 1, kHeight - 1), {"R", "old.R", "old.G", "olds.G", "Z"}};
  {
    Imf::OutputFile file(in().c_str(), part.header(Imf::ZIP_COMPRESSION));
    file.setFrameBuffer(part.pixels());
    file.writePixels(kHeight);
  }
  merge(layers({"old.r", "old.b"}));
  const Imf::MultiPartInputFile file(out().c_str());
  std::vector<std::string> names;
  for (auto it = file.header(0).channels().begin(); it != file.header(0).channels().end(); ++it)
    names.emplace_back(it.name());
  EXPECT_EQ(names, (std::vector<std::string>{"R", "Z", "old.B", "old.R", "olds.G"}));
  expect_added("old.R", 1, part.window);
  expect_added("old.B", 2, part.window);
  expect_kept("R");
  expect_kept("olds.G");
  // A second merge into the file itself gives the same names.
  fs::rename(out(), in());
  const auto header = read_header(in());
  ASSERT_TRUE(header);
  ASSERT_TRUE(write_merged(*header, layers({"old.r", "old.b"}), false, in()));
  EXPECT_EQ(read_header(in())->channels.size(), 5u);
}

TEST_F(ExrMerge, TilesAndLevelsAreKept) {
  for (const Imf::LevelMode mode : {Imf::ONE_LEVEL, Imf::MIPMAP_LEVELS, Imf::RIPMAP_LEVELS}) {
    TestPart part{box(0, 0, kWidth - 1, kHeight - 1)};
    {
      Imf::Header header = part.header(Imf::PIZ_COMPRESSION);
      header.setTileDescription(Imf::TileDescription(16, 8, mode));
      header.setType(Imf::TILEDIMAGE);
      header.setName("tiles");
      Imf::MultiPartOutputFile file(in().c_str(), &header, 1);
      Imf::TiledOutputPart tiles(file, 0);
      tiles.setFrameBuffer(part.pixels());
      for (int ly = 0; ly < tiles.numYLevels(); ++ly)
        for (int lx = 0; lx < tiles.numXLevels(); ++lx)
          if (tiles.isValidLevel(lx, ly))
            tiles.writeTiles(0, tiles.numXTiles(lx) - 1, 0, tiles.numYTiles(ly) - 1, lx, ly);
    }
    merge(layers({"umbrage.ao"}));
    for (const char* name : {"R", "Z", "id"}) expect_kept(name);
    expect_added("umbrage.ao", 1, part.window);
    Imf::MultiPartInputFile file(out().c_str());
    EXPECT_EQ(file.header(0).tileDescription().mode, mode);
    EXPECT_EQ(file.header(0).tileDescription().ySize, 8u);
    if (mode == Imf::ONE_LEVEL) continue;
    // In the level of half the size, pixel (x, y) has its centre in pixel (2 x + 1, 2 y + 1).
    Imf::TiledInputPart tiles(file, 0);
    std::vector<float> level(std::size_t(kWidth / 2 * kHeight / 2));
    Imf::FrameBuffer pixels;
    pixels.insert("umbrage.ao", Imf::Slice::Make(Imf::FLOAT, level.data(), box(0, 0, kWidth / 2 - 1, kHeight / 2 - 1)));
    tiles.setFrameBuffer(pixels);
    tiles.readTiles(0, tiles.numXTiles(1) - 1, 0, tiles.numYTiles(1) - 1, 1, 1);
    EXPECT_EQ(level[std::size_t(3 * kWidth / 2 + 5)], added(11, 7) + 1);
  }
}

TEST_F(ExrMerge, PartsViewsAndDeepDataAreKept) {
  TestPart depth{box(2, 3, 20, 30), {"Z"}}, beauty{box(0, 0, kWidth - 1, kHeight - 1), {"R", "G"}};
  const Imath::Box2i display = box(0, 0, kWidth - 1, kHeight - 1);
  const std::vector<float> values = {1, 2, 3};
  std::vector<std::uint32_t> counts(kWidth * kHeight, 0);
  std::vector<const float*> pointers(kWidth * kHeight, values.data());
  counts[5] = 3;
  {
    std::vector<Imf::Header> headers = {depth.header(Imf::ZIP_COMPRESSION), beauty.header(Imf::B44_COMPRESSION),
                                        Imf::Header(display, display)};
    const char *names[] = {"depth", "beauty", "deep"}, *views[] = {"left", "left", "right"};
    for (int p = 0; p < 3; ++p) {
      headers[p].setName(names[p]);
      headers[p].setView(views[p]);
      headers[p].setType(p == 2 ? Imf::DEEPSCANLINE : Imf::SCANLINEIMAGE);
    }
    headers[2].channels().insert("Z", Imf::Channel(Imf::FLOAT));
    headers[2].compression() = Imf::ZIPS_COMPRESSION;
    Imf::MultiPartOutputFile file(in().c_str(), headers.data(), 3);
    for (auto* part : {&depth, &beauty}) {
      Imf::OutputPart out(file, part == &beauty);
      out.setFrameBuffer(part->pixels());
      out.writePixels(part->window.max.y - part->window.min.y + 1);
    }
    Imf::DeepScanLineOutputPart deep(file, 2);
    Imf::DeepFrameBuffer buffer;
    buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()), 4, 4 * kWidth));
    buffer.insert("Z", Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(pointers.data()), sizeof(void*),
                                      sizeof(void*) * kWidth, 4));
    deep.setFrameBuffer(buffer);
    deep.writePixels(kHeight);
  }
  merge(layers({"umbrage.ao"}));
  const auto header = read_header(out());
  ASSERT_TRUE(header);
  std::vector<std::string> names;
  for (const Channel& channel : header->channels) names.push_back(channel.full_name() + "/" + channel.view);
  EXPECT_EQ(names, (std::vector<std::string>{"depth.Z/left", "beauty.G/left", "beauty.R/left", "deep.Z/right",
                                             "umbrage.ao/"}));
  EXPECT_TRUE(header->is_deep);
  expect_kept("depth.Z");
  expect_kept("deep.Z");
  expect_kept("beauty.R");
  expect_added("umbrage.ao", 1, beauty.window);
  // A second merge replaces the layer, in the part of the first.
  fs::rename(out(), in());
  merge(layers({"umbrage.depth", "umbrage.ao"}));
  EXPECT_EQ(read_header(out())->channels.size(), 6u);
  expect_added("umbrage.ao", 2, beauty.window);
}

TEST_F(ExrMerge, DeepFilesGetAPartForLayers) {
  std::vector<std::uint32_t> counts(kWidth * kHeight, 0);
  std::vector<const float*> pointers(kWidth * kHeight, nullptr);
  {
    Imf::Header header(kWidth, kHeight);
    header.setType(Imf::DEEPSCANLINE);
    header.compression() = Imf::ZIPS_COMPRESSION;
    header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
    Imf::MultiPartOutputFile file(in().c_str(), &header, 1);
    Imf::DeepScanLineOutputPart deep(file, 0);
    Imf::DeepFrameBuffer buffer;
    buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()), 4, 4 * kWidth));
    buffer.insert("Z", Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(pointers.data()), sizeof(void*),
                                      sizeof(void*) * kWidth, 4));
    deep.setFrameBuffer(buffer);
    deep.writePixels(kHeight);
  }
  merge(layers({"ao"}));
  expect_added("umbrage.ao", 1, box(0, 0, kWidth - 1, kHeight - 1));
  const Imf::MultiPartInputFile file(out().c_str());
  ASSERT_EQ(file.parts(), 2);
  EXPECT_EQ(file.header(0).type(), Imf::DEEPSCANLINE);
}

TEST_F(ExrMerge, ErrorsLeaveTheOldFile) {
  TestPart part{box(0, 0, kWidth - 1, kHeight - 1)};
  {
    Imf::OutputFile file(in().c_str(), part.header(Imf::ZIP_COMPRESSION));
    file.setFrameBuffer(part.pixels());
    file.writePixels(kHeight);
  }
  const auto header = read_header(in());
  ASSERT_TRUE(header);
  const auto refused = [&](const LayeredFile& from, const Image& image, const fs::path& to, std::string_view words) {
    const auto status = write_merged(from, image, false, to);
    ASSERT_FALSE(status) << words;
    EXPECT_EQ(status.error().kind, ErrorKind::kFile);
    EXPECT_NE(status.error().message.find(words), std::string::npos) << status.error().message;
  };
  Image other(3, 3);
  other.add("ao");
  refused(*header, other, out(), "both must be equal");
  refused(*header, layers({"a.r", "a.R"}), out(), "twice");
  refused(*header, layers({"ao"}), folder / "none" / "x.exr", "does not exist");
  refused(*header, layers({"ao"}), "/dev/full", "No space left");
  LayeredFile png = *header;
  png.format = "PNG";
  refused(png, layers({"ao"}), out(), "only be added to an EXR file");
  // Pixels that are missing are found while the copy is written.
  const auto size = fs::file_size(in());
  fs::resize_file(in(), size - 100);
  write("out.exr", "old");
  refused(*header, layers({"ao"}), out(), "in.exr");
  EXPECT_EQ(fs::file_size(out()), 3u);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 2);
}

}  // namespace
}  // namespace umbrage
