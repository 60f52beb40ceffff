// Areas of a picture as paths. Each pixel must be inside the paths of its colour, and of no other.
#include "io/filled_regions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "run_program.h"
#include "support.h"

namespace umbrage {
namespace {

/// A picture whose pixels are set by a function of their centre: the object, and a grey colour.
template <class Pixel>
Image drawn(int width, int height, const Pixel& pixel) {
  Image picture(width, height);
  for (const char* name : {"color.r", "color.g", "color.b", "object_id"}) picture.add(name) = Plane(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto [object, grey] = pixel(float(x) + 0.5f, float(y) + 0.5f);
      for (const char* name : {"color.r", "color.g", "color.b"}) picture.plane(name).at(x, y) = grey;
      picture.plane("object_id").at(x, y) = float(object);
    }
  return picture;
}

/// Returns the area of a closed path by its corners and arcs, positive from +x to +y.
double area_of(const DrawnPath& path) {
  double twice = 0.0, x = path.x, y = path.y;
  for (const DrawnSegment& s : path.segments) {
    twice += x * double(s.y) - y * double(s.x);
    if (s.radius > 0.0f) {
      const double chord = std::hypot(double(s.x) - x, double(s.y) - y), r = std::max(double(s.radius), 0.5 * chord);
      double angle = 2.0 * std::asin(0.5 * chord / r);
      if (s.large_arc) angle = 2.0 * M_PI - angle;
      twice += (s.clockwise ? 1.0 : -1.0) * r * r * (angle - std::sin(angle));
    }
    x = s.x, y = s.y;
  }
  double area = 0.5 * twice;
  for (const DrawnPath& hole : path.holes) area += area_of(hole);
  return area;
}

const DrawnPath& path_of(const DrawnLayer& layer, std::size_t k) { return std::get<DrawnPath>(layer.shapes.at(k)); }

TEST(FilledRegions, ADiscInASquareIsTwoAreasWithOneBorder) {
  constexpr float kRadius = 30.0f;
  const Image picture = drawn(128, 100, [](float x, float y) {
    if (std::hypot(x - 60.0f, y - 50.0f) < kRadius) return std::pair(1, 0.25f);
    return x > 10.0f && x < 110.0f && y > 5.0f && y < 95.0f ? std::pair(0, 0.75f) : std::pair(-1, 1.0f);
  });
  const auto layers = filled_regions(picture, FillBy::kPart);
  ASSERT_EQ(layers.size(), 2u);
  for (int object = 0; object < 2; ++object) {
    const DrawnLayer& layer = layers[std::size_t(object)];
    EXPECT_EQ(layer.name, "fill");
    EXPECT_EQ(layer.object, object);
    ASSERT_EQ(layer.shapes.size(), 1u);
    EXPECT_NEAR(path_of(layer, 0).fill->at(1), object == 0 ? 0.75f : 0.25f, 1e-3f);
  }
  const double disc = M_PI * kRadius * kRadius;
  EXPECT_NEAR(std::abs(area_of(path_of(layers[1], 0))), disc, 0.01 * disc);
  EXPECT_NEAR(std::abs(area_of(path_of(layers[0], 0))), 100.0 * 90.0 - disc, 0.01 * 9000.0);
  EXPECT_LE(path_of(layers[1], 0).segments.size(), 12u);  // arcs
  ASSERT_EQ(path_of(layers[0], 0).holes.size(), 1u);
  EXPECT_LE(path_of(layers[0], 0).segments.size(), 8u);  // sides, and corners of pixels
}

TEST(FilledRegions, TonesAreOfAnObjectAndNoLines) {
  // Two objects with three tones each; between them, as in an antialiased picture, a pixel of the mean colour.
  const Image picture = drawn(120, 60, [](float x, float y) {
    const float f = x / 40.0f, step = std::floor(f);
    const bool is_between = f - step < 0.025f && step > 0.0f;
    return std::pair(y < 30.0f ? 3 : 7, 0.2f + 0.25f * (is_between ? step - 0.5f : step));
  });
  const auto layers = filled_regions(picture, FillBy::kTone);
  ASSERT_EQ(layers.size(), 2u);
  for (const DrawnLayer& layer : layers) {
    std::set<int> percent;
    double area = 0.0;
    for (std::size_t k = 0; k < layer.shapes.size(); ++k) {
      percent.insert(int(std::lround(100.0f * path_of(layer, k).fill->at(0))));
      area += std::abs(area_of(path_of(layer, k)));
      EXPECT_NEAR(std::abs(area_of(path_of(layer, k))), 40.0 * 30.0, 40.0);
    }
    EXPECT_EQ(percent, (std::set<int>{20, 45, 70}));
    EXPECT_NEAR(area, 120.0 * 30.0, 1.0);  // no gaps, no overlaps
  }
}

TEST(FilledRegions, ArcsEndWhereBordersMeet) {
  constexpr float kRadius = 25.0f;
  for (int degrees = 0; degrees < 180; degrees += 7) {
    const float x_part = std::cos(float(degrees) * 0.01745f), y_part = std::sin(float(degrees) * 0.01745f);
    const Image picture = drawn(64, 64, [&](float x, float y) {
      const bool is_inside = std::hypot(x - 31.7f, y - 32.2f) < kRadius;
      return std::pair(!is_inside ? -1 : x_part * (x - 30.0f) + y_part * (y - 33.0f) > 0.0f ? 1 : 0, 0.5f);
    });
    double area = 0.0;
    for (const DrawnLayer& layer : filled_regions(picture, FillBy::kPart)) area += std::abs(area_of(path_of(layer, 0)));
    EXPECT_NEAR(area, M_PI * kRadius * kRadius, 0.01 * M_PI * kRadius * kRadius) << degrees;
  }
}

TEST(FilledRegions, AStraightBorderIsALine) {
  const Image picture =
      drawn(200, 100, [](float x, float y) { return std::pair(y > 20.3f + 0.07f * x ? 0 : -1, 0.5f); });
  const auto layers = filled_regions(picture, FillBy::kPart);
  ASSERT_EQ(layers.size(), 1u);
  EXPECT_LE(path_of(layers[0], 0).segments.size(), 6u);
}

TEST(FilledRegions, EmptyPicturesHaveNone) {
  EXPECT_TRUE(filled_regions(drawn(16, 8, [](float, float) { return std::pair(-1, 1.0f); }), FillBy::kTone).empty());
  const auto whole = filled_regions(drawn(1, 1, [](float, float) { return std::pair(0, 0.5f); }), FillBy::kTone);
  ASSERT_EQ(whole.size(), 1u);
  EXPECT_NEAR(std::abs(area_of(path_of(whole[0], 0))), 1.0, 1e-6);
}

class FillTest : public test::ProgramTest {
 protected:
  /// Returns the fraction of pixels that librsvg draws within 12 of 255 of another picture.
  double equal_fraction(const std::string& svg, const std::string& png) {
    const std::string line =
        fmt::format("cd {} && rsvg-convert {} -o fill.png", test::quoted(folder_.string()), test::quoted(svg));
    EXPECT_EQ(std::system(line.c_str()), 0) << line;
    const Image a = image("fill.png"), b = image(png);
    long equal = 0;
    for (int y = 0; y < a.height; ++y)
      for (int x = 0; x < a.width; ++x) {
        float max = 0.0f;
        for (const char* name : {"color.r", "color.g", "color.b"})
          max = std::max(max, std::abs(a.plane(name).at(x, y) - b.plane(name).at(x, y)));
        equal += max <= 12.0f / 255.0f;
      }
    return double(equal) / (double(a.width) * a.height);
  }
};

TEST_F(FillTest, LooksLikeThePicture) {
  const std::string line = "scene:pink --device cpu --look cartoon --background-color #eeeeee --resolution 640x640 ";
  good(line + "-o pink.png");
  good(line + "-o pink.svg --areas tone");
  EXPECT_GE(equal_fraction("pink.svg", "pink.png"), 0.95);
  good(line + "-o part.svg --areas part");
  good(line + "-o lines.svg");
  const double part = equal_fraction("part.svg", "pink.png"), lines = equal_fraction("lines.svg", "pink.png");
  EXPECT_LT(lines, part);
  EXPECT_LT(part, equal_fraction("pink.svg", "pink.png"));
}

TEST_F(FillTest, IsOfDrawingsAlone) {
  bad("nothere.obj -o out.png --look cartoon --areas tone", 2, {"--areas tone", ".svg"});
  bad("nothere.obj -o out.dxf --areas part", 2, {"--areas part", ".svg"});
  bad("nothere.obj -o out.svg --look studio --areas part", 2, {"--areas part", "cartoon"});
  bad("nothere.obj -o out.svg --areas parts", 2, {"--areas", "'parts'", "none, part or tone"});
}

}  // namespace
}  // namespace umbrage
