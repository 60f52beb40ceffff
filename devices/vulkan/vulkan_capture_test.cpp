// Captures on the GPU, compared with Embree's plane by plane.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <tuple>

#include "devices/vulkan/hierarchy.h"
#include "devices/vulkan/vulkan_device.h"
#include "faulty_vulkan.h"
#include "generators/shapes.h"
#include "renderer/draw.h"
#include "renderer/models.h"
#include "scene/finish.h"
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

class VulkanCaptureShots : public testing::TestWithParam<std::tuple<Shot, VulkanCapture>> {};

TEST_P(VulkanCaptureShots, PlanesMatchEmbree) {
  const auto& [shot, how] = GetParam();
  CaptureSettings settings = shot.settings;
  settings.ray_offsets = true;
  Device* const device = test::capturing_device(how);
  UMBRAGE_NEEDS_VULKAN(device);
  const test::NoMessages no_messages;
  auto scene = load_scene(shot.scene);
  ASSERT_TRUE(scene);
  Framing framing;
  framing.orthographic = shot.orthographic;
  const Camera camera = frame_scene(*scene, framing, shot.settings.width, shot.settings.height);
  if (scene->lights.empty())
    scene->lights = (shot.settings.shadow_rays > 0 ? studio_lighting : default_lighting)(camera, scene->up).lights;
  const test::Both both{test::captured(*device, *scene, camera, settings),
                        test::captured(*make_cpu_device(), *scene, camera, settings)};
  ASSERT_EQ(both.gpu.names, both.cpu.names);
  ASSERT_EQ(both.gpu.width, both.cpu.width);
  const int layers = *layer_count(shot.settings);
  const test::SurfacesAt surfaces(*scene, picture_info(*scene, camera, shot.settings));
  const test::Deviation d = test::deviation(both, layers, shot.settings.extra_views == 0 ? &surfaces : nullptr);
  EXPECT_LE(d.anywhere, d.pixels / 500) << shot.name;
  for (const auto& [plane, count] : d.inside) EXPECT_LE(count, d.pixels / 5000) << shot.name << ' ' << plane;
}

