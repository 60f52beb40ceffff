// Tests of the look `studio` and its parts: averaged pictures, automatic exposure, soft shadows, the ground under a
// model.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <set>
#include <utility>

#include "devices/cpu/cpu_device.h"
#include "draw_picture.h"
#include "generators/builtin.h"
#include "renderer/accumulation.h"
#include "renderer/completed_scene.h"
#include "renderer/draw.h"
#include "renderer/models.h"
#include "scene/finish.h"
#include "scene/ground.h"
#include "scene/scene.h"
#include "support.h"

namespace umbrage {
namespace {

// --- frames --------------------------------------------------------------------------------------------------------

TEST(Frames, OffsetsAreSpreadOverThePixel) {
  for (const int count : {1, 2, 3, 4, 5, 8, 16, 64}) {
    glm::dvec2 mean(0.0);
    int quarters[2][2] = {};
    for (int k = 0; k < count; ++k) {
      const glm::vec2 offset = sample_offset(k, count);
      EXPECT_LE(std::max(std::fabs(offset.x), std::fabs(offset.y)), 0.5f);
      mean += glm::dvec2(offset) / double(count);
      ++quarters[offset.x < 0.0f][offset.y < 0.0f];
    }
    EXPECT_EQ(sample_offset(0, count), glm::vec2(0.0f));
    if (count < 3) continue;
    // The mean is subtracted. Only of many samples are some so far out that they are clamped to the pixel.
    EXPECT_NEAR(mean.x, 0.0, count < 64 ? 1e-6 : 5e-4) << count;
    EXPECT_NEAR(mean.y, 0.0, count < 64 ? 1e-6 : 5e-4) << count;
    if (count < 4) continue;
    for (const auto& row : quarters)
      for (const int n : row) EXPECT_NEAR(n, count / 4, 1) << count;
  }
}

TEST(Frames, AnOddNumberOfOffsetsHasOneInEachRowAndColumn) {
  for (const int count : {3, 5, 7, 9, 15}) {
    std::set<long> rows, columns;
    for (int k = 0; k < count; ++k) {
      columns.insert(std::lround(sample_offset(k, count).x * float(count)));
      rows.insert(std::lround(sample_offset(k, count).y * float(count)));
    }
    EXPECT_EQ(columns.size(), std::size_t(count));
    EXPECT_EQ(rows.size(), std::size_t(count));
  }
}

TEST(Frames, ShiftedCameraIsOffsetByPixels) {
  const Camera camera = perspective_camera({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 40.0f, 2.0f);
  const Camera shifted = shifted_camera(camera, {1.0f, 1.0f}, 200, 100);
  // The centre of pixel (x, y) of `shifted` is that of pixel (x + 1, y + 1) of `camera`.
  const auto at = [](const Camera& c, double x, double y) {
    return glm::dvec2(c.left + (x + 0.5) / 200.0 * (c.right - c.left), c.top - (y + 0.5) / 100.0 * (c.top - c.bottom));
  };
  EXPECT_LT(glm::distance(at(shifted, 10, 20), at(camera, 11, 21)), 1e-6);
}

const std::vector<std::string> kAo = {"ao"};

Image one_pixel(float r, float alpha, float ao) {
  Image image(1, 1);
  for (const auto& [name, v] :
       {std::pair{"color.r", r}, {"color.g", 0.5f}, {"color.b", 0.0f}, {"color.a", alpha}, {"ao", ao}})
    image.add(name) = Plane(1, 1, v);
  return image;
}

PictureSum one_pixel_sum() { return empty_sum(one_pixel(0.0f, 0.0f, 0.0f).names, 1, {0, 1}); }

void add_picture(PictureSum& total, const Image& picture) {
  count_sample(total, true);
  add_rows(total, picture, 0, true);
}

TEST(Frames, ColourIsAveragedByItsAlpha) {
  PictureSum total = one_pixel_sum();
  add_picture(total, one_pixel(0.8f, 1.0f, 0.25f));
  add_picture(total, one_pixel(0.3f, 0.0f, 0.75f));
  add_picture(total, one_pixel(0.2f, 1.0f, 0.5f));
  add_picture(total, one_pixel(0.3f, 0.0f, 0.5f));
  const GBuffer mean = mean_picture(total, PictureInfo{.width = 1, .height = 1});
  EXPECT_FLOAT_EQ(mean.layers[0].plane("cover").at(0, 0), 0.5f);
  EXPECT_FLOAT_EQ(mean.layers[0].plane("lit.r").at(0, 0), 0.25f);  // 0.5 over half of the pixel
  EXPECT_FLOAT_EQ(mean_planes(total, kAo).plane("ao").at(0, 0), 0.5f);
  EXPECT_EQ(mean_planes(total, kAo).find("color.r"), nullptr);
}

TEST(Frames, ColourIsAveragedAsSquareRootsForSomeLooks) {
  PictureSum total = one_pixel_sum();
  total.as_square_roots = true;
  add_picture(total, one_pixel(0.64f, 1.0f, 0.25f));
  add_picture(total, one_pixel(0.3f, 0.0f, 0.75f));
  add_picture(total, one_pixel(0.04f, 1.0f, 0.5f));
  add_picture(total, one_pixel(-1.0f, 0.0f, 0.5f));
  for (PictureSum sum : {rows_of(total, 0, 1), rows_of(rows_of(total, 0, 1), 0, 1)}) {
    const GBuffer mean = mean_picture(sum, PictureInfo{.width = 1, .height = 1});
    EXPECT_EQ(mean.layers[0].find("cover"), nullptr);
    EXPECT_FLOAT_EQ(mean.layers[0].plane("cover_for_eye").at(0, 0), 0.5f);
    EXPECT_FLOAT_EQ(mean.layers[0].plane("lit.r").at(0, 0), 0.125f);  // (0.8 + 0.2)^2 / 4 over half of the pixel
    EXPECT_FLOAT_EQ(mean.layers[0].plane("lit.b").at(0, 0), 0.0f);
    EXPECT_FLOAT_EQ(mean_planes(sum, kAo).plane("ao").at(0, 0), 0.5f)
        << "values other than colours are averaged unchanged";
  }
}

/// Draws a scene with the look `ao` and no technique: white where there is a surface.
Image silhouette(Scene scene, int frames, const std::vector<std::string>& settings = {}, const char* look = "ao") {
  auto device = make_cpu_device();
  EXPECT_TRUE(device->prepare(scene));
  StageTimes times;
  Request request;
  request.width = 96;
  request.height = 64;
  request.look = look;
  request.occlusion = "none";
  request.settings = {"output.background_r=0", "output.background_g=0", "output.background_b=0",
                      "output.transfer=none"};
  request.settings.insert(request.settings.end(), settings.begin(), settings.end());
  request.anti_aliasing = frames;
  const auto frame = draw(*device, scene, request, times);
  EXPECT_TRUE(frame) << (frame ? "" : frame.error().message);
  return *device->download(*frame, {"color.r", "color.a", "depth"});
}

// Draws white surfaces in front of black. Coverage mixes the two as square roots of light.
TEST(Frames, CartoonMixesAsSquareRoots) {
  const Scene scene = *make_builtin_scene("scene:solids?detail=2000");
  const std::vector<std::string> settings = {"outline.opacity=0", "toon.steps=1", "toon.albedo=clay"};
  const Image fractions = silhouette(scene, 16), mixed = silhouette(scene, 16, settings, "cartoon");
  std::vector<std::string> transparent = settings;
  transparent.push_back("output.transparent=on");
  const Image cutout = silhouette(scene, 16, transparent, "cartoon");
  int partial = 0;
  float white = 0.0f;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 96; ++x) white = std::max(white, mixed.planes[0].at(x, y));
  EXPECT_GT(white, 0.1f);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 96; ++x) {
      const float fraction = fractions.planes[0].at(x, y);
      if (fraction < 0.1f || fraction > 0.9f || fractions.planes[1].at(x, y) < 1.0f) continue;
      ++partial;
      EXPECT_NEAR(mixed.planes[0].at(x, y) / white, fraction * fraction, 0.02f) << x << ", " << y;
      EXPECT_NEAR(cutout.planes[1].at(x, y), fraction, 1e-5) << "alpha is the covered fraction";
      EXPECT_NEAR(cutout.planes[0].at(x, y), white, 0.02f) << "colour is straight";
    }
  EXPECT_GT(partial, 20);
}

TEST(Frames, EdgePixelsHaveTheCoveredFraction) {
  const Scene scene = *make_builtin_scene("scene:solids?detail=2000");
  const Image coarse = silhouette(scene, 1), fine = silhouette(scene, 16), finest = silhouette(scene, 128);
  const Image cutout = silhouette(scene, 16, {"output.transparent=on"});
  int partial = 0;
  double error_coarse = 0.0, error_fine = 0.0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 96; ++x) {
      const double truth = finest.planes[0].at(x, y);
      EXPECT_TRUE(coarse.planes[0].at(x, y) == 0.0f || coarse.planes[0].at(x, y) == 1.0f);
      partial += fine.planes[0].at(x, y) > 0.1f && fine.planes[0].at(x, y) < 0.9f;
      error_coarse += std::pow(coarse.planes[0].at(x, y) - truth, 2.0);
      error_fine += std::pow(fine.planes[0].at(x, y) - truth, 2.0);
      EXPECT_NEAR(cutout.planes[1].at(x, y), fine.planes[0].at(x, y), 1e-5) << "alpha is the same fraction";
      if (cutout.planes[1].at(x, y) > 0.0f) {
        EXPECT_NEAR(cutout.planes[0].at(x, y), 1.0, 1e-4) << "colour is straight";
      }
    }
  EXPECT_GT(partial, 60);
  EXPECT_LT(error_fine, 0.05 * error_coarse);
}

