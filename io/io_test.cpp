// Image files: written images are read back unchanged, no partial files remain, and bad files give an error.
#include <ImfArray.h>
#include <ImfChannelList.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfFrameBuffer.h>
#include <ImfInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>
#include <png.h>
#include <sys/resource.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>
#include <thread>

#include "io/format.h"
#include "io/image_file.h"

namespace umbrage {
namespace {
namespace fs = std::filesystem;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr std::pair<int, int> kSizes[] = {{1, 1}, {3, 2}, {17, 5}, {191, 347}};

/// A separate folder for each test.
class Files : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "umbrage_io_XXXXXX").string();
    ASSERT_TRUE(::mkdtemp(name.data()));
    folder = name;
    fs::permissions(folder, fs::perms(0755));  // readable by other users, for the test of permissions
  }
  void TearDown() override { fs::remove_all(folder); }

  fs::path operator/(std::string_view name) const { return folder / name; }

  std::vector<std::string> listing() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  }

  fs::path folder;
};

using ImageFile = Files;
using PngFile = Files;
using ExrFile = Files;
using PfmFile = Files;
using AtomicWrite = Files;

std::string content(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_bytes(const fs::path& file, std::string_view bytes) {
  std::ofstream(file, std::ios::binary).write(bytes.data(), std::streamsize(bytes.size()));
}

/// Returns random planes with values in [low, high]. The padding after the end of each row is NaN, to detect code that
/// reads it.
Image random_image(int width, int height, std::initializer_list<const char*> names, float low = 0.0f,
                   float high = 1.0f) {
  Image image(width, height);
  std::mt19937 random(7);
  std::uniform_real_distribution<float> value(low, high);
  for (const char* name : names) {
    Plane& plane = image.add(name);
    std::fill_n(plane.data(), std::size_t(plane.stride) * height, kNan);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) plane.at(x, y) = value(random);
  }
  return image;
}

Image read_or_fail(const fs::path& file) {
  Result<Image> image = read_image(file);
  EXPECT_TRUE(image) << image.error().message;
  return image ? std::move(*image) : Image();
}

/// Returns the maximum difference of a plane of `image` from `expected`; infinity if the plane is missing.
float difference(const Image& image, const std::string& name, const Plane& expected) {
  const Plane* plane = image.find(name);
  if (!plane || plane->width != expected.width || plane->height != expected.height) return kInfinity;
  float max_error = 0.0f;
  for (int y = 0; y < expected.height; ++y)
    for (int x = 0; x < expected.width; ++x) {
      const float error = std::abs(plane->at(x, y) - expected.at(x, y));
      max_error = error <= max_error ? max_error : error;
    }
  return max_error;
}

/// Expects that all planes are bitwise identical, NaN included.
void expect_same(const Image& actual, const Image& expected) {
  ASSERT_EQ(actual.width, expected.width);
  ASSERT_EQ(actual.height, expected.height);
  ASSERT_EQ(actual.planes.size(), expected.planes.size());
  for (const std::string& name : expected.names) {
    const Plane* plane = actual.find(name);
    ASSERT_TRUE(plane) << name;
    for (int y = 0; y < expected.height; ++y)
      ASSERT_EQ(0, std::memcmp(plane->row(y), expected.plane(name).row(y), expected.width * sizeof(float)))
          << name << ", row " << y;
  }
}

/// Expects a kFile error with a message that contains all of `words`.
template <class T>
void expect_error(const Result<T>& result, std::initializer_list<std::string_view> words,
                  ErrorKind kind = ErrorKind::kFile) {
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().kind, kind);
  for (std::string_view word : words)
    EXPECT_NE(result.error().message.find(word), std::string::npos)
        << "'" << word << "' is missing in: " << result.error().message;
  EXPECT_EQ(result.error().message.find('\n'), std::string::npos) << result.error().message;
}

// --- Choice of the format -------------------------------------------------------------------------------------------

TEST_F(ImageFile, ExtensionsSelectFormats) {
  for (const ImageFormat& format : image_formats()) {
    const Result<const ImageFormat*> found = format_of("a.b/picture." + std::string(format.extension));
    ASSERT_TRUE(found);
    EXPECT_EQ((*found)->extension, format.extension);
    EXPECT_FALSE(format.summary.empty());
  }
  EXPECT_EQ(image_formats().size(), 6u);
  ASSERT_TRUE(format_of("PICTURE.PNG"));
  EXPECT_EQ((*format_of("PICTURE.PNG"))->extension, "png");
}

TEST_F(ImageFile, ExrHeadersThatClaimTooMuchAreRejected) {
  const fs::path file = *this / "a.exr";
  Image image(4, 4);
  image.add("depth");
  ASSERT_TRUE(write_image(file, image));
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  const std::string sound = text.str();
  const auto expect_refused = [&](const std::string& bytes, std::string_view reason) {
    std::ofstream(file, std::ios::binary) << bytes;
    expect_error(read_image(file), {"a.exr", reason});
  };
  const auto with = [&](const std::string& before, std::size_t after, std::uint32_t number) {
    std::string bytes = sound;
    const std::size_t at = bytes.find(before) + before.size() + after;
    for (int i = 0; i < 4; ++i) bytes[at + std::size_t(i)] = char(number >> (8 * i));
    return bytes;
  };
  const std::string window("Window\0box2i\0\x10\0\0\0", 17), text_kind("software\0string\0", 16);
  expect_refused(with(text_kind, 0, 0x70000000u), "its header is cut short or damaged");
  std::string large = with("data" + window, 8, 65535);
  const std::size_t at = large.find("display" + window) + 7 + window.size() + 8;
  for (int i = 0; i < 2; ++i) large[at + std::size_t(i)] = '\xff';
  expect_refused(large, "cut short");
  std::string frame = sound;
  for (const std::size_t side : {0u, 4u})
    for (std::size_t i = 0; i < 2; ++i) frame[at + side + i] = side == 4 && i == 1 ? '\x0f' : '\xff';
  expect_refused(frame, "a frame of 65536 x 4096 pixels in its header, but data for too few");
}

TEST_F(ImageFile, ExrHeadersOfHugeWindowsAreRefusedBeforeTheLibrarySeesThem) {
  const fs::path file = *this / "a.exr";
  for (const bool data : {true, false}) {
    Imf::Header header(8, 8);
    (data ? header.dataWindow() : header.displayWindow()).max.x = 65536;
    header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
    { const Imf::OutputFile empty(file.c_str(), header); }
    expect_error(read_image(file), {"a.exr", "larger than 65536 pixels per side"});
  }
}

// The library's number of threads and its limits apply to the whole process. The host sets them for its own files.
TEST_F(ImageFile, ExrLeavesTheLibrarysSettingsAlone) {
  for (const int threads : {0, 3}) {
    Imf::setGlobalThreadCount(threads);
    const fs::path file = *this / "a.exr";
    const Image image = random_image(300, 700, {"a", "b"});
    for (const int own : {0, 1, 2, 5}) {
      ASSERT_TRUE(write_image(file, image, {.threads = own}));
      const auto read_back = read_image(file);
      ASSERT_TRUE(read_back);
      for (std::size_t p = 0; p < 2; ++p)
        for (int y = 0; y < image.height; ++y)
          ASSERT_TRUE(
              std::equal(image.planes[p].row(y), image.planes[p].row(y) + image.width, read_back->planes[p].row(y)));
    }
    EXPECT_EQ(Imf::globalThreadCount(), threads);
  }
  Imf::setGlobalThreadCount(0);
  Imf::Header wide(100000, 1);
  wide.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  EXPECT_NO_THROW(wide.sanityCheck()) << "a size that umbrage rejects and the host may use";
}

