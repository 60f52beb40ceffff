// Tests of the program with depth layers, a guard band and the reference technique.
#include <gtest/gtest.h>

#include <algorithm>

#include "cli_support.h"
#include "looks/looks.h"

namespace umbrage {
namespace {

using test::expect_pictures_of;
using test::kSmall;
using test::kSolids;
using test::text_of;
using test::Words;

class CliLayers : public test::ProgramTest {};

TEST_F(CliLayers, LayersArePlanes) {
  good(kSolids + " --layers 4 --passes depth,layer1.depth,layer3.normal,layer2.object_id -o x.exr" + kSmall);
  const Image some = image("x.exr");
  EXPECT_EQ(std::set<std::string>(some.names.begin(), some.names.end()),
            (std::set<std::string>{"depth", "layer1.depth", "layer3.normal.x", "layer3.normal.y", "layer3.normal.z",
                                   "layer2.object_id"}));
  long behind = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const float first = some.plane("depth").at(x, y), second = some.plane("layer1.depth").at(x, y);
      if (!std::isfinite(second)) continue;
      ++behind;
      ASSERT_LT(first, second) << x << ',' << y;
    }
  EXPECT_GT(behind, 1000);
  good(kSolids + " --layers 3 --passes all -o all.exr" + kSmall);
  const Image all = image("all.exr");
  for (const char* name :
       {"depth", "layer1.depth", "layer2.depth", "layer1.normal.y", "layer2.albedo.r", "layer1.specular",
        "layer1.shininess", "layer2.shadow", "layer1.object_id", "layer2.material_id", "ao", "color.r"})
    EXPECT_NE(all.find(name), nullptr) << name;
  EXPECT_EQ(all.find("layer3.depth"), nullptr);
  EXPECT_EQ(test::difference(all.plane("layer1.depth"), some.plane("layer1.depth"), 0.0).max, 0.0);
  // Layers do not change the picture.
  good(kSolids + " -o one.png" + kSmall);
  good(kSolids + " -o many.png --layers 16" + kSmall);
  EXPECT_EQ(text_of(folder_ / "one.png"), text_of(folder_ / "many.png"));
}

TEST_F(CliLayers, LayersAsPicturesCanBeSeen) {
  const std::string line = kSolids + " --layers 2 --resolution 64x64 -o ";
  good(line + "depth.png --passes layer1.depth");
  good(line + "normal.png --passes layer1.normal");
  good(line + "both.exr --passes layer1.depth,layer1.normal");
  const Image depth = image("depth.png"), normal = image("normal.png"), both = image("both.exr");
  expect_pictures_of(both.plane("layer1.depth"), both.plane("layer1.normal.y"), depth, normal);
}

TEST_F(CliLayers, RefusesLayers) {
  for (const char* text : {"0", "17", "-1", "1.5", "x", "nan", "1e9"})
    bad_option(fmt::format("--layers {}", text), {"--layers", fmt::format("'{}'", text), "from 1 to 16"});
  bad("tri.obj -o out.png --passes layer2.depth", 2, {"'layer2.depth'", "--layers 1", "--layers 3"});
  bad("tri.obj -o out.exr --layers 3 --passes depth,layer3.normal", 2, {"'layer3.normal'", "--layers 4"});
  bad("tri.obj -o out.exr --layers 3 --passes layer2.dept", 2, {"'layer2.dept'", "did you mean 'layer2.depth'"});
  bad("tri.obj -o out.exr --passes layer16.depth", 2, {"'layer16.depth'"});
  // These errors are found before the model is read.
  bad("nothere.obj -o out.png --layers 16 --resolution 8192x8192", 2, {"16 layers", "8192 x 8192", "at most"});
  bad("nothere.obj -o out.png --guard-band 100% --resolution 8192x8192", 2, {"24576 x 24576", "at most"});
}

TEST_F(CliLayers, ExtraViewsAreLayers) {
  good(kSolids + " --layers 2 --extra-views 2 --passes depth,layer1.depth,layer2.depth,layer3.normal -o x.exr" +
       kSmall);
  const Image planes = image("x.exr");
  long others = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      others += std::isfinite(planes.plane("layer2.depth").at(x, y)) &&
                planes.plane("layer2.depth").at(x, y) != planes.plane("depth").at(x, y);
  EXPECT_GT(others, 500);
  // Extra views do not change a picture that reads one layer.
  good(kSolids + " -o one.png" + kSmall);
  good(kSolids + " -o many.png --extra-views 4" + kSmall);
  EXPECT_EQ(text_of(folder_ / "one.png"), text_of(folder_ / "many.png"));
  for (const char* text : {"5", "-1", "1.5", "x", "nan"})
    bad_option(fmt::format("--extra-views {}", text), {"--extra-views", fmt::format("'{}'", text), "from 0 to 4"});
  bad("nothere.obj -o out.png --layers 8 --extra-views 1", 2, {"8 layers and 1 extra view are 9", "at most 8"});
}

TEST_F(CliLayers, RefusesGuardBands) {
  for (const char* text : {"-1", "-1%", "101%", "5%%", "5%5", "abc", "%", "nan%", "5 %"})
    bad(Words{"tri.obj", "-o", "out.png", "--guard-band", text}, 2,
        {"--guard-band", fmt::format("'{}'", text), "0% to 100%"});
}

TEST_F(CliLayers, TheGuardBandIsNotWritten) {
  const std::string line = "tri.obj --resolution 60x40 --passes depth,ao --layers 2 -o ";
  good(line + "plain.exr");
  for (const char* band : {"10%", "100%", "0.1%"}) {
    good(line + "guarded.exr --guard-band " + band);
    const Image plain = image("plain.exr"), guarded = image("guarded.exr");
    ASSERT_EQ(guarded.width, 60);
    ASSERT_EQ(guarded.height, 40);
    EXPECT_LT(test::difference(plain.plane("depth"), guarded.plane("depth"), 1e-5).fraction_over, 0.01) << band;
    const auto a = read_camera(folder_ / "plain.exr"), b = read_camera(folder_ / "guarded.exr");
    ASSERT_TRUE(a && *a && b && *b) << band;
    EXPECT_EQ((*a)->view_from_world, (*b)->view_from_world);
    for (const auto edge : {&Camera::left, &Camera::right, &Camera::bottom, &Camera::top})
      EXPECT_NEAR((**a).*edge, (**b).*edge, 1e-5f) << band;
  }
}

TEST_F(CliLayers, TheGuardBandIsSeenByEffects) {
  // Zoomed in, the scene continues beyond the picture. With a guard band, border pixels are shaded like all others.
  const std::string line =
      kSolids +
      " --look ao --ao unsharp --camera-zoom-factor 2 --resolution 64x64 --passes ao --set unsharp.kernel=15 -o ";
  good(line + "plain.exr");
  good(line + "guarded.exr --guard-band 15%");
  const Image plain = image("plain.exr"), guarded = image("guarded.exr");
  double border = 0.0, middle = 0.0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const double difference = std::fabs(double(plain.planes[0].at(x, y)) - guarded.planes[0].at(x, y));
      const bool inside = std::min({x, y, 63 - x, 63 - y}) >= 8;
      (inside ? middle : border) += difference > 0.02;
    }
  EXPECT_GT(border, 50);
  EXPECT_LT(middle, 20);
}