// --- soft shadows --------------------------------------------------------------------------------------------------

constexpr float kDiscDeg = 30.0f;  // angular diameter of the sun over the sheet
constexpr int kSide = 128;         // width and height of its pictures, pixels

/// Returns a floor at height 0, and a sheet at height 1 that covers x below 0.
Scene sheet_over_floor(float disc_deg) {
  Scene scene;
  scene.name = "sheet";
  scene.materials.resize(1);
  const auto add = [&](float x0, float x1, float height) {
    Mesh mesh;
    mesh.object = int(scene.meshes.size());
    mesh.positions = {{x0, height, -9}, {x1, height, -9}, {x1, height, 9}, {x0, height, 9}};
    mesh.normals.assign(4, glm::vec3(0, 1, 0));
    mesh.indices = {0, 2, 1, 0, 3, 2};
    scene.meshes.push_back(mesh);
  };
  add(-9.0f, 9.0f, 0.0f);
  add(-9.0f, 0.0f, 1.0f);
  finish_scene(scene);
  Light sun;
  sun.direction = {0, 1, 0};
  sun.angle_deg = disc_deg;
  sun.casts_shadow = true;
  scene.lights = {sun};
  return scene;
}

/// Returns the fraction of the sun's disc that the sheet does not occlude: a segment of a circle. `at`: distance from
/// the point below the sheet's edge, scene units.
double unoccluded_fraction(double at, double disc_deg) {
  const double cut = std::clamp(at / std::tan(glm::radians(0.5 * disc_deg)), -1.0, 1.0);
  return 1.0 - (std::acos(cut) - cut * std::sqrt(1.0 - cut * cut)) / std::acos(-1.0);
}

