// Scenes whose files have coordinates too large for floats, also with strays far from the model.
#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "renderer/models.h"
#include "renderer/options.h"
#include "renderer/recipe.h"
#include "scene/framing.h"
#include "scene/readers/positions.h"
#include "scene/scene.h"

namespace umbrage {
namespace {

/// A triangle of size 1 at the scene's origin.
Scene triangle_at(const glm::dvec3& origin) {
  Scene scene;
  scene.origin = origin;
  scene.materials.emplace_back();
  Mesh& mesh = scene.meshes.emplace_back();
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0.25f}};
  mesh.indices = {0, 1, 2};
  scene.bounds_max = {1, 1, 0.25f};
  scene.views.push_back({.eye = {0, 0, 5}, .target = {0, 0, 1}});
  return scene;
}

TEST(SceneOrigin, MovesAllPositions) {
  Scene scene = triangle_at({500000.0, 4200000.0, 100.0});
  set_origin({499998.0, 4200001.0, 100.5}, scene);
  EXPECT_EQ(scene.meshes[0].positions[1], glm::vec3(3, -1, -0.5f));
  EXPECT_EQ(scene.bounds_min, glm::vec3(2, -1, -0.5f));
  EXPECT_EQ(scene.views[0].eye, glm::vec3(2, -1, 4.5f));
  EXPECT_EQ(scene.origin, glm::dvec3(499998.0, 4200001.0, 100.5));
}

TEST(SceneOrigin, SeveralModelsShareOneFrame) {
  Scene all = triangle_at({500000.0, 4200000.0, 100.0});
  append_scene(triangle_at({500004.0, 4200000.0, 100.0}), all);
  EXPECT_EQ(all.meshes[1].positions[0] - all.meshes[0].positions[0], glm::vec3(4, 0, 0));
  EXPECT_EQ(all.bounds_max - all.bounds_min, glm::vec3(5, 1, 0.25f));
}

TEST(SceneOrigin, TheModelThatNeedsAnOriginSetsTheFrame) {
  // Large land, which needs no origin of its own, and a house on it; in either order.
  const auto land = [] {
    Scene scene = triangle_at({0, 0, 0});
    for (glm::vec3& p : scene.meshes[0].positions) p = p * 1e5f + glm::vec3(5e5f, 4.2e6f, 0);
    scene.bounds_min = {5e5f, 4.2e6f, 0};
    scene.bounds_max = {6e5f, 4.3e6f, 25000};
    return scene;
  };
  Scene all = land(), other = triangle_at({500000.0, 4200000.0, 0.0});
  append_scene(triangle_at({500000.0, 4200000.0, 0.0}), all);
  EXPECT_EQ(all.origin, glm::dvec3(500000.0, 4200000.0, 0.0));
  EXPECT_EQ(all.meshes[1].positions[1], glm::vec3(1, 0, 0));
  EXPECT_EQ(all.meshes[0].positions[0], glm::vec3(0));
  append_scene(land(), other);
  EXPECT_EQ(other.origin, all.origin);
  EXPECT_EQ(other.bounds_max, all.bounds_max);
}

// Options are in the file's coordinates, and more precise than floats there.
TEST(SceneOrigin, CameraOptionsAreInTheCoordinatesOfTheFile) {
  const auto camera_of = [](const glm::dvec3& origin, const std::string& position, const std::string& focal_point) {
    Request request;
    EXPECT_TRUE(set_option(option_of("camera.position"), position, request));
    EXPECT_TRUE(set_option(option_of("camera.focal_point"), focal_point, request));
    const auto recipe = make_recipe(request);
    EXPECT_TRUE(recipe);
    return frame_scene(triangle_at(origin), recipe->framing, 64, 64);
  };
  const Camera far = camera_of({500000.0, 4200000.0, 100.0}, "500001.125,4200002.0625,103.5", "500000.1,4200000.2,100");
  const Camera near = camera_of({0.0, 0.0, 0.0}, "1.125,2.0625,3.5", "0.1,0.2,0");
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      EXPECT_NEAR(far.view_from_world[column][row], near.view_from_world[column][row], 1e-6f) << column << row;
  const glm::dmat4 world = view_from_file(far.view_from_world, {500000.0, 4200000.0, 100.0});
  const glm::dvec4 eye = glm::inverse(world) * glm::dvec4(0, 0, 0, 1);
  EXPECT_NEAR(eye.x, 500001.125, 1e-6);
  EXPECT_NEAR(eye.y, 4200002.0625, 1e-6);
}

glm::dvec3 origin_of(const std::vector<glm::dvec3>& positions) {
  OriginFinder finder;
  for (const glm::dvec3& p : positions) finder.add(p);
  return finder.origin();
}

/// Positions along a line of this length, with the strays after every 100th.
std::vector<glm::dvec3> line_at(const glm::dvec3& start, std::size_t count, const glm::dvec3& stray) {
  std::vector<glm::dvec3> positions;
  for (std::size_t i = 0; i < count; ++i) {
    positions.push_back(start + glm::dvec3(double(i) / double(count), 0.0, 0.0));
    if (i % 100 == 0) positions.push_back(stray);
  }
  return positions;
}

TEST(OriginFinder, IsNotMovedByStrays) {
  const glm::dvec3 far(512345.0, 4212345.0, 101.0), infinite(HUGE_VAL, 0.0, 0.0);
  for (const std::size_t count : {4u, 100u, 100000u})
    for (const glm::dvec3& stray : {glm::dvec3(0.0), -far, infinite}) {
      EXPECT_LT(glm::length(origin_of(line_at(far, count, stray)) - far), 2.0) << count;
      EXPECT_EQ(origin_of(line_at({0.0, 0.0, 0.0}, count, stray)), glm::dvec3(0.0)) << count;
    }
}

TEST(OriginFinder, IsZeroWithoutFinitePositions) {
  EXPECT_EQ(origin_of({}), glm::dvec3(0.0));
  EXPECT_EQ(origin_of({glm::dvec3(NAN)}), glm::dvec3(0.0));
  EXPECT_EQ(origin_of({glm::dvec3(1e9), glm::dvec3(1e9)}), glm::dvec3(0.0));
}

}  // namespace
}  // namespace umbrage
