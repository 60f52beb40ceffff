// Captures are reused while effects change: each picture is identical to one drawn anew.
#include <gtest/gtest.h>

#include <cstring>

#include "devices/cpu/cpu_device.h"
#include "faulty_vulkan.h"
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
  PreparedScene(Device& device, const std::string& look, Ground ground = Ground::kOn, bool blended = false)
      : device_(device), scene_(*load_scene("scene:solids?detail=2000")) {
    if (blended) scene_.materials[1].blended = true, scene_.materials[1].opacity = 0.4f;
    Recipe recipe = recipe_of({look, {}});
    recipe.ground = ground;
    complete_scene(scene_, recipe);
    EXPECT_TRUE(device.prepare(scene_));
  }

  Plan plan_of(const Case& wanted) const { return *make_plan(recipe_of(wanted), scene_, device_.threads()); }

  Image drawn(const Plan& plan) { return downloaded(draw(device_, scene_, plan, times_)); }
  Image drawn(const Plan& plan, const Captures& captures) {
    return downloaded(draw_captured(device_, scene_, plan, captures, times_));
  }
  Captures captured(const Plan& plan) { return *capture(device_, plan, times_); }

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

void expect_captures_are_reusable(Device& device, const std::string& look, int frames, const std::string& scale,
                                  int height = 45, bool blended = false) {
  SCOPED_TRACE(look + " " + std::to_string(frames) + " " + scale);
  PreparedScene prepared(device, look, Ground::kOn, blended);
  EXPECT_EQ(prepared.plan_of({look, {}, frames, scale, height}).has_blended, blended);
  const std::vector<Case> cases = {{look, {}, frames, scale, height},
                                   {look, {"output.exposure=1", "traced.falloff=linear"}, frames, scale, height},
                                   {look, {"outline.opacity=0.5", "composite.damping=0.3"}, frames, scale, height},
                                   {look, {}, frames, scale, height}};
  const Captures captures = prepared.captured(prepared.plan_of(cases[0]));
  const Image before = *device.download_all(captures[0]);
  std::vector<Image> pictures;
  for (const Case& wanted : cases) {
    const Plan plan = prepared.plan_of(wanted);
    if (!same_captures(plan, prepared.plan_of(cases[0]))) continue;
    pictures.push_back(prepared.drawn(plan, captures));
    expect_same(prepared.drawn(plan), pictures.back());
  }
  ASSERT_GE(pictures.size(), 3u);
  EXPECT_NE(pictures[0].plane("color.r").at(30, height / 2), pictures[1].plane("color.r").at(30, height / 2));
  expect_same(before, *device.download_all(captures[0]));
}

TEST(Captures, AreReusableForOtherEffectsOnTheCpu) {
  const auto device = make_cpu_device();
  for (const char* look : {"studio", "bleeding", "cartoon", "lit"})
    expect_captures_are_reusable(*device, look, 1, "full", 150);
  expect_captures_are_reusable(*device, "studio", 3, "full", 150);
  expect_captures_are_reusable(*device, "studio", 3, "full", 150, true);
  expect_captures_are_reusable(*device, "studio", 1, "half", 150);
}

TEST(Captures, AreReusableForOtherEffectsOnVulkan) {
  Device* device = test::vulkan_device();
  UMBRAGE_NEEDS_VULKAN(device);
  const test::NoMessages no_messages;
  expect_captures_are_reusable(*device, "studio", 1, "half");
  expect_captures_are_reusable(*device, "cartoon", 2, "full");
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
  const auto captures = capture(*device, plan, times);
  test::faulty().faults.submit = VK_SUCCESS;
  ASSERT_FALSE(captures);
  EXPECT_EQ(captures.error().kind, ErrorKind::kDevice);
}

TEST(Captures, AreNotReusableForOtherCamerasOrLayers) {
  const auto device = make_cpu_device();
  PreparedScene prepared(*device, "studio");
  const Plan plan = prepared.plan_of({"studio", {}});
  EXPECT_TRUE(same_captures(plan, prepared.plan_of({"studio", {"output.exposure=1"}})));
  EXPECT_FALSE(same_captures(plan, prepared.plan_of({"studio", {}, 4})));
  EXPECT_FALSE(same_captures(plan, prepared.plan_of({"bleeding", {}})));
  Plan bare = PreparedScene(*device, "studio", Ground::kOff).plan_of({"studio", {}});
  EXPECT_TRUE(plan.has_ground);
  EXPECT_FALSE(bare.has_ground);
  bare.camera = plan.camera;
  bare.capture = plan.capture;
  EXPECT_FALSE(same_captures(plan, bare));
  Plan moved = plan;
  moved.camera.left -= 0.1f;
  EXPECT_FALSE(same_captures(plan, moved));
  Plan lit = plan;
  lit.lighting().ambient.x += 0.1f;
  EXPECT_FALSE(same_captures(plan, lit));
}

}  // namespace
}  // namespace umbrage