/// Returns the mean shadow of `frames` pictures with `rays` rays per pixel each.
Plane mean_shadow(Device& device, const Camera& camera, int rays, int frames) {
  Plane mean(kSide, kSide, 0.0f);
  for (int sample = 0; sample < frames; ++sample) {
    const auto frame =
        device.capture(camera, {.width = kSide, .height = kSide, .shadows = 1, .shadow_rays = rays, .sample = sample});
    const auto image = device.download(*frame, {"shadow"});
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) mean.at(x, y) += image->planes[0].at(x, y) / float(frames);
  }
  return mean;
}

TEST(SoftShadows, APenumbraIsAsWideAsTheLightIsLarge) {
  const auto device = make_cpu_device();
  const Scene scene = sheet_over_floor(kDiscDeg);
  ASSERT_TRUE(device->prepare(scene));
  // The camera looks down at the sheet, so the floor to the right of its edge is fully visible.
  const Camera camera = orthographic_camera({0, 5, 0}, {0, 0, 0}, {0, 0, -1}, 2.0f, 1.0f);
  const auto seen = device->capture(camera, {.width = kSide, .height = kSide});
  ASSERT_TRUE(seen);
  const Image depth = *device->download(*seen, {"depth"});
  for (int y = 0; y < kSide; ++y)
    for (int x = kSide / 2 + 1; x < kSide; ++x) ASSERT_NEAR(depth.planes[0].at(x, y), 5.0, 1e-3);
  struct Case {
    int rays, frames;
    double error;
  };
  for (const auto& [rays, frames, error] : {Case{0, 1, 0.0}, Case{1, 1, 0.1}, Case{1, 4, 0.03}, Case{64, 1, 0.015}}) {
    const Plane shadow = mean_shadow(*device, camera, rays, frames);
    for (int x = kSide / 2 + 1; x < kSide; ++x) {
      double mean = 0.0;
      for (int y = 0; y < kSide; ++y) mean += shadow.at(x, y) / kSide;
      const double at = (x + 0.5) / (0.5 * kSide) - 1.0;  // distance from the sheet's edge, scene units
      const double open = unoccluded_fraction(at, kDiscDeg);
      EXPECT_NEAR(mean, rays == 0 ? 1.0 : open, error) << rays << ' ' << frames << ' ' << at;
    }
  }
}