TEST_F(ImageFile, ExrFilesDoNotDependOnThreadsOrRowGroups) {
  const auto bytes_of = [&](const fs::path& file) {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
  };
  for (const int height : {1, 15, 16, 17, 100}) {
    const Image image = random_image(37, height, {"a", "depth", "color.r"});
    for (const bool half : {false, true}) {
      ASSERT_TRUE(write_image(*this / "whole.exr", image, {.half = half, .threads = 1}));
      const std::string whole = bytes_of(*this / "whole.exr");
      // Let the library write a file of the complete picture.
      Imf::Header header = Imf::InputFile((*this / "whole.exr").c_str()).header();
      header.zipCompressionLevel() = 1;
      {
        Imf::OutputFile output((*this / "theirs.exr").c_str(), header);
        Imf::FrameBuffer pixels;
        std::vector<std::vector<Imath::half>> halves(image.planes.size());
        for (std::size_t p = 0; p < image.planes.size(); ++p) {
          const Plane& plane = image.planes[p];
          const std::string channel = std::vector<std::string>{"a", "depth.Z", "R"}[p];
          for (int y = 0; y < height; ++y) halves[p].insert(halves[p].end(), plane.row(y), plane.row(y) + plane.width);
          const bool is_half = half && p != 1;
          const void* start = is_half ? static_cast<const void*>(halves[p].data()) : plane.data();
          const std::size_t size = is_half ? 2 : 4;
          pixels.insert(channel, Imf::Slice::Make(is_half ? Imf::HALF : Imf::FLOAT, start, {0, 0}, plane.width, height,
                                                  size, size * std::size_t(is_half ? plane.width : plane.stride)));
        }
        output.setFrameBuffer(pixels);
        output.writePixels(height);
      }
      EXPECT_TRUE(whole == bytes_of(*this / "theirs.exr")) << height << (half ? " half" : "");
      for (const int piece : {1, 7, 16, 50}) {
        const MakeImageRows make = [&](const TakeImageRows& take) -> Result<void> {
          for (int y = 0; y < height; y += piece) {
            Image rows(image.width, std::min(piece, height - y));
            for (std::size_t p = 0; p < image.planes.size(); ++p)
              for (int j = 0; j < rows.height; ++j)
                std::copy_n(image.planes[p].row(y + j), image.width, rows.add(image.names[p]).row(j));
            if (auto taken = take(rows); !taken) return taken;
          }
          return {};
        };
        const ImageShape shape{image.width, height, image.names};
        ASSERT_TRUE(write_image_rows(*this / "pieces.exr", shape, {.half = half, .threads = 3}, make));
        EXPECT_TRUE(whole == bytes_of(*this / "pieces.exr")) << height << " in pieces of " << piece;
      }
    }
  }
}

TEST_F(ImageFile, UnknownExtensionListsAll) {
  expect_error(format_of("out.bmp"), {"'out.bmp'", ".bmp", ".png, .exr, .pfm, .jpg, .jpeg or .webp"},
               ErrorKind::kUsage);
  expect_error(format_of("out.pngg"), {"did you mean 'png'?", ".jpeg or .webp"}, ErrorKind::kUsage);
  expect_error(format_of("out"), {"'out'", "does not end in an image extension", ".jpeg or .webp"}, ErrorKind::kUsage);
  expect_error(format_of(""), {".jpeg or .webp"}, ErrorKind::kUsage);
  expect_error(write_image(*this / "x.bmp", random_image(2, 2, {"a"})), {"x.bmp", ".jpeg or .webp"}, ErrorKind::kUsage);
  EXPECT_TRUE(listing().empty());
}

TEST_F(ImageFile, ContentDecidesOnReading) {
  const Image image = random_image(3, 2, {"color.r", "color.g", "color.b"});
  ASSERT_TRUE(write_image(*this / "x.pfm", image));
  fs::rename(*this / "x.pfm", *this / "x.png");
  expect_same(read_or_fail(*this / "x.png"), image);
}

TEST_F(ImageFile, UnreadableFilesAreNamed) {
  expect_error(read_image(*this / "none.png"), {"none.png", "does not exist"});
  expect_error(read_image(folder), {folder.string(), "is a folder"});
  expect_error(read_image("/dev/null"), {"/dev/null", "device"});
  write_bytes(*this / "empty.exr", "");
  expect_error(read_image(*this / "empty.exr"), {"empty.exr", "is empty"});
  write_bytes(*this / "text.png", "This is no picture at all.");
  expect_error(read_image(*this / "text.png"), {"text.png", "not an image", ".png, .exr or .pfm"});
  for (const ImageFormat& format : image_formats())
    if (format.read) expect_error(format.read(*this / "text.png"), {"text.png"});
}

TEST_F(ImageFile, TruncatedFilesAreErrors) {
  const Image image = random_image(64, 48, {"color.r", "color.g", "color.b"});
  for (const ImageFormat& format : image_formats()) {
    const fs::path file = *this / ("x." + std::string(format.extension));
    ASSERT_TRUE(write_image(file, image));
    if (!format.read) continue;
    const std::string whole = content(file);
    for (int part = 0; part < 16; ++part) {
      write_bytes(file, std::string_view(whole).substr(0, whole.size() * part / 16));
      expect_error(read_image(file), {file.string()});
      expect_error(format.read(file), {file.string()});
    }
  }
}

TEST_F(ImageFile, DamagedFilesDoNotCrash) {
  const Image image = random_image(9, 7, {"color.r", "color.g", "color.b"});
  std::mt19937 random(1);
  for (const ImageFormat& format : image_formats()) {
    const fs::path file = *this / ("x." + std::string(format.extension));
    ASSERT_TRUE(write_image(file, image));
    if (!format.read) continue;
    const std::string whole = content(file);
    int errors = 0;
    for (int i = 0; i < 400; ++i) {
      std::string bytes = whole;
      // Change mostly the header, where a byte has the largest effect.
      const std::size_t range = i % 4 ? std::min<std::size_t>(whole.size(), 400) : whole.size();
      for (int k = i % 3; k >= 0; --k) bytes[random() % range] = char(random());
      write_bytes(file, bytes);
      const Result<Image> result = format.read(file);
      if (result) continue;
      ++errors;
      ASSERT_EQ(result.error().kind, ErrorKind::kFile);
    }
    EXPECT_GT(errors, 0) << format.extension;
  }
}

TEST_F(ImageFile, PicturesNeedColourOrOnePlane) {
  const Image buffers = random_image(4, 4, {"depth", "normal.x", "color.r"});
  for (const char* name : {"x.png", "x.pfm"}) {
    expect_error(write_image(*this / name, buffers), {name, "color.r, color.g and color.b", "depth, normal.x", ".exr"});
    expect_error(write_image(*this / name, Image(4, 4)), {name, "has none"});
    expect_error(write_image(*this / name, random_image(0, 0, {"a"})), {name, "0 x 0"});
  }
  expect_error(write_image(*this / "x.exr", Image(4, 4)), {"x.exr", "0 planes"});
  expect_error(write_image(*this / "x.exr", random_image(0, 3, {"a"})), {"x.exr", "0 x 3"});
  EXPECT_TRUE(listing().empty());
}

// --- PNG ------------------------------------------------------------------------------------------------------------

