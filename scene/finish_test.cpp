// Finished scenes: the later of faces in one plane is in front, and models of which nothing would be seen are shown.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <glm/geometric.hpp>

#include "scene/finish.h"

namespace umbrage {
namespace {

/// An orthonormal frame that is not aligned to the axes.
struct Frame {
  glm::vec3 u = glm::normalize(glm::vec3(3, 1, -2)), n = glm::normalize(glm::cross(u, glm::vec3(0, 1, 0.3f)));
  glm::vec3 v = glm::cross(n, u);
  glm::vec3 at(float x, float y, float height) const { return glm::vec3(1, 2, 3) + x * u + y * v + height * n; }
};

/// Returns a rectangle of `cells` times `cells` quadrilaterals in a slanted plane; `up`: it faces along Frame::n.
Mesh rectangle(glm::vec2 low, glm::vec2 high, float height, int cells, bool up = true) {
  const Frame frame;
  Mesh mesh;
  for (int i = 0; i <= cells; ++i)
    for (int k = 0; k <= cells; ++k) {
      const glm::vec2 p = low + (high - low) * glm::vec2(i, k) / float(cells);
      glm::vec3 q = frame.at(p.x, p.y, height);
      for (int c = 0; c < 3; ++c) q[c] = std::round(q[c] * 1e6f) / 1e6f;  // as files are written
      mesh.positions.push_back(q);
    }
  for (int i = 0; i < cells; ++i)
    for (int k = 0; k < cells; ++k) {
      const std::uint32_t a = std::uint32_t(i * (cells + 1) + k), b = a + 1, c = a + std::uint32_t(cells) + 1,
                          d = c + 1;
      if (up)
        mesh.indices.insert(mesh.indices.end(), {a, c, d, a, d, b});
      else
        mesh.indices.insert(mesh.indices.end(), {a, d, c, a, b, d});
    }
  return mesh;
}

Scene scene_of(std::vector<Mesh> meshes) {
  Scene scene;
  scene.meshes = std::move(meshes);
  finish_scene(scene);
  return scene;
}

/// Returns the range of heights of a mesh above the slanted plane, in radii of the scene.
glm::vec2 heights(const Scene& scene, std::size_t mesh) {
  const Frame frame;
  glm::vec2 range(1e9f, -1e9f);
  for (const glm::vec3& p : scene.meshes[mesh].positions) {
    const float height = float(glm::dot(glm::dvec3(p) - glm::dvec3(1, 2, 3), glm::dvec3(frame.n))) / scene.radius();
    range = {std::min(range.x, height), std::max(range.y, height)};
  }
  return range;
}

TEST(CoplanarFaces, OfALaterMeshAreInFront) {
  Scene scene = scene_of({rectangle({-1, -1}, {1, 1}, 0, 3), rectangle({-0.5f, -0.6f}, {0.7f, 0.5f}, 0, 5),
                          rectangle({-0.2f, -0.3f}, {0.4f, 0.3f}, 0, 2)});
  EXPECT_GT(separate_coplanar_faces(scene), 0u);
  EXPECT_LT(heights(scene, 0).y, 2e-6f);
  EXPECT_GT(heights(scene, 1).x, 7e-6f);
  EXPECT_LT(heights(scene, 1).y, 1.3e-5f);
  EXPECT_GT(heights(scene, 2).x, 1.7e-5f) << "two steps above the first, one above the second";
  EXPECT_EQ(separate_coplanar_faces(scene), 0u) << "a second time, none are in one plane";
}

TEST(CoplanarFaces, DoNotReturnStraysToTheBounds) {
  Mesh upper = rectangle({-0.5f, -0.6f}, {0.7f, 0.5f}, 0, 5);
  const auto stray = std::uint32_t(upper.positions.size());
  upper.positions.insert(upper.positions.end(), {{1e4f, 0, 0}, {1e4f + 1, 0, 0}, {1e4f, 1, 0}});
  upper.indices.insert(upper.indices.end(), {stray, stray + 1, stray + 2});
  Scene scene;
  scene.meshes = {rectangle({-1, -1}, {1, 1}, 0, 3), upper};
  finish_scene(scene, {}, {}, nullptr, BoundsOf::kAllButStrays);
  const float radius = scene.radius();
  ASSERT_LT(radius, 10.0f);
  EXPECT_GT(separate_coplanar_faces(scene), 0u);
  EXPECT_LT(scene.radius(), 1.01f * radius);
}

TEST(CoplanarFaces, AreInFrontOnTheSideOfTheEarlierNormals) {
  Scene scene = scene_of({rectangle({-1, -1}, {1, 1}, 0, 1), rectangle({-0.5f, -0.6f}, {0.7f, 0.5f}, 0, 1, false)});
  EXPECT_EQ(separate_coplanar_faces(scene), 2u);
  EXPECT_GT(heights(scene, 1).x, 7e-6f) << "a decal may be wound either way";
}

TEST(CoplanarFaces, ThatFaceDownAreInFrontFromAboveToo) {
  Scene scene = scene_of({rectangle({-1, -1}, {1, 1}, 0, 1, false), rectangle({-0.5f, -0.6f}, {0.7f, 0.5f}, 0, 1),
                          rectangle({-0.2f, -0.3f}, {0.4f, 0.3f}, 0, 1)});
  scene.meshes[1].colors.assign(scene.meshes[1].positions.size(), glm::vec3(1, 0, 0));
  scene.meshes[1].object = 1;
  Scene upwards = scene;
  scene.up = Frame().n;
  upwards.up = -Frame().n;
  separate_coplanar_faces(scene);
  ASSERT_EQ(scene.meshes.size(), 5u);
  EXPECT_LT(heights(scene, 1).y, -7e-6f) << "the side of the earlier normals";
  EXPECT_GT(heights(scene, 3).x, 7e-6f);
  EXPECT_GT(heights(scene, 4).x, heights(scene, 3).y) << "the later mesh is in front there, too";
  EXPECT_EQ(scene.meshes[3].colors, std::vector<glm::vec3>(6, glm::vec3(1, 0, 0)));
  EXPECT_EQ(scene.meshes[3].object, 1);
  separate_coplanar_faces(upwards);
  EXPECT_EQ(upwards.meshes.size(), 3u) << "faces that face up";
  Scene blended = scene_of({rectangle({-1, -1}, {1, 1}, 0, 1, false), rectangle({-0.5f, -0.6f}, {0.7f, 0.5f}, 0, 1)});
  blended.up = Frame().n;
  blended.materials[0].blended = true;
  separate_coplanar_faces(blended);
  EXPECT_EQ(blended.meshes.size(), 2u);
}

TEST(CoplanarFaces, ThatOnlyTouchOrAreApartDoNotMove) {
  const Mesh base = rectangle({-1, -1}, {1, 1}, 0, 3);
  for (const Mesh& other : {rectangle({1, -1}, {2, 1}, 0, 3), rectangle({-0.5f, -0.5f}, {0.5f, 0.5f}, 1e-3f, 3),
                            rectangle({1.5f, -1}, {2, 1}, 0, 3)}) {
    Scene scene = scene_of({base, other});
    const std::vector<glm::vec3> before = scene.meshes[1].positions;
    EXPECT_EQ(separate_coplanar_faces(scene), 0u);
    EXPECT_EQ(scene.meshes[1].positions, before);
  }
}

TEST(CoplanarFaces, StayJoinedToTheirNeighbours) {
  // A box of separate faces, whose top is in the plane of another mesh: its sides follow.
  Mesh box;
  const Frame frame;
  const auto quad = [&](glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) {
    const std::uint32_t first = std::uint32_t(box.positions.size());
    for (const glm::vec3& p : {a, b, c, d}) box.positions.push_back(frame.at(p.x, p.y, p.z));
    box.indices.insert(box.indices.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
  };
  quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  quad({0, 0, -1}, {1, 0, -1}, {1, 0, 0}, {0, 0, 0});
  quad({1, 0, -1}, {1, 1, -1}, {1, 1, 0}, {1, 0, 0});
  Scene scene = scene_of({rectangle({-1, -1}, {2, 2}, 0, 1), box});
  const std::vector<glm::vec3> before = scene.meshes[1].positions;
  EXPECT_EQ(separate_coplanar_faces(scene), 2u);
  std::size_t moved = 0;
  for (std::size_t v = 0; v < before.size(); ++v)
    for (std::size_t w = 0; w < before.size(); ++w) {
      if (before[v] == before[w]) {
        EXPECT_EQ(scene.meshes[1].positions[v], scene.meshes[1].positions[w]);
      }
      moved += v == w && before[v] != scene.meshes[1].positions[v];
    }
  EXPECT_EQ(moved, 8u) << "four corners of the top and the upper corners of the sides";
}

Scene stacked(std::size_t count) {
  Mesh triangle = rectangle({-1, -1}, {1, 1}, 0, 1);
  triangle.indices.resize(3);
  return scene_of(std::vector<Mesh>(count, triangle));
}

TEST(CoplanarFaces, AreMovedApartInLimitedTime) {
  constexpr std::size_t kCount = 20000;
  Scene scene = stacked(kCount);
  const auto started = std::chrono::steady_clock::now();
  EXPECT_EQ(separate_coplanar_faces(scene), kCount - 1);
  EXPECT_LT(std::chrono::steady_clock::now() - started, std::chrono::seconds(3)) << "5 s if all pairs are kept";
  EXPECT_GT(heights(scene, 1).x, 7e-6f);
  EXPECT_GT(heights(scene, kCount - 1).x, 9e-4f) << "the max level";
}

TEST(CoplanarFaces, OfAnArrayOnOnePlateMoveByOneStep) {
  // All parts are in one plane, but only the plate overlaps them.
  constexpr int kColumns = 10, kRows = 300;
  std::vector<Mesh> meshes{rectangle({-100, -100}, {100, 100}, 0, 1)};
  for (int i = 0; i < kColumns * kRows; ++i) {
    const glm::vec2 low(-90 + 18 * (i % kColumns), -90.0f + 0.6f * float(i / kColumns));
    meshes.push_back(rectangle(low, low + glm::vec2(15, 0.5f), 0, 1));
  }
  Scene scene = scene_of(std::move(meshes));
  EXPECT_EQ(separate_coplanar_faces(scene), 2u * kColumns * kRows);
  for (std::size_t m = 1; m <= std::size_t(kColumns * kRows); ++m) {
    EXPECT_GT(heights(scene, m).x, 0.8e-5f) << m;
    EXPECT_LT(heights(scene, m).y, 1.2e-5f) << m;
  }
}

TEST(CoplanarFaces, StayWhereTheyAreOnceThePollEnds) {
  Scene scene = stacked(100);
  const glm::vec3 before = scene.meshes[99].positions[0];
  const ProgressMonitor monitor = [](double) { return false; };
  Poll poll(monitor);
  poll.ask(0.0);
  EXPECT_EQ(separate_coplanar_faces(scene, &poll), 0u);
  EXPECT_EQ(scene.meshes[99].positions[0], before);
}

/// Two meshes with a material each; the second material has a texture of one texel.
Scene scene_of(float opacity, std::uint8_t alpha) {
  Scene scene;
  scene.materials.resize(2);
  for (Material& material : scene.materials) material.blended = true;
  scene.materials[0].opacity = 0.0f;
  scene.materials[1].opacity = opacity;
  scene.materials[1].texture = 0;
  scene.textures.push_back({.width = 1, .height = 1, .rgba = {255, 255, 255, alpha}});
  for (int k = 0; k < 2; ++k) {
    Mesh& mesh = scene.meshes.emplace_back();
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.uvs.resize(3);
    mesh.indices = {0, 1, 2};
    mesh.material = k;
  }
  return scene;
}

bool shows(Scene scene) {
  const bool shown = show_if_invisible(scene);
  for (const Material& material : scene.materials) EXPECT_EQ(material.blended || material.alpha_mask, !shown);
  return shown;
}

TEST(Invisible, AModelIsOpaqueIfNothingOfItWouldBeSeen) {
  EXPECT_TRUE(shows(scene_of(0.0f, 255)));
  EXPECT_TRUE(shows(scene_of(1.0f, 0)));
  EXPECT_FALSE(shows(scene_of(1.0f, 255))) << "one of two is seen";
  EXPECT_FALSE(shows(scene_of(0.5f, 10)));
  Scene cut = scene_of(1.0f, 100);
  cut.materials[1].blended = false;
  cut.materials[1].alpha_mask = true;
  EXPECT_TRUE(shows(cut));
  cut.materials[1].alpha_cutoff = 0.25f;
  EXPECT_FALSE(shows(cut));
  cut.meshes[1].uvs.clear();
  cut.materials[1].alpha_cutoff = 0.5f;
  EXPECT_FALSE(shows(cut)) << "without texture coordinates there is no texture";
}

}  // namespace
}  // namespace umbrage
