// The indirect light of `traced` beside a wall that emits light or hides the sky, for which it is known.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "run_effect.h"
#include "scene/finish.h"

namespace umbrage {
namespace {

using test::Settings;

constexpr float kWall = 2.0f, kFar = 50.0f;  // where the wall stands; size of what stands for infinite
constexpr double kRadius = 1.5;
constexpr int kWidth = 28, kHeight = 64;
const glm::vec3 kEmission(1.0f, 0.5f, 0.25f);

/// Makes the parallelogram origin + s u + t v for s, t in [0, 1].
Mesh parallelogram(glm::vec3 origin, glm::vec3 u, glm::vec3 v, int material) {
  Mesh mesh;
  mesh.positions = {origin, origin + u, origin + u + v, origin + v};
  mesh.normals.assign(4, glm::normalize(glm::cross(u, v)));
  mesh.indices = {0, 1, 2, 0, 2, 3};
  mesh.material = mesh.object = material;
  return mesh;
}

/// Returns a black floor, z = 0, and a black wall that emits light, x = kWall, without lights.
Scene lit_wall() {
  Scene scene;
  scene.meshes = {parallelogram({-kFar, -kFar, 0}, {2 * kFar, 0, 0}, {0, 2 * kFar, 0}, 0),
                  parallelogram({kWall, -kFar, -kFar}, {0, 2 * kFar, 0}, {0, 0, 2 * kFar}, 1)};
  Material black;
  black.albedo = glm::vec3(0.0f);
  scene.materials = {black, black};
  scene.materials[1].emission = kEmission;
  scene.ambient = glm::vec3(0.0f);
  EXPECT_EQ(finish_scene(scene), 0u);
  return scene;
}

/// Runs `traced` on a picture of the floor, seen from above: column k is at the distance (kWidth - k - 0.5) / 20 from
/// the wall. `shape`: of ambient light, whose view space has the axes of world space.
Image traced_beside_wall(const Settings& settings, int threads = 0, const AmbientShape& shape = {}) {
  const Scene scene = lit_wall();
  const auto device = make_cpu_device({.threads = threads});
  EXPECT_TRUE(device->prepare(scene));
  const float x = kWall - 0.5f * kWidth / 20.0f;
  const Camera camera = orthographic_camera({x, 0, 10}, {x, 0, 0}, {0, 1, 0}, kHeight / 20.0f, float(kWidth) / kHeight);
  auto frame = device->capture(camera, {.width = kWidth, .height = kHeight, .ray_offsets = true});
  EXPECT_TRUE(frame);
  frame->info.ambient_shape = shape;
  const Effect& effect = *find_effect("traced");
  const ParameterBytes params = test::parameters_of(effect, test::joined({{"radius", "1.5"}}, settings));
  EXPECT_TRUE(device->run(effect, params, *frame));
  return *device->download(*frame, test::written_planes(effect, params));
}

/// Returns the fraction of the cosine-weighted hemisphere in which the wall is within the radius: half a spherical cap
/// around the horizontal direction to the wall, whose projection to the floor is half of a segment of a disc.
double wall_fraction(double distance) {
  const double angle = std::acos(std::min(distance / kRadius, 1.0));
  return (angle - std::sin(angle) * std::cos(angle)) / std::numbers::pi;
}

double wall_fraction_of_column(int x) { return wall_fraction((kWidth - x - 0.5) / 20.0); }

TEST(TracedLight, AWallThatEmitsLight) {
  constexpr int kRays = 16;
  const Image image = traced_beside_wall({{"rays", "16"}, {"max_rays", "16"}, {"filter", "off"}, {"bleeding", "2"}});
  for (int x = 0; x < kWidth; ++x) {
    const double expected = wall_fraction_of_column(x);
    glm::dvec3 sum(0.0);
    for (int y = 0; y < kHeight; ++y)
      for (int c = 0; c < 3; ++c) sum[c] += image.plane(test::kIndirect[c]).at(x, y) / kHeight;
    // Standard error of independent rays; those of neighbours are more even.
    const double error = std::sqrt(expected * (1.0 - expected) / (kRays * kHeight));
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(sum[c], 2.0 * kEmission[c] * expected, 2.0 * kEmission[c] * 3.0 * error + 1e-6) << x << ' ' << c;
  }
}

TEST(TracedLight, TheFilterPreservesTheMean) {
  double expected = 0.0;
  for (int x = 0; x < kWidth; ++x) expected += wall_fraction_of_column(x) / kWidth;
  for (const char* rays : {"0.5", "1", "2"}) {
    const Image image = traced_beside_wall({{"rays", rays}, {"bleeding", "1"}});
    for (int c = 0; c < 3; ++c) {
      double mean = 0.0;
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) mean += image.plane(test::kIndirect[c]).at(x, y) / (kWidth * kHeight);
      EXPECT_NEAR(mean, kEmission[c] * expected, 0.05 * kEmission[c] * expected) << rays << " rays, channel " << c;
    }
  }
}

TEST(TracedLight, OpenDirectionsTakeTheirOwnAmbientLight) {
  // Radiance, by channel: 0.5 x; 0.8 z; x z + x^2 - 1/3.
  const auto radiance = [](int channel, double x, double z) {
    return channel == 0 ? 0.5 * x : channel == 1 ? 0.8 * z : x * z + x * x - 1.0 / 3.0;
  };
  AmbientShape shape;  // irradiance has 2/3 of the first degree, and 1/4 of the second
  shape.by_color[0][0][3] = shape.by_color[0][3][0] = 0.5f / 3.0f;
  shape.by_color[1][2][3] = shape.by_color[1][3][2] = 0.8f / 3.0f;
  shape.by_color[2][0][2] = shape.by_color[2][2][0] = 0.125f;
  for (int axis = 0; axis < 3; ++axis) shape.by_color[2][axis][axis] = (axis == 0 ? 0.25f : 0.0f) - 0.25f / 3.0f;
  const Settings rays = {{"rays", "16"}, {"max_rays", "16"}, {"filter", "off"}, {"directional", "1"}};
  const Image image = traced_beside_wall(rays, 0, shape);
  const double of_floor[] = {0.0, 0.8 * 2.0 / 3.0, -1.0 / 12.0};  // the light of the whole sky on the floor
  for (int x = 0; x < kWidth; ++x)
    for (int channel = 0; channel < 3; ++channel) {
      double expected = 0.0;
      constexpr int kSteps = 400;
      for (int i = 0; i < kSteps; ++i)
        for (int j = 0; j < kSteps; ++j) {
          const double u = (i + 0.5) / kSteps, along = std::sqrt(u) * std::cos(2.0 * std::numbers::pi * j / kSteps);
          if (along * kRadius > (kWidth - x - 0.5) / 20.0)
            expected += (of_floor[channel] - radiance(channel, along, std::sqrt(1.0 - u))) / (kSteps * kSteps);
        }
      double mean = 0.0;
      for (int y = 0; y < kHeight; ++y) mean += image.plane(test::kIndirect[channel]).at(x, y) / kHeight;
      EXPECT_NEAR(mean, expected, 0.015) << x << ' ' << channel;
    }
  // Where the sky is uniform, nothing changes.
  const Image uniform = traced_beside_wall(rays);
  for (const char* name : test::kIndirect)
    EXPECT_EQ(test::difference(uniform.plane(name), Plane(kWidth, kHeight, 0.0f), 0.0).max, 0.0) << name;
}

TEST(TracedLight, DoesNotChangeTheOcclusion) {
  const Image with = traced_beside_wall({{"bleeding", "1"}}), without = traced_beside_wall({});
  EXPECT_EQ(without.find("indirect.r"), nullptr);
  EXPECT_EQ(test::difference(with.plane("ao"), without.plane("ao"), 0.0).max, 0.0);
}

TEST(TracedLight, DoesNotDependOnThreads) {
  const Image one = traced_beside_wall({{"bleeding", "1"}}, 1), all = traced_beside_wall({{"bleeding", "1"}});
  for (const char* name : test::kIndirect)
    EXPECT_EQ(test::difference(one.plane(name), all.plane(name), 0.0).max, 0.0) << name;
}

}  // namespace
}  // namespace umbrage
