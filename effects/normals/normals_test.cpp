// Compares `normals` with the normals of planes, a box and a sphere, captured together with their depth.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "run_effect.h"
#include "scene/finish.h"
#include "support.h"

namespace umbrage {
namespace {

using test::Settings;

glm::vec3 normal_at(const Image& image, int x, int y) {
  return {image.plane("normal.x").at(x, y), image.plane("normal.y").at(x, y), image.plane("normal.z").at(x, y)};
}

Camera camera_for(bool orthographic, float aspect) {
  const glm::vec3 eye(3.0f, 2.0f, 4.0f), target(0.0f), up(0, 1, 0);
  return orthographic ? orthographic_camera(eye, target, up, 3.2f, aspect)
                      : perspective_camera(eye, target, up, 36.0f, aspect);
}

/// Returns a scene of one mesh.
Scene scene_of(const Mesh& mesh) {
  Scene scene;
  scene.name = "shape";
  scene.materials.resize(1);
  scene.meshes = {mesh};
  finish_scene(scene, 30.0f);
  return scene;
}

Scene box() {
  Mesh mesh;
  for (int k = 0; k < 8; ++k)
    mesh.positions.push_back({k & 1 ? 0.8f : -0.8f, k & 2 ? 0.7f : -0.7f, k & 4 ? 0.6f : -0.6f});
  mesh.indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                  2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  return scene_of(mesh);
}

Scene floor_at(float degrees) {
  const float c = std::cos(glm::radians(degrees)), s = std::sin(glm::radians(degrees));
  Mesh mesh;
  mesh.positions = {{-9, -9 * s, -9 * c}, {9, -9 * s, -9 * c}, {9, 9 * s, 9 * c}, {-9, 9 * s, 9 * c}};
  mesh.indices = {0, 2, 1, 0, 3, 2};
  return scene_of(mesh);
}

/// Returns the depth and normals of a scene.
GBuffer captured(const Scene& scene, bool orthographic, int width = 131, int height = 97) {
  const auto device = make_cpu_device();
  EXPECT_TRUE(device->prepare(scene));
  const auto frame = device->capture(camera_for(orthographic, float(width) / float(height)),
                                     {.width = width, .height = height, .shadows = 0});
  EXPECT_TRUE(frame);
  GBuffer g;
  g.info = frame->info;
  g.layers.push_back(*device->download(*frame, {"depth", "normal.x", "normal.y", "normal.z"}));
  return g;
}

/// Returns whether a pixel can be extrapolated exactly: in its row and in its column, the next two pixels on at least
/// one side show a surface.
bool is_predictable(const Plane& depth, int x, int y) {
  const auto there = [&](int i, int j) {
    return i >= 0 && i < depth.width && j >= 0 && j < depth.height && std::isfinite(depth.at(i, j));
  };
  return ((there(x - 1, y) && there(x - 2, y)) || (there(x + 1, y) && there(x + 2, y))) &&
         ((there(x, y - 1) && there(x, y - 2)) || (there(x, y + 1) && there(x, y + 2)));
}

TEST(Normals, PlanesAreExactAtEveryTilt) {
  for (const bool orthographic : {false, true})
    for (const float degrees : {0.0f, 20.0f, -30.0f, 55.0f, 80.0f}) {
      const GBuffer g = captured(floor_at(degrees), orthographic);
      test::on_every_target("normals", g, {}, [&](const Image& image) {
        long compared = 0;
        for (int y = 0; y < image.height; ++y)
          for (int x = 0; x < image.width; ++x) {
            if (!std::isfinite(g.layers[0].plane("depth").at(x, y))) {
              ASSERT_EQ(normal_at(image, x, y), glm::vec3(0.0f));
              continue;
            }
            if (!is_predictable(g.layers[0].plane("depth"), x, y)) continue;
            ++compared;
            ASSERT_GT(glm::dot(normal_at(image, x, y), normal_at(g.layers[0], x, y)), 0.99999f)
                << degrees << orthographic << ' ' << x << ' ' << y;
          }
        EXPECT_GT(compared, 500);
      });
    }
}

/// Returns the number of pixels of a box whose normal is not that of a face within a pixel of them.
long mixtures(bool orthographic, const Settings& settings) {
  const GBuffer g = captured(box(), orthographic);
  const Image image = test::run_effect(*find_effect("normals"), g, settings, {});
  long mixed = 0;
  for (int y = 1; y < image.height - 1; ++y)
    for (int x = 1; x < image.width - 1; ++x) {
      if (!std::isfinite(g.layers[0].plane("depth").at(x, y))) continue;
      float best = -1.0f;
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i)
          best = std::max(best, glm::dot(normal_at(image, x, y), normal_at(g.layers[0], x + i, y + j)));
      mixed += best < 0.999f;
    }
  return mixed;
}

TEST(Normals, EdgesOfABoxHaveTheNormalOfAFace) {
  for (const bool orthographic : {false, true}) {
    const long better = mixtures(orthographic, {}), mean = mixtures(orthographic, {{"sides", "mean"}});
    EXPECT_LT(better, 12) << "corners, where a row or column has one pixel of a face";
    EXPECT_GT(mean, 100);
  }
}

TEST(Normals, ASphereIsRound) {
  constexpr int kRings = 192;
  Mesh mesh;
  for (int v = 0; v <= kRings; ++v)
    for (int u = 0; u <= 2 * kRings; ++u) {
      const double a = 3.14159265358979 * v / kRings, b = 3.14159265358979 * u / kRings;
      mesh.positions.push_back(
          {float(std::sin(a) * std::cos(b)), float(std::cos(a)), float(std::sin(a) * std::sin(b))});
    }
  for (std::uint32_t v = 0; v < kRings; ++v)
    for (std::uint32_t u = 0; u < 2 * kRings; ++u) {
      const std::uint32_t k = v * (2 * kRings + 1) + u, below = k + 2 * kRings + 1;
      mesh.indices.insert(mesh.indices.end(), {k, k + 1, below, k + 1, below + 1, below});
    }
  mesh.normals = mesh.positions;
  const GBuffer g = captured(scene_of(mesh), false);
  const Image image = test::run_effect(*find_effect("normals"), g, {}, {});
  double off = 0.0;
  long compared = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      if (!std::isfinite(g.layers[0].plane("depth").at(x, y)) || g.layers[0].plane("normal.z").at(x, y) < 0.5f)
        continue;
      off += std::acos(std::min(glm::dot(normal_at(image, x, y), normal_at(g.layers[0], x, y)), 1.0f));
      ++compared;
    }
  EXPECT_LT(glm::degrees(off / double(compared)), 2.5) << "the turn over half a pixel, plus that between facets";
}

TEST(Normals, SinglePixelsFaceTheCamera) {
  GBuffer g = test::empty_gbuffer(9, 9);
  Plane& depth = g.layers[0].add("depth") = Plane(9, 9, std::numeric_limits<float>::infinity());
  depth.at(4, 4) = 3.0f;
  test::on_every_target("normals", g, {}, [](const Image& image) {
    EXPECT_GT(normal_at(image, 4, 4).z, 0.99f);
    EXPECT_NEAR(glm::length(normal_at(image, 4, 4)), 1.0f, 1e-5f);
    EXPECT_EQ(normal_at(image, 3, 4), glm::vec3(0.0f));
  });
}

}  // namespace
}  // namespace umbrage