TEST(VulkanCaptureBlended, PlanesMatchEmbree) {
  // A sphere of glass, and a textured pane in front of a solid.
  Scene scene = *load_scene("scene:solids?detail=3000");
  for (std::size_t m = 0; m < scene.materials.size(); m += 2) {
    scene.materials[m].blended = true;
    scene.materials[m].opacity = m % 4 == 0 ? 0.3f : 0.7f;
    scene.materials[m].glass = m % 4 == 0;
    scene.materials[m].tint = {0.5f, 0.75f, 1.0f};
  }
  ASSERT_TRUE(has_blended(scene));
  const Camera camera = frame_scene(scene, {}, 160, 120);
  scene.lights = default_lighting(camera, scene.up).lights;
  for (const VulkanCapture how : test::kGpuCaptures)
    for (const bool blended : {false, true}) {
      Device* const device = test::capturing_device(how);
      UMBRAGE_NEEDS_VULKAN(device);
      const test::NoMessages no_messages;
      const CaptureSettings settings{.width = 160, .height = 120, .layers = 2, .blended = blended};
      const test::Both both{test::captured(*device, scene, camera, settings),
                            test::captured(*make_cpu_device(), scene, camera, settings)};
      ASSERT_EQ(both.gpu.names, both.cpu.names);
      const test::SurfacesAt surfaces(scene, picture_info(scene, camera, settings));
      EXPECT_LE(test::deviation(both, 2, &surfaces).anywhere, both.cpu.width * both.cpu.height / 250)
          << test::name_of(how) << blended;
      if (!blended) continue;
      // Pixels differ only where the border of a surface lies, perhaps behind others.
      for (const char* name : {"opacity", "transmittance.r", "transmittance.b", "albedo.r", "albedo.g"}) {
        int covered = 0, differing = 0;
        for (int y = 0; y < both.cpu.height; ++y)
          for (int x = 0; x < both.cpu.width; ++x) {
            covered += both.cpu.plane("opacity").at(x, y) > 0.0f;
            differing += std::fabs(both.cpu.plane(name).at(x, y) - both.gpu.plane(name).at(x, y)) > 2.0f / 255.0f;
          }
        EXPECT_GT(covered, 500) << "the scene has blended pixels";
        EXPECT_LE(differing, covered / 50) << test::name_of(how) << ' ' << name;
      }
    }
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, VulkanCaptureShots,
    testing::Combine(
        testing::Values(
            Shot{"solids", "scene:solids?detail=3000", false, {.width = 160, .height = 120}},
            Shot{"parallel", "scene:solids?detail=3000", true, {.width = 131, .height = 97, .guard = 9}},
            Shot{"soft", "scene:solids?detail=3000", false, {.width = 160, .height = 120, .shadow_rays = 8}},
            Shot{"penumbrae", "scene:solids?detail=3000", false, {.width = 160, .height = 120, .shadow_rays = 1}},
            Shot{"pairs",
                 "scene:solids?detail=3000",
                 false,
                 {.width = 160, .height = 120, .shadow_rays = 2, .sample = 3}},
            Shot{"room", "scene:room?detail=3000", false, {.width = 160, .height = 120, .shadow_rays = 4}},
            Shot{"textures", "scene:atrium?detail=8000", false, {.width = 160, .height = 120}},
            Shot{"terrain", "scene:terrain?detail=8000", false, {.width = 160, .height = 120}},
            Shot{"layers", "scene:tank?detail=5000", false, {.width = 120, .height = 90, .layers = 4}},
            Shot{"backs",
                 "scene:atrium?detail=8000",
                 false,
                 {.width = 120, .height = 90, .layers = 2, .back_sides = true}},
            Shot{"views",
                 "scene:atrium?detail=8000",
                 false,
                 {.width = 120, .height = 90, .layers = 2, .extra_views = 2}}),
        testing::ValuesIn(test::kGpuCaptures)),
    [](const auto& info) {
      return std::string(std::get<0>(info.param).name) + "_" + test::name_of(std::get<1>(info.param));
    });

/// Expects that the boxes below `child`, and [low, high], contain their triangles. Counts each triangle in `seen`.
void expect_boxes_contain(const Hierarchy& h, int child, glm::vec3 low, glm::vec3 high, std::vector<int>& seen) {
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
    expect_boxes_contain(h, std::bit_cast<int>(lower.w), glm::vec3(lower), glm::vec3(upper), seen);
  }
}

TEST(Hierarchy, ContainsEachTriangleOnceInItsBoxes) {
  auto scene = load_scene("scene:solids?detail=3000");
  ASSERT_TRUE(scene);
  // A thousand triangles in one place: no plane separates them.
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
  expect_boxes_contain(*h, h->root, -all, all, seen);
  for (const int count : seen) ASSERT_EQ(count, 1);
  Scene empty;
  ASSERT_TRUE(build_hierarchy(empty, {}, 1.0f));
  EXPECT_TRUE(build_hierarchy(empty, {}, 1.0f)->empty());
}

class VulkanCaptureModes : public testing::TestWithParam<VulkanCapture> {};

INSTANTIATE_TEST_SUITE_P(Modes, VulkanCaptureModes, testing::ValuesIn(test::kGpuCaptures),
                         [](const auto& info) { return std::string(test::name_of(info.param)); });

