// Points: sizes and normals estimated from the neighbours.
#include "scene/points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <random>

#include "scene/finish.h"
#include "scene/framing.h"
#include "scene/ground.h"

namespace umbrage {
namespace {

/// Returns a scene of these points after finish_scene.
Scene scene_of(std::vector<glm::vec3> positions, const PointSettings& settings = {}) {
  Scene scene;
  Mesh mesh;
  mesh.points = true;
  mesh.positions = std::move(positions);
  scene.meshes = {std::move(mesh)};
  finish_scene(scene, 80.0f, settings);
  return scene;
}

std::vector<glm::vec3> random_sphere(int count, bool filled, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> unit;
  std::vector<glm::vec3> points;
  for (int k = 0; k < count; ++k) {
    const glm::vec3 direction = glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
    points.push_back(filled ? direction * std::cbrt(unit(random)) : direction);
  }
  return points;
}

TEST(Points, OfAGridAreDiscsThatJustCoverIt) {
  std::vector<glm::vec3> grid;
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) grid.emplace_back(0.1f * float(x), 0.1f * float(y), 7.0f);
  const Scene scene = scene_of(grid);
  const Mesh& mesh = scene.meshes.at(0);
  EXPECT_FALSE(mesh.spheres);
  ASSERT_EQ(mesh.positions.size(), grid.size());
  for (std::size_t i = 0; i < grid.size(); ++i) {
    EXPECT_NEAR(std::abs(mesh.normals[i].z), 1.0f, 1e-5f);
    const glm::vec3& p = mesh.positions[i];
    const bool inside = p.x > 0.25f && p.x < 3.65f && p.y > 0.25f && p.y < 2.65f;
    EXPECT_GE(mesh.radii[i], 0.0707f) << "half of a cell's diagonal";
    EXPECT_LE(mesh.radii[i], inside ? 0.078f : 0.14f);
  }
}

TEST(Points, OfARoughlyEvenSurfaceLeaveNoHole) {
  const Scene scene = scene_of(random_sphere(4000, false));
  const Mesh& mesh = scene.meshes.at(0);
  ASSERT_FALSE(mesh.spheres);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    EXPECT_GT(std::abs(glm::dot(mesh.normals[i], mesh.positions[i])), 0.97f)
        << "the normal of a sphere is along its radius";
  // Count the directions that meet no disc.
  const std::vector<glm::vec3> directions = random_sphere(3000, false, 2);
  int open = 0;
  double area = 0.0;
  for (const glm::vec3& d : directions) {
    bool is_covered = false;
    for (std::size_t i = 0; i < mesh.positions.size() && !is_covered; ++i) {
      const float t = glm::dot(mesh.positions[i], mesh.normals[i]) / glm::dot(d, mesh.normals[i]);
      is_covered = t > 0.0f && glm::distance(d * t, mesh.positions[i]) < mesh.radii[i];
    }
    open += !is_covered;
  }
  for (const float radius : mesh.radii) area += std::numbers::pi * radius * radius;
  EXPECT_LE(open, 6) << "of 3000";
  EXPECT_LT(area, 5.0 * 4.0 * std::numbers::pi) << "each spot is covered a few times, not many";
}

/// Returns the mean and the maximum angle, degrees, between the normals of two discs at points where they overlap.
std::pair<double, double> normal_steps(const Mesh& mesh, bool bent) {
  double sum = 0.0, max = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const glm::vec3 away = mesh.positions[k] - mesh.positions[i];
      if (glm::length(away) > 0.9f * (mesh.radii[i] + mesh.radii[k])) continue;
      const glm::vec3 middle = 0.5f * away;
      const glm::vec3 bend_i = bent ? mesh.bends[i] : glm::vec3(0.0f), bend_k = bent ? mesh.bends[k] : glm::vec3(0.0f);
      const float cosine =
          glm::dot(bent_normal(mesh.normals[i], bend_i, middle), bent_normal(mesh.normals[k], bend_k, -middle));
      const double angle = std::acos(std::clamp(double(std::abs(cosine)), 0.0, 1.0)) * 180.0 / std::numbers::pi;
      sum += angle;
      max = std::max(max, angle);
      ++count;
    }
  return {sum / count, max};
}

