// The progress of drawings: nested parts, and strips of marked samples.
#include "renderer/drawing.h"

#include <gtest/gtest.h>

#include "devices/cpu/cpu_device.h"
#include "renderer/models.h"
#include "renderer/strips.h"

namespace umbrage {
namespace {

TEST(DrawProgress, PartsAreFractionsOfThePartAroundThem) {
  double reported = -1.0;
  const ProgressMonitor monitor = [&](double done) { return reported = done, true; };
  DrawProgress progress(monitor, 2);
  const ProgressMonitor step = progress.step_monitor();
  {
    const DrawProgress::Part sample(progress, 0.5, 1.0);
    step(0.5);
    EXPECT_DOUBLE_EQ(reported, 0.5 + 0.5 * 0.25);
    progress.step_done();
    {
      const DrawProgress::Part strip(progress, 0.75, 1.0);
      step(0.0);
      EXPECT_DOUBLE_EQ(reported, 0.875) << "a part begins with no step";
    }
    step(1.0);
    EXPECT_DOUBLE_EQ(reported, 1.0) << "the part around it goes on after its first step";
  }
  const DrawProgress::Part earlier(progress, 0.0, 0.1);
  step(0.0);
  EXPECT_DOUBLE_EQ(reported, 1.0) << "progress never decreases";
}

TEST(DrawProgress, OfStripsOfMarkedSamplesGrowsSteadily) {
  Request request{.look = "studio", .width = 80, .height = 256};
  const auto recipe = make_recipe(request);
  Scene scene = *load_scene("scene:solids?detail=2000");
  complete_scene(scene, *recipe);
  const auto device = make_cpu_device();
  ASSERT_TRUE(device->prepare(scene));
  const auto plan = make_plan(*recipe, scene, device->threads());
  ASSERT_TRUE(plan && plan->marked);
  std::vector<double> reported = {0.0};
  const auto monitor = [&](double done) { return reported.push_back(done), true; };
  StageTimes times;
  const auto take = [](const PictureInfo&, const Image&, int) { return Result<void>(); };
  ASSERT_TRUE(draw_strips(*device, *plan, 64, {"color.r"}, false, take, times, monitor));
  EXPECT_DOUBLE_EQ(reported.back(), 1.0);
  double largest = 0.0;
  for (std::size_t k = 1; k < reported.size(); ++k) {
    EXPECT_GE(reported[k], reported[k - 1]);
    largest = std::max(largest, reported[k] - reported[k - 1]);
  }
  EXPECT_LT(largest, 1.0 / 8.0) << "each picture of a strip counts";
}

}  // namespace
}  // namespace umbrage
