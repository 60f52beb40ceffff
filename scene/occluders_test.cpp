// Coarse occluders: their areas, their normals, their division among objects, and that nothing else changes them.
#include "scene/occluders.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <numbers>

#include "scene/finish.h"

namespace umbrage {
namespace {

/// Returns a box with these half sides, every face of which has its own vertices.
Mesh box(glm::vec3 center, glm::vec3 half, int object = 0) {
  Mesh mesh;
  mesh.object = object;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f}) {
      const auto first = std::uint32_t(mesh.positions.size());
      for (const auto& [u, v] : {std::pair{-1.0f, -1.0f}, {1.0f, -1.0f}, {1.0f, 1.0f}, {-1.0f, 1.0f}}) {
        glm::vec3 corner(0.0f), normal(0.0f);
        corner[axis] = side;
        corner[(axis + 1) % 3] = u;
        corner[(axis + 2) % 3] = v;
        normal[axis] = side;
        mesh.positions.push_back(center + half * corner);
        mesh.normals.push_back(normal);
      }
      for (const std::uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) mesh.indices.push_back(first + k);
    }
  return mesh;
}

Scene scene_of(std::vector<Mesh> meshes) {
  Scene scene;
  scene.materials.resize(1);
  scene.meshes = std::move(meshes);
  finish_scene(scene);
  return scene;
}

double cross_section_of(const OccluderSet& set) {
  double sum = 0.0;
  for (const Occluder& occluder : set.occluders)
    sum += std::numbers::pi * double(occluder.radius) * double(occluder.radius);
  return sum;
}

TEST(Occluders, HaveTheAreaOfTheScene) {
  for (const float scale : {1.0f, 1e-9f, 1e12f}) {
    const Scene scene = scene_of({box({0, 0, 0}, scale * glm::vec3(1.0f, 2.0f, 3.0f))});
    const double area = 8.0 * (2.0 + 3.0 + 6.0) * double(scale) * double(scale);
    for (const int count : {1, 8, 64, 256}) {
      const OccluderSet set = make_occluders(scene, count);
      EXPECT_LE(int(set.occluders.size()), count) << scale;
      EXPECT_GE(int(set.occluders.size()), count - 1) << "a cluster may lose all its points";
      EXPECT_NEAR(cross_section_of(set) / (area / 4.0), 1.0, 1e-4) << scale << ' ' << count;
    }
  }
}

TEST(Occluders, AreMostlyOfTheModelNotOfItsGround) {
  Scene scene = scene_of({box({0, 0, 0}, glm::vec3(1.0f)), box({0, -2, 0}, glm::vec3(50.0f, 0.01f, 50.0f))});
  scene.meshes[0].object = 0;
  scene.meshes[1].object = scene.ground_object = 1;
  const OccluderSet set = make_occluders(scene, 128);
  const auto of_model = std::count_if(set.occluders.begin(), set.occluders.end(),
                                      [](const Occluder& occluder) { return occluder.object == 0; });
  EXPECT_GE(of_model, 60);
  EXPECT_EQ(set.objects, 2);
}

TEST(Occluders, OfABoxAreFlat) {
  const OccluderSet set = make_occluders(scene_of({box({5, 0, 0}, glm::vec3(1.0f))}), 128);
  double flat = 0.0, whole = 0.0;
  for (const Occluder& occluder : set.occluders) {
    const double area = double(occluder.radius) * double(occluder.radius);
    whole += area;
    flat += area * double(glm::length(occluder.mean_normal));
    EXPECT_GT(glm::dot(occluder.mean_normal, occluder.center - glm::vec3(5, 0, 0)), 0.6f) << "outwards";
  }
  EXPECT_GT(flat / whole, 0.9);
}

TEST(Occluders, OfAClosedObjectAloneHaveNoNormal) {
  const OccluderSet set = make_occluders(scene_of({box({0, 0, 0}, glm::vec3(1.0f))}), 1);
  ASSERT_EQ(set.occluders.size(), 1u);
  EXPECT_LT(glm::length(set.occluders[0].mean_normal), 0.03f);
  EXPECT_LT(glm::length(set.occluders[0].center), 0.02f);
}