TEST_F(PngFile, RoundTripsWithinHalfAStep) {
  for (auto [width, height] : kSizes)
    for (int bits : {8, 16})
      for (int channels : {1, 3, 4}) {
        Image image = channels == 1   ? random_image(width, height, {"ao"})
                      : channels == 3 ? random_image(width, height, {"color.r", "color.g", "color.b"})
                                      : random_image(width, height, {"color.b", "color.a", "color.r", "color.g"});
        ASSERT_TRUE(write_image(*this / "x.png", image, {.bits = bits}));
        const Image read_back = read_or_fail(*this / "x.png");
        EXPECT_EQ(int(read_back.planes.size()), channels);
        const float step = bits == 8 ? 1.0f / 255 : 1.0f / 65535;
        for (const std::string& name : image.names)
          EXPECT_LE(difference(read_back, channels == 1 ? "grey" : name, image.plane(name)), 0.5001f * step)
              << width << " x " << height << ", " << bits << " bits, " << name;
        // An image that was read does not change when it is written and read again.
        ASSERT_TRUE(write_image(*this / "y.png", read_back, {.bits = bits}));
        expect_same(read_or_fail(*this / "y.png"), read_back);
      }
}

TEST_F(PngFile, ClampsAndTakesNanAsBlack) {
  Image image(6, 1);
  const float values[] = {-1.0f, kNan, kInfinity, -kInfinity, 1.5f, 0.5f};
  std::copy_n(values, 6, image.add("x").row(0));
  for (int bits : {8, 16}) {
    ASSERT_TRUE(write_image(*this / "x.png", image, {.bits = bits}));
    const Image read_back = read_or_fail(*this / "x.png");
    const float half = bits == 8 ? 128.0f / 255 : 32768.0f / 65535;
    const float expected[] = {0, 0, 1, 0, 1, half};
    for (int x = 0; x < 6; ++x) EXPECT_EQ(read_back.plane("grey").at(x, 0), expected[x]) << "pixel " << x;
  }
}

TEST_F(PngFile, OnlyColourIsMarkedSrgb) {
  ASSERT_TRUE(write_image(*this / "c.png", random_image(2, 2, {"color.r", "color.g", "color.b"})));
  ASSERT_TRUE(write_image(*this / "g.png", random_image(2, 2, {"depth"})));
  EXPECT_NE(content(*this / "c.png").find("sRGB"), std::string::npos);
  EXPECT_EQ(content(*this / "g.png").find("sRGB"), std::string::npos);
}

TEST_F(PngFile, OtherPlanesAndColoursOrderDoNotMatter) {
  const Image image = random_image(5, 4, {"depth", "color.b", "ao", "color.g", "color.r"});
  ASSERT_TRUE(write_image(*this / "x.png", image, {.bits = 16}));
  const Image read_back = read_or_fail(*this / "x.png");
  EXPECT_EQ(read_back.names, (std::vector<std::string>{"color.r", "color.g", "color.b"}));
  EXPECT_LE(difference(read_back, "color.b", image.plane("color.b")), 1.0f / 65535);
}

TEST_F(PngFile, RefusesOtherDepths) {
  expect_error(write_image(*this / "x.png", random_image(2, 2, {"a"}), {.bits = 12}), {"x.png", "12", "8 or 16"});
}