TEST(Points, NormalsOfOverlappingDiscsBlend) {
  // A sphere whose normals have noise of about 10 degrees, as those of a scan.
  Scene scene;
  Mesh noisy;
  noisy.points = true;
  noisy.positions = random_sphere(3000, false);
  const std::vector<glm::vec3> noise = random_sphere(3000, false, 3);
  for (std::size_t i = 0; i < noise.size(); ++i)
    noisy.normals.push_back(glm::normalize(noisy.positions[i] + 0.2f * noise[i]));
  scene.meshes = {noisy};
  finish_scene(scene, 80.0f);
  const Mesh& mesh = scene.meshes.at(0);
  ASSERT_EQ(mesh.bends.size(), mesh.positions.size());
  const auto [flat, flat_max] = normal_steps(mesh, false);
  const auto [mean, max] = normal_steps(mesh, true);
  EXPECT_LT(mean, 0.5 * flat);
  EXPECT_LT(mean, 1.5);
  EXPECT_LT(max, 12.0) << "two of the given normals differ by up to 23 degrees from noise alone";
  double off = 0.0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    off += 1.0 - std::abs(double(glm::dot(mesh.normals[i], mesh.positions[i])));
  EXPECT_LT(std::sqrt(2.0 * off / double(mesh.positions.size())), 0.08) << "radians, of 0.16 before";
}

TEST(Points, NormalsDoNotBlendAcrossACreaseOrAGap) {
  // Two walls that meet at 90 degrees, and a disc far from both.
  std::vector<glm::vec3> points;
  for (int y = 0; y < 30; ++y)
    for (int x = 1; x < 30; ++x) {
      points.emplace_back(0.1f * float(x), 0.1f * float(y), 0.0f);
      points.emplace_back(0.0f, 0.1f * float(y), 0.1f * float(x));
    }
  Scene scene;
  Mesh walls;
  walls.points = true;
  walls.positions = points;
  for (const glm::vec3& p : points) walls.normals.push_back(p.x > 0.0f ? glm::vec3(0, 0, 1) : glm::vec3(1, 0, 0));
  walls.positions.emplace_back(30.0f, 0.0f, 0.0f);
  walls.normals.push_back(glm::normalize(glm::vec3(0.3f, 0.0f, 1.0f)));
  scene.meshes = {walls};
  finish_scene(scene, 80.0f);
  const Mesh& mesh = scene.meshes.at(0);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec3 p = mesh.positions[i];
    const glm::vec3 expected = p.x > 20.0f  ? glm::normalize(glm::vec3(0.3f, 0.0f, 1.0f))
                               : p.x > 0.0f ? glm::vec3(0, 0, 1)
                                            : glm::vec3(1, 0, 0);
    EXPECT_GT(glm::dot(mesh.normals[i], expected), 0.9999f) << p.x << " " << p.y << " " << p.z;
    EXPECT_LT(glm::length(mesh.bends[i]) * mesh.radii[i], 0.02f);
  }
}

TEST(Points, OfGivenRadiiStayFlat) {
  Scene scene;
  Mesh splats;
  splats.points = true;
  splats.positions = {{0, 0, 0}, {0.5f, 0, 0}};
  splats.normals = {{0, 0, 1}, {0.5f, 0, 1}};
  splats.radii = {1.0f, 1.0f};
  scene.meshes = {splats};
  finish_scene(scene, 80.0f);
  EXPECT_TRUE(scene.meshes.at(0).bends.empty());
}

