// Captures on different devices: sizes, threads, several scenes and frames; uploaded planes; PictureInfo.
#include "capture_support.h"

namespace umbrage {
namespace {

using namespace test;

// ---- sizes, threads, devices ----

TEST(Capture, SmallAndOddSizes) {
  const Scene scene = mixed_scene();
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 2}, {2, 3}, {17, 5}, {191, 347}}) {
    const Camera camera = perspective_camera({-5, -6, 9}, {-1, -1, 0}, {0, 0, 1}, 40.0f, float(width) / float(height));
    const Picture picture = capture(scene, camera, width, height);
    EXPECT_EQ(picture.planes.width, width);
    EXPECT_EQ(picture.planes.height, height);
    EXPECT_EQ(picture.planes.planes.size(), 12u);
    long hits = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        if (!std::isfinite(picture.depth(x, y))) continue;
        ++hits;
        const PixelRay ray = ray_of(picture.info, x, y);
        if (picture["object_id"].at(x, y) == 0.0f) {
          ASSERT_NEAR(ray.at(picture.depth(x, y)).z, 0.0, 1e-5);
        }
        if (picture["object_id"].at(x, y) == 1.0f) {
          ASSERT_NEAR(ray.at(picture.depth(x, y)).z, 2.0, 1e-5);
        }
      }
    EXPECT_GT(hits, width * height / 2);
  }
}

TEST(Capture, DoesNotDependOnThreads) {
  const Scene scene = mixed_scene();
  const Camera camera = perspective_camera({-5, -6, 9}, {-1, -1, 0}, {0, 0, 1}, 40.0f, 0.6f);
  const Picture one = capture(scene, camera, 120, 200, {.threads = 1});
  for (const int threads : {1, 2, 7})
    expect_equal(one.planes, capture(scene, camera, 120, 200, {.threads = threads}).planes,
                 fmt::format("{} threads", threads));
}

TEST(Capture, ADeviceCapturesSeveralScenesInTurn) {
  const Scene first = mixed_scene(), second = scene_of({square(3.0f, 1.5f)});
  const Camera camera = from_above(10.0f);
  const auto device = make_cpu_device();
  const auto draw = [&](const Scene& scene) {
    EXPECT_TRUE(device->prepare(scene));
    return *device->download_all(*device->capture(camera, {64, 64, true}));
  };
  const Image a = draw(first), b = draw(second), again = draw(first), twice = draw(first);
  expect_equal(a, capture(first, camera, 64, 64).planes, "first");
  expect_equal(b, capture(second, camera, 64, 64).planes, "second");
  expect_equal(a, again, "first again");
  expect_equal(a, twice, "prepared twice");
  EXPECT_GT(test::difference(a.plane("depth"), b.plane("depth"), 0.0).max, 0.5);
}

TEST(Capture, FramesOfOneDeviceAreIndependent) {
  const Scene scene = mixed_scene();
  const auto device = make_cpu_device();
  ASSERT_TRUE(device->prepare(scene));
  const auto small = device->capture(from_above(10.0f), {20, 10, true});
  const auto large = device->capture(from_above(5.0f), {40, 30, true});
  EXPECT_EQ(device->download_all(*small)->width, 20);
  EXPECT_EQ(device->download(*large, {"depth"})->height, 30);
  EXPECT_EQ(small->info.width, 20);
}

TEST(Device, ReportsTheMissingPlane) {
  const auto device = make_cpu_device();
  GBuffer g = test::empty_gbuffer(4, 3);
  const Effect& effect = *find_effect("lighting");
  const ParameterBytes params = initial_parameters(effect.parameters, effect.params_size);
  auto frame = device->upload(g);
  ASSERT_TRUE(frame);
  const auto status = device->run(effect, params, *frame);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::kUsage);
  EXPECT_NE(status.error().message.find("lighting needs the plane 'depth'"), std::string::npos)
      << status.error().message;
  const auto image = device->download(*frame, {"depth"});
  ASSERT_FALSE(image);
  EXPECT_EQ(image.error().kind, ErrorKind::kUsage);
  EXPECT_NE(image.error().message.find("'depth'"), std::string::npos) << image.error().message;
}

TEST(Device, UploadsAndDownloadsTheSamePlanes) {
  const auto device = make_cpu_device();
  GBuffer g = test::bumpy_gbuffer(37, 23, 3);
  g.layers.push_back(g.layers[0]);
  g.layers[1].plane("depth").at(5, 6) = 99.0f;
  const auto frame = device->upload(g);
  ASSERT_TRUE(frame);
  const Image image = *device->download_all(*frame);
  EXPECT_EQ(image.planes.size(), 2 * g.layers[0].planes.size());
  for (std::size_t p = 0; p < g.layers[0].planes.size(); ++p)
    EXPECT_EQ(test::difference(image.plane(g.layers[0].names[p]), g.layers[0].planes[p], 0.0).max, 0.0);
  EXPECT_EQ(image.plane("layer1.depth").at(5, 6), 99.0f);
  const Image two = *device->download(*frame, {"normal.y", "depth"});
  EXPECT_EQ(two.names, (std::vector<std::string>{"normal.y", "depth"}));
}