/// Writes a PNG file of rows of raw bytes. The header can be any that PNG allows.
void write_png(const fs::path& file, int width, int height, int bits, int type, int interlace,
               const std::vector<std::vector<png_byte>>& rows, const std::vector<png_color>& palette = {},
               const std::vector<png_byte>& transparency = {}) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  std::FILE* out = std::fopen(file.c_str(), "wb");
  ASSERT_TRUE(out);
  png_init_io(png, out);
  png_set_IHDR(png, info, width, height, bits, type, interlace, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (!palette.empty()) png_set_PLTE(png, info, palette.data(), int(palette.size()));
  if (!transparency.empty()) png_set_tRNS(png, info, transparency.data(), int(transparency.size()), nullptr);
  png_write_info(png, info);
  std::vector<png_bytep> pointers;
  for (const auto& row : rows) pointers.push_back(const_cast<png_bytep>(row.data()));
  png_write_image(png, pointers.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  std::fclose(out);
}

TEST_F(PngFile, ReadsAllColourTypes) {
  const float x = 0x33 / 255.0f;
  write_png(*this / "p.png", 2, 1, 8, PNG_COLOR_TYPE_PALETTE, PNG_INTERLACE_NONE, {{1, 0}},
            {{0, 0, 0}, {255, 0, 0x33}});
  Image image = read_or_fail(*this / "p.png");
  EXPECT_EQ(image.planes.size(), 3u);
  EXPECT_EQ(image.plane("color.r").at(0, 0), 1.0f);
  EXPECT_EQ(image.plane("color.b").at(0, 0), x);
  EXPECT_EQ(image.plane("color.r").at(1, 0), 0.0f);

  write_png(*this / "t.png", 2, 1, 8, PNG_COLOR_TYPE_PALETTE, PNG_INTERLACE_NONE, {{1, 0}}, {{0, 0, 0}, {255, 0, 0}},
            {0x33, 255});
  image = read_or_fail(*this / "t.png");
  EXPECT_EQ(image.planes.size(), 4u);
  EXPECT_EQ(image.plane("color.a").at(1, 0), x);

  write_png(*this / "g1.png", 3, 1, 1, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, {{0b10100000}});
  image = read_or_fail(*this / "g1.png");
  EXPECT_EQ(image.plane("grey").at(0, 0), 1.0f);
  EXPECT_EQ(image.plane("grey").at(1, 0), 0.0f);
  write_png(*this / "g4.png", 2, 1, 4, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, {{0x3f}});
  EXPECT_EQ(read_or_fail(*this / "g4.png").plane("grey").at(0, 0), x);

  write_png(*this / "ga.png", 1, 1, 8, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_INTERLACE_NONE, {{0x33, 0xff}});
  image = read_or_fail(*this / "ga.png");
  EXPECT_EQ(image.planes.size(), 4u);
  EXPECT_EQ(image.plane("color.g").at(0, 0), x);
  EXPECT_EQ(image.plane("color.a").at(0, 0), 1.0f);

  write_png(*this / "w.png", 1, 1, 16, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, {{0x12, 0x34, 0xff, 0xff, 0, 1}});
  image = read_or_fail(*this / "w.png");
  EXPECT_EQ(image.plane("color.r").at(0, 0), 0x1234 / 65535.0f);
  EXPECT_EQ(image.plane("color.g").at(0, 0), 1.0f);
  EXPECT_EQ(image.plane("color.b").at(0, 0), 1 / 65535.0f);

  std::vector<std::vector<png_byte>> rows(9, std::vector<png_byte>(11));
  for (int y = 0; y < 9; ++y)
    for (int i = 0; i < 11; ++i) rows[y][i] = png_byte(y * 20 + i);
  write_png(*this / "i.png", 11, 9, 8, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_ADAM7, rows);
  image = read_or_fail(*this / "i.png");
  for (int y = 0; y < 9; ++y)
    for (int i = 0; i < 11; ++i) ASSERT_EQ(image.plane("grey").at(i, y), float(y * 20 + i) / 255) << i << ", " << y;
}

/// Returns a PNG file of one white pixel with another size in its header.
std::string png_of_size(const fs::path& file, std::uint32_t width, std::uint32_t height) {
  write_png(file, 1, 1, 8, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, {{255}});
  std::string bytes = content(file);
  constexpr std::size_t kHeader = 12, kLength = 17;  // "IHDR" and its 13 bytes of data
  for (int i = 0; i < 4; ++i) {
    bytes[kHeader + 4 + i] = char(width >> (24 - 8 * i));
    bytes[kHeader + 8 + i] = char(height >> (24 - 8 * i));
  }
  const auto sum = std::uint32_t(crc32(0, reinterpret_cast<const Bytef*>(bytes.data() + kHeader), kLength));
  for (int i = 0; i < 4; ++i) bytes[kHeader + kLength + i] = char(sum >> (24 - 8 * i));
  return bytes;
}

TEST_F(PngFile, RefusesHostileSizes) {
  const fs::path file = *this / "x.png";
  write_bytes(file, png_of_size(file, 0x7fffffff, 0x7fffffff));
  expect_error(read_image(file), {"x.png", "2147483647 x 2147483647", "65536"});
  write_bytes(file, png_of_size(file, 65536, 65536));
  expect_error(read_image(file), {"cut short", "65536 x 65536"});
  write_bytes(file, png_of_size(file, 16384, 16384));
  expect_error(read_image(file), {"cut short", "16384 x 16384"});
  write_bytes(file, png_of_size(file, 0, 5));
  expect_error(read_image(file), {"x.png"});
}

TEST_F(PngFile, EncodesSmoothShadingSmallAndFast) {
  constexpr int kSize = 1024;
  Image image(kSize, kSize);
  for (const char* name : {"color.r", "color.g", "color.b"}) {
    Plane& plane = image.add(name);
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const float u = (float(x) - 512) / 450, v = (float(y) - 512) / 450, r2 = u * u + v * v;
        const float light = 0.4f * u - 0.5f * v + 0.75f * std::sqrt(std::max(0.0f, 1 - r2));
        plane.at(x, y) = r2 < 1 ? std::pow(0.2f + 0.8f * std::max(0.0f, light), 1 / 2.2f) : 0.95f;
      }
  }
  std::vector<double> times;
  for (int i = 0; i < 5; ++i) {
    const auto start = std::chrono::steady_clock::now();
    ASSERT_TRUE(write_image(*this / "x.png", image));
    times.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  std::sort(times.begin(), times.end());
  const auto size = fs::file_size(*this / "x.png");
  std::printf("write_image, 1024 x 1024 RGB, 8 bit: median %.1f ms, %zu kB\n", times[2], std::size_t(size / 1000));
  EXPECT_LT(size, 400'000u);
  EXPECT_LT(times[2], 500.0);  // a generous limit: a typical machine takes 25 ms
}

// --- PFM ------------------------------------------------------------------------------------------------------------

TEST_F(PfmFile, RoundTripsExactly) {
  for (auto [width, height] : kSizes) {
    Image grey = random_image(width, height, {"grey"}, -1e6f, 1e6f);
    grey.plane("grey").at(0, 0) = kInfinity;
    grey.plane("grey").at(width - 1, height - 1) = kNan;
    ASSERT_TRUE(write_image(*this / "x.pfm", grey));
    expect_same(read_or_fail(*this / "x.pfm"), grey);
    const Image colour = random_image(width, height, {"color.r", "color.g", "color.b"}, -10, 10);
    ASSERT_TRUE(write_image(*this / "x.pfm", colour));
    expect_same(read_or_fail(*this / "x.pfm"), colour);
  }
}

TEST_F(PfmFile, BottomRowFirstLittleEndian) {
  Image image(1, 2);
  image.add("a").at(0, 0) = 1.0f;
  image.plane("a").at(0, 1) = 2.0f;
  ASSERT_TRUE(write_image(*this / "x.pfm", image));
  EXPECT_EQ(content(*this / "x.pfm"), std::string("Pf\n1 2\n-1.0\n\0\0\0\x40\0\0\x80\x3f", 20));
}

TEST_F(PfmFile, ReadsBigEndianAndAnyScale) {
  write_bytes(*this / "x.pfm", std::string("PF 1\t1\r2.5\n\x3f\x80\0\0\x40\0\0\0\xc0\0\0\0", 23));
  const Image image = read_or_fail(*this / "x.pfm");
  EXPECT_EQ(image.plane("color.r").at(0, 0), 1.0f);
  EXPECT_EQ(image.plane("color.g").at(0, 0), 2.0f);
  EXPECT_EQ(image.plane("color.b").at(0, 0), -2.0f);
}

TEST_F(PfmFile, RefusesBadHeaders) {
  const auto read_with_header = [&](std::string_view header) {
    write_bytes(*this / "x.pfm", std::string(header) + std::string(64, '\0'));
    return read_image(*this / "x.pfm");
  };
  expect_error(read_with_header("Pf\n0 4\n-1\n"), {"x.pfm", "0 x 4"});
  expect_error(read_with_header("Pf\n-4 4\n-1\n"), {"-4 x 4"});
  expect_error(read_with_header("Pf\n70000 1\n-1\n"), {"70000 x 1"});
  expect_error(read_with_header("Pf\n65536 65536\n-1\n"), {"65536 x 65536"});
  expect_error(read_with_header("PF\n5000 5000\n-1\n"), {"cut short", "300000000 bytes", "has 64"});
  expect_error(read_with_header("Pf\nfour 4\n-1\n"), {"'four 4'", "two integers"});
  expect_error(read_with_header("Pf\n4.5 4\n-1\n"), {"'4.5 4'"});
  expect_error(read_with_header("Pf\nnan 1e400\n-1\n"), {"'nan 1e400'"});
  expect_error(read_with_header("Pf\n4 4\n0\n"), {"scale '0'"});
  expect_error(read_with_header("Pf\n4 4\ninf\n"), {"scale 'inf'"});
  expect_error(read_with_header("Pf\n4 4\nx\n"), {"scale 'x'"});
  expect_error(read_with_header("Pfx\n4 4\n-1\n"), {"PF or Pf"});
  expect_error(read_with_header("Pf\n" + std::string(1000, '9')), {"x.pfm"});
}

// --- OpenEXR --------------------------------------------------------------------------------------------------------

TEST_F(ExrFile, RoundTripsExactly) {
  for (auto [width, height] : kSizes) {
    Image image = random_image(width, height,
                               {"color.r", "color.g", "color.b", "color.a", "depth", "normal.x", "normal.y", "normal.z",
                                "albedo.r", "ao", "object_id", "layer.depth"},
                               -1e4f, 1e4f);
    image.plane("depth").at(0, 0) = kInfinity;
    image.plane("ao").at(width - 1, height - 1) = kNan;
    image.plane("albedo.r").at(0, 0) = -kInfinity;
    ASSERT_TRUE(write_image(*this / "x.exr", image));
    expect_same(read_or_fail(*this / "x.exr"), image);
  }
}

TEST_F(ExrFile, HalfIsCloseAndExcludesDepthAndIds) {
  for (auto [width, height] : kSizes) {
    Image image = random_image(width, height, {"color.r", "color.g", "color.b", "depth", "l1.depth", "object_id", "id"},
                               1e-4f, 65000.0f);
    image.plane("color.g").at(0, 0) = kInfinity;
    ASSERT_TRUE(write_image(*this / "x.exr", image, {.half = true}));
    const Image read_back = read_or_fail(*this / "x.exr");
    for (const char* name : {"color.r", "color.b"})
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          const float value = image.plane(name).at(x, y);
          ASSERT_NEAR(read_back.plane(name).at(x, y), value, value / 2048) << name;
        }
    EXPECT_EQ(read_back.plane("color.g").at(0, 0), kInfinity);
    for (const char* name : {"depth", "l1.depth", "object_id", "id"})
      EXPECT_EQ(difference(read_back, name, image.plane(name)), 0.0f) << name;
    const Imf::InputFile file((*this / "x.exr").c_str());
    EXPECT_EQ(file.header().channels()["R"].type, Imf::HALF);
    EXPECT_EQ(file.header().channels()["depth.Z"].type, Imf::FLOAT);
  }
}

TEST_F(ExrFile, ChannelNames) {
  const std::pair<const char*, const char*> names[] = {{"color.r", "R"},
                                                       {"color.g", "G"},
                                                       {"color.b", "B"},
                                                       {"color.a", "A"},
                                                       {"depth", "depth.Z"},
                                                       {"normal.x", "normal.X"},
                                                       {"ao", "ao"},
                                                       {"albedo.b", "albedo.B"},
                                                       {"object_id", "object_id"},
                                                       {"a.color.r", "a.color.R"},
                                                       {"uv.u", "uv.u"},
                                                       {"color.x", "color.X"},
                                                       {"layer1.depth", "layer1.depth.Z"},
                                                       {"layer15.depth", "layer15.depth.Z"},
                                                       {"layer1.normal.z", "layer1.normal.Z"},
                                                       {"layer2.albedo.r", "layer2.albedo.R"},
                                                       {"layer1.object_id", "layer1.object_id"},
                                                       {"unsharp_depth", "unsharp_depth"}};
  Image image(2, 1);
  for (auto [plane, channel] : names) image.planes.push_back(Plane(2, 1, 0.5f)), image.names.push_back(plane);
  ASSERT_TRUE(write_image(*this / "x.exr", image));
  const Imf::InputFile file((*this / "x.exr").c_str());
  for (auto [plane, channel] : names) EXPECT_TRUE(file.header().channels().findChannel(channel)) << channel;
  EXPECT_EQ(file.header().findTypedAttribute<Imf::StringAttribute>("software")->value(), "Umbrage");
  EXPECT_FALSE(Imf::hasWorldToCamera(file.header()));
  expect_same(read_or_fail(*this / "x.exr"), image);
}

TEST_F(ExrFile, RefusesNamesThatCollide) {
  expect_error(write_image(*this / "x.exr", random_image(2, 2, {"color.r", "R"})), {"x.exr", "'R'", "another plane"});
  expect_error(write_image(*this / "x.exr", random_image(2, 2, {"depth", "depth.z"})), {"'depth.z'", "'depth.Z'"});
  const std::string long_name(300, 'n');
  expect_error(write_image(*this / "x.exr", random_image(2, 2, {long_name.c_str()})), {"255"});
  expect_error(write_image(*this / "x.exr", random_image(2, 2, {""})), {"255"});
  EXPECT_TRUE(listing().empty());
}

/// A camera at (10, 0, 0) that looks along -x with +y up, so that right is -z; the window is off centre.
Camera sideways(Projection projection) {
  Camera camera = perspective_camera({10, 0, 0}, {0, 0, 0}, {0, 1, 0}, 50, 1);
  camera.projection = projection;
  camera.left = -1.0f, camera.right = 3.0f, camera.bottom = -0.5f, camera.top = 1.5f;
  return camera;
}

void expect_at(const Imath::V3f& point, float x, float y, float bound) {
  EXPECT_NEAR(point.x, x, bound);
  EXPECT_NEAR(point.y, y, bound);
}

/// Writes a picture with this camera. Returns the header of the file.
Imf::Header header_with_camera(const std::filesystem::path& path, const Camera& camera) {
  EXPECT_TRUE(write_image(path, random_image(8, 4, {"ao"}), {.camera = &camera}));
  return Imf::InputFile(path.c_str()).header();
}

TEST_F(ExrFile, PerspectiveCameraAttributes) {
  const Imf::Header header = header_with_camera(*this / "x.exr", sideways(Projection::kPerspective));
  const Imath::M44f to_camera = Imf::worldToCamera(header), to_ndc = Imf::worldToNDC(header);
  // A point 4 in front of the camera, 2 to the right and 1 up. At distance 1 it is at (0.5, 0.25) in a window of 4
  // by 2.
  const Imath::V3f point(6, 1, -2);
  const Imath::V3f in_camera = point * to_camera, ndc = point * to_ndc;
  expect_at(in_camera, 2, 1, 1e-5f);
  EXPECT_NEAR(in_camera.z, 4, 1e-5f);
  expect_at(ndc, 0.375f, 0.625f, 1e-6f);
  // The window's upper left corner, 5 in front of the camera: its x of -5 is z = 5 in the world, its y is 7.5.
  const Imath::V3f corner = Imath::V3f(5, 7.5f, 5) * to_ndc;
  expect_at(corner, 0, 0, 1e-6f);
  // The lower right corner, 2 in front of the camera: its x of 6 is z = -6 in the world, its y is -1.
  const Imath::V3f other = Imath::V3f(8, -1, -6) * to_ndc;
  expect_at(other, 1, 1, 1e-6f);
  EXPECT_GT(std::abs(to_ndc.determinant()), 1e-3f);
  EXPECT_EQ(header.screenWindowWidth(), 4.0f);
  EXPECT_EQ(header.screenWindowCenter(), Imath::V2f(1.0f, 0.5f));
}

TEST_F(ExrFile, OrthographicCameraAttributes) {
  const Imf::Header header = header_with_camera(*this / "x.exr", sideways(Projection::kOrthographic));
  const Imath::M44f to_camera = Imf::worldToCamera(header), to_ndc = Imf::worldToNDC(header);
  const Imath::V3f point(6, 1, -2);
  const Imath::V3f in_camera = point * to_camera, ndc = point * to_ndc;
  EXPECT_NEAR(in_camera.z, 4, 1e-5f);
  expect_at(ndc, 0.75f, 0.25f, 1e-6f);
  // A point at twice the distance has the same position.
  const Imath::V3f farther = Imath::V3f(2, 1, -2) * to_ndc;
  expect_at(farther, 0.75f, 0.25f, 1e-6f);
  EXPECT_GT(std::abs(to_ndc.determinant()), 1e-3f);
}

TEST_F(ExrFile, CameraRoundTrips) {
  for (const Projection projection : {Projection::kPerspective, Projection::kOrthographic}) {
    Camera camera = perspective_camera({120, -35, 7}, {-3, 8, 1}, {0, 0, 1}, 40, 1);
    camera.projection = projection;
    camera.left = -0.4f, camera.right = 0.7f, camera.bottom = -0.5f, camera.top = 0.3f;
    ASSERT_TRUE(write_image(*this / "x.exr", random_image(8, 4, {"ao"}), {.camera = &camera}));
    const Result<std::optional<Camera>> read_back = read_camera(*this / "x.exr");
    ASSERT_TRUE(read_back) << read_back.error().message;
    ASSERT_TRUE(*read_back);
    EXPECT_EQ((*read_back)->projection, projection);
    EXPECT_EQ((*read_back)->view_from_world, camera.view_from_world);
    EXPECT_NEAR((*read_back)->left, camera.left, 2e-5f);
    EXPECT_NEAR((*read_back)->right, camera.right, 2e-5f);
    EXPECT_NEAR((*read_back)->bottom, camera.bottom, 2e-5f);
    EXPECT_NEAR((*read_back)->top, camera.top, 2e-5f);
  }
}

TEST_F(ExrFile, CameraFarFromTheOriginRoundTrips) {
  Camera camera = perspective_camera({1e5f, -2e5f, 3e4f}, {1e5f + 1, -2e5f + 2, 3e4f - 1}, {0, 1, 0}, 40, 1.5f);
  ASSERT_TRUE(write_image(*this / "x.exr", random_image(8, 4, {"ao"}), {.camera = &camera}));
  const Result<std::optional<Camera>> read_back = read_camera(*this / "x.exr");
  ASSERT_TRUE(read_back && *read_back);
  EXPECT_EQ((*read_back)->projection, Projection::kPerspective);
  EXPECT_NEAR((*read_back)->right, camera.right, 1e-4f);
}

TEST_F(ExrFile, OnlyUsableCamerasAreRead) {
  const Image image = random_image(8, 4, {"ao"});
  for (const char* name : {"x.exr", "x.png"}) {
    ASSERT_TRUE(write_image(*this / name, image));
    const Result<std::optional<Camera>> none = read_camera(*this / name);
    ASSERT_TRUE(none);
    EXPECT_FALSE(*none) << name;
  }
  const Imath::M44f scaled(2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1), identity, empty(0.0f);
  Imath::M44f nan;
  nan[1][1] = kNan;
  for (auto [to_camera, to_ndc] : {std::pair(scaled, identity), std::pair(identity, empty), std::pair(nan, identity),
                                   std::pair(identity, nan), std::pair(empty, empty)}) {
    Imf::Header header(4, 4);
    header.channels().insert("ao", Imf::Channel(Imf::FLOAT));
    Imf::addWorldToCamera(header, to_camera);
    Imf::addWorldToNDC(header, to_ndc);
    { Imf::OutputFile out((*this / "bad.exr").c_str(), header); }
    const Result<std::optional<Camera>> none = read_camera(*this / "bad.exr");
    ASSERT_TRUE(none);
    EXPECT_FALSE(*none);
  }
  expect_error(read_camera(*this / "none.exr"), {"none.exr", "does not exist"});
  write_bytes(*this / "cut.exr", content(*this / "x.exr").substr(0, 40));
  expect_error(read_camera(*this / "cut.exr"), {"cut.exr"});
}

/// The channels of a part, each with a name and a base value. Pixel (x, y) has the value base + x + 100 * y.
struct Channels {
  Imath::Box2i window;
  std::vector<std::pair<std::string, float>> channels;
  std::vector<std::vector<float>> values;

  Channels(Imath::Box2i window_, std::vector<std::pair<std::string, float>> channels_)
      : window(window_), channels(std::move(channels_)) {
    for (const auto& [name, base] : channels) {
      values.emplace_back();
      for (int y = window.min.y; y <= window.max.y; ++y)
        for (int x = window.min.x; x <= window.max.x; ++x) values.back().push_back(base + float(x + 100 * y));
    }
  }
  Imf::Header header(Imath::Box2i display) const {
    Imf::Header header(display, window);
    for (const auto& [name, base] : channels) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    return header;
  }
  Imf::FrameBuffer pixels() const {
    Imf::FrameBuffer pixels;
    for (std::size_t i = 0; i < channels.size(); ++i)
      pixels.insert(channels[i].first, Imf::Slice::Make(Imf::FLOAT, values[i].data(), window));
    return pixels;
  }
  int rows() const { return window.max.y - window.min.y + 1; }
};

Imath::Box2i box(int x0, int y0, int x1, int y1) { return {{x0, y0}, {x1, y1}}; }

void write_exr(const fs::path& file, Imath::Box2i display, const Channels& channels) {
  Imf::OutputFile out(file.c_str(), channels.header(display));
  out.setFrameBuffer(channels.pixels());
  out.writePixels(channels.rows());
}

TEST_F(ExrFile, SmallDataWindowIsPadded) {
  write_exr(*this / "x.exr", box(0, 0, 9, 7),
            Channels(box(2, 1, 5, 4), {{"R", 1}, {"Z", 2}, {"N.X", 3}, {"N.Y", 4}, {"N.Z", 5}, {"depth.Z", 6}}));
  const Image image = read_or_fail(*this / "x.exr");
  EXPECT_EQ(image.width, 10);
  EXPECT_EQ(image.height, 8);
  EXPECT_EQ(image.plane("color.r").at(2, 1), 1 + 2 + 100);
  EXPECT_EQ(image.plane("color.r").at(5, 4), 1 + 5 + 400);
  EXPECT_EQ(image.plane("N.z").at(3, 2), 5 + 3 + 200);
  for (auto [x, y] : {std::pair(0, 0), std::pair(1, 2), std::pair(6, 2), std::pair(3, 0), std::pair(3, 5)}) {
    EXPECT_EQ(image.plane("color.r").at(x, y), 0.0f);
    EXPECT_EQ(image.plane("N.z").at(x, y), 0.0f) << "Z beside X is not depth";
    EXPECT_EQ(image.plane("Z").at(x, y), kInfinity);
    EXPECT_EQ(image.plane("depth").at(x, y), kInfinity);
  }
}

TEST_F(ExrFile, LayersOfDepthAreInfiniteOutside) {
  write_exr(*this / "x.exr", box(0, 0, 3, 3),
            Channels(box(1, 1, 2, 2), {{"layer1.depth.Z", 1},
                                       {"layer2.depth", 2},
                                       {"layer1.normal.X", 3},
                                       {"layer1.normal.Y", 4},
                                       {"layer1.normal.Z", 5},
                                       {"linear_depth", 6}}));
  const Image image = read_or_fail(*this / "x.exr");
  for (const char* name : {"layer1.depth", "layer2.depth"}) EXPECT_EQ(image.plane(name).at(0, 0), kInfinity) << name;
  for (const char* name : {"layer1.normal.z", "linear_depth"}) EXPECT_EQ(image.plane(name).at(0, 0), 0.0f) << name;
  EXPECT_EQ(image.plane("layer1.depth").at(2, 1), 1 + 2 + 100);
  EXPECT_EQ(image.plane("layer2.depth").at(1, 2), 2 + 1 + 200);
}

TEST_F(ExrFile, FormsOfALayersDepthAreKeptSeparate) {
  write_exr(*this / "x.exr", box(0, 0, 1, 1), Channels(box(0, 0, 1, 1), {{"layer1.depth", 1}, {"layer1.depth.Z", 2}}));
  const Image image = read_or_fail(*this / "x.exr");
  ASSERT_EQ(image.names, (std::vector<std::string>{"layer1.depth", "layer1.depth.Z"}));
  for (int p = 0; p < 2; ++p) EXPECT_EQ(image.planes[p].at(0, 0), float(p + 1));
}

TEST_F(ExrFile, LargeDataWindowIsCut) {
  write_exr(*this / "x.exr", box(-1, 2, 3, 5), Channels(box(-4, -3, 9, 8), {{"ao", 0.5f}}));
  const Image image = read_or_fail(*this / "x.exr");
  ASSERT_EQ(image.width, 5);
  ASSERT_EQ(image.height, 4);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 5; ++x) EXPECT_EQ(image.plane("ao").at(x, y), 0.5f + float(x - 1 + 100 * (y + 2)));
}

