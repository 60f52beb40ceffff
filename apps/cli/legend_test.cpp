// Tests of legends: ticks, colours and places in the picture, their files, and what is refused.
#include "apps/cli/legend.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "apps/cli/page.h"
#include "cli_support.h"

namespace umbrage::cli {
namespace {

using test::quoted;

ValueColors values_of(float low, float high, ValueColors::Scale scale = ValueColors::Scale::kLinear) {
  return {.name = "p",
          .low = low,
          .high = high,
          .scale = scale,
          .linear_threshold = 1.0f,
          .map = {"", {{0.0f, 0.0f, 1.0f}, {1.0f, 0.0f, 0.0f}}, false}};
}

std::string labels(const ValueColors& values, int count = 7) {
  std::vector<std::string> all;
  const Ticks ticks = ticks_of(values, count);
  for (const Tick& tick : ticks.all) all.push_back(tick.label);
  if (!ticks.factor.empty()) all.push_back(ticks.factor);
  return fmt::format("{}", fmt::join(all, " "));
}

TEST(Legend, TicksAreRound) {
  using Scale = ValueColors::Scale;
  EXPECT_EQ(labels(values_of(98.2f, 103.6f)), "99 100 101 102 103");
  EXPECT_EQ(labels(values_of(0.0f, 1.0f)), "0.0 0.2 0.4 0.6 0.8 1.0");
  EXPECT_EQ(labels(values_of(-0.013f, 0.011f)), "\u22120.010 \u22120.005 0.000 0.005 0.010");
  EXPECT_EQ(labels(values_of(0.0f, 3e6f)), "0.0 0.5 1.0 1.5 2.0 2.5 3.0 \u00d710\u2076");
  EXPECT_EQ(labels(values_of(-2e-9f, 1e-9f)),
            "\u22122.0 \u22121.5 \u22121.0 \u22120.5 0.0 0.5 1.0 \u00d710\u207b\u2079");
  EXPECT_EQ(labels(values_of(101325.0f, 101326.0f)), "101325.0 101325.2 101325.4 101325.6 101325.8 101326.0");
  EXPECT_EQ(labels(values_of(0.1001f, 0.1002f)), "0.10010 0.10012 0.10014 0.10016 0.10018 0.10020");
  EXPECT_EQ(labels(values_of(0.01f, 1000.0f, Scale::kLog)), "0.01 0.1 1 10 100 1000");
  EXPECT_EQ(labels(values_of(1e-6f, 1e6f, Scale::kLog)),
            "10\u207b\u2076 10\u207b\u2074 10\u207b\u00b2 10\u2070 10\u00b2 10\u2074 10\u2076");
  EXPECT_EQ(labels(values_of(2.0f, 7.0f, Scale::kLog)), "2 3 4 5 6 7");
  EXPECT_EQ(labels(values_of(-100.0f, 100.0f, Scale::kSymlog)), "\u2212100 \u221210 \u22121 0 1 10 100");
  ValueColors bands = values_of(0.0f, 1.0f);
  bands.bands = 4;
  EXPECT_EQ(labels(bands), "0.00 0.25 0.50 0.75 1.00");
  bands.bands = 12;
  EXPECT_EQ(labels(bands), "0.000 0.167 0.333 0.500 0.667 0.833 1.000");
  for (const float low : {-72.0f, 0.0f, 0.3f, 1e-5f, 40.0f})
    for (const float range : {0.7f, 1.0f, 24.0f, 96.0f, 97.0f, 1234.5f})
      for (const int count : {4, 5, 7, 9}) {
        const std::size_t ticks = ticks_of(values_of(low, low + range), count).all.size();
        EXPECT_LE(int(ticks), count) << low << " " << range;
        EXPECT_GE(int(ticks), 2) << low << " " << range << " " << count;
      }
}

TEST(Legend, TicksStandAtTheirValues) {
  for (const Tick& tick : ticks_of(values_of(0.01f, 1000.0f, ValueColors::Scale::kLog), 7).all)
    EXPECT_NEAR(tick.place, (std::log10(std::stod(tick.label)) + 2.0) / 5.0, 1e-6);
  const auto symlog = ticks_of(values_of(-10.0f, 10.0f, ValueColors::Scale::kSymlog), 7).all;
  for (std::size_t k = 0; k < symlog.size(); ++k)
    EXPECT_NEAR(symlog[k].place, 1.0 - symlog[symlog.size() - 1 - k].place, 1e-6);
  for (const double max : {0.00123, 0.99, 1.0, 1.99, 4.9, 7.0, 123456.0}) {
    const double length = round_length(max);
    EXPECT_LE(length, max * (1.0 + 1e-9));
    EXPECT_GT(length, 0.39 * max);
  }
}

/// Returns the pixel of the page, or 0 outside.
std::uint32_t at(const PagePixels& pixels, int x, int y) {
  x -= pixels.x, y -= pixels.y;
  if (x < 0 || y < 0 || x >= pixels.width || y >= pixels.height) return 0;
  return pixels.argb[std::size_t(y) * std::size_t(pixels.width) + std::size_t(x)];
}

TEST(Legend, BarHasTheColorsOfItsValues) {
  Scene scene;
  scene.value_colors = std::make_shared<ValueColors>(values_of(0.0f, 1.0f));
  const auto layers = legends_of({.color_bar = true, .ink = {0.0f, 1.0f, 0.0f}}, scene, Camera(), 400, 300);
  ASSERT_TRUE(layers) << layers.error().message;
  const auto pixels = pixels_of(*layers, 400, 300);
  ASSERT_TRUE(pixels) << pixels.error().message;
  // The rows of the bar: columns that are mostly mixtures of red and blue.
  int x = 0, top = 300, bottom = 0;
  for (int i = 0; i < 400; ++i)
    for (int j = 0, count = 0; j < 300; ++j) {
      const std::uint32_t c = at(*pixels, i, j);
      count += c >> 24 == 255 && (c >> 8 & 255) < 4;
      if (count > 100) x = i;
    }
  for (int j = 0; j < 300; ++j)
    if (const std::uint32_t c = at(*pixels, x, j); c >> 24 == 255 && (c >> 8 & 255) < 4)
      top = std::min(top, j), bottom = j;
  ASSERT_GT(bottom - top, 100);
  for (int j = top + 3; j < bottom - 3; ++j) {
    const double value = double(bottom + 1 - j - 0.5) / double(bottom + 1 - top);
    EXPECT_NEAR(double(at(*pixels, x, j) >> 16 & 255) / 255.0, value, 0.02) << j;
    EXPECT_NEAR(double(at(*pixels, x, j) & 255) / 255.0, 1.0 - value, 0.02) << j;
  }
}

TEST(Legend, TextIsInsideThePage) {
  Scene scene;
  ValueColors values = values_of(-123456.0f, 123456.0f);
  values.missing_count = 3;
  scene.value_colors = std::make_shared<ValueColors>(values);
  const auto layers =
      legends_of({.color_bar = true, .scale_bar = true, .axes = true, .title = "A rather long title (unit)"}, scene,
                 orthographic_camera({1, 2, 3}, {}, {0, 1, 0}, 2.0f, 1.0f), 500, 500);
  ASSERT_TRUE(layers) << layers.error().message;
  const auto pixels = pixels_of(*layers, 500, 500);
  ASSERT_TRUE(pixels) << pixels.error().message;
  for (int k = 0; k < 500; ++k) {
    EXPECT_EQ(at(*pixels, k, 2), 0u);
    EXPECT_EQ(at(*pixels, 497, k), 0u);
    EXPECT_EQ(at(*pixels, k, 497), 0u);
    EXPECT_EQ(at(*pixels, 2, k), 0u);
  }
}

TEST(Legend, IsBlendedOverThePicture) {
  Image picture(4, 2);
  for (const char* name : {"color.r", "color.g", "color.b"}) picture.add(name) = Plane(4, 2, 1.0f);
  const PagePixels pixels{1, 5, 2, 1, {0xff000000u, 0x80008000u}};  // black; half green
  const Image drawn = drawn_over(std::move(picture), pixels, 4);
  EXPECT_EQ(drawn.plane("color.r").at(1, 1), 0.0f);
  EXPECT_NEAR(drawn.plane("color.r").at(2, 1), 0.498f, 1e-3f);
  EXPECT_NEAR(drawn.plane("color.g").at(2, 1), 1.0f, 1e-3f);
  EXPECT_EQ(drawn.plane("color.r").at(1, 0), 1.0f);
  EXPECT_EQ(drawn.plane("color.r").at(3, 1), 1.0f);
}

class Figure : public test::ProgramTest {
 protected:
  /// Writes a quadrilateral whose corners have the values 0 to 3.
  void SetUp() override {
    ProgramTest::SetUp();
    write("values.ply",
          "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
          "property float p\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
          "0 0 0 0\n1 0 0 1\n1 1 0 2\n0 1 0 3\n4 0 1 2 3\n");
  }
  std::string bytes(const std::string& name) { return test::text_of(folder_ / name); }
};

TEST_F(Figure, HasItsSizeOnPaper) {
  const std::string line =
      "values.ply --print-size 25.4,12.7 --dpi 200 --color-by p --color-bar --scale-bar --axes -o ";
  good(line + "a.png");
  const Image picture = image("a.png");
  EXPECT_EQ(picture.width, 200);
  EXPECT_EQ(picture.height, 100);
  EXPECT_NE(bytes("a.png").find(std::string("pHYs\0\0\x1e\xc2\0\0\x1e\xc2\1", 13)), std::string::npos);  // 7874 / m
  good(line + "a.jpg");
  EXPECT_NE(bytes("a.jpg").find(std::string("JFIF\0\1\1\1\0\xc8\0\xc8", 12)), std::string::npos);  // 200 / inch
  good(line + "a.svg");
  EXPECT_NE(bytes("a.svg").find("width=\"25.4mm\" height=\"12.7mm\" viewBox=\"0 0 200 100\""), std::string::npos);
  EXPECT_NE(bytes("a.svg").find(">p</text>"), std::string::npos);
  good(line + "a.pdf");
  const std::string pdf = bytes("a.pdf"), box = "MediaBox [ 0 0 ";
  ASSERT_NE(pdf.find(box), std::string::npos);
  EXPECT_NEAR(std::stod(pdf.substr(pdf.find(box) + box.size())), 72.0, 1e-3);  // points
}

TEST_F(Figure, SvgAndPdfShowThePicture) {
  const std::string line = "values.ply --color-by p --color-bar --scale-bar --axes --resolution 320x240 -o ";
  good(line + "a.png");
  good(line + "a.svg");
  good(line + "a.pdf");
  const std::string folder = quoted(folder_.string());
  ASSERT_EQ(std::system(fmt::format("cd {} && rsvg-convert a.svg -o svg.png", folder).c_str()), 0);
  ASSERT_EQ(std::system(fmt::format("cd {} && pdftoppm -singlefile -png -r 96 a.pdf pdf", folder).c_str()), 0);
  const Image png = image("a.png");
  for (const char* name : {"svg.png", "pdf.png"}) {
    const Image page = image(name);
    ASSERT_EQ(page.width, 320) << name;
    ASSERT_EQ(page.height, 240) << name;
    int differ = 0;
    for (int y = 0; y < 240; ++y)
      for (int x = 0; x < 320; ++x)
        for (const char* channel : {"color.r", "color.g", "color.b"})
          differ += std::abs(page.plane(channel).at(x, y) - png.plane(channel).at(x, y)) > 0.25f;
    EXPECT_LT(differ, 3 * 320 * 240 / 200) << name;  // edges of letters
  }
}

TEST_F(Figure, LinesHaveLegends) {
  good("scene:solids?detail=2000 --resolution 96x96 --axes --scale-bar -o a.svg");
  EXPECT_NE(bytes("a.svg").find("id=\"axes\""), std::string::npos);
  good("scene:solids?detail=2000 --resolution 96x96 --axes --legend b.svg -o a.svg");
  EXPECT_EQ(bytes("a.svg").find("id=\"axes\""), std::string::npos);
  EXPECT_NE(bytes("b.svg").find("id=\"axes\""), std::string::npos);
}

TEST_F(Figure, ModelsLeaveRoomForLegends) {
  const std::string line = "tri.obj --resolution 300x300 --look cartoon --camera-orthographic -o ";
  const auto lowest = [&] {
    EXPECT_EQ(
        std::system(fmt::format("cd {} && rsvg-convert a.svg -b white -o a.png", quoted(folder_.string())).c_str()), 0);
    const Image page = image("a.png");
    int row = 0;
    for (int y = 0; y < page.height; ++y)
      for (int x = 150; x < 200; ++x)  // beside the axes
        if (page.plane("color.g").at(x, y) < 0.5f) row = y;
    return row;
  };
  good(line + "a.svg");
  const int without = lowest();
  good(line + "a.svg --axes");
  EXPECT_LT(lowest(), without - 20);
}

TEST_F(Figure, LegendsHaveAFileOfTheirOwn) {
  const std::string line = "values.ply --resolution 96x96 --color-by p ";
  good(line + "-o plain.png");
  good(line + "--color-bar --legend legend.png -o own.png");
  EXPECT_TRUE(bytes("plain.png") == bytes("own.png"));
  const Plane alpha = image("legend.png").plane("color.a");
  EXPECT_EQ(alpha.at(2, 2), 0.0f);
  float max = 0.0f;
  for (int y = 0; y < alpha.height; ++y)
    max = std::max(max, *std::max_element(alpha.row(y), alpha.row(y) + alpha.width));
  EXPECT_GT(max, 0.99f);
  good(line + "--color-bar --color-bar-title Druck --legend legend.pdf -o own.png");
  ASSERT_EQ(std::system(fmt::format("cd {} && pdftotext legend.pdf legend.txt", quoted(folder_.string())).c_str()), 0);
  EXPECT_NE(bytes("legend.txt").find("Druck"), std::string::npos) << bytes("legend.txt");
}

TEST_F(Figure, StripsHaveLegends) {
  const std::string line =
      "values.ply --device cpu --resolution 512x512 --anti-aliasing 1 --color-by p --color-bar --axes -o ";
  good(line + "whole.png");
  const test::Outcome outcome = run(line + "strips.png --memory 20M --verbose");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  ASSERT_NE(outcome.err.find("drawn in strips"), std::string::npos) << outcome.err;
  EXPECT_TRUE(bytes("whole.png") == bytes("strips.png"));
}

TEST_F(Figure, WrongOptionsAreRefused) {
  const std::pair<const char*, const char*> cases[] = {
      {"--color-bar", "--color-by"},
      {"--color-bar-title T --color-by p", "--color-bar"},
      {"--legend a.png", "--color-bar, --scale-bar or --axes"},
      {"--axes --legend a.txt", ".png, .svg or .pdf"},
      {"--print-size 80", "width and height in mm"},
      {"--print-size 80,0", "width and height in mm"},
      {"--print-size 4000,4000 --dpi 9000", "lower --dpi"},
      {"--print-size 80,60 --resolution 64,64", "--resolution"},
      {"--axes --passes depth", "--legend"},
      {"--dpi 0", "--dpi"},
      {"--axes --resolution 80", "at least 84"},
      {"--axes --legend ./out.png", "the picture itself"},
      {"--length-unit mm", "--scale-bar or --views"},
      {"--axes --legend a.png --turntable 3", "--turntable"},
  };
  for (const auto& [words, sentence] : cases) bad(std::string("values.ply -o out.png ") + words, 2, {sentence});
  bad("values.ply --axes -o out.exr", 2, {"--legend"});
}

}  // namespace
}  // namespace umbrage::cli