TEST(Occluders, FaceTheSideOfTheVertexNormalsNotOfTheWinding) {
  Mesh mesh = box({0, 0, 0}, glm::vec3(1.0f));
  for (std::size_t k = 0; k < mesh.indices.size(); k += 3) std::swap(mesh.indices[k], mesh.indices[k + 1]);
  Scene scene;
  scene.materials.resize(1);
  scene.meshes = {mesh};  // not finished, so that the winding stays wrong
  scene.bounds_min = glm::vec3(-1.0f);
  scene.bounds_max = glm::vec3(1.0f);
  for (const Occluder& occluder : make_occluders(scene, 128).occluders)
    EXPECT_GT(glm::dot(occluder.mean_normal, occluder.center), 0.6f);
}

TEST(Occluders, AreDividedAmongObjects) {
  const Scene scene = scene_of({box({0, 0, 0}, glm::vec3(4.0f), 3), box({20, 0, 0}, glm::vec3(1.0f), 7)});
  const OccluderSet set = make_occluders(scene, 32);
  EXPECT_EQ(set.objects, 2);
  int of_object[2] = {0, 0};
  for (const Occluder& occluder : set.occluders) {
    ASSERT_EQ(occluder.object, occluder.center.x < 10.0f ? 0 : 1);
    ++of_object[occluder.object];
  }
  EXPECT_EQ(of_object[0], 25) << "1 + 30 * 4 / 5: the square roots of the areas are as 4 to 1";
  EXPECT_EQ(of_object[1], 7);
  EXPECT_EQ(make_occluders(scene, 1).objects, 1) << "more objects than occluders";
}

TEST(Occluders, DoNotDependOnThreads) {
  const Scene scene = scene_of({box({0, 0, 0}, {1, 2, 3}), box({3, 1, 0}, {1, 1, 4}, 1)});
  const auto made = [&](int threads) {
    return tbb::task_arena(threads).execute([&] { return make_occluders(scene, 96); });
  };
  const OccluderSet one = made(1), four = made(4);
  ASSERT_EQ(one.occluders.size(), four.occluders.size());
  for (std::size_t k = 0; k < one.occluders.size(); ++k) {
    EXPECT_EQ(one.occluders[k].center, four.occluders[k].center);
    EXPECT_EQ(one.occluders[k].radius, four.occluders[k].radius);
    EXPECT_EQ(one.occluders[k].mean_normal, four.occluders[k].mean_normal);
  }
}

TEST(Occluders, OfPointsAreTheirDiscsOrSpheres) {
  Mesh mesh;
  mesh.points = true;
  mesh.positions = {{0, 0, 0}, {2, 0, 0}, {0, 4, 0}};
  mesh.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  mesh.radii = {0.5f, 0.5f, 0.5f};
  Scene scene;
  scene.materials.resize(1);
  scene.bounds_max = {2, 4, 0};
  scene.meshes = {mesh};
  const OccluderSet discs = make_occluders(scene, 64);
  ASSERT_EQ(discs.occluders.size(), 3u) << "one each";
  EXPECT_NEAR(cross_section_of(discs), 3.0 * std::numbers::pi * 0.25 / 8.0, 1e-6);
  for (const Occluder& occluder : discs.occluders) EXPECT_EQ(occluder.mean_normal, glm::vec3(0, 0, 1));
  scene.meshes[0].spheres = true;
  scene.meshes[0].normals.clear();
  const OccluderSet spheres = make_occluders(scene, 64);
  ASSERT_EQ(spheres.occluders.size(), 3u);
  for (const Occluder& occluder : spheres.occluders) {
    EXPECT_NEAR(occluder.radius, 0.5f, 0.01f);
    EXPECT_EQ(occluder.mean_normal, glm::vec3(0.0f));
  }
}

TEST(Occluders, OfNothingAreNone) {
  EXPECT_TRUE(make_occluders(Scene(), 64).occluders.empty());
  Scene scene = scene_of({box({0, 0, 0}, glm::vec3(1.0f))});
  scene.materials[0].blended = true;
  EXPECT_FALSE(make_occluders(scene, 8).occluders.empty()) << "of full opacity";
  scene.materials[0].opacity = 0.5f;
  EXPECT_TRUE(make_occluders(scene, 64).occluders.empty()) << "surfaces that are seen through";
  MadeOccluders made;
  EXPECT_EQ(occluders_of(scene, 0, made), nullptr);
  const auto first = occluders_of(scene, 8, made);
  EXPECT_EQ(first, occluders_of(scene, 8, made)) << "made once";
  EXPECT_NE(first, occluders_of(scene, 9, made));
}

}  // namespace
}  // namespace umbrage