TEST(SoftShadows, ALongPenumbraHasNoStreaks) {
  const auto device = make_cpu_device();
  const Scene scene = sheet_over_floor(kDiscDeg);
  ASSERT_TRUE(device->prepare(scene));
  // Four times the magnification of the test above: the radius of the penumbra is 69 pixels.
  const Camera camera = orthographic_camera({0, 5, 0}, {0, 0, 0}, {0, 0, -1}, 0.5f, 1.0f);
  struct Case {
    int frames;
    double rms, max;
  };
  // Without the second filter the RMS and max errors are 0.028 and 0.064 in one picture, 0.016 and 0.043 in four.
  for (const auto& [frames, rms, max] : {Case{1, 0.025, 0.04}, Case{4, 0.0105, 0.02}}) {
    const Plane mean = mean_shadow(*device, camera, 1, frames);
    double squares = 0.0, worst = 0.0;
    int count = 0;
    // Exclude the sheet's edge, where the filter ends, and the picture's borders.
    for (int y = 16; y < kSide - 16; ++y)
      for (int x = kSide / 2 + 16; x < kSide - 16; ++x, ++count) {
        const double off = mean.at(x, y) - unoccluded_fraction(0.25 * ((x + 0.5) / (0.5 * kSide) - 1.0), kDiscDeg);
        squares += off * off;
        worst = std::max(worst, std::fabs(off));
      }
    EXPECT_LT(std::sqrt(squares / count), rms) << frames;
    EXPECT_LT(worst, max) << frames;
  }
}

TEST(SoftShadows, PlainAndVectorFiltersAgree) {
  const Scene scene = sheet_over_floor(30.0f);
  const Camera camera = orthographic_camera({0, 5, 0.3f}, {0, 0, 0}, {0, 0, -1}, 0.9f, 1.0f);
  std::vector<Plane> shadows;
  for (const bool scalar : {false, true}) {
    auto device = make_cpu_device({.scalar = scalar});
    ASSERT_TRUE(device->prepare(scene));
    const auto frame = device->capture(camera, {.width = 131, .height = 97, .shadows = 1, .shadow_rays = 1});
    ASSERT_TRUE(frame);
    shadows.push_back(device->download(*frame, {"shadow"})->planes[0]);
  }
  EXPECT_LT(test::difference(shadows[0], shadows[1], 0.0).max, 1e-5);
}

TEST(SoftShadows, AveragedFramesHaveOtherRays) {
  const Scene scene = sheet_over_floor(30.0f);
  auto device = make_cpu_device();
  ASSERT_TRUE(device->prepare(scene));
  const Camera camera = orthographic_camera({0, 5, 0}, {0, 0, 0}, {0, 0, -1}, 2.0f, 1.0f);
  const auto shadow = [&](int sample) {
    const auto frame =
        device->capture(camera, {.width = 32, .height = 32, .shadows = 1, .shadow_rays = 1, .sample = sample});
    return device->download(*frame, {"shadow"})->planes[0];
  };
  EXPECT_EQ(test::difference(shadow(1), shadow(1), 0.0).max, 0.0);
  EXPECT_GT(test::difference(shadow(0), shadow(1), 0.0).fraction_over, 0.02);
}

