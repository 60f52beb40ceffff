// Depth that is easily misread: depth buffers without a name, points, panoramas, wide pixels.
#include <gtest/gtest.h>

#include <algorithm>

#include "gbuffers/test_scene.h"

namespace umbrage {
namespace {

using test::grey_png;
using test::has_warning;
using test::Hit;
using test::hit_at;
using test::scene;
using test::TestFile;
using test::TestScene;
using test::understand;
using test::Understood;

/// The value of a depth buffer with the planes 2 and 40.
double window_of(const Hit& hit) { return 40.0 * (hit.depth - 2.0) / (hit.depth * 38.0); }

/// Returns the max deviation of depth from a multiple of the true one, relative.
double deviation(const Understood& got) {
  std::vector<double> ratios;
  for (int y = 0; y < scene().height; ++y)
    for (int x = 0; x < scene().width; ++x)
      if (hit_at(x, y).found) ratios.push_back(got.planes.plane("depth").at(x, y) / hit_at(x, y).depth);
  const auto [low, high] = std::minmax_element(ratios.begin(), ratios.end());
  return *high / *low - 1.0;
}

TEST(DepthBuffers, DepthBuffersAreRecognisedByTheirPlanesAndBackground) {
  for (const bool reversed : {false, true})
    for (const double max : {0.0, 65535.0}) {
      if (reversed && max > 0.0) continue;  // 0 means no surface in any integers
      TestFile file(scene(), max > 0.0 ? "PNG" : "NPY");
      file.max_integer = max;
      const double one = max > 0.0 ? max : 1.0;
      file.add("Y", reversed ? 0.0f : float(one), [&](const Hit& hit) {
        const double v = one * (reversed ? 1.0 - window_of(hit) : window_of(hit));
        return max > 0.0 ? std::round(v) : v;
      });
      Understood got = understand(file);
      ASSERT_EQ(got.error, "");
      EXPECT_EQ(got.conventions.depth.model.meaning, reversed ? DepthMeaning::kReversed : DepthMeaning::kWindow)
          << got.text();
      EXPECT_TRUE(has_warning(got, "`near_plane` and `far_plane`")) << got.text();
      EXPECT_TRUE(std::isinf(got.planes.plane("depth").at(120, 0)));
      EXPECT_LT(got.planes.plane("depth").at(60, 100) * hit_at(120, 140).depth,
                got.planes.plane("depth").at(120, 140) * hit_at(60, 100).depth * 1.5)
          << got.text();
      if (max > 0.0) continue;
      // Normals tell the planes.
      file.add_vector("N", [](const Hit& hit) { return hit.normal_view; });
      file.header.channels[0].layer = "depth";
      got = understand(file);
      EXPECT_LT(deviation(got), 0.02) << got.text();
      EXPECT_FALSE(has_warning(got, "planes")) << got.text();
    }
}

TEST(DepthBuffers, PlanesSayThatIntegersAreADepthBuffer) {
  GBufferSettings settings;
  settings.near_plane = 2.0f, settings.far_plane = 40.0f;
  for (const double max : {255.0, 65535.0})
    for (const bool reversed : {false, true}) {
      const Understood got =
          understand(grey_png(max, reversed ? 0.0f : float(max),
                              [&](const Hit& hit) { return max * (reversed ? 1.0 - window_of(hit) : window_of(hit)); }),
                     settings);
      EXPECT_EQ(got.conventions.depth.model.meaning, reversed ? DepthMeaning::kReversed : DepthMeaning::kWindow)
          << got.text();
      EXPECT_LT(deviation(got), max > 255.0 ? 1e-3 : 0.2) << got.text();
      EXPECT_TRUE(std::isinf(got.planes.plane("depth").at(120, 0)));
    }
  // Millimetres make surfaces flat as they are.
  const Understood lengths =
      understand(grey_png(65535, 0.0f, [](const Hit& hit) { return 1000.0 * hit.depth; }), settings);
  EXPECT_EQ(lengths.conventions.depth.model.meaning, DepthMeaning::kPlanar) << lengths.text();
  EXPECT_LT(deviation(lengths), 1e-3) << lengths.text();
}

TEST(DepthBuffers, PlanarDepthFromZeroToOneIsNoDepthBuffer) {
  TestFile file(scene(), "NPY");
  file.add("Y", 1.0f, [](const Hit& hit) { return hit.depth / 20.0; });
  const Understood got = understand(file);
  EXPECT_EQ(got.conventions.depth.model.meaning, DepthMeaning::kPlanar) << got.text();
  EXPECT_TRUE(got.facts.warnings.empty()) << got.text();
  EXPECT_LT(deviation(got), 1e-5) << got.text();
  EXPECT_TRUE(std::isinf(got.planes.plane("depth").at(120, 0)));
}

TEST(DepthBuffers, UnclearDepthBufferIsWarnedOf) {
  // A ball alone, whose surface is curved in any kind of depth.
  TestScene ball;
  for (Hit& hit : ball.hits) hit.found = hit.object == 1;
  TestFile file(ball, "NPY");
  file.add("Y", 1.0f, window_of);
  const Understood got = understand(file);
  EXPECT_TRUE(got.conventions.depth.model.meaning == DepthMeaning::kWindow || has_warning(got, "`depth_kind` window"))
      << got.text();
}

TEST(DepthBuffers, PointsOfAScannerAreWarnedOf) {
  const auto points = [](int one_in) {
    TestFile file(scene(), "PNG");
    file.max_integer = 65535.0;
    file.add(
        "Y", 0.0f, [](const Hit& hit) { return std::round(256.0 * hit.depth); }, ChannelType::kUint16);
    unsigned state = 1;
    for (float& v : file.values[0])
      if (state = state * 1664525u + 1013904223u; (state >> 8) % 100u >= unsigned(one_in)) v = 0.0f;
    return understand(file);
  };
  EXPECT_TRUE(has_warning(points(5), "isolated points")) << points(5).text();
  EXPECT_FALSE(has_warning(points(90), "isolated points")) << points(90).text();
}

TEST(DepthBuffers, StepIsTheMinDifference) {
  const Understood got = understand(grey_png(65535, 65535.0f, [](const Hit& hit) { return 10.0 * hit.depth; }));
  EXPECT_NE(got.conventions.step_warning.find("steps of 1 ("), std::string::npos) << got.conventions.step_warning;
  EXPECT_NE(got.conventions.step_cure.find("finer unit"), std::string::npos);
}

TEST(DepthBuffers, PanoramaIsRefused) {
  // A room and a ball, by longitude and latitude.
  TestScene room;
  room.width = 256, room.height = 128;
  room.hits.clear();
  const PixelGrid grid(Camera(), room.width, room.height);
  for (int y = 0; y < room.height; ++y)
    for (int x = 0; x < room.width; ++x) {
      const glm::dvec3 ray = grid.direction(x, y), low(-3.0, -1.2, -2.0), high(2.0, 1.6, 4.0), center(1.0, -0.5, 1.5);
      Hit& hit = room.hits.emplace_back();
      hit.found = true;
      hit.distance = 1e9;
      for (int axis = 0; axis < 3; ++axis) {
        const double t = (ray[axis] > 0.0 ? high : low)[axis] / ray[axis];
        if (!(t > 0.0 && t < hit.distance)) continue;
        hit.distance = t;
        hit.normal_world = glm::dvec3(0.0);
        hit.normal_world[axis] = ray[axis] > 0.0 ? -1.0 : 1.0;
      }
      const double b = glm::dot(ray, center), root = b * b - glm::dot(center, center) + 0.49;
      if (root < 0.0 || b - std::sqrt(root) > hit.distance) continue;
      hit.distance = b - std::sqrt(root);
      hit.normal_world = glm::normalize(hit.distance * ray - center);
    }
  for (const bool with_normals : {true, false}) {
    TestFile file(room);
    file.add("Depth.Z", 0.0f, [](const Hit& hit) { return hit.distance; });
    if (with_normals) file.add_vector("Normal", [](const Hit& hit) { return hit.normal_world; });
    EXPECT_NE(understand(file).error.find("panorama"), std::string::npos) << understand(file).text();
  }
  // A picture of a camera with the same sides.
  TestScene wide;
  wide.width = 320;
  wide.hits.clear();
  for (int y = 0; y < wide.height; ++y)
    for (int x = 0; x < wide.width; ++x) wide.hits.push_back(wide.cast(x, y));
  for (const bool along_ray : {false, true})
    for (const bool with_normals : {true, false}) {
      TestFile file(wide);
      file.add("Depth.Z", 0.0f, [&](const Hit& hit) { return along_ray ? hit.distance : hit.depth; });
      if (with_normals) file.add_vector("Normal", [](const Hit& hit) { return hit.normal_world; });
      EXPECT_EQ(understand(file).error, "") << along_ray << with_normals;
    }
}

TEST(DepthBuffers, WidePixelsAreKnownToTheFit) {
  TestScene wide;  // each pixel is as wide as two
  const int width = wide.width / 2;
  wide.hits.clear();
  for (int y = 0; y < wide.height; ++y)
    for (int x = 0; x < width; ++x) wide.hits.push_back(wide.cast(2.0 * x + 0.5, y));
  wide.width = width;
  TestFile file(wide);
  file.header.pixel_aspect = 2.0;
  file.add("Z", 0.0f, [](const Hit& hit) { return hit.depth; });
  file.add_vector("N", [](const Hit& hit) { return hit.normal_world; });
  const Camera camera = understand(file).conventions.camera;
  EXPECT_NEAR(camera.top, wide.top(), 0.01 * wide.top());
  EXPECT_NEAR(camera.right, 1.5 * camera.top, 1e-5);
}

}  // namespace
}  // namespace umbrage
