// Bounds without strays: what is far from the rest does not make the picture empty, and nothing else changes.
#include "scene/strays.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "core/camera.h"
#include "scene/framing.h"

namespace umbrage {
namespace {

/// Returns `count` points on a unit sphere.
Mesh ball_of_points(int count) {
  Mesh mesh;
  mesh.points = true;
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  for (int i = 0; i < count; ++i)
    mesh.positions.push_back(glm::normalize(glm::vec3(normal(random), normal(random), normal(random))));
  return mesh;
}

/// Adds a box from `low` to `high`.
void add_box(const glm::vec3& low, const glm::vec3& high, Mesh& mesh) {
  const std::uint32_t first = std::uint32_t(mesh.positions.size());
  for (int i = 0; i < 8; ++i)
    mesh.positions.emplace_back(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
  for (const std::uint32_t k :
       {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5})
    mesh.indices.push_back(first + k);
}

void add_triangle(const glm::vec3& at, Mesh& mesh) {
  for (int k = 0; k < 3; ++k) {
    mesh.indices.push_back(std::uint32_t(mesh.positions.size()));
    mesh.positions.push_back(at + glm::vec3(k == 1, k == 2, 0));
  }
}

Scene finished(Mesh mesh, BoundsOf bounds = BoundsOf::kAllButStrays) {
  Scene scene;
  scene.meshes.push_back(std::move(mesh));
  finish_scene(scene, {}, {}, nullptr, bounds);
  return scene;
}

/// Returns the fraction of the picture's height that the unit ball around the origin takes in the default view.
float height_in_picture(const Scene& scene) {
  const Camera camera = frame_scene(scene, {}, 100, 100);
  const float depth = -(camera.view_from_world * glm::vec4(0, 0, 0, 1)).z;
  return 2.0f / (depth * (camera.top - camera.bottom));
}

TEST(Strays, OfPointsAreOutsideOfThePicture) {
  const Scene plain = finished(ball_of_points(3000));
  EXPECT_TRUE(plain.warnings.empty());
  Mesh one = ball_of_points(3000);
  one.positions.emplace_back(5000, 0, 0);
  const Scene far = finished(one);
  EXPECT_NEAR(far.radius(), plain.radius(), 0.1f * plain.radius());
  EXPECT_GT(height_in_picture(far), 0.6f);
  EXPECT_EQ(far.point_count(), 3001u) << "it is in the scene";
  ASSERT_EQ(far.warnings.size(), 1u);
  EXPECT_NE(far.warnings[0].find("1 point lies far from the rest"), std::string::npos) << far.warnings[0];
  // Noise in a space ten times as large.
  Mesh noise = ball_of_points(30000);
  std::mt19937 random(2);
  std::uniform_real_distribution<float> coordinate(-10.0f, 10.0f);
  for (int i = 0; i < 30; ++i) noise.positions.emplace_back(coordinate(random), coordinate(random), coordinate(random));
  EXPECT_GT(height_in_picture(finished(noise)), 0.35f);
}

TEST(Strays, OfASparseReconstructionAreOutsideOfThePicture) {
  const Scene plain = finished(ball_of_points(3000));
  for (const int percent : {4, 7, 10}) {
    Mesh mesh = ball_of_points(3000);
    std::mt19937 random(3);
    std::normal_distribution<float> normal;
    std::uniform_real_distribution<float> uniform;
    for (int i = 0; i < 30 * percent; ++i)
      mesh.positions.push_back(std::pow(60.0f, uniform(random)) * 1.2f *
                               glm::normalize(glm::vec3(normal(random), normal(random), normal(random))));
    const Scene scene = finished(mesh);
    EXPECT_GT(height_in_picture(scene), 0.3f) << percent;
    EXPECT_LT(scene.radius(), 3.0f * plain.radius()) << percent;
    ASSERT_EQ(scene.warnings.size(), 1u) << percent;
  }
  Mesh flower = ball_of_points(3000);  // a stem of points as close to each other as those of the ball
  for (int i = 0; i < 270; ++i)
    flower.positions.emplace_back(0.04f * std::cos(float(i)), -1.0f - 0.04f * float(i), 0.04f * std::sin(float(i)));
  EXPECT_LT(finished(flower).bounds_min.y, -11.0f);
}

TEST(Strays, OfTrianglesAreOutsideOfThePicture) {
  Mesh mesh;
  add_box(glm::vec3(-1), glm::vec3(1), mesh);
  const float before = height_in_picture(finished(mesh));
  add_triangle({1e5f, 0, 0}, mesh);
  add_triangle({0, -3e5f, 0}, mesh);
  const Scene scene = finished(mesh);
  EXPECT_EQ(height_in_picture(scene), before);
  EXPECT_EQ(scene.bounds_max, glm::vec3(1));
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("2 triangles lie far"), std::string::npos) << scene.warnings[0];
}

TEST(Strays, OneBadVertexIsOutsideOfThePicture) {
  Mesh mesh;
  for (int i = 0; i < 30; ++i) add_box(glm::vec3(-1.0f + 0.01f * float(i)), glm::vec3(1.0f + 0.01f * float(i)), mesh);
  const Scene before = finished(mesh);
  mesh.positions[17].x = 4e6f;
  const Scene scene = finished(mesh);
  EXPECT_NEAR(scene.radius(), before.radius(), 0.01f * before.radius());
  ASSERT_EQ(scene.warnings.size(), 1u);
  Mesh fan;  // nothing but needles: a tall tent of many faces
  fan.positions.emplace_back(0, 9000, 0);
  for (std::uint32_t i = 0; i <= 300; ++i) {
    fan.positions.emplace_back(std::cos(0.02f * float(i)), 0, std::sin(0.02f * float(i)));
    if (i > 0) fan.indices.insert(fan.indices.end(), {0u, i, i + 1});
  }
  EXPECT_EQ(finished(fan).bounds_max.y, 9000.0f);
}

TEST(Strays, AreNotWhatBelongsToAScene) {
  Mesh statue;  // with many small triangles, on a large floor, near a house
  for (int i = 0; i < 200; ++i) add_box(glm::vec3(0.01f * float(i)), glm::vec3(0.01f * float(i) + 0.1f), statue);
  add_box({-300, -1, -300}, {300, 0, 300}, statue);
  EXPECT_EQ(finished(statue).bounds_max.x, 300.0f) << "a floor under a statue";
  Mesh pair;
  add_box(glm::vec3(0), glm::vec3(1), pair);
  add_box(glm::vec3(100), glm::vec3(101), pair);
  EXPECT_EQ(finished(pair).bounds_max.x, 101.0f) << "one of two equal parts";
  Mesh near;
  for (int i = 0; i < 10; ++i) add_box(glm::vec3(float(i)), glm::vec3(float(i) + 1), near);
  add_triangle({30, 0, 0}, near);
  EXPECT_EQ(finished(near).bounds_max.x, 31.0f) << "a part at a distance of two sizes";
  Mesh cloud;  // a laser scan is dense near the scanner
  cloud.points = true;
  for (int i = 0; i < 40000; ++i) {
    const float distance = std::pow(60.0f, float(i % 1000) / 999.0f), angle = 0.1f * float(i);
    cloud.positions.emplace_back(distance * std::cos(angle), 0.001f * float(i % 7), distance * std::sin(angle));
  }
  const Scene scan = finished(cloud);
  EXPECT_TRUE(scan.warnings.empty());
  EXPECT_GT(scan.bounds_max.x, 59.0f);
}

TEST(Strays, CountForScenesOfCallers) {
  Mesh mesh;
  add_box(glm::vec3(-1), glm::vec3(1), mesh);
  add_triangle({1e5f, 0, 0}, mesh);
  const Scene scene = finished(mesh, BoundsOf::kAll);
  EXPECT_GT(scene.bounds_max.x, 1e5f);
  EXPECT_TRUE(scene.warnings.empty());
}

}  // namespace
}  // namespace umbrage