// --- ground --------------------------------------------------------------------------------------------------------

/// Returns an axis-aligned box that stands on height 0.
Scene box_scene(glm::vec3 size) {
  Scene scene;
  scene.name = "box";
  scene.materials.resize(1);
  Mesh mesh;
  for (int k = 0; k < 8; ++k)
    mesh.positions.push_back(size * glm::vec3(k & 1 ? 0.5f : -0.5f, k & 2 ? 1.0f : 0.0f, k & 4 ? 0.5f : -0.5f));
  mesh.indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                  2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  scene.meshes = {mesh};
  finish_scene(scene);
  return scene;
}

bool gets_ground(Scene scene, Request request = {}) {
  request.look = "studio";
  EXPECT_TRUE(complete_scene(scene, *make_recipe(request)));
  return scene.ground_object >= 0;
}

TEST(GroundUnderModels, IsAddedUnlessTheModelsOwnFillsTheFootOfThePicture) {
  Request near;
  near.camera.zoom = 4.0f;
  for (const glm::vec3& size : {glm::vec3(1, 1, 1), {1, 3, 1}, {1, 0.4f, 1}}) EXPECT_TRUE(gets_ground(box_scene(size)));
  EXPECT_TRUE(gets_ground(box_scene({1, 3, 1}), near)) << "only its walls are at the foot";
  // A house on its slab stands on the ground, as long as the slab ends in the picture.
  Scene house = box_scene({10, 0.5f, 10});
  house.meshes.push_back(box_scene({4, 3, 4}).meshes[0]);
  finish_scene(house);
  EXPECT_TRUE(gets_ground(house));
  EXPECT_FALSE(gets_ground(box_scene({10, 0.5f, 10}), near));
  near.camera.orthographic = true;
  EXPECT_FALSE(gets_ground(box_scene({10, 0.5f, 10}), near));
  EXPECT_FALSE(gets_ground(*make_builtin_scene("scene:terrain?detail=8000")));
  for (const char* name : {"scene:solids", "scene:tank"})
    EXPECT_TRUE(gets_ground(*make_builtin_scene(std::string(name) + "?detail=8000"))) << name;
  // The floor of a house is below its roof: seen from outside, the house stands in the open.
  Request outside;
  outside.camera.direction = {-1.0f, -0.4f, -1.0f};
  for (const char* name : {"scene:room", "scene:atrium"})
    EXPECT_TRUE(gets_ground(*make_builtin_scene(std::string(name) + "?detail=8000"), outside)) << name;
}

TEST(GroundUnderModels, IsTheSameAllAlongAnOrbit) {
  Scene house = box_scene({10, 0.5f, 6});
  house.meshes.push_back(box_scene({3, 3, 3}).meshes[0]);
  finish_scene(house);
  const Scene room = *make_builtin_scene("scene:room?detail=8000");
  std::array<int, 2> answers{};
  for (const Scene* scene : {&std::as_const(house), &room}) {
    for (const float zoom : {1.0f, 1.5f, 2.0f, 2.5f, 3.0f, 4.0f, 6.0f}) {
      Request request;
      request.look = "studio";
      request.camera.zoom = zoom;
      for (const bool fitted : {true, false}) {
        const auto answer = [&](int k) {
          const float angle = glm::radians(30.0f * float(k)), distance = 3.0f * scene->radius();
          const glm::vec3 away(std::sin(angle), 0.5f, std::cos(angle)), eye = scene->center() + distance * away;
          request.camera.azimuth_deg = fitted ? 30.0f * float(k) : 0.0f;
          request.camera.direction = {-1.0f, -0.5f, 0.0f};
          if (!fitted) {
            request.camera.direction.reset();
            request.camera.position = {eye.x, eye.y, eye.z};
          }
          return needs_ground(*scene, *make_recipe(request));
        };
        const bool first = answer(0);
        ++answers[first];
        for (int k = 1; k < 12; ++k)
          EXPECT_EQ(answer(k), first) << scene->name << ", zoom " << zoom << ", " << 30 * k << " degrees, " << fitted;
        request.camera.position.reset();
      }
    }
    EXPECT_EQ(scene->shape_facts->relief.found(), 1) << "one pass over the triangles";
  }
  EXPECT_GT(std::min(answers[0], answers[1]), 3) << "the answers depend on what is at the foot of the picture";
}

