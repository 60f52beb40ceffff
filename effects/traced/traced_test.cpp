// `traced` on scenes whose occlusion is known in closed form, and beside the reference; its indirect light beside a
// wall that emits light or hides the sky, for which it is known.
#include "effects/traced/traced.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <numbers>

#include "devices/cpu/cpu_device.h"
#include "generators/builtin.h"
#include "reference/trace.h"
#include "run_effect.h"
#include "scene/finish.h"
#include "scene/framing.h"
#include "support.h"

namespace umbrage {
namespace {

using test::Settings;

/// Makes the parallelogram origin + s u + t v for s, t in [0, 1].
Mesh parallelogram(glm::vec3 origin, glm::vec3 u, glm::vec3 v, int material = 0) {
  Mesh mesh;
  mesh.positions = {origin, origin + u, origin + u + v, origin + v};
  mesh.normals.assign(4, glm::normalize(glm::cross(u, v)));
  mesh.indices = {0, 1, 2, 0, 2, 3};
  mesh.material = mesh.object = material;
  return mesh;
}

Scene scene_of(std::vector<Mesh> meshes) {
  Scene scene;
  scene.name = "test";
  scene.meshes = std::move(meshes);
  scene.materials = {Material{}};
  EXPECT_EQ(finish_scene(scene), 0u);
  return scene;
}

/// A floor of 8 x 8 at z = 0, and if `walled` a wall in the plane x = 1.5.
Scene floor_scene(bool walled) {
  std::vector<Mesh> meshes = {parallelogram({-4, -4, 0}, {8, 0, 0}, {0, 8, 0})};
  if (walled) meshes.push_back(parallelogram({1.5f, -6, -3}, {0, 12, 0}, {0, 0, 6}));
  return scene_of(std::move(meshes));
}

/// A scene captured on the CPU.
struct Captured {
  Captured(Scene captured_scene, const Camera& camera, int width, int height, int threads = 0)
      : scene(std::make_unique<Scene>(std::move(captured_scene))), device(make_cpu_device({.threads = threads})) {
    EXPECT_TRUE(device->prepare(*scene));
    auto captured = device->capture(camera, {.width = width, .height = height, .ray_offsets = true});
    EXPECT_TRUE(captured);
    frame = std::move(*captured);
  }

  Image run(const Settings& settings, const std::vector<std::string>& planes = {"ao"}) const {
    const Effect& effect = *find_effect("traced");
    Frame branch = device->branch(frame);
    const auto status = device->run(effect, test::parameters_of(effect, settings), branch);
    EXPECT_TRUE(status) << (status ? "" : status.error().message);
    auto image = device->download(branch, planes);
    EXPECT_TRUE(image);
    return std::move(*image);
  }

  std::unique_ptr<Scene> scene;
  std::unique_ptr<Device> device;
  Frame frame;
};

Camera from_above(float width, float height, float x) {
  return orthographic_camera({x, 0, 10}, {x, 0, 0}, {0, 1, 0}, height, width / height);
}

Captured captured_builtin(std::string_view name, int width, int height, int threads = 0) {
  auto scene = *make_builtin_scene("scene:" + std::string(name));
  const Camera camera = frame_scene(scene, {}, width, height);
  return {std::move(scene), camera, width, height, threads};
}

double mean_of(const Plane& plane) {
  double sum = 0.0;
  for (int y = 0; y < plane.height; ++y)
    for (int x = 0; x < plane.width; ++x) sum += plane.at(x, y);
  return sum / (double(plane.width) * plane.height);
}

TEST(Traced, PlaneIsExactlyOpen) {
  const Captured floor(floor_scene(false), from_above(4, 4, 0), 40, 40);
  const Image image = floor.run({{"rays", "4"}, {"bent", "on"}}, {"ao", "bent.z"});
  EXPECT_EQ(test::difference(image.plane("ao"), Plane(40, 40, 1.0f), 0.0).max, 0.0);
  EXPECT_GT(mean_of(image.plane("bent.z")), 0.8);
}

TEST(Traced, WallWithinARadius) {
  // The projections of hits within the radius on the floor's unit disc lie beyond a chord at distance / radius.
  constexpr int kWidth = 64, kHeight = 40;
  constexpr double kRadius = 1.3;
  const PictureInfo info{.width = kWidth, .height = kHeight, .camera = from_above(1.6f, 1, 0.65f)};
  const Captured wall(floor_scene(true), info.camera, kWidth, kHeight);
  for (const char* rays : {"0.25", "1", "8"}) {
    const Image image = wall.run({{"rays", rays}, {"radius", "1.3"}, {"filter", "off"}}, {"ao", "traced_confidence"});
    double error = 0.0, count = 0.0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const double confidence = image.plane("traced_confidence").at(x, y),
                     n = std::round(confidence / (1.0 - confidence));
        const double k = (1.5 - test::ray_of(info, x, y).origin.x) / kRadius;
        const double open = k < 1.0 ? 1.0 - (std::acos(k) - k * std::sqrt(1.0 - k * k)) / M_PI : 1.0;
        error += n * (image.plane("ao").at(x, y) - open);
        count += n;
      }
    EXPECT_GT(count, kWidth * kHeight * std::stod(rays) * 0.9) << rays;
    // The deviation of a mean of independent rays; those of neighbours are more even than that.
    EXPECT_NEAR(error / count, 0.0, 3.0 * 0.4 / std::sqrt(count)) << rays;
  }
}

TEST(Traced, EveryPixelHasTheRaysAskedForWhateverTheMax) {
  const Captured floor(floor_scene(false), from_above(4, 4, 0), 40, 40);
  const Image image = floor.run({{"rays", "20"}, {"filter", "off"}}, {"traced_confidence"});
  EXPECT_FLOAT_EQ(image.plane("traced_confidence").at(20, 20), 20.0f / 21.0f);
}

TEST(Traced, PixelsWithoutSurfaceGetNoRay) {
  const Captured edge(scene_of({parallelogram({-1, -1, 0}, {2, 0, 0}, {0, 2, 0})}), from_above(4, 4, 0), 40, 40);
  const Image image =
      edge.run({{"rays", "4"}, {"filter", "off"}, {"bent", "on"}}, {"ao", "traced_confidence", "bent.z"});
  EXPECT_EQ(image.plane("traced_confidence").at(0, 0), 0.0f);
  EXPECT_EQ(image.plane("ao").at(0, 0), 1.0f);
  EXPECT_EQ(image.plane("bent.z").at(0, 0), 0.0f);
  EXPECT_EQ(image.plane("traced_confidence").at(20, 20), 0.8f);
  EXPECT_GT(image.plane("traced_confidence").at(10, 20), 0.81f) << "a pixel beside the edge";
}

TEST(Traced, MeanOfManySamplesIsTheReference) {
  constexpr int kWidth = 48, kHeight = 36, kSamples = 64;
  const Captured room = captured_builtin("room", kWidth, kHeight);
  const auto traced = build_traced_scene(*room.scene);
  ASSERT_TRUE(traced);
  const float radius = 0.1f * room.frame.info.scene_radius;
  for (const Falloff falloff : {Falloff::kNone, Falloff::kLinear, Falloff::kSmooth}) {
    const auto truth =
        trace_occlusion(**traced, room.frame.info, {.samples = 1024, .radius = radius, .falloff = falloff});
    ASSERT_TRUE(truth);
    static constexpr const char* kNames[] = {"none", "linear", "smooth"};
    Plane sum(kWidth, kHeight, 0.0f);
    for (int k = 0; k < kSamples; ++k) {
      const Image one = room.run(
          {{"rays", "1"}, {"filter", "off"}, {"falloff", kNames[int(falloff)]}, {"sample_index", std::to_string(k)}});
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) sum.at(x, y) += one.plane("ao").at(x, y) / kSamples;
    }
    double squares = 0.0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) squares += std::pow(sum.at(x, y) - truth->plane("ao").at(x, y), 2.0);
    // 64 independent rays would have an error of up to 0.0625.
    EXPECT_LT(std::sqrt(squares / (kWidth * kHeight)), 0.05) << int(falloff);
    EXPECT_NEAR(mean_of(sum), mean_of(truth->plane("ao")), 0.003) << int(falloff);
  }
}