/// Returns the difference of two devices' pictures in the worst channel: the max, and as fraction_over the fraction of
/// pixels that differ by more than 2/255.
test::Difference difference_between(std::array<Device*, 2> devices, Request settings) {
  settings.width = 150;
  settings.height = 110;
  settings.anti_aliasing = 2;
  std::vector<Image> images;
  for (Device* device : devices) {
    auto scene = load_scene("scene:solids?detail=3000");
    EXPECT_TRUE(complete_scene(*scene, *make_recipe(settings)));
    EXPECT_TRUE(device->prepare(*scene));
    StageTimes times;
    const auto frame = draw(*device, *scene, settings, times);
    EXPECT_TRUE(frame) << frame.error().message;
    images.push_back(*device->download(*frame, {"color.r", "color.g", "color.b"}));
  }
  test::Difference max;
  for (std::size_t p = 0; p < 3; ++p) {
    const auto d = test::difference(images[0].planes[p], images[1].planes[p], 2.0 / 255.0);
    max.max = std::max(max.max, d.max);
    max.fraction_over = std::max(max.fraction_over, d.fraction_over);
  }
  return max;
}

TEST_P(VulkanCaptureModes, EveryLookGivesTheSamePicture) {
  Device* const gpu = test::capturing_device(GetParam());
  UMBRAGE_NEEDS_VULKAN(gpu);
  const test::NoMessages no_messages;
  const auto cpu = make_cpu_device();
  for (const Look* look : scene_looks()) {
    Request settings;
    settings.look = std::string(look->name);
    if (settings.look == "hatching") continue;  // it has nothing but lines
    if (settings.look == "cartoon" || settings.look == "technical") settings.settings = {"outline.opacity=0"};
    const auto d = difference_between({gpu, cpu.get()}, settings);
    EXPECT_LE(d.fraction_over, 2e-3) << look->name << ", most " << d.max;
  }
  // Lines are smooth: where one pixel of a line differs, all of it is shifted by a few hundredths of a pixel.
  for (const char* look : {"cartoon", "technical"}) {
    Request with_lines;
    with_lines.look = look;
    const auto d = difference_between({gpu, cpu.get()}, with_lines);
    EXPECT_LE(d.fraction_over, 1e-2) << look;
    // A pixel on a silhouette may show the background with one capture only. In `technical` it differs by more than the
    // shift of a line, since a dark blue surface may be there.
    EXPECT_LE(d.max, with_lines.look == "cartoon" ? 0.1 : 0.2) << look;
  }
}

TEST_P(VulkanCaptureModes, MemoryDoesNotGrowFromSceneToScene) {
  Device* const gpu = test::capturing_device(GetParam());
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
      ASSERT_EQ(test::difference(image.planes[p], first[k % 2].planes[p], 0.0).max, 0.0) << k << image.names[p];
    if (k == 3) after_both = vulkan_memory(*gpu);
  }
  EXPECT_EQ(vulkan_memory(*gpu).device_bytes, after_both.device_bytes);
  EXPECT_EQ(vulkan_memory(*gpu).host_bytes, after_both.host_bytes);
}

/// Returns whether a capture drew triangles.
bool drew(Device& gpu, const Scene& scene, const Camera& camera, const CaptureSettings& settings, Image* image) {
  EXPECT_TRUE(gpu.finish());
  *image = test::captured(gpu, scene, camera, settings);
  const std::vector<DispatchTime> times = *gpu.finish();
  EXPECT_FALSE(times.empty());
  return std::any_of(times.begin(), times.end(), [](const DispatchTime& time) { return time.dispatch == "seen"; });
}

