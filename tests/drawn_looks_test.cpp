// Tests the pictures of looks that draw lines: tones, lines and background of `technical`, and lines of `cartoon` that
// effects/outline/outline_test.cpp does not cover.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/color.h"
#include "devices/cpu/cpu_device.h"
#include "generators/builtin.h"
#include "renderer/draw.h"
#include "renderer/models.h"
#include "renderer/recipe.h"
#include "support.h"

namespace umbrage {
namespace {

double luminance(const glm::dvec3& color) { return glm::dot(color, glm::dvec3(0.2126, 0.7152, 0.0722)); }

constexpr const char* kAlbedo[] = {"albedo.r", "albedo.g", "albedo.b"};

/// Returns the look's picture of the built-in solids, an average of `pictures`: color, outline, depth, normal and
/// albedo.
Image technical_picture(const std::vector<std::string>& settings, int pictures = 1) {
  Scene scene = *make_builtin_scene("scene:solids?detail=2000");
  const auto device = make_cpu_device();
  Request request;
  request.width = request.height = 200;
  request.look = "technical";
  request.anti_aliasing = pictures;
  request.passes = {"color", "outline", "depth", "normal", "albedo"};
  request.settings = settings;
  StageTimes times;
  EXPECT_TRUE(device->prepare(scene));
  const auto frame = draw(*device, scene, request, times);
  EXPECT_TRUE(frame) << (frame ? "" : frame.error().message);
  return *device->download(*frame, {"color.r", "color.g", "color.b", "outline", "depth", "normal.x", "normal.y",
                                    "normal.z", "albedo.r", "albedo.g", "albedo.b"});
}

TEST(Technical, PicturesHaveThePapersTonesBlackLinesAndALightBackground) {
  const Image picture = technical_picture(
      {"gooch.light_azimuth=90", "gooch.light_elevation=0", "gooch.highlight=0", "gooch.hue=0", "outline.width=4"});
  long lines = 0, background = 0, surfaces = 0;
  for (int y = 2; y < 198; ++y)
    for (int x = 2; x < 198; ++x) {
      const glm::dvec3 color = {picture.planes[0].at(x, y), picture.planes[1].at(x, y), picture.planes[2].at(x, y)};
      const float line = picture.plane("outline").at(x, y);
      // The effect `antialias` mixes colours beside edges, which are within a few pixels of lines.
      bool is_clear = true;
      for (int j = -2; j <= 2; ++j)
        for (int i = -2; i <= 2; ++i) is_clear &= picture.plane("outline").at(x + i, y + j) == 0.0f;
      if (line == 1.0f) {
        ++lines;
        EXPECT_LT(luminance(color), 0.01) << x << ", " << y;
      } else if (is_clear && !std::isfinite(picture.plane("depth").at(x, y))) {
        ++background;
        EXPECT_GT(luminance(color), 0.9);
      } else if (is_clear) {
        ++surfaces;
        const double light = 0.5 + 0.5 * picture.plane("normal.x").at(x, y);
        for (int c = 0; c < 3; ++c) {
          const double kd = srgb_from_linear(picture.plane(kAlbedo[c]).at(x, y));
          const double cool = (c == 2 ? 0.4 : 0.0) + 0.2 * kd, warm = (c == 2 ? 0.0 : 0.4) + 0.6 * kd;
          ASSERT_NEAR(color[c], (1.0 - light) * cool + light * warm, 1.0 / 255.0) << x << ", " << y;
        }
      }
    }
  EXPECT_GT(lines, 500);
  EXPECT_GT(background, 5000);
  EXPECT_GT(surfaces, 3000);
}

TEST(Technical, HiddenLinesCaptureTheLayersThatTheyNeed) {
  const auto layers = [](const std::vector<std::string>& settings, std::optional<int> set) {
    Request request;
    request.look = "technical";
    request.settings = settings;
    request.layers = set;
    return make_recipe(request)->capture.layers;
  };
  EXPECT_EQ(layers({}, {}), 1);
  EXPECT_EQ(layers({"hidden.draw=on"}, {}), 8);
  EXPECT_EQ(layers({"hidden.draw=on", "hidden.layers=1"}, {}), 4);
  EXPECT_EQ(layers({"hidden.draw=on"}, 3), 3);
}

TEST(Technical, HiddenLinesCaptureAsManyLayersAsFit) {
  const auto layers = [](int side) {
    Request request;
    request.width = request.height = side;
    request.look = "technical";
    request.settings = {"hidden.draw=on"};
    const auto recipe = make_recipe(request);
    return recipe ? recipe->capture.layers : 0;
  };
  EXPECT_EQ(layers(2048), 8);
  EXPECT_EQ(layers(4096), 4);
  EXPECT_EQ(layers(8192), 0) << "two layers do not fit";
  Request request;  // the layers of a G-buffer are given, and need no room
  request.width = 4096, request.height = 2160;
  request.look = "technical";
  request.settings = {"hidden.draw=on"};
  EXPECT_TRUE(make_shading_recipe(request));
}

TEST(Technical, OutlinesOfModePaperAreAveragedAlsoWithHiddenLines) {
  const auto smooth_pixels = [](const std::string& draw) {
    const Plane lines = technical_picture({"outline.mode=paper", "hidden.layers=1", draw}, 4).plane("outline");
    int count = 0;
    for (int y = 0; y < 200; ++y)
      for (int x = 0; x < 200; ++x) count += lines.at(x, y) == 0.25f || lines.at(x, y) == 0.5f;
    return count;
  };
  const int without = smooth_pixels("hidden.draw=off");
  EXPECT_GT(without, 200);
  EXPECT_NEAR(smooth_pixels("hidden.draw=on"), without, 0.3 * without);
}

TEST(Technical, HiddenLinesAreDrawnOverAverages) {
  // The lines are those of sample 0 whether or not the picture is an average.
  const Plane without = technical_picture({}).plane("outline");
  const Plane one = technical_picture({"hidden.draw=on", "hidden.width=1"}).plane("outline");
  const Plane average = technical_picture({"hidden.draw=on", "hidden.width=1"}, 4).plane("outline");
  int more = 0, differ = 0;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) {
      EXPECT_GE(one.at(x, y), without.at(x, y));
      more += one.at(x, y) > without.at(x, y) + 0.2f;
      differ += one.at(x, y) != average.at(x, y);
    }
  EXPECT_GT(more, 300);
  EXPECT_EQ(differ, 0);
}

TEST(Technical, HiddenLinesOfOneLayerAreReported) {
  Request request;
  request.look = "technical";
  request.settings = {"hidden.draw=on"};
  request.layers = 1;
  const auto any = [](std::string_view) { return true; };
  const auto warnings = setting_warnings(request, *make_recipe(request), nullptr, any);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0], "`settings` hidden draws nothing: the picture has one layer");
  request.layers.reset();
  EXPECT_TRUE(setting_warnings(request, *make_recipe(request), nullptr, any).empty());
  request.width = request.height = 4096;
  ASSERT_EQ(setting_warnings(request, *make_recipe(request), nullptr, any).size(), 1u);
  EXPECT_EQ(setting_warnings(request, *make_recipe(request), nullptr, any)[0],
            "`settings` hidden draws what 4 layers show: 8 layers of 4096 x 4096 pixels are too large");
  EXPECT_TRUE(setting_warnings(request, *make_recipe(request, kMaxStripPixels), nullptr, any).empty());
}