TEST(Traced, FilterKeepsTheMeanOcclusion) {
  const Captured atrium = captured_builtin("atrium", 960, 540);
  const auto traced = build_traced_scene(*atrium.scene);
  ASSERT_TRUE(traced);
  const auto truth =
      trace_occlusion(**traced, atrium.frame.info, {.samples = 16, .radius = 0.1f * atrium.frame.info.scene_radius});
  ASSERT_TRUE(truth);
  for (const char* rays : {"0.25", "0.5", "1", "2", "8"})
    EXPECT_NEAR(mean_of(atrium.run({{"rays", rays}}).plane("ao")), mean_of(truth->plane("ao")), 0.003) << rays;
}

TEST(Traced, DoesNotDependOnThreads) {
  const Settings settings = {{"rays", "2"}, {"bent", "on"}};
  const Image one = captured_builtin("solids", 100, 70, 1).run(settings, {"ao", "bent.x"});
  const Image two = captured_builtin("solids", 100, 70, 2).run(settings, {"ao", "bent.x"});
  for (std::size_t p = 0; p < one.planes.size(); ++p)
    EXPECT_EQ(test::difference(one.planes[p], two.planes[p], 0.0).max, 0.0) << one.names[p];
}

TEST(Traced, ScalarAndLaneKernelsMakeTheSameRays) {
  const Settings settings = {{"rays", "2"}};
  const Captured lanes = captured_builtin("solids", 100, 70);
  const auto scalar = make_cpu_device({.scalar = true});
  ASSERT_TRUE(scalar->prepare(*lanes.scene));
  auto frame =
      scalar->capture(frame_scene(*lanes.scene, {}, 100, 70), {.width = 100, .height = 70, .ray_offsets = true});
  ASSERT_TRUE(frame);
  const Effect& effect = *find_effect("traced");
  ASSERT_TRUE(scalar->run(effect, test::parameters_of(effect, settings), *frame));
  const auto image = scalar->download(*frame, {"ao"});
  ASSERT_TRUE(image);
  const auto difference = test::difference(image->plane("ao"), lanes.run(settings).plane("ao"), 1e-3);
  // The last bits of a direction may turn a hit into a miss.
  EXPECT_LT(difference.fraction_over, 0.002);
}

TEST(Traced, NeedsTheModel) {
  const Captured floor(floor_scene(false), from_above(4, 4, 0), 8, 8);
  GBuffer gbuffer;
  gbuffer.info = floor.frame.info;
  gbuffer.layers.push_back(*floor.device->download_all(floor.frame));
  auto frame = floor.device->upload(std::move(gbuffer));
  ASSERT_TRUE(frame);
  const Effect& effect = *find_effect("traced");
  const auto status = floor.device->run(effect, test::parameters_of(effect, {}), *frame);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::kUsage);
  EXPECT_NE(status.error().message.find("needs the model"), std::string::npos) << status.error().message;
}

constexpr float kWall = 2.0f, kFar = 50.0f;  // where the wall stands; size of what stands for infinite
constexpr double kRadius = 1.5;
constexpr int kWidth = 28, kHeight = 64;
const glm::vec3 kEmission(1.0f, 0.5f, 0.25f);

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