TEST(VulkanCapture, DrawsTrianglesIfItCan) {
  Device* const rays = test::capturing_device(VulkanCapture::kRays);
  Device* const raster = test::capturing_device(VulkanCapture::kRaster);
  UMBRAGE_NEEDS_VULKAN(rays && raster);
  const test::NoMessages no_messages;
  const auto scene = load_scene("scene:solids?detail=2000");
  ASSERT_TRUE(scene);
  const CaptureSettings settings{.width = 40, .height = 30, .layers = 2};
  const Camera camera = frame_scene(*scene, {}, settings.width, settings.height);
  Image by_rays, image;
  EXPECT_FALSE(drew(*rays, *scene, camera, settings, &by_rays));
  EXPECT_TRUE(drew(*raster, *scene, camera, settings, &image));
  // A queue that can only compute.
  ASSERT_TRUE(test::start_faulty());
  test::faulty().faults.draws = false;
  const auto computes = test::new_vulkan_device({.capture = VulkanCapture::kRaster, .get = test::faulty_get});
  ASSERT_TRUE(computes);
  EXPECT_FALSE(drew(*computes, *scene, camera, settings, &image));
  for (std::size_t p = 0; p < image.planes.size(); ++p)
    EXPECT_EQ(test::difference(image.planes[p], by_rays.planes[p], 0.0).max, 0.0) << image.names[p];
  // Points among triangles are drawn too.
  Scene mixed = *scene;
  Mesh points;
  points.points = true;
  points.positions = {mixed.bounds_max, mixed.bounds_min};
  mixed.meshes.push_back(points);
  finish_scene(mixed);
  EXPECT_TRUE(drew(*raster, mixed, camera, settings, &image));
  // Nothing is in front of the camera.
  Camera away = camera;
  away.view_from_world = glm::mat4(-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1) * camera.view_from_world;
  drew(*raster, *scene, away, settings, &image);
  for (int y = 0; y < settings.height; ++y)
    for (int x = 0; x < settings.width; ++x) ASSERT_EQ(image.plane("depth").at(x, y), INFINITY);
}

/// Returns a scene in which mesh k is object k.
Scene scene_of(std::vector<Mesh> meshes) {
  Scene scene;
  scene.meshes = std::move(meshes);
  scene.materials.resize(1);
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) scene.meshes[m].object = int(m);
  EXPECT_EQ(finish_scene(scene), 0u);
  return scene;
}

