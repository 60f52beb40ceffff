// Scenes drawn by the GPU, plane by plane against Embree's.
#include <array>
#include <bit>
#include <cmath>
#include <map>

#include "apps/job/job.h"
#include "devices/vulkan/hierarchy.h"
#include "devices/vulkan/vulkan_device.h"
#include "faulty_vulkan.h"
#include "support.h"
#include "vulkan_capture.h"
#include "vulkan_support.h"

namespace umbrage {
namespace {

struct Shot {
  const char *name, *scene;
  bool orthographic;
  CaptureSettings settings;
};

class VulkanCaptureShots : public testing::TestWithParam<Shot> {};

TEST_P(VulkanCaptureShots, PlanesAreThoseOfEmbree) {
  const Shot& shot = GetParam();
  Device* const device = test::drawing_device();
  UMBRAGE_NEEDS_VULKAN(device);
  const test::NoMessages no_messages;
  auto scene = load_scene(shot.scene);
  ASSERT_TRUE(scene);
  Framing framing;
  framing.orthographic = shot.orthographic;
  const Camera camera = frame_scene(*scene, framing, shot.settings.width, shot.settings.height);
  if (scene->lights.empty())
    scene->lights = shot.settings.shadow_rays > 0 ? studio_lights(camera) : default_lights(*scene, camera);
  const test::Both both{test::captured(*device, *scene, camera, shot.settings),
                        test::captured(*make_cpu_device(), *scene, camera, shot.settings)};
  ASSERT_EQ(both.gpu.names, both.cpu.names);
  ASSERT_EQ(both.gpu.width, both.cpu.width);
  const int layers = *layer_count(shot.settings);
  const test::Disagreement d = test::disagreement(both, layers);
  EXPECT_LE(d.anywhere, d.pixels / 500) << shot.name;
  for (const auto& [plane, count] : d.inside) EXPECT_LE(count, d.pixels / 5000) << shot.name << ' ' << plane;
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, VulkanCaptureShots,
    testing::Values(
        Shot{"solids", "scene:solids?detail=3000", false, {.width = 160, .height = 120}},
        Shot{"parallel", "scene:solids?detail=3000", true, {.width = 131, .height = 97, .guard = 9}},
        Shot{"soft", "scene:solids?detail=3000", false, {.width = 160, .height = 120, .shadow_rays = 8}},
        Shot{"penumbrae", "scene:solids?detail=3000", false, {.width = 160, .height = 120, .shadow_rays = 1}},
        Shot{"room", "scene:room?detail=3000", false, {.width = 160, .height = 120, .shadow_rays = 4}},
        Shot{"textures", "scene:atrium?detail=8000", false, {.width = 160, .height = 120}},
        Shot{"terrain", "scene:terrain?detail=8000", false, {.width = 160, .height = 120}},
        Shot{"layers", "scene:tank?detail=5000", false, {.width = 120, .height = 90, .layers = 4}},
        Shot{"backs", "scene:atrium?detail=8000", false, {.width = 120, .height = 90, .layers = 2, .back_sides = true}},
        Shot{"views", "scene:atrium?detail=8000", false, {.width = 120, .height = 90, .layers = 2, .extra_views = 2}}),
    [](const auto& info) { return std::string(info.param.name); });

/// The hierarchy's root box and every inner one, checked against what lies below it.
void expect_boxes_hold(const Hierarchy& h, int child, glm::vec3 low, glm::vec3 high, std::vector<int>& seen) {
  if (child < 0) {
    for (int k = ~child >> 3; k < (~child >> 3) + (~child & 7); ++k) {
      ++seen[std::size_t(k)];
      for (int c = 0; c < 3; ++c) {
        const glm::vec3 p(h.triangles[std::size_t(k)][c]);
        for (int axis = 0; axis < 3; ++axis) {
          EXPECT_GE(p[axis], low[axis]);
          EXPECT_LE(p[axis], high[axis]);
        }
      }
    }
    return;
  }
  for (int side = 0; side < 2; ++side) {
    const glm::vec4 lower = h.nodes[std::size_t(child)][2 * side], upper = h.nodes[std::size_t(child)][2 * side + 1];
    expect_boxes_hold(h, std::bit_cast<int>(lower.w), glm::vec3(lower), glm::vec3(upper), seen);
  }
}

TEST(Hierarchy, HoldsEachTriangleOnceInItsBoxes) {
  auto scene = load_scene("scene:solids?detail=3000");
  ASSERT_TRUE(scene);
  // A thousand triangles in one place: no plane parts them.
  Mesh pile = scene->meshes[0];
  pile.indices.resize(3);
  for (int k = 1; k < 1000; ++k)
    for (int c = 0; c < 3; ++c) pile.indices.push_back(pile.indices[std::size_t(c)]);
  scene->meshes.push_back(pile);
  const auto h = build_hierarchy(*scene, scene->center(), 1.0f / 64.0f);
  ASSERT_TRUE(h);
  ASSERT_EQ(h->triangles.size(), scene->triangle_count());
  std::vector<int> seen(h->triangles.size());
  const glm::vec3 all(1e30f);
  expect_boxes_hold(*h, h->root, -all, all, seen);
  for (const int count : seen) ASSERT_EQ(count, 1);
  Scene empty;
  ASSERT_TRUE(build_hierarchy(empty, {}, 1.0f));
  EXPECT_TRUE(build_hierarchy(empty, {}, 1.0f)->empty());
}

TEST(VulkanCapture, EveryLookGivesTheSamePicture) {
  Device* const gpu = test::drawing_device();
  UMBRAGE_NEEDS_VULKAN(gpu);
  const test::NoMessages no_messages;
  const auto cpu = make_cpu_device();
  for (const Look* look : looks()) {
    DrawSettings settings;
    settings.width = 150;
    settings.height = 110;
    settings.look = std::string(look->name);
    settings.frames = 2;
    std::array<Image, 2> images;
    int k = 0;
    for (Device* device : {gpu, static_cast<Device*>(cpu.get())}) {
      auto scene = load_scene("scene:solids?detail=3000");
      ASSERT_TRUE(scene);
      furnish(*scene, settings);
      ASSERT_TRUE(device->prepare(*scene));
      StageTimes times;
      const auto frame = draw(*device, *scene, settings, times);
      ASSERT_TRUE(frame) << frame.error().message;
      images[k++] = *device->download(*frame, {"color.r", "color.g", "color.b"});
    }
    for (std::size_t p = 0; p < 3; ++p) {
      const auto d = test::difference(images[0].planes[p], images[1].planes[p], 2.0 / 255.0);
      EXPECT_LE(d.share_over, 2e-3) << look->name << ", most " << d.most;
    }
  }
}

TEST(VulkanCapture, TakesOneSceneAfterTheOtherWithoutGrowth) {
  Device* const gpu = test::drawing_device();
  UMBRAGE_NEEDS_VULKAN(gpu);
  const test::NoMessages no_messages;
  const std::array scenes = {*load_scene("scene:solids?detail=2000"), *load_scene("scene:tank?detail=2000")};
  std::array<Image, 2> first;
  VulkanMemory after_both;
  for (int k = 0; k < 40; ++k) {
    const Scene& scene = scenes[k % 2];
    const Camera camera = frame_scene(scene, {}, 48, 32);
    const Image image = test::captured(*gpu, scene, camera, {.width = 48, .height = 32});
    if (k < 2) first[k] = image;
    for (std::size_t p = 0; p < image.planes.size(); ++p)
      ASSERT_EQ(test::difference(image.planes[p], first[k % 2].planes[p], 0.0).most, 0.0) << k << image.names[p];
    if (k == 3) after_both = vulkan_memory(*gpu);
  }
  EXPECT_EQ(vulkan_memory(*gpu).device_bytes, after_both.device_bytes);
  EXPECT_EQ(vulkan_memory(*gpu).host_bytes, after_both.host_bytes);
}

TEST(VulkanCapture, TooLittleMemoryForASceneIsAnError) {
  if (!test::start_faulty()) GTEST_SKIP() << "no Vulkan here";
  const auto gpu = test::new_vulkan_device({.capture = VulkanCapture::kGpu, .get = test::faulty_get});
  UMBRAGE_NEEDS_VULKAN(gpu);
  const test::NoMessages no_messages;
  const auto scene = load_scene("scene:solids?detail=30000");
  ASSERT_TRUE(scene);
  test::faulty().faults.memory_left = 1 << 20;
  const auto refused = gpu->prepare(*scene);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kDevice);
  test::faulty().faults.memory_left = std::uint64_t(1) << 30;
  ASSERT_TRUE(gpu->prepare(*scene));
  EXPECT_TRUE(gpu->capture(frame_scene(*scene, {}, 32, 32), {.width = 32, .height = 32}));
}

}  // namespace
}  // namespace umbrage
