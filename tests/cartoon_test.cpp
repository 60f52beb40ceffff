// Lines of the look `cartoon` on the built-in scenes, where those of effects/outline/outline_test.cpp do not tell.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "apps/job/job.h"
#include "devices/cpu/cpu_device.h"
#include "effects/effects.h"
#include "scene/builtin.h"
#include "support.h"

namespace umbrage {
namespace {

// The moulding below the ceiling of `room` is two lines, the lower of which has no room beside the upper one far away:
// it becomes thinner up to there. It had ended half as dark as a line.
TEST(Cartoon, TheLineOfAMouldingFadesWhereItBegins) {
  constexpr int kSize = 1024;
  constexpr const char* kLines = "outline";
  DrawSettings settings;
  settings.look = "cartoon";
  settings.width = settings.height = kSize;
  settings.frames = 1;
  Scene scene = *load_scene("scene:room");
  const auto device = make_cpu_device({});
  furnish(scene, settings);
  ASSERT_TRUE(device->prepare(scene));
  StageTimes times;
  const auto frame = draw(*device, scene, settings, times);
  ASSERT_TRUE(frame) << frame.error().message;
  const Image image = *device->download(*frame, {kLines});
  const Plane& lines = image.plane(kLines);

  // What it covers of a column, in the mean over eight of them: it is three to seven rows below the upper one.
  constexpr int kFirst = 540, kEnd = 756, kColumns = 8, kTop = 150, kBottom = 215;
  std::vector<double> widths;
  for (int x0 = kFirst; x0 < kEnd; x0 += kColumns) {
    double sum = 0.0;
    for (int x = x0; x < x0 + kColumns; ++x) {
      int upper = kTop;
      while (upper < kBottom && lines.at(x, upper) < 0.5f) ++upper;
      ASSERT_LT(upper, kBottom) << "column " << x;
      for (int y = upper + 3; y < upper + 8; ++y) sum += lines.at(x, y) / kColumns;
    }
    widths.push_back(sum);
  }
  EXPECT_EQ(widths.front(), 0.0);
  EXPECT_GT(widths.back(), 1.2);
  std::size_t begins = 0;
  while (widths[begins] == 0.0) ++begins;
  ASSERT_LT(begins + 1, widths.size());
  EXPECT_LT(widths[begins], 0.1);
  EXPECT_LT(widths[begins + 1], 0.2);
  for (std::size_t k = begins; k + 1 < widths.size(); ++k) EXPECT_GT(widths[k + 1], widths[k] - 0.1) << k;
}

// Lines are those of frame 0, over the mean of all: where they cover a pixel it has their colour, which no exposure
// changes.
TEST(Cartoon, LinesAreDrawnOnceOverTheMean) {
  const Scene scene = *make_builtin_scene("scene:solids?detail=2000");
  const auto drawn = [&](int frames, const std::vector<std::string>& also, bool averaged = false) {
    auto device = make_cpu_device();
    EXPECT_TRUE(device->prepare(scene));
    DrawSettings draw_with;
    draw_with.width = draw_with.height = 200;
    draw_with.look = "cartoon";
    draw_with.occlusion = "none";
    draw_with.frames = frames;
    draw_with.radius = "5%";  // which applies settings anew
    draw_with.settings = {"outline.width=4", "outline.r=0.6", "outline.g=0.3", "outline.b=0.05",
                          "output.transfer=none"};
    draw_with.settings.insert(draw_with.settings.end(), also.begin(), also.end());
    if (averaged) draw_with.averaged = {"outline"};
    StageTimes times;
    Scene own = scene;
    const auto frame = draw(*device, own, draw_with, times);
    EXPECT_TRUE(frame) << (frame ? "" : frame.error().message);
    return *device->download(*frame, {"outline", "color.r", "color.g", "color.b", "color.a"});
  };
  const Image single = drawn(1, {});
  for (const int frames : {2, 4})
    for (const char* exposure : {"output.exposure=0", "output.exposure=-1"}) {
      const Image picture = drawn(frames, {exposure}, frames == 4);
      EXPECT_EQ(test::difference(single.planes[0], picture.planes[0], 0.0).most, 0.0);
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
  // Where nothing is behind, alpha is theirs.
  const Image picture = drawn(4, {"output.transparent=on"});
  const Image bare = drawn(4, {"output.transparent=on", "outline.opacity=0"});
  int beyond = 0;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) {
      const float line = picture.planes[0].at(x, y), below = bare.planes[4].at(x, y);
      ASSERT_NEAR(picture.planes[4].at(x, y), line + (1.0f - line) * below, 1e-6f) << x << ", " << y;
      beyond += line > 0.0f && below == 0.0f;
    }
  EXPECT_GT(beyond, 10);
}

}  // namespace
}  // namespace umbrage
