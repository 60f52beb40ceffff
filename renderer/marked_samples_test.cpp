// Averages whose further samples are drawn at marked pixels only, against averages of whole samples.
#include "renderer/marked_samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "devices/cpu/cpu_device.h"
#include "renderer/draw.h"
#include "renderer/models.h"
#include "renderer/passes.h"

namespace umbrage {
namespace {

constexpr int kWidth = 120, kHeight = 90;

/// A square that fills the picture.
Scene square() {
  Scene scene;
  Mesh mesh;
  mesh.positions = {{-100.0f, -100.0f, 0.0f}, {100.0f, -100.0f, 0.0f}, {100.0f, 100.0f, 0.0f}, {-100.0f, 100.0f, 0.0f}};
  mesh.normals.assign(4, {0.0f, 0.0f, 1.0f});
  mesh.indices = {0, 1, 2, 0, 2, 3};
  scene.meshes.push_back(mesh);
  scene.materials.emplace_back();
  scene.bounds_min = {-100.0f, -100.0f, 0.0f};
  scene.bounds_max = {100.0f, 100.0f, 0.0f};
  return scene;
}

Image drawn(Scene scene, Request request, bool marked) {
  request.width = kWidth;
  request.height = kHeight;
  const auto device = make_cpu_device({});
  const auto recipe = make_recipe(request);
  EXPECT_TRUE(recipe) << recipe.error().message;
  EXPECT_TRUE(complete_scene(scene, *recipe));
  EXPECT_TRUE(device->prepare(scene));
  auto plan = make_plan(*recipe, scene, device->threads());
  EXPECT_TRUE(plan) << plan.error().message;
  EXPECT_TRUE(plan->marked);
  plan->marked = marked;
  if (request.occlusion == kNoOcclusion) plan->capture.shadow_rays = 0;  // no soft shadows
  StageTimes times;
  const auto picture = draw(*device, scene, *plan, times);
  EXPECT_TRUE(picture) << picture.error().message;
  std::vector<std::string> planes = {"color.r", "color.g", "color.b", "color.a"};
  if (marked) planes.emplace_back("marks");
  return *device->download(picture->frame, planes);
}

TEST(MarkedSamples, PictureWithoutEdgesIsThatOfTheFirstSample) {
  Request request{.look = "lit", .occlusion = "traced"};
  request.camera.position = {{0.0f, 3.0f, 10.0f}};
  request.camera.focal_point = {{0.0f, 0.0f, 0.0f}};
  request.anti_aliasing = 2;
  const Image two = drawn(square(), request, true);
  request.anti_aliasing = 7;
  const Image seven = drawn(square(), request, true);
  for (const std::string& name : two.names)
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) ASSERT_EQ(two.plane(name).at(x, y), seven.plane(name).at(x, y)) << name;
  EXPECT_EQ(two.plane("marks").at(kWidth / 2, kHeight / 2), 0.0f);
}

// Without occlusion and soft shadows, a further sample computes each marked pixel as a whole sample does. Only the
// order of the sum differs.
TEST(MarkedSamples, MarkedPixelsEqualTheAverageOfWholeSamples) {
  Request request{.look = "lit", .occlusion = "none"};
  request.anti_aliasing = 5;
  const Scene scene = *load_scene("scene:room?detail=3000");
  const Image some = drawn(scene, request, true), all = drawn(scene, request, false);
  double sum = 0.0;
  int marked = 0;
  for (const char* name : {"color.r", "color.g", "color.b", "color.a"})
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const float difference = std::abs(some.plane(name).at(x, y) - all.plane(name).at(x, y));
        if (some.plane("marks").at(x, y) > 0.0f) {
          ++marked;
          ASSERT_LE(difference, 2e-6f) << name << " " << x << ", " << y;
        } else {
          sum += difference;
        }
      }
  EXPECT_GT(marked, kWidth * kHeight / 10);
  EXPECT_LT(marked, 4 * kWidth * kHeight * 9 / 10);
  EXPECT_LE(sum / (4.0 * kWidth * kHeight - marked), 0.002);
}

// Look `ao` smooths its edges for the time of one frame and no more, whatever the technique.
TEST(MarkedSamples, EdgeFramesAreDrawnAtMarksOrNotAtAll) {
  const auto frames = [](const Request& request) {
    const Recipe recipe = *make_recipe(request);
    return std::pair(recipe.frames, draws_marked_samples(recipe));
  };
  const std::pair at_marks(5, true), one(1, false);
  for (const char* technique : {"traced", "bitmask", "unsharp", "none"})
    EXPECT_EQ(frames({.look = "ao", .occlusion = technique}), at_marks) << technique;
  EXPECT_EQ(frames({.look = "ao", .quality = "draft"}), at_marks);
  // Effects that read neighbours, and what the request asks for.
  EXPECT_EQ(frames({.look = "ao", .settings = {"antialias.search=8"}}), one);
  EXPECT_EQ(frames({.look = "ao", .passes = {"traced_confidence"}}), at_marks) << "the pass is that of one sample";
  EXPECT_EQ(frames({.look = "ao", .anti_aliasing = 1}), one);
  EXPECT_EQ(frames({.look = "ao", .occlusion = "bitmask", .anti_aliasing = 4}), std::pair(4, false));
}