TEST(Device, NeutralValuesReplaceMissingPlanes) {
  // Depth and normals alone suffice to light a picture.
  const auto device = make_cpu_device();
  GBuffer g = test::empty_gbuffer(2, 2);
  g.info.lights = {{.direction = {0, 0, 1}, .color = glm::vec3(0.5f)}};
  g.layers[0].add("depth") = Plane(2, 2, 3.0f);
  for (const char* name : {"normal.x", "normal.y", "normal.z"})
    g.layers[0].add(name) = Plane(2, 2, name == std::string_view("normal.z") ? 1.0f : 0.0f);
  auto frame = device->upload(g);
  const Effect& effect = *find_effect("lighting");
  ASSERT_TRUE(device->run(effect, initial_parameters(effect.parameters, effect.params_size), *frame));
  const Image image = *device->download(*frame, {"direct.g", "ambient.g"});
  EXPECT_NEAR(image.planes[0].at(1, 1), 0.8f * 0.5f, 1e-6);
  EXPECT_NEAR(image.planes[1].at(1, 1), 0.8f * 0.3f, 1e-6);
}

// ---- picture_info ----

TEST(PictureInfo, DepthsSpanTheScene) {
  const Scene scene = scene_of({shapes::box({-1, -2, -3}, {1, 2, 3})});
  const PictureInfo info = picture_info(scene, from_above(4.0f, 2.0f, 10.0f), {.width = 64, .height = 32});
  EXPECT_EQ(info.width, 64);
  EXPECT_EQ(info.height, 32);
  EXPECT_NEAR(info.depth_min, 7.0f, 1e-5);
  EXPECT_NEAR(info.depth_max, 13.0f, 1e-5);
  EXPECT_NEAR(info.scene_radius, std::sqrt(1.0 + 4.0 + 9.0), 1e-5);
}

TEST(PictureInfo, CapturedDepthsLieWithinTheRange) {
  const Scene scene = mixed_scene();
  for (const Camera& camera : {perspective_camera({-5, -6, 9}, {-1, -1, 0}, {0, 0, 1}, 40.0f, 1.0f),
                               perspective_camera({0, 0, 1}, {8, 0, 0.5f}, {0, 0, 1}, 90.0f, 1.0f),  // inside the scene
                               from_above(10.0f), orthographic_camera({3, 2, 1}, {0, 0, 0}, {0, 0, 1}, 9.0f, 1.0f)}) {
    const Picture picture = capture(scene, camera, 80, 80);
    EXPECT_GT(picture.info.depth_min, 0.0f);
    EXPECT_LE(picture.info.depth_min, picture.info.depth_max);
    long hits = 0;
    for (int y = 0; y < 80; ++y)
      for (int x = 0; x < 80; ++x) {
        const float depth = picture.depth(x, y);
        if (!std::isfinite(depth)) continue;
        ++hits;
        ASSERT_LE(depth, picture.info.depth_max * 1.000001f);
        // From inside, surfaces may be nearer than depth_min, which is at least 1e-3 of the farthest depth.
        ASSERT_GE(depth, std::min(picture.info.depth_min, 1e-3f * picture.info.depth_max) * 0.999999f);
      }
    EXPECT_GT(hits, 1000);
  }
}

TEST(PictureInfo, IsValidIfTheSceneIsBehindTheCamera) {
  const Scene scene = scene_of({square(1.0f)});
  const PictureInfo info =
      picture_info(scene, perspective_camera({0, 0, 5}, {0, 0, 9}, {0, 1, 0}, 40.0f, 1.0f), {.width = 8, .height = 8});
  EXPECT_GT(info.depth_min, 0.0f);
  EXPECT_LE(info.depth_min, info.depth_max);
  EXPECT_TRUE(std::isfinite(info.depth_max));
  const Picture picture = capture(scene, info.camera, 8, 8);
  for (int x = 0; x < 8; ++x) EXPECT_EQ(picture.depth(x, 4), kInfinity);
}

TEST(PictureInfo, LightsAreInViewSpace) {
  Scene scene = scene_of({square(1.0f)});
  scene.ambient = {0.1f, 0.2f, 0.3f};
  scene.lights = {key_light({0, 0, 1}), key_lamp({1, 2, 3})};
  const Camera camera = perspective_camera({4, 0, 3}, {0, 0, 3}, {0, 0, 1}, 40.0f, 1.0f);  // looks along -x
  const PictureInfo info = picture_info(scene, camera, {.width = 8, .height = 8});
  ASSERT_EQ(info.lights.size(), 2u);
  EXPECT_LT(glm::distance(info.lights[0].direction, glm::vec3(0, 1, 0)), 1e-6f);
  EXPECT_LT(glm::distance(info.lights[1].position, glm::vec3(2, 0, -3)), 1e-5f);
  EXPECT_EQ(info.ambient, scene.ambient);
}

}  // namespace
}  // namespace umbrage
