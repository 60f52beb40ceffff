// Tests of what the program writes to .exr files: scene-linear colour, passes for compositing, background values.
#include <gtest/gtest.h>

#include "cli_support.h"
#include "core/color.h"
#include "vulkan_support.h"

namespace umbrage {
namespace {

using test::kSmall;
using test::kSolids;

constexpr const char* kChannels[] = {"r", "g", "b"};

class CliExr : public test::ProgramTest {
 protected:
  /// Draws with these options and returns the planes of the .exr file.
  Image exr(const std::string& options) {
    good(options + " -o x.exr" + kSmall);
    return image("x.exr");
  }
  std::string header() { return test::text_of(folder_ / "x.exr").substr(0, 2000); }
};

bool is_surface(const Image& image, int x, int y) { return std::isfinite(image.plane("depth").at(x, y)); }

double srgb(double v) { return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055; }

TEST_F(CliExr, ThePngIsItsDisplayTransform) {
  // Without averaging, and with a look without tone curve: the curve of an average is not the average of the curve.
  // Without a ground: a shadow is the alpha of light in .exr, and of display values in .png.
  for (const char* look : {"studio --anti-aliasing 1 --set output.tone=none --ground off",
                           "lit --anti-aliasing 1 --ground off", "cartoon", "ao --anti-aliasing 1"})
    for (const char* background : {"", " --no-background", " --background-color 0.2,0.4,0.6"}) {
      SCOPED_TRACE(std::string(look) + background);
      const std::string options = kSolids + " --look " + look + background;
      const Image light = exr(options);
      good(options + " -o x.png" + kSmall);
      const Image display = image("x.png");
      double worst = 0.0;
      for (int y = 0; y < light.height; ++y)
        for (int x = 0; x < light.width; ++x) {
          const float alpha = light.plane("color.a").at(x, y);
          if (const Plane* a = display.find("color.a")) {
            ASSERT_NEAR(a->at(x, y), alpha, 1.0 / 255) << x << ' ' << y;
          }
          for (const std::string channel : kChannels) {
            const float v = light.plane("color." + channel).at(x, y);
            if (alpha < 0.02f) {
              ASSERT_LE(v, 0.02f);  // premultiplied
              continue;
            }
            const double shown = std::min(srgb(double(v) / double(alpha)), 1.0);
            worst = std::max(worst, std::abs(shown - double(display.plane("color." + channel).at(x, y))));
          }
        }
      EXPECT_LE(worst, 1.0 / 255) << worst * 255;
    }
}

TEST_F(CliExr, TheBackgroundIsLinear) {
  const Image drawn = exr("tri.obj --background-color 0.25,0.5,0.75");
  EXPECT_FLOAT_EQ(drawn.plane("color.r").at(0, 0), linear_from_srgb(0.25f));
  EXPECT_FLOAT_EQ(drawn.plane("color.b").at(0, 0), linear_from_srgb(0.75f));
  EXPECT_EQ(drawn.plane("color.a").at(0, 0), 1.0f);
}

TEST_F(CliExr, TheDisplayTransformIsWrittenIfItIsSet) {
  good(kSolids + " -o x.png --no-background" + kSmall);
  const Image display = image("x.png"), set = exr(kSolids + " --no-background --set output.transfer=srgb");
  for (int y = 0; y < set.height; ++y)
    for (int x = 0; x < set.width; ++x) {
      const float alpha = set.plane("color.a").at(x, y);
      ASSERT_NEAR(set.plane("color.g").at(x, y), alpha * display.plane("color.g").at(x, y), 1.0 / 255);
    }
}

TEST_F(CliExr, HeadersStateColourAndCamera) {
  exr(kSolids);
  const std::string text = header();
  for (const char* name : {"worldToCamera", "worldToNDC"}) EXPECT_NE(text.find(name), std::string::npos) << name;
  const std::string start = std::string("chromaticities\0chromaticities\0\x20\0\0\0", 34);
  const std::size_t at = text.find(start);
  ASSERT_NE(at, std::string::npos);
  float values[8];
  std::memcpy(values, text.data() + at + start.size(), sizeof values);
  const float rec709[] = {0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f};
  for (int k = 0; k < 8; ++k) EXPECT_FLOAT_EQ(values[k], rec709[k]) << k;
}

TEST_F(CliExr, BeautyIsTheSumOfItsParts) {
  for (const char* options :
       {"", " --no-background", " --quality draft --anti-aliasing 1", " --look lit --anti-aliasing 1",
        " --look bleeding --anti-aliasing 1", " --hdri-file sky: --hdri-skybox", " --set output.exposure=1.5"}) {
    SCOPED_TRACE(options);
    const Image all = exr(kSolids + options + " --passes beauty");
    for (const char* name : {"color.a", "depth", "normal.x", "albedo.r", "ao", "shadow", "direct.r", "object_id"})
      EXPECT_NE(all.find(name), nullptr) << name;
    double worst = 0.0, max = 0.0;
    for (int y = 0; y < all.height; ++y)
      for (int x = 0; x < all.width; ++x)
        for (const std::string channel : kChannels) {
          double sum = 0.0;
          for (const char* part : {"direct.", "ambient.", "indirect.", "background."})
            sum += double(all.plane("beauty_" + (part + channel)).at(x, y));
          const double beauty = double(all.plane("color." + channel).at(x, y));
          worst = std::max(worst, std::abs(sum - beauty));
          max = std::max(max, beauty);
        }
    EXPECT_LE(worst, 1e-5);
    EXPECT_GT(max, 0.1);
    // The preset does not change the picture.
    const Image alone = exr(kSolids + options);
    for (const char* name : {"color.r", "color.g", "color.b", "color.a"})
      EXPECT_EQ(test::difference(all.plane(name), alone.plane(name), 0.0).max, 0.0) << name;
  }
}

TEST_F(CliExr, EdgesAreSmoothWithoutParts) {
  const Image smooth = exr(kSolids + " --look bleeding"), jagged = exr(kSolids + " --look bleeding --anti-aliasing 1"),
              parts = exr(kSolids + " --look bleeding --passes beauty");
  EXPECT_GT(test::difference(smooth.plane("color.g"), jagged.plane("color.g"), 0.0).max, 0.05);
  EXPECT_EQ(test::difference(parts.plane("color.g"), jagged.plane("color.g"), 0.0).max, 0.0);
}

TEST_F(CliExr, BeautyIsForFilesOfSeveralPasses) {
  bad(kSolids + " -o x.png --passes beauty", 2, {"--passes beauty", ".exr"});
  // Looks without these parts have the rest.
  const Image drawn = exr(kSolids + " --look cartoon --passes beauty,outline");
  EXPECT_NE(drawn.find("outline"), nullptr);
  EXPECT_NE(drawn.find("normal.x"), nullptr);
  EXPECT_EQ(drawn.find("beauty_direct.r"), nullptr);
}

TEST_F(CliExr, StripsAreTheSame) {
  for (const char* options : {"", " --no-background --look cartoon", " --quality draft"}) {
    SCOPED_TRACE(options);
    const std::string line = kSolids + options + " --passes beauty --resolution 64x200 -o ";
    good(line + "whole.exr");
    run("render " + line + "strips.exr --memory 1M");
    EXPECT_EQ(test::text_of(folder_ / "whole.exr"), test::text_of(folder_ / "strips.exr"));
  }
}

TEST_F(CliExr, WhatShowsNoSurfaceHasBackgroundValues) {
  const std::string passes =
      " --passes depth,normal,albedo,specular,shininess,shadow,shadow1,direct,ambient,open_light,ao,indirect,object_id,"
      "material_id,shadow_catcher,layer1.depth,layer1.normal,layer1.object_id --layers 2";
  for (const char* options : {"", " --anti-aliasing 1", " --memory 1M", " --device vulkan --anti-aliasing 1",
                              " --hdri-file sky: --hdri-skybox"}) {
    SCOPED_TRACE(options);
    const std::string line = "render tri.obj --ground on" + passes + options + kSmall + " -o x.exr";
    const int code = run(line).code;
    if (code == 4 && line.find("vulkan") != std::string::npos && test::may_lack_vulkan()) continue;
    ASSERT_EQ(code, 0);
    const Image drawn = image("x.exr");
    long empty = 0, shaded = 0;
    for (int y = 0; y < drawn.height; ++y)
      for (int x = 0; x < drawn.width; ++x) {
        const bool behind = std::isfinite(drawn.plane("layer1.depth").at(x, y));
        ASSERT_EQ(drawn.plane("layer1.object_id").at(x, y), behind ? 0.0f : -1.0f) << "the ground is object 1";
        if (!behind) {
          ASSERT_EQ(drawn.plane("layer1.normal.y").at(x, y), 0.0f);
        }
        if (is_surface(drawn, x, y)) continue;
        ++empty;
        shaded += drawn.plane("shadow_catcher").at(x, y) > 0.0f;
        for (std::size_t k = 0; k < drawn.names.size(); ++k) {
          const std::string& name = drawn.names[k];
          if (name == "depth" || name == "shadow_catcher" || name.starts_with("layer1.")) continue;
          const bool one = name == "ao" || name == "shadow" || name == "shadow1";
          ASSERT_EQ(drawn.planes[k].at(x, y), one ? 1.0f : name.ends_with("_id") ? -1.0f : 0.0f) << name;
        }
      }
    EXPECT_GT(empty, 1000);
    EXPECT_GT(shaded, 10) << "the ground was there";
  }
}

}  // namespace
}  // namespace umbrage
