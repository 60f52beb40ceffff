// `traced` on scenes whose occlusion is known in closed form, and beside the reference.
#include "effects/traced/traced.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <memory>

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

Mesh parallelogram(glm::vec3 origin, glm::vec3 u, glm::vec3 v) {
  Mesh mesh;
  mesh.positions = {origin, origin + u, origin + u + v, origin + v};
  mesh.normals.assign(4, glm::normalize(glm::cross(u, v)));
  mesh.indices = {0, 1, 2, 0, 2, 3};
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

}  // namespace
}  // namespace umbrage
