// Coarse occluders on their way from the scene to a technique: made once per scene, on request, for every device.
#include <gtest/gtest.h>

#include "core/gbuffer.h"
#include "devices/cpu/cpu_device.h"
#include "generators/builtin.h"
#include "renderer/draw.h"
#include "renderer/plan.h"
#include "renderer/recipe.h"
#include "vulkan_support.h"

namespace umbrage {
namespace {

Request request_of(std::string_view technique, std::vector<std::string> settings = {}) {
  Request request;
  request.width = 96;
  request.height = 64;
  request.look = "ao";
  request.occlusion = technique;
  request.settings = std::move(settings);
  return request;
}

int requested(const Request& request) { return make_recipe(request)->capture.occluders; }

TEST(CoarseOccluders, AreCapturedOnlyForTechniquesThatReadThem) {
  EXPECT_EQ(requested(request_of("bitmask")), 0);
  EXPECT_EQ(requested(request_of("shanmugam", {"shanmugam.occluders=77"})), 77);
  EXPECT_EQ(requested(request_of("shanmugam", {"shanmugam.far=off"})), 0);
}

void expect_made_once(Device& device) {
  const Scene scene = *make_builtin_scene("scene:solids?detail=4000"),
              other = *make_builtin_scene("scene:pink?detail=4000");
  ASSERT_TRUE(device.prepare(scene));
  const Plan plan = *make_plan(*make_recipe(request_of("shanmugam")), scene, 0);
  const auto captured = [&](int count) {
    CaptureSettings settings = plan.capture;
    settings.occluders = count;
    return device.capture(plan.camera, settings)->info.occluders;
  };
  const auto first = captured(24);
  ASSERT_TRUE(first);
  EXPECT_GT(first->occluders.size(), 8u);
  EXPECT_LE(first->occluders.size(), 24u);
  EXPECT_EQ(captured(24), first);
  EXPECT_EQ(captured(0), nullptr);
  EXPECT_EQ(captured(24), first) << "kept while other pictures do without";
  ASSERT_TRUE(device.prepare(other));
  EXPECT_NE(captured(24), first);
  device.release_scene();
}

TEST(CoarseOccluders, AreMadeOncePerScene) { expect_made_once(*make_cpu_device({})); }

TEST(CoarseOccluders, AreMadeOncePerSceneOnVulkan) {
  Device* const device = test::vulkan_device();
  UMBRAGE_NEEDS_VULKAN(device);
  expect_made_once(*device);
}

TEST(CoarseOccluders, DarkenWhatIsFarFromThem) {
  const Scene scene = *make_builtin_scene("scene:claw?detail=4000");
  const auto device = make_cpu_device({});
  ASSERT_TRUE(device->prepare(scene));
  const auto mean_of = [&](std::vector<std::string> settings) {
    StageTimes times;
    const auto frame = draw(*device, scene, request_of("shanmugam", std::move(settings)), times);
    const Plane ao = device->download(*frame, {"ao"})->planes[0];
    double sum = 0.0;
    for (int y = 0; y < ao.height; ++y)
      for (int x = 0; x < ao.width; ++x) sum += double(ao.at(x, y));
    return sum / (ao.width * ao.height);
  };
  EXPECT_LT(mean_of({}), mean_of({"shanmugam.far=off"}) - 0.01);
  EXPECT_LT(mean_of({}), mean_of({"shanmugam.near=off"}) - 0.005);
  EXPECT_EQ(mean_of({"shanmugam.near=off", "shanmugam.far=off"}), 1.0);
}

TEST(CoarseOccluders, OfAGBufferAreMissedAloud) {
  const auto warnings = [](const Request& request) {
    return setting_warnings(request, *make_shading_recipe(request), nullptr, [](std::string_view) { return true; });
  };
  EXPECT_EQ(
      warnings(request_of("shanmugam")),
      (std::vector<std::string>{"`occlusion` shanmugam: a G-buffer has no model, so that only what is near occludes"}));
  EXPECT_TRUE(warnings(request_of("shanmugam", {"shanmugam.far=off"})).empty());
  EXPECT_TRUE(warnings(request_of("bitmask")).empty());
}

}  // namespace
}  // namespace umbrage