TEST(GroundUnderModels, IsDecidedWithoutAPassPerPicture) {
  const Scene house = box_scene({10, 0.5f, 6});
  Request request;
  request.look = "studio";
  auto kept = completed(house, *make_recipe(request), 0);
  ASSERT_TRUE(kept);
  for (int k = 0; k < 12; ++k) {
    request.camera.azimuth_deg = 30.0f * float(k);
    const auto recipe = make_recipe(request);
    EXPECT_TRUE(*kept->serves(*recipe, 0)) << k;
    ASSERT_TRUE(make_plan(*recipe, *kept->scene, 1));
  }
  EXPECT_EQ(kept->scene->shape_facts->relief.found(), 1);
  EXPECT_EQ(kept->scene->shape_facts->front.found(), 1);
}

TEST(GroundUnderModels, IsUnderFlatPartsInAnyUnit) {
  for (const float unit : {0.001f, 1.0f, 25.4f, 1000.0f})
    for (const glm::vec3& size : {glm::vec3(1, 0.02f, 1), {1, 0.1f, 0.6f}}) {
      Scene part = box_scene(unit * size);
      EXPECT_TRUE(gets_ground(part)) << unit;
      part.meshes.push_back(box_scene(unit * glm::vec3(0.3f, 0.4f, 0.3f)).meshes[0]);
      finish_scene(part);
      EXPECT_TRUE(gets_ground(part)) << unit << ", on a base plate";
    }
}

TEST(GroundUnderModels, LeavesTheBoundsAndTheFraming) {
  for (const float scale : {0.001f, 1.0f, 1000.0f}) {
    Scene scene = box_scene(glm::vec3(scale));
    const Camera before = frame_scene(scene, {}, 64, 64);
    const glm::vec3 low = scene.bounds_min, high = scene.bounds_max;
    add_ground(scene);
    EXPECT_EQ(scene.bounds_min, low);
    EXPECT_EQ(scene.bounds_max, high);
    EXPECT_EQ(frame_scene(scene, {}, 64, 64).view_from_world, before.view_from_world);
    EXPECT_EQ(scene.ground_object, 1);
    for (const glm::vec3& p : scene.meshes.back().positions) {
      EXPECT_LT(p.y, low.y);
      EXPECT_GT(p.y, low.y - 0.001f * scale);
    }
  }
}

TEST(GroundUnderModels, HidesNothingFromBelow) {
  for (const bool orthographic : {false, true}) {
    Scene scene = box_scene({1, 1, 1});
    Request request;
    request.look = "studio";
    request.camera.elevation_deg = -60.0f;
    request.camera.orthographic = orthographic;
    EXPECT_TRUE(complete_scene(scene, *make_recipe(request)));
    EXPECT_LT(scene.ground_object, 0) << orthographic;
    request.camera.elevation_deg = 20.0f;
    EXPECT_TRUE(complete_scene(scene, *make_recipe(request)));
    EXPECT_EQ(scene.ground_object, 1) << orthographic;
  }
}

Image studio_picture(Scene scene, const std::string& ground, const std::vector<std::string>& settings = {}) {
  Request request;
  request.width = 128;
  request.height = 128;
  request.look = "studio";
  request.ground = ground;
  request.settings = settings;
  return test::drawn_picture(std::move(scene), request, {"color.r", "color.g", "color.b", "color.a"}).image;
}

const std::vector<std::string> kPlainBackground = {"output.background_g=0.93", "output.gradient=0"};

TEST(Studio, ABoxHasAShadowAndTheRestIsBackground) {
  for (const float scale : {0.001f, 1000.0f}) {
    const Image with = studio_picture(box_scene(glm::vec3(scale)), "auto", kPlainBackground);
    const Image without = studio_picture(box_scene(glm::vec3(scale)), "off", kPlainBackground);
    long shaded = 0, background = 0, brighter = 0;
    for (int y = 0; y < 128; ++y)
      for (int x = 0; x < 128; ++x) {
        if (without.planes[1].at(x, y) != 0.93f) continue;  // not background, so the box
        const float g = with.planes[1].at(x, y);
        shaded += g < 0.88f;
        background += g == 0.93f;
        brighter += g > 0.9301f;
      }
    EXPECT_GT(shaded, 400) << scale;
    EXPECT_GT(background, 2000) << scale;
    EXPECT_EQ(brighter, 0) << scale;
  }
}

