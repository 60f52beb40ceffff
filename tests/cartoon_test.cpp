// Lines of the look `cartoon` on the built-in scenes, where those of effects/outline/outline_test.cpp do not tell.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "apps/job/job.h"
#include "devices/cpu/cpu_device.h"
#include "effects/effects.h"

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

}  // namespace
}  // namespace umbrage