TEST(VulkanCapture, RasterisationLeavesNoHoleAroundTheCamera) {
  Device* const rays = test::capturing_device(VulkanCapture::kRays);
  Device* const raster = test::capturing_device(VulkanCapture::kRaster);
  UMBRAGE_NEEDS_VULKAN(rays && raster);
  const test::NoMessages no_messages;
  // The camera is inside a box of a few large triangles that extend on both sides of it, once close to a wall, and
  // inside a sphere of many small triangles.
  Mesh box;
  for (int k = 0; k < 8; ++k) box.positions.emplace_back(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
  box.indices = {0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5, 0, 4, 5, 0, 5, 1,
                 2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3};
  // The camera is also inside a point; a second, smaller point occludes a part of it.
  Scene points;
  points.materials.resize(1);
  points.meshes.resize(1);
  points.meshes[0].points = true;
  points.meshes[0].positions = {{0, 0, 0}, {1.1f, 0.3f, 0.2f}};
  ASSERT_EQ(finish_scene(points, 80.0f, {PointShape::kSpheres, {2.0f, 0}}), 0u);
  points.meshes[0].radii[points.meshes[0].positions[0] == glm::vec3(0.0f) ? 1 : 0] = 0.3f;
  const std::array scenes = {scene_of({box}), scene_of({shapes::sphere(1.0f, 96, 48)}), points};
  const CaptureSettings settings{.width = 120, .height = 90};
  for (const Scene& scene : scenes)
    for (const glm::vec3 eye : {glm::vec3(0.3f, 0.2f, -0.1f), glm::vec3(0.1f, -0.2f, 0.95f)})
      for (const glm::vec3 toward : {glm::vec3(1, 0.2, 0.1), glm::vec3(-0.3, -1, 0.2), glm::vec3(0.1, 0.4, 1)}) {
        const Camera camera = perspective_camera(eye, eye + toward, {0, 1, 0.1f}, 100.0f, 4.0f / 3.0f);
        const Image drawn = test::captured(*raster, scene, camera, settings);
        const Image traced = test::captured(*rays, scene, camera, settings);
        for (int y = 0; y < settings.height; ++y)
          for (int x = 0; x < settings.width; ++x) {
            const float depth = traced.plane("depth").at(x, y);
            ASSERT_NEAR(drawn.plane("depth").at(x, y), depth, 1e-3f * depth) << x << ',' << y;
          }
        EXPECT_LE(test::difference(drawn.plane("depth"), traced.plane("depth"), 1e-5).fraction_over, 1e-3);
      }
}

TEST(VulkanCapture, DiscsThatBlendHaveTheNormalsOfTheCpu) {
  // Points on an ellipsoid of uneven axes: the normals of the discs change differently along and across.
  Mesh discs;
  discs.points = true;
  for (int k = 0; k < 1200; ++k) {
    const float z = 1.0f - (2.0f * float(k) + 1.0f) / 1200.0f, turn = 2.4f * float(k), r = std::sqrt(1.0f - z * z);
    discs.positions.push_back(3.0f * glm::vec3(r * std::cos(turn), 0.6f * r * std::sin(turn), 0.4f * z));
    discs.normals.push_back(glm::normalize(glm::vec3(r * std::cos(turn), r * std::sin(turn) / 0.6f, z / 0.4f)));
  }
  const Scene scene = scene_of({discs});
  ASSERT_FALSE(scene.meshes[0].bends.empty());
  const CaptureSettings settings{.width = 120, .height = 90};
  const Camera camera = frame_scene(scene, {}, settings.width, settings.height);
  const Image cpu = test::captured(*make_cpu_device(), scene, camera, settings);
  for (const VulkanCapture way : test::kGpuCaptures) {
    Device* const gpu = test::capturing_device(way);
    UMBRAGE_NEEDS_VULKAN(gpu);
    const test::NoMessages no_messages;
    const Image image = test::captured(*gpu, scene, camera, settings);
    for (const char* plane : {"normal.x", "normal.y", "normal.z"})
      EXPECT_LE(test::difference(image.plane(plane), cpu.plane(plane), 1e-3).fraction_over, 2e-3)
          << test::name_of(way) << ' ' << plane;
  }
}

TEST(VulkanCapture, RasterisationSeparatesDistantSheets) {
  Device* const raster = test::capturing_device(VulkanCapture::kRaster);
  UMBRAGE_NEEDS_VULKAN(raster);
  const test::NoMessages no_messages;
  // Two sheets that extend from behind the camera to the horizon; either one is drawn first.
  const auto sheet = [](float height) {
    Mesh mesh;
    mesh.positions = {{-100, height, -100}, {-100, height, 100}, {100, height, 100}, {100, height, -100}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    return mesh;
  };
  const CaptureSettings settings{.width = 100, .height = 100, .layers = 2};
  const Camera camera = perspective_camera({0, 1, 0}, {0.3f, 0.4f, -1}, {0, 1, 0}, 60.0f, 1.0f);
  for (const float gap : {1e-4f, 3e-6f})
    for (const int upper : {0, 1}) {
      const Scene scene = scene_of({sheet(upper == 0 ? 0.0f : -gap), sheet(upper == 0 ? -gap : 0.0f)});
      const Image image = test::captured(*raster, scene, camera, settings);
      long seen = 0;
      for (int y = 0; y < settings.height; ++y)
        for (int x = 0; x < settings.width; ++x) {
          if (!std::isfinite(image.plane("depth").at(x, y))) continue;
          ++seen;
          ASSERT_EQ(image.plane("object_id").at(x, y), float(upper)) << gap << ' ' << x << ',' << y;
          // Sheets that are closer than the step between layers count as one surface.
          if (gap == 1e-4f && std::isfinite(image.plane("layer1.depth").at(x, y))) {
            ASSERT_EQ(image.plane("layer1.object_id").at(x, y), float(1 - upper)) << x << ',' << y;
          }
        }
      EXPECT_GT(seen, 6000);
    }
}

TEST_P(VulkanCaptureModes, TooLittleMemoryForASceneIsAnError) {
  UMBRAGE_NEEDS_VULKAN(test::start_faulty());
  const auto gpu = test::new_vulkan_device({.capture = GetParam(), .get = test::faulty_get});
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

TEST_P(VulkanCaptureModes, TracesRaysWithoutMemoryForTheRenderTarget) {
  UMBRAGE_NEEDS_VULKAN(test::start_faulty());
  const auto gpu = test::new_vulkan_device({.capture = GetParam(), .get = test::faulty_get});
  Device* const rays = test::capturing_device(VulkanCapture::kRays);
  UMBRAGE_NEEDS_VULKAN(gpu && rays);
  const test::NoMessages no_messages;
  const auto scene = load_scene("scene:solids?detail=30000");
  ASSERT_TRUE(scene);
  ASSERT_TRUE(gpu->prepare(*scene));
  ASSERT_TRUE(rays->prepare(*scene));
  const auto captured = [&](Device& device, int width) {
    const Camera camera = frame_scene(*scene, {}, width, 32);
    return device.capture(camera, {.width = width, .height = 32});
  };
  ASSERT_TRUE(captured(*gpu, 32));
  const auto drew = [&](Device& device) {
    bool any = false;
    const auto times = device.finish();
    for (const DispatchTime& time : *times) any = any || time.dispatch == "seen";
    return any;
  };
  EXPECT_EQ(drew(*gpu), GetParam() == VulkanCapture::kRaster);
  // There is memory for planes of the same size, but not for the render target.
  test::faulty().faults.memory_left = 0;
  const auto without = captured(*gpu, 30);
  test::faulty().faults.memory_left = std::uint64_t(1) << 30;
  ASSERT_TRUE(without) << without.error().message;
  const auto image = gpu->download(*without, {"depth", "normal.x"});
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_FALSE(drew(*gpu));
  const auto traced = captured(*rays, 30);
  ASSERT_TRUE(traced);
  const auto expected = rays->download(*traced, {"depth", "normal.x"});
  ASSERT_TRUE(expected);
  for (int p = 0; p < 2; ++p)
    for (int y = 0; y < 32; ++y)
      EXPECT_TRUE(std::equal(image->planes[p].row(y), image->planes[p].row(y) + 30, expected->planes[p].row(y)));
  ASSERT_TRUE(captured(*gpu, 30));
  EXPECT_EQ(drew(*gpu), GetParam() == VulkanCapture::kRaster);
}

TEST(VulkanCapture, TheRenderTargetIsReleasedIfPlanesNeedItsMemory) {
  UMBRAGE_NEEDS_VULKAN(test::start_faulty());
  const auto gpu = test::new_vulkan_device({.capture = VulkanCapture::kRaster, .get = test::faulty_get});
  UMBRAGE_NEEDS_VULKAN(gpu);
  const test::NoMessages no_messages;
  const auto scene = load_scene("scene:solids?detail=3000");
  ASSERT_TRUE(scene);
  ASSERT_TRUE(gpu->prepare(*scene));
  const auto capture = [&] { return gpu->capture(frame_scene(*scene, {}, 256, 256), {.width = 256, .height = 256}); };
  const auto frame = capture();
  ASSERT_TRUE(frame);
  const auto before = gpu->download_all(*frame);  // also allocates host memory for uploads
  ASSERT_TRUE(before);
  const std::uint64_t bytes_before = vulkan_memory(*gpu).device_bytes;
  test::faulty().faults.memory_left = 0;
  test::faulty().faults.reuses_memory = true;
  // The planes of this frame take less memory than the render target.
  const auto other = gpu->upload(test::bumpy_gbuffer(80, 60, 5));
  EXPECT_TRUE(other) << other.error().message;
  EXPECT_LT(vulkan_memory(*gpu).device_bytes, bytes_before);
  test::faulty().faults.memory_left = std::uint64_t(1) << 30;
  const auto again = capture();
  ASSERT_TRUE(again);
  const auto after = gpu->download(*again, {"depth"});
  ASSERT_TRUE(after);
  EXPECT_EQ(test::difference(before->plane("depth"), after->planes[0], 0.0).max, 0.0);
}

}  // namespace
}  // namespace umbrage