TEST_F(ExrFile, DataBesideTheDisplayIsAllBackground) {
  write_exr(*this / "x.exr", box(0, 0, 3, 3), Channels(box(10, 10, 12, 12), {{"Z", 0}}));
  const Image image = read_or_fail(*this / "x.exr");
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) EXPECT_EQ(image.plane("Z").at(x, y), kInfinity);
}

TEST_F(ExrFile, PartsAreNamed) {
  const Imath::Box2i display = box(0, 0, 3, 3);
  const Channels parts[] = {Channels(display, {{"R", 1}, {"G", 2}, {"B", 3}}), Channels(box(1, 1, 2, 2), {{"Z", 4}}),
                            Channels(display, {{"motion.u", 5}}), Channels(display, {{"motion.u", 6}, {"Z", 7}})};
  const char* names[] = {"beauty", "Depth", "left", "depth"};
  {
    std::vector<Imf::Header> headers;
    for (int p = 0; p < 4; ++p) {
      headers.push_back(parts[p].header(display));
      headers[p].setName(names[p]);
      headers[p].setType(Imf::SCANLINEIMAGE);
    }
    Imf::MultiPartOutputFile out((*this / "x.exr").c_str(), headers.data(), 4);
    for (int p = 0; p < 4; ++p) {
      Imf::OutputPart part(out, p);
      part.setFrameBuffer(parts[p].pixels());
      part.writePixels(parts[p].rows());
    }
  }
  const Image image = read_or_fail(*this / "x.exr");
  EXPECT_EQ(image.planes.size(), 7u);
  EXPECT_EQ(image.plane("color.b").at(1, 2), 3 + 1 + 200);
  EXPECT_EQ(image.plane("Depth.z").at(2, 1), 4 + 2 + 100);
  EXPECT_EQ(image.plane("Depth.z").at(0, 0), kInfinity);
  EXPECT_EQ(image.plane("motion.u").at(0, 0), 5);
  EXPECT_EQ(image.plane("depth.motion.u").at(0, 0), 6);
  EXPECT_EQ(image.plane("depth").at(0, 0), 7);
}