// Lines are those of sample index 0, drawn over the mean of all pictures. A fully covered pixel has the colour of the
// line, without exposure.
TEST(Cartoon, LinesAreDrawnOnceOverTheMean) {
  const Scene scene = *make_builtin_scene("scene:solids?detail=2000");
  const auto drawn = [&](int frames, const std::vector<std::string>& extra, bool averaged = false) {
    auto device = make_cpu_device();
    EXPECT_TRUE(device->prepare(scene));
    Request request;
    request.width = request.height = 200;
    request.look = "cartoon";
    request.occlusion = "none";
    request.anti_aliasing = frames;
    request.occlusion_radius = "5%";  // which applies the settings again
    request.settings = {"outline.width=4", "outline.r=0.6", "outline.g=0.3", "outline.b=0.05", "output.transfer=none"};
    request.settings.insert(request.settings.end(), extra.begin(), extra.end());
    if (averaged) request.passes = {"outline"};
    StageTimes times;
    Scene own = scene;
    const auto frame = draw(*device, own, request, times);
    EXPECT_TRUE(frame) << (frame ? "" : frame.error().message);
    return *device->download(*frame, {"outline", "color.r", "color.g", "color.b", "color.a"});
  };
  const Image single = drawn(1, {});
  for (const int frames : {2, 4})
    for (const char* exposure : {"output.exposure=0", "output.exposure=-1"}) {
      const Image picture = drawn(frames, {exposure}, frames == 4);
      EXPECT_EQ(test::difference(single.planes[0], picture.planes[0], 0.0).max, 0.0);
      const float line[] = {0.6f, 0.3f, 0.05f};
      int lines = 0;
      for (int y = 0; y < 200; ++y)
        for (int x = 0; x < 200; ++x) {
          if (picture.planes[0].at(x, y) < 1.0f) continue;
          ++lines;
          for (int c = 0; c < 3; ++c) ASSERT_NEAR(picture.planes[1 + c].at(x, y), line[c], 1e-6f) << x << ", " << y;
        }
      EXPECT_GT(lines, 200);
    }
  // Over the transparent background, alpha is that of the lines.
  const Image picture = drawn(4, {"output.transparent=on"});
  const Image without_lines = drawn(4, {"output.transparent=on", "outline.opacity=0"});
  int beyond = 0;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) {
      const float line = picture.planes[0].at(x, y), below = without_lines.planes[4].at(x, y);
      ASSERT_NEAR(picture.planes[4].at(x, y), line + (1.0f - line) * below, 1e-6f) << x << ", " << y;
      beyond += line > 0.0f && below == 0.0f;
    }
  EXPECT_GT(beyond, 10);
}

}  // namespace
}  // namespace umbrage
