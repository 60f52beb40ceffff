// Metering of pictures of 100 metered pixels, against stops calculated by hand.
#include "looks/metering.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <string>
#include <vector>

#include "devices/cpu/cpu_device.h"
#include "renderer/draw.h"
#include "scene/finish.h"
#include "support.h"

namespace umbrage {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kSide = 30;  // one pixel in 3 is metered, across and down: 100 in all

/// Some of the metered pixels and their luminance.
struct Part {
  int count;
  float luminance;
};

/// Returns the planes of a grey picture, row by row in the order of the parts. Pixels that are not metered are black.
Image picture_of(const std::vector<Part>& parts) {
  Image image(kSide, kSide);
  for (const std::string& name : kMeteredPlanes) image.add(name) = Plane(kSide, kSide, name == "depth" ? 1.0f : 0.0f);
  int pixel = 0;
  for (const Part& part : parts)
    for (int k = 0; k < part.count; ++k, ++pixel)
      for (int c = 0; c < 3; ++c)
        image.planes[std::size_t(c)].at(pixel % 10 * 3 + 1, pixel / 10 * 3 + 1) = part.luminance;
  EXPECT_EQ(pixel, 100);
  return image;
}

float stops_of(const Image& image, float usual = 0.0f) {
  Metering metering;
  metering.add(image, 0, image.height);
  return metering.stops(usual);
}

float stops_of(const std::vector<Part>& parts, float usual = 0.0f) { return stops_of(picture_of(parts), usual); }

/// Returns the correction half way from where this highlight is white to the median's target.
double half_way(double highlight, double to_median) {
  const double to_white = std::log2(double(kMeteredWhite) / highlight);
  return to_white + 0.5 * (to_median - to_white);
}

/// Returns what is applied of a correction.
double applied(double stops) { return stops / (1.0 + std::fabs(stops) / 16.0); }

TEST(MeteringNumbers, TheMedianUnlessHighlightsGetTooBright) {
  const float median = kMeteredMedian;
  ASSERT_FLOAT_EQ(median, 0.395f);
  ASSERT_FLOAT_EQ(kMeteredWhite, 1.05f);
  // One stop below, whatever the 3 % that are highlights.
  EXPECT_NEAR(stops_of({{100, median / 2}}), applied(1.0), 1e-5);
  EXPECT_NEAR(stops_of({{97, median / 2}, {3, 16.0f}}), applied(1.0), 1e-5);
  // With 4 % they count.
  EXPECT_NEAR(stops_of({{96, median / 2}, {4, 4.0f}}), applied(half_way(4.0, 1.0)), 1e-5);
  // A dark hall, in which the sun shines on a tenth.
  EXPECT_NEAR(stops_of({{90, 0.01f}, {10, 1.0f}}), applied(half_way(1.0, std::log2(39.5))), 1e-5);
  // The 50th of 100 is the median.
  EXPECT_NEAR(stops_of({{50, median / 2}, {50, median}}), applied(1.0), 1e-5);
  EXPECT_NEAR(stops_of({{49, median / 2}, {51, median}}), 0.0, 1e-5);
  // The correction is that of the usual stops.
  EXPECT_NEAR(stops_of({{100, median / 2}}, -1.0f), -1.0 + applied(2.0), 1e-5);
  EXPECT_NEAR(stops_of({{100, median / 16}}, 0.5f), 0.5 + applied(3.5), 1e-5);
  EXPECT_NEAR(stops_of({{100, median * 16}}, 0.5f), 0.5 - applied(4.5), 1e-5);
  EXPECT_EQ(stops_of({{100, 0.0f}}, 0.5f), 0.5f) << "no light at all";
}

TEST(MeteringNumbers, BrightnessOfSurfacesInOnePixelOfThree) {
  // The brightness of a pure colour is the mean of its channel and of its luminance by Rec.709.
  const float weights[] = {0.2126f, 0.7152f, 0.0722f};
  for (std::size_t c = 0; c < 3; ++c) {
    Image image = picture_of({{100, 0.0f}});
    for (int y = 1; y < kSide; y += 3)
      for (int x = 1; x < kSide; x += 3) image.planes[c].at(x, y) = kMeteredMedian / (1.0f + weights[c]);
    EXPECT_NEAR(stops_of(image), applied(1.0), 1e-4) << c;
    // The background and what is not finite do not count.
    for (int y = 1; y < kSide; y += 3)
      for (int x = 1; x < kSide / 2; x += 3) {
        image.planes[c].at(x, y) = x == 1 ? std::nanf("") : 100.0f;
        if (x > 1) image.planes[3].at(x, y) = kInfinity;
      }
    EXPECT_NEAR(stops_of(image), applied(1.0), 1e-4) << c;
    // Rows may come in pieces.
    for (const int rows : {1, 4, 7}) {
      Metering metering;
      for (int first = 0; first < kSide; first += rows) {
        const int count = std::min(rows, kSide - first);
        Image part(kSide, count);
        for (std::size_t p = 0; p < 4; ++p) {
          Plane& plane = part.add(kMeteredPlanes[p]);
          for (int y = 0; y < count; ++y) std::copy_n(image.planes[p].row(first + y), kSide, plane.row(y));
        }
        metering.add(part, first, kSide);
      }
      EXPECT_NEAR(metering.stops(0.0f), applied(1.0), 1e-4) << rows;
      EXPECT_EQ(metering.stops(0.25f), 0.25f) << "the rows are cleared";
    }
    // 4 % that are two stops beyond white in this channel alone are highlights.
    image = picture_of({{96, kMeteredMedian / 2}, {4, 0.0f}});
    for (int x = 1; x <= 28; x += 9) image.planes[c].at(x, 28) = 4.0f;
    EXPECT_NEAR(stops_of(image), applied(half_way(4.0, 1.0)), 1e-4) << c;
  }
}

float stops_of(float brightness, float surface_fraction) {
  GBuffer g = test::empty_gbuffer(60, 60);
  for (const char* name : {"lit.r", "lit.g", "lit.b"}) g.layers[0].add(name) = Plane(60, 60, brightness);
  Plane& depth = g.layers[0].add("depth") = Plane(60, 60, 1.0f);
  for (int y = int(60 * surface_fraction); y < 60; ++y)
    for (int x = 0; x < 60; ++x) depth.at(x, y) = std::numeric_limits<float>::infinity();
  const auto device = make_cpu_device();
  auto frame = device->upload(g);
  return **metered_stops(*device, *frame);
}

TEST(Metering, ADarkHallWithASunlitFloorIsBrightened) {
  // A tenth of the picture is white, the rest a hundredth of that.
  GBuffer g = test::empty_gbuffer(60, 60);
  for (const char* name : {"lit.r", "lit.g", "lit.b"}) {
    Plane& plane = g.layers[0].add(name) = Plane(60, 60, 0.01f);
    for (int y = 0; y < 6; ++y)
      for (int x = 0; x < 60; ++x) plane.at(x, y) = kMeteredWhite;
  }
  g.layers[0].add("depth") = Plane(60, 60, 1.0f);
  const auto device = make_cpu_device();
  auto frame = device->upload(g);
  const float stops = **metered_stops(*device, *frame);
  EXPECT_GT(stops, 1.5f);
  EXPECT_LE(stops, 2.3f);
}

TEST(Metering, BringsSurfacesTowardsMiddleGrey) {
  EXPECT_NEAR(stops_of(kMeteredMedian, 1.0f), 0.0, 1e-5);
  EXPECT_GT(stops_of(kMeteredMedian / 4.0f, 1.0f), 1.0f);
  EXPECT_LT(stops_of(kMeteredMedian / 4.0f, 1.0f), 2.0f) << "what is dark stays darker";
  EXPECT_LT(stops_of(kMeteredMedian * 4.0f, 1.0f), -1.0f);
  EXPECT_EQ(stops_of(kMeteredMedian / 4.0f, 0.3f), stops_of(kMeteredMedian / 4.0f, 1.0f))
      << "the background is left out";
  EXPECT_EQ(stops_of(0.5f, 0.0f), 0.0f) << "nothing is in view";
  EXPECT_EQ(stops_of(0.0f, 1.0f), 0.0f) << "no light at all";
  EXPECT_LT(1e-6f * std::exp2(stops_of(1e-6f, 1.0f)), 1e-3f) << "what is black stays black";
}

/// Returns a cube of side 2 around the origin with one white wall and grey ones.
Scene cube_with_a_white_wall() {
  Scene scene;
  scene.name = "cube";
  scene.materials.resize(2);
  scene.materials[0].albedo = glm::vec3(0.02f);
  scene.materials[1].albedo = glm::vec3(0.9f);
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f}) {
      glm::vec3 normal(0.0f), right(0.0f);
      normal[axis] = side;
      right[(axis + 1) % 3] = 1.0f;
      const glm::vec3 up = glm::cross(normal, right);
      Mesh mesh;
      mesh.object = int(scene.meshes.size());
      mesh.material = axis == 2 && side > 0.0f;  // to the front
      mesh.positions = {normal - right - up, normal + right - up, normal + right + up, normal - right + up};
      mesh.normals.assign(4, normal);
      mesh.indices = {0, 1, 2, 0, 2, 3};
      scene.meshes.push_back(mesh);
    }
  finish_scene(scene);
  return scene;
}