TEST_F(ExrFile, FormsOfOneNameAreKeptSeparate) {
  write_exr(*this / "x.exr", box(0, 0, 1, 1),
            Channels(box(0, 0, 1, 1), {{"N.X", 1}, {"N.x", 2}, {"R", 3}, {"color.r", 4}}));
  const Image image = read_or_fail(*this / "x.exr");
  ASSERT_EQ(image.names, (std::vector<std::string>{"N.X", "N.x", "R", "color.r"}));
  for (int p = 0; p < 4; ++p) EXPECT_EQ(image.planes[p].at(0, 0), float(p + 1));
}

TEST_F(ExrFile, ReadsTiles) {
  const Channels channels(box(0, 0, 36, 20), {{"ao", 1}});
  {
    Imf::Header header = channels.header(channels.window);
    header.setTileDescription(Imf::TileDescription(16, 8, Imf::MIPMAP_LEVELS));
    Imf::TiledOutputFile out((*this / "x.exr").c_str(), header);
    for (int level = 0; level < out.numLevels(); ++level) {
      out.setFrameBuffer(channels.pixels());
      out.writeTiles(0, out.numXTiles(level) - 1, 0, out.numYTiles(level) - 1, level);
    }
  }
  const Image image = read_or_fail(*this / "x.exr");
  ASSERT_EQ(image.width, 37);
  for (int y = 0; y < 21; ++y)
    for (int x = 0; x < 37; ++x) ASSERT_EQ(image.plane("ao").at(x, y), float(1 + x + 100 * y));
}

