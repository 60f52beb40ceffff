// Lights for scenes without lights when the camera is inside the scene.
#include "rays/interior_lights.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "generators/shapes.h"
#include "renderer/devices.h"
#include "renderer/draw.h"
#include "renderer/models.h"
#include "scene/finish.h"

namespace umbrage {
namespace {

/// Returns a hall of 8 x 4 x 8 with walls. Its roof has a gap along the middle if it is `open`.
Scene hall(bool open) {
  Scene scene;
  scene.materials = {Material{}};
  const auto add = [&](glm::vec3 low, glm::vec3 high) { scene.meshes.push_back(shapes::box(low, high)); };
  add({-4, -0.1f, -4}, {4, 0, 4});
  add({-4.1f, 0, -4}, {-4, 4, 4});
  add({4, 0, -4}, {4.1f, 4, 4});
  add({-4, 0, -4.1f}, {4, 4, -4});
  add({-4, 0, 4}, {4, 4, 4.1f});
  add({-4, 4, -4}, {-0.8f, 4.1f, 4});
  add({0.8f, 4, -4}, {4, 4.1f, 4});
  if (!open) add({-0.8f, 4, -4}, {0.8f, 4.1f, 4});
  finish_scene(scene);
  return scene;
}

std::vector<Light> lights_in(const Scene& scene, const Camera& camera) {
  const auto traced = build_traced_scene(scene);
  return interior_lights(**traced, {.width = 64, .height = 48, .camera = camera},
                         default_lighting(camera, scene.up).lights);
}

const Camera kInside = perspective_camera({0, 1.5f, 3.5f}, {0, 1, -1}, {0, 1, 0}, 70.0f, 4.0f / 3.0f);

TEST(InteriorLights, TheSunComesThroughTheRoof) {
  const std::vector<Light> lights = lights_in(hall(true), kInside);
  ASSERT_EQ(lights.size(), 1u);
  EXPECT_EQ(lights[0].kind, LightKind::kDirectional);
  EXPECT_TRUE(lights[0].casts_shadow);
  EXPECT_NEAR(glm::length(lights[0].direction), 1.0f, 1e-5);
  EXPECT_GT(lights[0].direction.y, 0.5f);
}

TEST(InteriorLights, ClosedRoomsGetALampBelowTheCeiling) {
  const std::vector<Light> lights = lights_in(hall(false), kInside);
  ASSERT_EQ(lights.size(), 1u);
  EXPECT_EQ(lights[0].kind, LightKind::kPoint);
  EXPECT_GT(lights[0].position.y, 1.5f);
  EXPECT_LT(lights[0].position.y, 4.0f);
  EXPECT_GT(lights[0].reach, 1.0f);
}

TEST(InteriorLights, ScenesReachedByTheDefaultLightKeepIt) {
  Scene scene;
  scene.materials = {Material{}};
  scene.meshes = {shapes::box({-4, -0.1f, -4}, {4, 0, 4}), shapes::box({-1, 0, -1}, {1, 1, 1})};
  finish_scene(scene);
  EXPECT_TRUE(lights_in(scene, kInside).empty());
  // There are no lights if nothing is visible.
  EXPECT_TRUE(lights_in(scene, perspective_camera({0, 9, 0}, {0, 10, 0}, {0, 0, 1}, 40.0f, 1.0f)).empty());
}

TEST(InteriorLights, PicturesOfScenesWithoutLightsUseThem) {
  for (const bool open : {true, false}) {
    Scene scene = hall(open);
    const auto device = make_device("cpu", 0);
    ASSERT_TRUE((*device)->prepare(scene));
    Request settings;
    settings.width = settings.height = 48;
    settings.look = "lit";
    settings.camera.position = {0.0f, 1.5f, 3.5f};
    settings.camera.focal_point = {0.0f, 1.0f, -1.0f};
    const auto plan = make_plan(*make_recipe(settings), scene, 0);
    ASSERT_TRUE(plan);
    ASSERT_EQ(plan->lighting().lights.size(), 1u);
    EXPECT_EQ(plan->lighting().lights[0].kind, open ? LightKind::kDirectional : LightKind::kPoint);
    EXPECT_TRUE(scene.lights.empty());
    StageTimes times;
    const auto picture = draw(**device, scene, *plan, times);
    ASSERT_TRUE(picture);
    EXPECT_EQ(picture->frame.info.lights.size(), 1u);
  }
}

}  // namespace
}  // namespace umbrage
