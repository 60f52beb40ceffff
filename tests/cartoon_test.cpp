// Tests of the lines of the look `cartoon` on built-in scenes that effects/outline/outline_test.cpp does not cover.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "devices/cpu/cpu_device.h"
#include "generators/builtin.h"
#include "renderer/draw.h"
#include "renderer/models.h"
#include "support.h"

namespace umbrage {
namespace {

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