TEST_F(ExrFile, ReadsIntegers) {
  const std::uint32_t values[2] = {7, 1 << 24};
  {
    Imf::Header header(2, 1);
    header.channels().insert("id", Imf::Channel(Imf::UINT));
    Imf::OutputFile out((*this / "x.exr").c_str(), header);
    Imf::FrameBuffer pixels;
    pixels.insert("id", Imf::Slice::Make(Imf::UINT, values, header.dataWindow()));
    out.setFrameBuffer(pixels);
    out.writePixels(1);
  }
  const Image image = read_or_fail(*this / "x.exr");
  EXPECT_EQ(image.plane("id").at(0, 0), 7.0f);
  EXPECT_EQ(image.plane("id").at(1, 0), 16777216.0f);
}

TEST_F(ExrFile, RepeatsSubsampledChannelsAndRefusesUnfinishedFiles) {
  {
    Imf::Header header(4, 4);
    header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
    header.setType(Imf::DEEPSCANLINE);
    header.compression() = Imf::ZIPS_COMPRESSION;
    Imf::DeepScanLineOutputFile out((*this / "deep.exr").c_str(), header);
  }
  expect_error(read_image(*this / "deep.exr"), {"deep.exr"});  // it has no pixels
  {
    Imf::Header header(4, 4);
    header.channels().insert("BY", Imf::Channel(Imf::FLOAT, 2, 2));
    const std::vector<float> values = {1, 2, 3, 4};
    Imf::FrameBuffer pixels;
    pixels.insert("BY", Imf::Slice::Make(Imf::FLOAT, values.data(), header.dataWindow(), 4, 8, 2, 2));
    Imf::OutputFile out((*this / "half.exr").c_str(), header);
    out.setFrameBuffer(pixels);
    out.writePixels(4);
  }
  const Image repeated = read_or_fail(*this / "half.exr");
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x)
      EXPECT_EQ(repeated.plane("BY").at(x, y), float(1 + x / 2 + y / 2 * 2)) << x << ", " << y;
  {
    const Channels channels(box(0, 0, 63, 63), {{"ao", 1}});
    Imf::OutputFile out((*this / "part.exr").c_str(), channels.header(channels.window));
    out.setFrameBuffer(channels.pixels());
    out.writePixels(32);
  }
  expect_error(read_image(*this / "part.exr"), {"part.exr"});
}