TEST(Points, OfACloudAreSpheresOfOneSize) {
  const Scene scene = scene_of(random_sphere(3000, true));
  const Mesh& mesh = scene.meshes.at(0);
  EXPECT_TRUE(mesh.spheres);
  EXPECT_TRUE(mesh.normals.empty());
  // 3000 points in a sphere of volume 4.19: one point per cube of side 0.112.
  for (const float radius : mesh.radii) EXPECT_EQ(radius, mesh.radii[0]);
  EXPECT_NEAR(mesh.radii[0], 0.056f, 0.008f);
}

TEST(Points, ScaleWithTheirScene) {
  for (const float scale : {1e-6f, 1e-3f, 1e4f}) {
    std::vector<glm::vec3> small = random_sphere(500, false), scaled = small;
    for (glm::vec3& p : scaled) p *= scale;
    const Scene a = scene_of(small), b = scene_of(scaled);
    double sum_a = 0.0, sum_b = 0.0;
    for (const float r : a.meshes.at(0).radii) sum_a += r;
    for (const float r : b.meshes.at(0).radii) sum_b += r;
    EXPECT_NEAR(sum_b / sum_a / scale, 1.0, 1e-3) << scale;
    EXPECT_EQ(a.meshes[0].spheres, b.meshes[0].spheres);
  }
}

TEST(Points, FarPointsStaySmall) {
  std::vector<glm::vec3> points = random_sphere(500, false);
  points.emplace_back(1000.0f, 0.0f, 0.0f);
  const Scene scene = scene_of(points);
  for (const float radius : scene.meshes.at(0).radii) EXPECT_LT(radius, 1.0f);
}

TEST(Points, FewAreDrawnToo) {
  for (const std::vector<glm::vec3>& points :
       {std::vector<glm::vec3>{{3, 4, 5}}, {{0, 0, 0}, {1, 0, 0}}, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}}) {
    const Scene scene = scene_of(points);
    ASSERT_EQ(scene.point_count(), points.size());
    EXPECT_GT(scene.radius(), 0.0f);
    for (const float radius : scene.meshes[0].radii) {
      EXPECT_GT(radius, 0.0f);
      EXPECT_LT(radius, 3.0f);
    }
    for (const glm::vec3& normal : scene.meshes[0].normals) EXPECT_NEAR(glm::length(normal), 1.0f, 1e-5f);
  }
}

TEST(Points, DuplicatesAndNonFinitePointsAreDropped) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  std::vector<glm::vec3> points = random_sphere(100, false);
  const std::vector<glm::vec3> unique_points = points;
  for (int k = 0; k < 20; ++k) points.insert(points.end(), unique_points.begin(), unique_points.end());
  points.emplace_back(kNan, 0.0f, 0.0f);
  points.emplace_back(0.0f, 1e30f, 0.0f);
  Scene scene;
  Mesh mesh;
  mesh.points = true;
  mesh.positions = points;
  mesh.colors.assign(points.size(), glm::vec3(0.25f));
  scene.meshes = {mesh};
  EXPECT_EQ(finish_scene(scene), 2u);
  EXPECT_EQ(scene.point_count(), 100u);
  EXPECT_EQ(scene.meshes[0].colors.size(), 100u);
}

TEST(Points, AreGroundAtTheFootOfAPictureWhereTheyAreLevel) {
  const Framing whole, near{.zoom = 3.0f};
  const auto shows_ground = [](const Scene& scene, const Framing& framing) {
    return shows_own_ground(scene, frame_scene(scene, framing, 100, 100));
  };
  const Scene sphere = scene_of(random_sphere(2000, false));
  EXPECT_FALSE(shows_ground(sphere, whole));
  std::vector<glm::vec3> with_floor = random_sphere(2000, false);
  for (int z = -40; z <= 40; ++z)
    for (int x = -40; x <= 40; ++x) with_floor.emplace_back(0.05f * float(x), -1.0f, 0.05f * float(z));
  const Scene on_floor = scene_of(with_floor);
  EXPECT_FALSE(shows_ground(on_floor, whole)) << "the floor ends above the border";
  EXPECT_TRUE(shows_ground(on_floor, near));
}

}  // namespace
}  // namespace umbrage
