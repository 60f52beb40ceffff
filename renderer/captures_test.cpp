// A capture is reused while effects change: each picture is identical to one drawn anew.
#include <gtest/gtest.h>

#include <cstring>

#include "core/check.h"
#include "devices/cpu/cpu_device.h"
#include "faulty_vulkan.h"
#include "renderer/completed_scene.h"
#include "renderer/draw.h"
#include "renderer/models.h"
#include "support.h"
#include "vulkan_support.h"

namespace umbrage {
namespace {

struct Case {
  std::string look;
  std::vector<std::string> settings;
  int frames = 1;
  std::string scale = {};
  int height = 45;
};

/// A scene completed for a look, by default with a ground, and a device that is prepared with it.
class PreparedScene {
 public:
  PreparedScene(Device& device, const std::string& look, Ground ground = Ground::kOn)
      : device_(device), scene_(*load_scene("scene:solids?detail=2000")) {
    Recipe recipe = recipe_of({look, {}});
    recipe.ground = ground;
    EXPECT_TRUE(complete_scene(scene_, recipe));
    EXPECT_TRUE(device.prepare(scene_));
  }

  Plan plan_of(const Case& wanted) const { return *make_plan(recipe_of(wanted), scene_, device_.threads()); }

  Image drawn(const Plan& plan) { return downloaded(draw(device_, scene_, plan, times_)); }
  Image drawn(const Plan& plan, const Frame& captured) {
    return downloaded(draw_captured(device_, scene_, plan, captured, times_));
  }
  Image drawn(const Plan& plan, KeptCapture& kept, StageTimes& times) {
    return downloaded(draw_keeping(device_, scene_, plan, kept, times, [] { return Result<void>(); }, {}, {}));
  }
  Frame captured(const Plan& plan) { return *capture(device_, plan, times_); }

 private:
  static Recipe recipe_of(const Case& wanted) {
    Request request{.look = wanted.look, .settings = wanted.settings, .width = 60, .height = wanted.height};
    request.occlusion_scale = wanted.scale;
    Recipe recipe = *make_recipe(request);
    recipe.frames = wanted.frames;
    return recipe;
  }

  Image downloaded(const Result<Drawn>& picture) {
    EXPECT_TRUE(picture) << picture.error().message;
    return *device_.download_all(picture->frame);
  }