TEST_F(ExrFile, RefusesHostileSizes) {
  write_exr(*this / "x.exr", box(0, 0, 99'999, 0), Channels(box(0, 0, 0, 0), {{"ao", 1}}));
  expect_error(read_image(*this / "x.exr"), {"x.exr"});
  write_exr(*this / "y.exr", box(0, 0, 65'535, 65'535), Channels(box(0, 0, 0, 0), {{"ao", 1}}));
  expect_error(read_image(*this / "y.exr"), {"y.exr", "65536 x 65536", "268435456"});
  std::vector<std::pair<std::string, float>> many;
  for (int i = 0; i < 20; ++i) many.emplace_back("c" + std::to_string(i), 0.0f);
  write_exr(*this / "z.exr", box(0, 0, 16'383, 16'383), Channels(box(0, 0, 0, 0), many));
  expect_error(read_image(*this / "z.exr"), {"z.exr", "5368709120 values"});
}

// --- Atomic writing -------------------------------------------------------------------------------------------------

TEST_F(AtomicWrite, ReplacesExistingFiles) {
  write_bytes(*this / "x.txt", "old");
  ASSERT_TRUE(write_text(*this / "x.txt", "new"));
  EXPECT_EQ(content(*this / "x.txt"), "new");
  ASSERT_TRUE(write_text(*this / "x.txt", ""));
  EXPECT_EQ(content(*this / "x.txt"), "");
  EXPECT_EQ(listing(), std::vector<std::string>{"x.txt"});
}

TEST_F(AtomicWrite, LinksStayLinks) {
  write_bytes(*this / "target", "old");
  fs::create_symlink("target", *this / "link");
  ASSERT_TRUE(write_text(*this / "link", "new"));
  EXPECT_TRUE(fs::is_symlink(*this / "link"));
  EXPECT_EQ(content(*this / "target"), "new");
}

TEST_F(AtomicWrite, LongNamesFit) {
  const std::string name = std::string(251, 'n') + ".txt";
  ASSERT_TRUE(write_text(*this / name, "text"));
  EXPECT_EQ(listing(), std::vector<std::string>{name});
  expect_error(write_text(*this / (name + "n"), "text"), {"name too long"});
  EXPECT_EQ(listing(), std::vector<std::string>{name});
}

TEST_F(AtomicWrite, BadPathsAreNamed) {
  write_bytes(*this / "file", "x");
  const Image image = random_image(2, 2, {"a"});
  expect_error(check_writable(""), {"empty"});
  expect_error(check_writable(folder), {folder.string(), "is a folder"});
  expect_error(check_writable(*this / ""), {"is a folder"});
  expect_error(check_writable(*this / "none/x.png"), {"none/x.png", "does not exist", "create"});
  expect_error(check_writable(*this / "file/x.png"), {"file/x.png", "is not a folder"});
  expect_error(write_image(*this / "none/x.png", image), {"does not exist"});
  expect_error(write_image("/proc/x.exr", image), {"/proc/x.exr", "cannot be written"});
  fs::create_directory(*this / "x.pfm");
  expect_error(write_image(*this / "x.pfm", image), {"x.pfm", "is a folder"});
  EXPECT_TRUE(check_writable(*this / "new.png"));
  EXPECT_TRUE(check_writable(*this / "file"));
  EXPECT_TRUE(check_writable("no_folder_given.png"));
  EXPECT_FALSE(fs::exists("no_folder_given.png"));
}

/// Gives up the rights of root, if the tests run as root, during its lifetime.
class Unprivileged {
 public:
  Unprivileged() {
    constexpr uid_t kNobody = 65534;
    if (root_) changed_ = ::seteuid(kNobody) == 0;
  }
  ~Unprivileged() {
    if (changed_ && ::seteuid(0) != 0) std::abort();
  }
  bool is_unprivileged() const { return !root_ || changed_; }

 private:
  bool root_ = ::geteuid() == 0, changed_ = false;
};

TEST_F(AtomicWrite, MissingPermissionsAreNamed) {
  fs::create_directory(*this / "locked");
  write_bytes(*this / "locked/old.png", "old");
  fs::permissions(*this / "locked", fs::perms(0555));
  fs::create_directory(*this / "open");
  write_bytes(*this / "open/kept.png", "kept");
  fs::permissions(*this / "open/kept.png", fs::perms(0444));
  fs::permissions(*this / "open", fs::perms(0777));
  {
    const Unprivileged user;
    ASSERT_TRUE(user.is_unprivileged());
    const Image image = random_image(2, 2, {"a"});
    expect_error(check_writable(*this / "locked/new.png"), {"locked/new.png", "Permission denied"});
    expect_error(write_image(*this / "locked/new.png", image), {"Permission denied"});
    expect_error(write_image(*this / "open/kept.png", image), {"kept.png", "write-protected"});
    EXPECT_TRUE(write_image(*this / "open/new.png", image));
  }
  EXPECT_EQ(content(*this / "open/kept.png"), "kept");
  fs::permissions(*this / "locked", fs::perms(0755));
}

// In a file and in memory alike: kDevice, with the name.
TEST_F(AtomicWrite, LackOfMemoryIsADeviceError) {
  const ImageShape shape{8, 8, {"grey"}};
  const MakeImageRows make = [](const TakeImageRows&) -> Result<void> { throw std::bad_alloc(); };
  const auto expect_no_memory = [](const Error& error, const std::string& name) {
    EXPECT_EQ(error.kind, ErrorKind::kDevice);
    EXPECT_EQ(error.message, "not enough memory to write '" + name + "'");
  };
  const auto file = write_image_rows(*this / "x.png", shape, {}, make);
  ASSERT_FALSE(file);
  expect_no_memory(file.error(), (*this / "x.png").string());
  const auto bytes = encode_png_rows("standard output", shape, {}, make);
  ASSERT_FALSE(bytes);
  expect_no_memory(bytes.error(), "standard output");
}

/// Limits the size of files during its lifetime.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit limit{bytes, old_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit old_{};
  void (*handler_)(int);
};

TEST_F(AtomicWrite, FailedWritesLeaveNothing) {
  const Image image = random_image(200, 200, {"color.r", "color.g", "color.b"});
  for (const rlim_t limit : {0, 100, 5000, 40'000})
    for (const char* name : {"x.png", "x.exr", "x.pfm"}) {
      {
        const FileSizeLimit small(limit);
        expect_error(write_image(*this / name, image), {name, "cannot be written", "File too large"});
      }
      EXPECT_TRUE(listing().empty()) << name << " at " << limit;
    }
  for (const char* name : {"x.png", "x.exr", "x.pfm", "x.txt"}) {
    write_bytes(*this / name, "older");
    {
      const FileSizeLimit small(5000);
      if (std::string_view(name) == "x.txt")
        expect_error(write_text(*this / name, std::string(6000, 't')), {"x.txt", "File too large"});
      else
        expect_error(write_image(*this / name, image), {name, "File too large"});
    }
    EXPECT_EQ(content(*this / name), "older");
  }
  EXPECT_EQ(listing().size(), 4u);
}

TEST_F(AtomicWrite, FullDeviceIsAnError) {
  const Image image = random_image(200, 200, {"color.r", "color.g", "color.b"});
  for (const char* name : {"x.png", "x.exr", "x.pfm"}) {
    fs::create_symlink("/dev/full", *this / name);
    expect_error(write_image(*this / name, image), {name, "No space left on device"});
  }
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
  EXPECT_EQ(listing().size(), 3u);
  EXPECT_TRUE(write_text("/dev/null", "text"));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(AtomicWrite, AbandonedWritesLeaveNothing) {
  write_bytes(*this / "x.txt", "older");
  const auto abandon = [&] {
    std::size_t during = 0, after = 0;
    const Result<void> status = write_atomically(*this / "x.txt", [&](std::FILE* stream) -> Result<void> {
      std::fputs("newer", stream);
      during = listing().size();
      abandon_writes();
      after = listing().size();
      return {};
    });
    EXPECT_EQ(during, 2u);
    EXPECT_EQ(after, 1u);
    expect_error(status, {"x.txt"});
    expect_error(write_text(*this / "y.txt", "later"), {"y.txt"});
    std::_Exit(HasFailure());
  };
  EXPECT_EXIT(abandon(), ::testing::ExitedWithCode(0), "");  // in a process of its own, which cannot write any more
  EXPECT_EQ(listing(), std::vector<std::string>{"x.txt"});
  EXPECT_EQ(content(*this / "x.txt"), "older");
}

TEST_F(AtomicWrite, WritesOfOtherThreadsAreAbandonedToo) {
  const auto abandon = [&](int round) {
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t)
      threads.emplace_back([&, t] {
        while (write_text(*this / fmt::format("{}.txt", t), "text")) continue;
      });
    std::this_thread::sleep_for(std::chrono::microseconds(1000 + 50 * round));
    abandon_writes();
    std::_Exit(0);
  };
  for (int round = 0; round < 100; ++round) EXPECT_EXIT(abandon(round), ::testing::ExitedWithCode(0), "");
  for (const std::string& name : listing()) EXPECT_EQ(fs::path(name).extension(), ".txt") << name;
}

TEST_F(AtomicWrite, ThreadsDoNotMix) {
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (int i = 0; i < 25; ++i) EXPECT_TRUE(write_text(*this / "x.txt", std::string(20'000, char('a' + t))));
    });
  for (std::thread& thread : threads) thread.join();
  const std::string text = content(*this / "x.txt");
  ASSERT_EQ(text.size(), 20'000u);
  EXPECT_EQ(text, std::string(20'000, text[0]));
  EXPECT_EQ(listing(), std::vector<std::string>{"x.txt"});
}

}  // namespace
}  // namespace umbrage
