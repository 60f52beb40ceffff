// The reference with the occluders that a picture holds, on scenes whose occlusion is known in closed form: a rectangle
// occludes a fraction of the hemisphere that is its form factor, here to a point of the floor z = 0.
#include "reference/held_occluders.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <memory>

#include "devices/shared/capture_info.h"
#include "reference/trace.h"
#include "scene/finish.h"
#include "support.h"

namespace umbrage {
namespace {

using test::PixelRay;
using test::ray_of;

Mesh rectangle(glm::vec3 origin, glm::vec3 u, glm::vec3 v) {
  Mesh mesh;
  mesh.positions = {origin, origin + u, origin + u + v, origin + v};
  mesh.normals.assign(4, glm::normalize(glm::cross(u, v)));
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

Mesh level_square(float half, float height) {
  return rectangle({-half, -half, height}, {2 * half, 0, 0}, {0, 2 * half, 0});
}

/// A scene and its traced scene, which points to it; therefore the scene is on the heap.
struct PreparedScene {
  std::unique_ptr<Scene> scene = std::make_unique<Scene>();
  TracedScenePtr traced;

  explicit PreparedScene(std::vector<Mesh> meshes) {
    scene->name = "test";
    scene->meshes = std::move(meshes);
    scene->materials = {Material{}};
    EXPECT_EQ(finish_scene(*scene), 0u);
    traced = std::move(*build_traced_scene(*scene));
  }
  PictureInfo info(const Camera& camera, int width, int height, int layers = 1) const {
    const CaptureSettings settings{.width = width, .height = height, .layers = layers};
    PictureInfo info = picture_info(*scene, camera, settings);
    add_layers(*traced, settings, info);
    return info;
  }
  Plane visibility(const PictureInfo& info, const OcclusionSettings& settings, int threads = 0) const {
    auto image = trace_occlusion(*traced, info, settings, {.threads = threads});
    EXPECT_TRUE(image);
    return std::move(image->plane("ao"));
  }
};

Camera from_above(float side, float from) {
  return orthographic_camera({0, 0, from}, {0, 0, 0}, {0, 1, 0}, side, 1.0f);
}

glm::dvec3 on_floor(const PixelRay& ray) { return ray.origin - ray.direction * (ray.origin.z / ray.direction.z); }

/// Returns the form factor of a wall from the floor to height c, at distance a, from y0 to y1 along it.
double wall_factor(double a, double y0, double y1, double c) {
  const double slant = std::hypot(a, c);
  const auto to = [&](double b) { return (std::atan(b / a) - a / slant * std::atan(b / slant)) / (2.0 * M_PI); };
  return to(y1) - to(y0);
}

/// Returns the form factor of a level square with side 2 half at height h above the origin, to the floor point p.
double square_factor(glm::dvec3 p, double half, double h) {
  const auto corner = [&](double x, double y) {
    const double a = (x - p.x) / h, b = (y - p.y) / h, ra = std::hypot(1.0, a), rb = std::hypot(1.0, b);
    return (a / ra * std::atan(b / ra) + b / rb * std::atan(a / rb)) / (2.0 * M_PI);
  };
  return corner(half, half) - corner(-half, half) - corner(half, -half) + corner(-half, -half);
}

/// Expects that the mean error over the pixels for which `counts` is within three standard errors of 0. The standard
/// error must be below 1e-3; otherwise the test would prove nothing.
void expect_occlusion(
    const PreparedScene& prepared, const PictureInfo& info, const OcclusionSettings& settings,
    const std::function<double(glm::dvec3)>& occlusion, std::string_view what,
    const std::function<bool(glm::dvec3)>& counts = [](glm::dvec3) { return true; }) {
  const Plane ao = prepared.visibility(info, settings);
  double sum = 0.0, squares = 0.0;
  long count = 0;
  for (int y = 0; y < info.height; ++y)
    for (int x = 0; x < info.width; ++x) {
      const glm::dvec3 point = on_floor(ray_of(info, x, y));
      if (!counts(point)) continue;
      const double error = ao.at(x, y) - (1.0 - occlusion(point));
      sum += error;
      squares += error * error;
      ++count;
    }
  ASSERT_GE(count, 100) << what;
  const double mean = sum / double(count);
  const double standard_error = std::sqrt((squares / double(count) - mean * mean) / double(count - 1));
  EXPECT_LT(standard_error, 1e-3) << what;
  EXPECT_NEAR(mean, 0.0, 3.0 * standard_error + 1e-6) << what;
}

TEST(HeldOccluders, AWallCountsAsFarAsThePictureShowsIt) {
  // The camera looks down at 45 degrees. Its window ends where the wall at x = 2 has the height 1.2.
  constexpr float kWall = 2.0f, kHeight = 1.2f, kWallHeight = 9.0f, kWallHalf = 8.0f;
  const PreparedScene prepared({level_square(12.0f, 0.0f), rectangle({kWall, -kWallHalf, -kWallHeight},
                                                                     {0, 2 * kWallHalf, 0}, {0, 0, 2 * kWallHeight})});
  const auto info_of = [&](glm::vec3 target, float height) {
    return prepared.info(orthographic_camera(target + glm::vec3(-5, 0, 5), target, {0, 0, 1}, height, 2.0f), 64, 32);
  };
  const float height = kHeight * std::sqrt(2.0f);
  const PictureInfo info = info_of({kWall - 0.5f, 0, 0.5f}, height);
  const auto on_the_floor = [](glm::dvec3 p) { return p.x < kWall; };
  const auto whole = [](glm::dvec3 p) {
    return wall_factor(kWall - p.x, -kWallHalf - p.y, kWallHalf - p.y, kWallHeight);
  };
  const auto shown = [&](glm::dvec3 p) { return wall_factor(kWall - p.x, -height - p.y, height - p.y, kHeight); };
  expect_occlusion(prepared, info, {.samples = 256}, whole, "all", on_the_floor);
  for (const Occluders occluders : {Occluders::kWindow, Occluders::kLayers})
    expect_occlusion(prepared, info, {.samples = 256, .occluders = occluders}, shown, "window", on_the_floor);
  // A picture of the floor alone holds no occluder.
  expect_occlusion(
      prepared, info_of({kWall - 1.0f, 0, 0}, 1.0f), {.samples = 16, .occluders = Occluders::kWindow},
      [](glm::dvec3) { return 0.0; }, "floor");
}

TEST(HeldOccluders, SlabsBehindAnotherAreHeldByLaterLayers) {
  // From above, the upper slab hides the lower one. Rays pass the lower one and meet the upper one.
  constexpr float kHalf = 1.0f, kLower = 0.6f, kUpper = 1.1f;
  const PreparedScene prepared({level_square(6.0f, 0.0f), level_square(kHalf, kLower), level_square(kHalf, kUpper)});
  const PictureInfo one = prepared.info(from_above(5.0f, 4.0f), 40, 40);
  const PictureInfo two = prepared.info(from_above(5.0f, 4.0f), 40, 40, 2);
  const auto beside = [](glm::dvec3 p) { return std::max(std::abs(p.x), std::abs(p.y)) > kHalf; };
  const auto upper = [](glm::dvec3 p) { return square_factor(p, kHalf, kUpper); };
  const auto lower = [](glm::dvec3 p) { return square_factor(p, kHalf, kLower); };
  const auto with = [](Occluders occluders, Falloff falloff = Falloff::kNone) {
    return OcclusionSettings{.samples = 256, .falloff = falloff, .occluders = occluders};
  };
  expect_occlusion(prepared, one, with(Occluders::kWindow), upper, "window", beside);
  expect_occlusion(prepared, two, with(Occluders::kWindow), upper, "window of two layers", beside);
  expect_occlusion(prepared, one, with(Occluders::kLayers), upper, "one layer", beside);
  const PreparedScene only_lower({level_square(6.0f, 0.0f), level_square(kHalf, kLower)});
  expect_occlusion(only_lower, one, with(Occluders::kWindow), lower, "the lower one alone", beside);
  for (const Falloff falloff : {Falloff::kNone, Falloff::kSmooth}) {
    OcclusionSettings all = with(Occluders::kAll, falloff), layers = with(Occluders::kLayers, falloff);
    all.radius = layers.radius = 3.0f;
    const Plane a = prepared.visibility(two, all), b = prepared.visibility(two, layers);
    EXPECT_EQ(test::difference(a, b, 0.0).max, 0.0) << "two layers hold all, falloff " << int(falloff);
  }
}

TEST(HeldOccluders, ExtraViewsHoldWhatTheySee) {
  constexpr float kHalf = 1.0f, kLower = 0.6f, kUpper = 1.1f;
  const PreparedScene prepared({level_square(6.0f, 0.0f), level_square(kHalf, kLower), level_square(kHalf, kUpper)});
  PictureInfo info = prepared.info(from_above(5.0f, 4.0f), 32, 32);
  const OcclusionSettings all{.samples = 64}, layers{.samples = 64, .occluders = Occluders::kLayers};
  const Plane truth = prepared.visibility(info, all);
  EXPECT_GT(test::difference(truth, prepared.visibility(info, layers), 0.05).fraction_over, 0.1);
  // The lower slab from below, as large as the window of the camera.
  const Camera below = orthographic_camera({0, 0, 0.3f}, {0, 0, 1}, {0, 1, 0}, 5.0f, 1.0f);
  info.more_layers.push_back({LayerKind::kOther, 0, below});
  EXPECT_EQ(test::difference(truth, prepared.visibility(info, layers), 0.0).max, 0.0);
  const OcclusionSettings window{.samples = 64, .occluders = Occluders::kWindow};
  EXPECT_GT(test::difference(truth, prepared.visibility(info, window), 0.05).fraction_over, 0.1);
}

TEST(HeldOccluders, NothingBehindTheCameraOrEdgeOnIsHeld) {
  const OcclusionSettings all{.samples = 64, .radius = 2.0f};
  const OcclusionSettings window{.samples = 64, .radius = 2.0f, .occluders = Occluders::kWindow};
  // The camera is below the slab, or looks along the wall.
  for (const Mesh& occluder : {level_square(2.0f, 0.7f), rectangle({0.3f, -3, -1}, {0, 6, 0}, {0, 0, 2})}) {
    const PreparedScene prepared({level_square(4.0f, 0.0f), occluder});
    for (const bool perspective : {false, true}) {
      const glm::vec3 eye(0.3f, 0, 0.5f);
      const Camera camera = perspective ? perspective_camera(eye, {0.3f, 0, 0}, {0, 1, 0}, 60.0f, 1.0f)
                                        : orthographic_camera(eye, {0.3f, 0, 0}, {0, 1, 0}, 0.8f, 1.0f);
      const PictureInfo info = prepared.info(camera, 16, 16);
      EXPECT_GT(test::difference(prepared.visibility(info, all), Plane(16, 16, 1.0f), 0.2).fraction_over, 0.9);
      EXPECT_EQ(test::difference(prepared.visibility(info, window), Plane(16, 16, 1.0f), 0.0).max, 0.0) << perspective;
    }
  }
}

/// Makes waves of the floor, which a camera from above sees whole, as a fine grid from -3 to 3.
Mesh waves() {
  constexpr int kCells = 96;
  constexpr float kHalf = 3.0f;
  Mesh mesh;
  for (int j = 0; j <= kCells; ++j)
    for (int i = 0; i <= kCells; ++i) {
      const float x = kHalf * (2.0f * float(i) / kCells - 1.0f), y = kHalf * (2.0f * float(j) / kCells - 1.0f);
      mesh.positions.push_back({x, y, 0.25f * std::sin(5.0f * x) * std::cos(4.0f * y)});
    }
  for (int j = 0; j < kCells; ++j)
    for (int i = 0; i < kCells; ++i) {
      const auto a = std::uint32_t(j * (kCells + 1) + i), b = a + kCells + 1;
      for (const std::uint32_t index : {a, a + 1, b, a + 1, b + 1, b}) mesh.indices.push_back(index);
    }
  return mesh;
}

TEST(HeldOccluders, WhereNothingIsHiddenAllCount) {
  const PreparedScene prepared({waves()});
  for (const Camera& camera : {from_above(4.0f, 3.0f), perspective_camera({0, 0, 8}, {0, 0, 0}, {0, 1, 0}, 28.0f, 1)}) {
    const PictureInfo info = prepared.info(camera, 64, 64);
    const OcclusionSettings all{.samples = 64, .radius = 0.5f};
    const OcclusionSettings window{.samples = 64, .radius = 0.5f, .occluders = Occluders::kWindow};
    const Plane a = prepared.visibility(info, all), b = prepared.visibility(info, window);
    EXPECT_GT(test::difference(a, Plane(64, 64, 1.0f), 0.1).fraction_over, 0.4) << "the waves must occlude";
    // A pixel is 1/16 wide: within 10 pixels, rays leave the picture.
    constexpr int kMargin = 10;
    const Plane inside_a = cropped(a, kMargin), inside_b = cropped(b, kMargin);
    // Rays that graze an edge of the grid may differ by one hit.
    const auto difference = test::difference(inside_a, inside_b, 0.0);
    EXPECT_LT(difference.fraction_over, 0.01);
    EXPECT_LE(difference.max, 2.0 / 64.0);
    EXPECT_GT(test::difference(a, b, 0.05).fraction_over, 0.005) << "at the border, occluders are outside";
  }
}

TEST(HeldOccluders, ThreadsAndScaleDoNotMatter) {
  std::vector<Plane> pictures;
  for (const float scale : {1.0f, 1024.0f}) {
    std::vector<Mesh> meshes = {waves(), level_square(1.0f, 0.6f), level_square(1.3f, 0.9f)};
    for (Mesh& mesh : meshes)
      for (glm::vec3& p : mesh.positions) p *= scale;
    const PreparedScene prepared(std::move(meshes));
    const Camera camera = perspective_camera(scale * glm::vec3(3, 2, 5), {0, 0, 0}, {0, 0, 1}, 40.0f, 1.0f);
    const PictureInfo info = prepared.info(camera, 48, 48, 2);
    const OcclusionSettings settings{.samples = 16, .radius = 0.8f * scale, .occluders = Occluders::kLayers};
    for (const int threads : {1, 2, 0}) pictures.push_back(prepared.visibility(info, settings, threads));
  }
  for (const Plane& picture : pictures) EXPECT_EQ(test::difference(pictures[0], picture, 0.0).max, 0.0);
}

}  // namespace
}  // namespace umbrage