/// Returns the exposure that metering adds to the cube in look studio.
float stops_of_cube(const CameraSettings& camera, int width, int height) {
  Request request;
  request.look = "studio";
  request.width = width;
  request.height = height;
  request.camera = camera;
  const auto recipe = make_recipe(request);
  Scene scene = cube_with_a_white_wall();
  EXPECT_TRUE(complete_scene(scene, *recipe));
  const auto device = make_cpu_device();
  EXPECT_TRUE(device->prepare(scene));
  const auto plan = make_plan(*recipe, scene, 0);
  StageTimes times;
  return *draw(*device, scene, *plan, times)->stops;
}

TEST(Metering, AModelHasOneExposureFromAllSides) {
  const float usual = stops_of_cube({}, 64, 64);
  EXPECT_GT(std::fabs(usual), 0.1f);
  for (const float azimuth : {60.0f, 180.0f, 270.0f}) {
    CameraSettings camera;
    camera.azimuth_deg = azimuth;
    EXPECT_EQ(stops_of_cube(camera, 64, 64), usual) << azimuth;
  }
  CameraSettings close;
  close.zoom = 4.0f;
  EXPECT_EQ(stops_of_cube(close, 64, 64), usual);
  EXPECT_EQ(stops_of_cube({}, 96, 32), usual);
}

TEST(Metering, InsideASceneTheViewIsMetered) {
  CameraSettings to_white, to_grey;
  to_white.position = to_grey.position = {0.0, 0.0, 0.0};
  to_white.direction = {0.0f, 0.0f, 1.0f};
  to_grey.direction = {0.0f, 0.0f, -1.0f};
  EXPECT_LT(stops_of_cube(to_white, 64, 64) + 0.5f, stops_of_cube(to_grey, 64, 64));
}

}  // namespace
}  // namespace umbrage