// Lines are drawn over the average; without them, the samples of such a look compute each pixel by itself.
TEST(MarkedSamples, LooksWithLinesKeepWhatFurtherSamplesRead) {
  Request request{.look = "technical", .occlusion = "traced", .anti_aliasing = 4};
  request.width = request.height = 64;
  Recipe recipe = *make_recipe(request);
  EXPECT_TRUE(draws_marked_samples(recipe));
  reduce_to_passes(recipe);
  Scene scene = *load_scene("scene:solids?detail=2000");
  const auto device = make_cpu_device({});
  ASSERT_TRUE(device->prepare(scene));
  const auto plan = make_plan(recipe, scene, device->threads());
  EXPECT_TRUE(plan->marked);
  StageTimes times;
  const auto picture = draw(*device, scene, *plan, times);
  EXPECT_TRUE(picture) << picture.error().message;
}

// A pane whose edges are marked in front, before a wall with a step whose edge is marked behind.
TEST(MarkedSamples, BlendedSurfacesHaveMarksOfTheirOwn) {
  Scene scene = square();
  scene.materials[0].albedo = glm::vec3(0.8f);
  scene.materials.push_back({.albedo = glm::vec3(0.1f)});
  scene.materials.push_back({.albedo = {0.8f, 0.1f, 0.1f}, .blended = true, .opacity = 0.4f, .tint = glm::vec3(0.7f)});
  for (const auto& [x0, x1, z, material] : {std::tuple{-9.0f, 0.3f, 0.1f, 1}, {-1.7f, 1.9f, 2.0f, 2}}) {
    Mesh mesh = scene.meshes[0];
    mesh.positions = {{x0, -1.3f, z}, {x1, -1.3f, z}, {x1, 1.6f, z}, {x0, 1.6f, z}};
    mesh.material = material;
    scene.meshes.push_back(mesh);
  }
  Request request{.look = "lit", .occlusion = "none"};
  request.ground = "off";
  request.camera.position = {{1.0f, 0.5f, 8.0f}};
  request.camera.focal_point = {{0.0f, 0.0f, 0.0f}};
  request.anti_aliasing = 5;
  const Image some = drawn(scene, request, true), all = drawn(scene, request, false);
  float max = 0.0f, red = 0.0f;
  for (const char* name : {"color.r", "color.g", "color.b", "color.a"})
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        max = std::max(max, std::abs(some.plane(name).at(x, y) - all.plane(name).at(x, y)));
        red = std::max(red, some.plane("color.r").at(x, y) - some.plane("color.g").at(x, y));
      }
  EXPECT_LT(max, 0.01f) << "edges have all samples; elsewhere the samples are nearly equal";
  EXPECT_GT(red, 0.1f) << "the pane shows";
}

// Metering sees a bright pane as if it were opaque, with marked samples and without.
TEST(MarkedSamples, MeterBlendedSurfaces) {
  Scene scene = square();
  scene.materials[0].albedo = glm::vec3(0.02f);
  scene.materials.push_back({.albedo = glm::vec3(0.9f), .blended = true, .opacity = 0.6f});
  scene.meshes.push_back(scene.meshes[0]);
  for (glm::vec3& position : scene.meshes[1].positions) position.z = 1.0f;
  scene.meshes[1].material = 1;
  Request request{.look = "studio", .width = kWidth, .height = kHeight};
  request.ground = "off";
  request.camera.position = {{1.0f, 0.5f, 8.0f}};
  request.camera.focal_point = {{0.0f, 0.0f, 0.0f}};
  const auto device = make_cpu_device({});
  ASSERT_TRUE(device->prepare(scene));
  auto plan = make_plan(*make_recipe(request), scene, device->threads());
  ASSERT_TRUE(plan->marked && plan->has_blended);
  StageTimes times;
  const auto marked = draw(*device, scene, *plan, times);
  plan->marked = false;
  const auto whole = draw(*device, scene, *plan, times);
  ASSERT_TRUE(marked && whole);
  EXPECT_NEAR(*marked->stops, *whole->stops, 0.05f);
}

}  // namespace
}  // namespace umbrage
