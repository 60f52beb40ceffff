// Pictures of `umbrage shade` from the planes that `umbrage render` writes equal the rendered ones, and the look `comp`
// leaves a picture without occlusion as it is.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "cli_support.h"

namespace umbrage {
namespace {

class ShadeRoundTrip : public test::ProgramTest {
 protected:
  static constexpr const char* kScene = "scene:solids?detail=3000";
  // Pixels as they are, level camera: what is up in the picture is up in the scene.
  static constexpr const char* kView =
      " --resolution 160x120 --anti-aliasing 1 --camera-direction -0.3,0,-1 --ground off --set antialias.search=0";

  /// Returns the max difference of planes of the same names; infinity where one has a value and the other none, or NaN.
  double difference(const Image& a, const Image& b, std::initializer_list<const char*> planes) {
    double worst = 0.0;
    for (const char* name : planes)
      for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x) {
          const double of_a = a.plane(name).at(x, y), of_b = b.plane(name).at(x, y);
          if (of_a == of_b) continue;
          const double apart = std::abs(of_a - of_b);
          worst = std::isnan(apart) ? std::numeric_limits<double>::infinity() : std::max(worst, apart);
        }
    return worst;
  }
};

TEST_F(ShadeRoundTrip, OcclusionEqualsThatOfTheRenderer) {
  const std::string look = " --look ao --ao bitmask --ao-radius 0.4 --set denoise.for_height=0";
  good(kScene + std::string(" -o drawn.exr --passes color,ao,depth,normal") + kView + look);
  good(std::string("shade drawn.exr -o shaded.exr --passes color,ao --set antialias.search=0") + look);
  const Image drawn = image("drawn.exr"), shaded = image("shaded.exr");
  ASSERT_EQ(shaded.width, drawn.width);
  EXPECT_LE(difference(drawn, shaded, {"ao", "color.r", "color.a"}), 1e-3);
  double darkest = 1.0;  // there is occlusion at all
  for (int y = 0; y < drawn.height; ++y)
    for (int x = 0; x < drawn.width; ++x) darkest = std::min(darkest, double(drawn.plane("ao").at(x, y)));
  EXPECT_LT(darkest, 0.5);
}

TEST_F(ShadeRoundTrip, StudioEqualsThatOfTheRendererWhereTheFileHasAllPlanes) {
  const std::string look =
      " --look studio --ao bitmask --ao-radius 0.4 --ao-scale full --set output.metering=none --set "
      "denoise.for_height=0";
  good(kScene +
       std::string(" -o drawn.exr --passes "
                   "color,depth,normal,albedo,specular,shininess,shadow,shadow1,shadow2,object_id,material_id") +
       kView + look);
  good(std::string("shade drawn.exr -o shaded.exr --set antialias.search=0") + look);
  EXPECT_LE(difference(image("drawn.exr"), image("shaded.exr"), {"color.r", "color.g", "color.b", "color.a"}), 1e-3);
}

TEST_F(ShadeRoundTrip, CompWithoutOcclusionIsThePicture) {
  good(kScene + std::string(" -o drawn.exr --passes color,depth,normal --no-background --look studio") + kView);
  good(kScene + std::string(" -o drawn.png --look studio") + kView);
  good("shade drawn.exr -o same.exr --look comp --ao-strength 0");
  const Image drawn = image("drawn.exr");
  EXPECT_LE(difference(drawn, image("same.exr"), {"color.r", "color.g", "color.b", "color.a"}), 1e-5);
  good("shade --depth drawn.exr:depth --beauty drawn.png -o same.png --ao-strength 0");
  EXPECT_LE(difference(image("drawn.png"), image("same.png"), {"color.r", "color.g", "color.b"}), 1.01 / 255);
  good("shade drawn.exr -o dark.exr");  // comp is the default of a file with a beauty
  const Image dark = image("dark.exr");
  double darker = 0.0;
  for (int y = 0; y < dark.height; ++y)
    for (int x = 0; x < dark.width; ++x) {
      ASSERT_LE(dark.plane("color.g").at(x, y), drawn.plane("color.g").at(x, y) + 1e-5f);
      darker = std::max(darker, double(drawn.plane("color.g").at(x, y) - dark.plane("color.g").at(x, y)));
    }
  EXPECT_GT(darker, 0.05);
}

TEST_F(ShadeRoundTrip, ReductionHalvesThePicture) {
  good(kScene + std::string(" -o drawn.exr --passes color,depth,normal,albedo --look studio") + kView);
  good("shade drawn.exr -o small.exr --passes color,depth --look studio --reduction 2");
  const Image small = image("small.exr");
  EXPECT_EQ(small.width, 80);
  EXPECT_EQ(small.height, 60);
  bad("shade drawn.exr -o small.exr --reduction 9", 2, {"reduction"});
}

}  // namespace
}  // namespace umbrage