/// Draws a scene as requested and returns one plane of the picture.
Plane drawn(Scene scene, const Request& request, const std::string& plane) {
  const auto device = make_cpu_device();
  EXPECT_TRUE(device->prepare(scene));
  StageTimes times;
  const auto frame = draw(*device, scene, request, times);
  EXPECT_TRUE(frame) << (frame ? "" : frame.error().message);
  return device->download(*frame, {plane})->planes[0];
}

TEST(Frames, FramesAverageTheNoiseOfATechnique) {
  // The mean of several pictures with few samples is closer to the ground truth than one of them.
  const Scene scene = *make_builtin_scene("scene:solids?detail=7000");
  for (const std::string technique : {"bitmask", "hemisphere", "reference"}) {
    const auto occlusion = [&](int frames, const std::string& setting) {
      return drawn(scene,
                   {.look = "ao",
                    .occlusion = technique,
                    .settings = {setting},
                    .width = 64,
                    .height = 48,
                    .anti_aliasing = frames,
                    .passes = {"ao"}},
                   "ao");
    };
    const std::string few = technique == "bitmask" ? "bitmask.slices=1" : technique + ".samples=4";
    const std::string many = technique == "bitmask" ? "bitmask.slices=16" : technique + ".samples=256";
    const auto error = [](const Plane& a, const Plane& b) {
      double sum = 0.0;
      for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x) sum += std::pow(double(a.at(x, y)) - b.at(x, y), 2.0);
      return std::sqrt(sum / (double(a.width) * a.height));
    };
    // Both have the same jitter, so that edges do not contribute.
    const Plane truth = occlusion(16, many), sixteen = occlusion(16, few), one = occlusion(1, few);
    EXPECT_LT(error(sixteen, truth), 0.5 * error(one, truth)) << technique;
  }
}

TEST(Frames, AGuardBandIsCutOffAveragedPictures) {
  const auto picture = [](float guard_percent) {
    return drawn(
        *make_builtin_scene("scene:solids?detail=7000"),
        {.look = "ao", .occlusion = "none", .width = 66, .height = 50, .anti_aliasing = 4, .guard_band = guard_percent},
        "color.g");
  };
  const Plane without = picture(0.0f), with = picture(10.0f);
  ASSERT_EQ(with.width, 66);
  EXPECT_LT(test::difference(without, with, 1e-3).fraction_over, 0.01);
}

TEST(Studio, WithoutABackgroundTheShadowIsInAlpha) {
  const Image cutout = studio_picture(box_scene(glm::vec3(1.0f)), "on", {"output.transparent=on"});
  long partly = 0;
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 128; ++x) {
      const float alpha = cutout.planes[3].at(x, y);
      partly += alpha > 0.05f && alpha < 0.7f;
      EXPECT_GE(alpha, 0.0f);
      EXPECT_LE(alpha, 1.0f);
    }
  EXPECT_GT(partly, 400);
}

TEST(Studio, ExposureFollowsThePicture) {
  // The same model with its albedo reduced by two stops: the picture is darker by much less.
  const auto brightness = [](float albedo) {
    Scene scene = box_scene(glm::vec3(1.0f));
    scene.materials[0].albedo = glm::vec3(albedo);
    auto settings = kPlainBackground;
    settings.emplace_back("output.transfer=none");
    const Image image = studio_picture(scene, "off", settings);
    double sum = 0.0;
    long count = 0;
    for (int y = 0; y < 128; ++y)
      for (int x = 0; x < 128; ++x)
        if (image.planes[1].at(x, y) != 0.93f) sum += image.planes[1].at(x, y), ++count;
    return sum / double(count);
  };
  const double white = brightness(0.8f), dark = brightness(0.2f);
  EXPECT_GT(white, 0.25);
  EXPECT_LT(white, 0.5);
  EXPECT_GT(dark, white / 2.2);
  EXPECT_LT(dark, white);
}

}  // namespace
}  // namespace umbrage