  Device& device_;
  Scene scene_;
  StageTimes times_;
};

void expect_same(const Image& a, const Image& b) {
  ASSERT_EQ(a.width, b.width);
  for (const std::string& name : a.names) {
    ASSERT_NE(b.find(name), nullptr) << name;
    const Plane &p = a.plane(name), &q = b.plane(name);
    for (int y = 0; y < a.height; ++y)
      ASSERT_EQ(std::memcmp(p.row(y), q.row(y), std::size_t(a.width) * sizeof(float)), 0) << name << " row " << y;
  }
  EXPECT_EQ(a.names.size(), b.names.size());
}

void expect_captures_are_reusable(Device& device, const std::string& look, const std::string& scale, int height = 45) {
  SCOPED_TRACE(look + " " + scale);
  PreparedScene prepared(device, look);
  const std::vector<Case> cases = {{look, {}, 1, scale, height},
                                   {look, {"output.exposure=1", "traced.falloff=linear"}, 1, scale, height},
                                   {look, {"outline.opacity=0.5", "composite.damping=0.3"}, 1, scale, height},
                                   {look, {}, 1, scale, height}};
  const Frame captured = prepared.captured(prepared.plan_of(cases[0]));
  const Image before = *device.download_all(captured);
  std::vector<Image> pictures;
  for (const Case& wanted : cases) {
    const Plan plan = prepared.plan_of(wanted);
    if (!same_capture(plan, prepared.plan_of(cases[0]))) continue;
    pictures.push_back(prepared.drawn(plan, captured));
    expect_same(prepared.drawn(plan), pictures.back());
  }
  ASSERT_GE(pictures.size(), 3u);
  EXPECT_NE(pictures[0].plane("color.r").at(30, height / 2), pictures[1].plane("color.r").at(30, height / 2));
  expect_same(before, *device.download_all(captured));
}

TEST(Captures, AreReusableForOtherEffectsOnTheCpu) {
  const auto device = make_cpu_device();
  for (const char* look : {"studio", "bleeding", "cartoon", "lit"})
    expect_captures_are_reusable(*device, look, "full", 150);
  expect_captures_are_reusable(*device, "studio", "half", 150);
}

TEST(Captures, AreReusableForOtherEffectsOnVulkan) {
  Device* device = test::vulkan_device();
  UMBRAGE_NEEDS_VULKAN(device);
  const test::NoMessages no_messages;
  expect_captures_are_reusable(*device, "studio", "half");
  expect_captures_are_reusable(*device, "cartoon", "full");
}

TEST(Captures, ReportAFailedSubmission) {
  UMBRAGE_NEEDS_VULKAN(test::start_faulty());
  const auto device = test::new_vulkan_device({.get = test::faulty_get});
  UMBRAGE_NEEDS_VULKAN(device);
  PreparedScene prepared(*device, "studio");
  StageTimes times;
  const Plan plan = prepared.plan_of({"studio", {}});
  EXPECT_TRUE(capture(*device, plan, times));
  test::faulty().faults.submit = VK_ERROR_OUT_OF_DEVICE_MEMORY;
  const auto captured = capture(*device, plan, times);
  test::faulty().faults.submit = VK_SUCCESS;
  ASSERT_FALSE(captured);
  EXPECT_EQ(captured.error().kind, ErrorKind::kDevice);
}

TEST(Captures, DoNotServeAverages) {
  const auto device = make_cpu_device();
  PreparedScene prepared(*device, "studio");
  const Plan one = prepared.plan_of({"studio", {}}), four = prepared.plan_of({"studio", {}, 4});
  EXPECT_FALSE(same_capture(four, four));
  StageTimes times;
  EXPECT_THROW((void)draw_captured(*device, Scene(), four, prepared.captured(one), times), InternalError);
}

TEST(Captures, KeepTheExposureOfTheSceneForOtherViews) {
  const auto device = make_cpu_device();
  PreparedScene prepared(*device, "studio");
  KeptCapture kept;
  const auto metered = [&](const Case& wanted) {
    StageTimes times;
    const Plan plan = prepared.plan_of(wanted);
    expect_same(prepared.drawn(plan, kept, times), prepared.drawn(plan));
    return std::any_of(times.stages.begin(), times.stages.end(), [](const auto& s) { return s.name == "metering"; });
  };
  EXPECT_TRUE(metered({"studio", {}}));
  EXPECT_FALSE(metered({.look = "studio", .settings = {}, .height = 60}));
  EXPECT_TRUE(metered({"studio", {"output.exposure=1"}}));
}

TEST(Captures, AreNotReusableForOtherCamerasOrLayers) {
  const auto device = make_cpu_device();
  PreparedScene prepared(*device, "studio");
  const Plan plan = prepared.plan_of({"studio", {}});
  EXPECT_TRUE(same_capture(plan, prepared.plan_of({"studio", {"output.exposure=1"}})));
  EXPECT_FALSE(same_capture(plan, prepared.plan_of({"studio", {}, 4})));
  EXPECT_FALSE(same_capture(plan, prepared.plan_of({"bleeding", {}})));
  Plan bare = PreparedScene(*device, "studio", Ground::kOff).plan_of({"studio", {}});
  EXPECT_TRUE(plan.has_ground);
  EXPECT_FALSE(bare.has_ground);
  bare.camera = plan.camera;
  bare.capture = plan.capture;
  EXPECT_FALSE(same_capture(plan, bare));
  Plan moved = plan;
  moved.camera.left -= 0.1f;
  EXPECT_FALSE(same_capture(plan, moved));
  Plan lit = plan;
  lit.lighting().ambient.x += 0.1f;
  EXPECT_FALSE(same_capture(plan, lit));
}

}  // namespace
}  // namespace umbrage