TEST_F(CliLayers, TheReferenceIsATechnique) {
  const std::string few = " --resolution 24x24 --ao reference --set reference.samples=2";
  for (const Look* look : scene_looks()) good(fmt::format("{} -o out.png --look {}{}", kSolids, look->name, few));
  good(kSolids + " -o out.exr --passes ao,bent_normal" + few);
  const Image planes = image("out.exr");
  EXPECT_EQ(std::set<std::string>(planes.names.begin(), planes.names.end()),
            (std::set<std::string>{"ao", "bent_normal.x", "bent_normal.y", "bent_normal.z"}));
  good(kSolids + " -o light.exr --look lit --set reference.light=bounce --passes all" + few);
  const Image light = image("light.exr");
  float max = 0.0f;
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 24; ++x) max = std::max(max, light.plane("indirect.g").at(x, y));
  EXPECT_GT(max, 0.0f);
  good(kSolids + " -o plain.exr --look lit --passes all" + few);
  EXPECT_EQ(test::difference(image("plain.exr").plane("indirect.g"), Plane(24, 24, 0.0f), 0.0).max, 0.0);
  EXPECT_GT(test::difference(image("plain.exr").plane("lit.g"), light.plane("lit.g"), 0.0).max, 0.01);
}

TEST_F(CliLayers, TheReferenceBouncesLightWhereTheLookDoes) {
  const std::string few = " --resolution 24x24 --ao reference --passes all --set reference.samples=2";
  const auto brightest = [&](const std::string& options) {
    good(kSolids + " -o light.exr" + options + few);
    const Image light = image("light.exr");
    float max = 0.0f;
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 24; ++x) max = std::max(max, light.plane("indirect.g").at(x, y));
    return max;
  };
  EXPECT_GT(brightest(" --look bleeding"), 0.0f);
  EXPECT_GT(brightest(" --look bleeding-paper"), 0.0f);
  EXPECT_EQ(brightest(" --look bleeding --set reference.light=off"), 0.0f);
  EXPECT_EQ(brightest(" --look lit"), 0.0f);
}

TEST_F(CliLayers, RefusesReferencesThatCannotBe) {
  bad_option("--ao refrence", {"'refrence'", "did you mean 'reference'"});
  bad_option("--ao reference --set reference.samples=0", {"reference.samples", "'0'", "1 to 4096"});
  bad_option("--ao reference --set reference.samples=5000", {"reference.samples", "'5000'", "1 to 4096"});
  bad_option("--ao reference --set reference.lights=on", {"'lights'", "did you mean 'light'"});
  bad_option("--ao reference --set reference.light=bounced", {"'bounced'", "did you mean 'bounce'"});
  bad_option("--ao reference --ao-radius 0", {"--ao-radius", "'0'"});
  bad_option("--ao reference --ao-radius=-1", {"--ao-radius", "'-1'"});
  bad_option("--ao reference --ao-radius 1e9", {"--ao-radius", "larger than the scene"});
  bad_option("--ao reference --set reference.radius=1e9", {"reference.radius", "larger than the scene"});
}

TEST_F(CliLayers, LinesAloneHaveAlpha) {
  good(kSolids +
       " --look cartoon --passes outline --set outline.width=2 --set outline.r=1 --set outline.b=0.25 -o lines.png" +
       kSmall);
  const Image lines = image("lines.png");
  ASSERT_NE(lines.find("color.a"), nullptr);
  double min = 1.0, max = 0.0;
  for (int y = 0; y < lines.height; ++y)
    for (int x = 0; x < lines.width; ++x) {
      min = std::min<double>(min, lines.plane("color.a").at(x, y));
      max = std::max<double>(max, lines.plane("color.a").at(x, y));
      EXPECT_EQ(lines.plane("color.r").at(x, y), 1.0f);
      EXPECT_NEAR(lines.plane("color.b").at(x, y), 0.537, 0.003);  // 0.25 as sRGB
    }
  EXPECT_EQ(min, 0.0);
  EXPECT_GT(max, 0.9);
}

}  // namespace
}  // namespace umbrage
