// The front of a model: by the names of its parts, by its format, and by the shape of animals.
#include "scene/front.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <string>
#include <thread>
#include <utility>

#include "scene/finish.h"
#include "scene/framing.h"
#include "scene/scene.h"

namespace umbrage {
namespace {

constexpr glm::vec3 kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1);

/// Returns a box as a mesh of 12 triangles.
Mesh box(const glm::vec3& low, const glm::vec3& high, const std::string& name = {}) {
  Mesh mesh;
  mesh.name = name;
  for (int corner = 0; corner < 8; ++corner)
    mesh.positions.emplace_back(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z);
  mesh.indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                  2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  return mesh;
}

Scene scene_of(std::vector<Mesh> meshes, const glm::vec3& up = kY) {
  Scene scene;
  scene.meshes = std::move(meshes);
  scene.up = up;
  finish_scene(scene);
  return scene;
}

/// Returns a four-legged animal with the head at +z; y is up.
std::vector<Mesh> animal() {
  return {box({-0.3f, 0.5f, -1}, {0.3f, 1.1f, 0.9f}),   box({-0.25f, 1, 0.4f}, {0.25f, 1.7f, 1.1f}),
          box({-0.3f, 0, -0.9f}, {-0.1f, 0.5f, -0.7f}), box({0.1f, 0, -0.9f}, {0.3f, 0.5f, -0.7f}),
          box({-0.3f, 0, 0.5f}, {-0.1f, 0.5f, 0.7f}),   box({0.1f, 0, 0.5f}, {0.3f, 0.5f, 0.7f})};
}

/// Rotates meshes: x, y and z become these.
std::vector<Mesh> with_axes(std::vector<Mesh> meshes, const glm::mat3& axes) {
  for (Mesh& mesh : meshes)
    for (glm::vec3& p : mesh.positions) p = axes * p;
  return meshes;
}

void expect_front(const Scene& scene, const glm::vec3& front, const char* what) {
  EXPECT_GT(glm::dot(front_of(scene, scene.up), front), 0.999f) << what;
  const Camera camera = frame_scene(scene, {}, 100, 100);
  EXPECT_GT(glm::dot(glm::normalize(camera.eye() - scene.center()), front), 0.7f) << what << ": seen from there";
}

TEST(Front, IsTowardsTheHeadOfAnAnimal) {
  expect_front(scene_of(animal()), kZ, "as usual");
  expect_front(scene_of(with_axes(animal(), {-kX, kY, -kZ})), -kZ, "the other way round");
  expect_front(scene_of(with_axes(animal(), {-kZ, kY, kX})), kX, "to the right");
  expect_front(scene_of(with_axes(animal(), {kZ, kY, -kX})), -kX, "to the left");
  expect_front(scene_of(with_axes(animal(), {-kX, kZ, kY}), kZ), kY, "z up, the other way round");
  auto lying = animal();
  for (Mesh& mesh : lying)
    for (glm::vec3& p : mesh.positions) p = {p.x + (p.z < 0.0f ? 0.4f : 0.0f), p.y, -p.z};
  expect_front(scene_of(lying), kZ, "not alike on both sides");
}

TEST(Front, IsTheUsualOneOfOtherShapes) {
  const Mesh bed = box({-0.5f, 0, -1}, {0.5f, 0.5f, 1});
  expect_front(scene_of({bed, box({-0.5f, 0.4f, -1}, {0.5f, 1, -0.9f})}), kZ, "a headboard");
  expect_front(scene_of({bed, box({-0.5f, 0.4f, -0.5f}, {0.5f, 1, 0.1f})}), kZ, "a car");
  expect_front(scene_of({bed, box({-0.02f, 0.4f, -1}, {0.02f, 1, -0.85f})}), kZ, "a fin");
  expect_front(scene_of({box({-1, 0, -1}, {1, 0.5f, 1}), box({-1, 0.5f, -1}, {1, 1, -0.6f})}), kZ, "a sofa");
  expect_front(scene_of({box({-1, 0, -1}, {1, 0.5f, 1})}, kZ), -kY, "a box with z up");
}

TEST(Front, OfAFormatThatDefinesItIsKept) {
  Scene scene = scene_of(with_axes(animal(), {-kX, kY, -kZ}));
  scene.has_front = true;
  expect_front(scene, kZ, "an animal that faces backwards on purpose");
}

TEST(Front, FollowsPartsNamedLeftAndRight) {
  const auto figure = [](const char* at_minus_x, const char* at_plus_x) {
    Scene scene =
        scene_of({box({-0.2f, 0, -0.2f}, {0.2f, 2, 0.2f}, "Body"), box({-0.4f, 1, 0}, {-0.2f, 1.2f, 0.1f}, at_minus_x),
                  box({0.2f, 1, 0}, {0.4f, 1.2f, 0.1f}, at_plus_x)});
    scene.has_front = true;
    return scene;
  };
  expect_front(figure("arm_Right", "arm_Left"), kZ, "its left is on the right as seen from +z");
  expect_front(figure("arm_Left", "arm_Right"), -kZ, "its left is on the left as seen from +z");
  expect_front(figure("arm_Left", "leg_Right"), kZ, "no pair");
  Scene sideways = figure("LeftArm", "RightArm");
  sideways.meshes = with_axes(sideways.meshes, {kZ, kY, -kX});
  finish_scene(sideways);
  expect_front(sideways, kX, "-z turned to +x");
}

TEST(Front, FollowsPartsNamedByALastLetter) {
  const auto figure = [](const std::string& at_minus_x, const std::string& at_plus_x) {
    return scene_of({box({-0.2f, 0, -0.2f}, {0.2f, 2, 0.2f}, "Body"),
                     box({-0.4f, 1, 0}, {-0.2f, 1.2f, 0.1f}, at_minus_x),
                     box({0.2f, 1, 0}, {0.4f, 1.2f, 0.1f}, at_plus_x)});
  };
  for (const auto& [left, right] :
       {std::pair{"_L", "_R"}, {".L", ".R"}, {"_l", "_r"}, {"-L", "-R"}, {".L.001", ".R.001"}})
    expect_front(figure(std::string("arm") + left, std::string("arm") + right), -kZ, left);
  expect_front(figure("arm_R", "arm_L"), kZ, "its left is on the right as seen from +z");
  // Each would be a pair that faces -z.
  expect_front(figure("arm_L", "leg_R"), kZ, "two stems");
  expect_front(figure("arm_L", "arm_L"), kZ, "one side alone");
  expect_front(figure("wheel", "wheer"), kZ, "letters of a word");
  expect_front(figure("_L", "_R"), kZ, "no stem");
  expect_front(figure("arm_L", "arm-R"), kZ, "two separators");
  expect_front(figure("arm_L1", "arm_R2"), kZ, "two numbers");
}

TEST(Front, IsFoundOncePerScene) {
  Scene scene = scene_of(with_axes(animal(), {-kX, kY, -kZ}));
  std::vector<std::thread> threads;
  for (int k = 0; k < 4; ++k) threads.emplace_back([&] { EXPECT_GT(glm::dot(front_of(scene, kY), -kZ), 0.999f); });
  for (std::thread& thread : threads) thread.join();
  const Scene copy = scene;
  front_of(copy, kY);
  EXPECT_EQ(scene.shape_facts->front.found(), 1);
  scene.meshes = animal();
  finish_scene(scene);
  EXPECT_GT(glm::dot(front_of(scene, kY), kZ), 0.999f) << "a new shape";
  EXPECT_GT(glm::dot(front_of(copy, kY), -kZ), 0.999f) << "the copy keeps its own";
  EXPECT_GT(glm::dot(front_of(scene, kX), kZ), 0.999f) << "another up direction";
}

}  // namespace
}  // namespace umbrage
