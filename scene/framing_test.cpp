// Framing: the whole scene is inside the picture and fills it, for any shape, size and position; and the options.
#include "scene/framing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <random>
#include <string>

#include "scene/finish.h"
#include "scene/ground.h"

namespace umbrage {
namespace {

/// Returns a finished scene of random vertices in an ellipsoid.
Scene lump(const glm::vec3& half, const glm::vec3& center, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> at(-1.0f, 1.0f);
  Mesh mesh;
  for (int i = 0; i < 900; ++i) {
    glm::vec3 p(at(random), at(random), at(random));
    if (glm::length(p) > 1.0f) p = glm::normalize(p);
    mesh.positions.push_back(center + half * p);
    mesh.indices.push_back(std::uint32_t(i));
  }
  Scene scene;
  scene.meshes.push_back(mesh);
  finish_scene(scene, 180.0f);
  return scene;
}

struct Extent {
  float left = 1e30f, right = -1e30f, bottom = 1e30f, top = -1e30f;  ///< -1 to 1 is the picture
  float nearest = 1e30f;                                             ///< depth of the nearest vertex
  float fill() const { return std::max(right - left, top - bottom) / 2.0f; }
};

Extent extent_of(const Scene& scene, const Camera& camera) {
  Extent extent;
  for (const Mesh& mesh : scene.meshes) {
    for (const glm::vec3& p : mesh.positions) {
      const glm::vec3 view(camera.view_from_world * glm::vec4(p, 1.0f));
      const float depth = -view.z, scale = camera.projection == Projection::kPerspective ? depth : 1.0f;
      const float x = 2.0f * (view.x / scale - camera.left) / (camera.right - camera.left) - 1.0f;
      const float y = 2.0f * (view.y / scale - camera.bottom) / (camera.top - camera.bottom) - 1.0f;
      extent.left = std::min(extent.left, x);
      extent.right = std::max(extent.right, x);
      extent.bottom = std::min(extent.bottom, y);
      extent.top = std::max(extent.top, y);
      extent.nearest = std::min(extent.nearest, depth);
    }
  }
  return extent;
}

glm::vec3 forward_of(const Camera& camera) {
  return -glm::vec3(camera.view_from_world[0][2], camera.view_from_world[1][2], camera.view_from_world[2][2]);
}

void expect_near(const glm::vec3& a, const glm::vec3& b, float tolerance) {
  EXPECT_LT(glm::distance(a, b), tolerance)
      << a.x << " " << a.y << " " << a.z << " | " << b.x << " " << b.y << " " << b.z;
}

/// Returns a lump with a ground below.
Scene lump_on_ground(const glm::vec3& half) {
  Scene scene = lump(half, {3, 1, 0});
  add_ground(scene);
  return scene;
}

Extent model_extent_of(Scene scene, const Camera& camera) {
  scene.meshes.resize(1);
  return extent_of(scene, camera);
}

TEST(Framing, AModelAndItsShadowAreCentred) {
  for (const glm::vec3& half : {glm::vec3(1, 1, 1), glm::vec3(0.5f, 2, 0.5f), glm::vec3(3, 1, 2)})
    for (const bool orthographic : {false, true})
      for (const float zoom : {1.0f, 2.0f}) {
        const Scene scene = lump_on_ground(half);
        Framing framing{.usual_view_angle_deg = 35.0f, .margin = 0.11f, .zoom = zoom, .orthographic = orthographic};
        const Camera plain = frame_scene(scene, framing, 300, 300);
        framing.centers_shadow = true;
        const Camera shifted = frame_scene(scene, framing, 300, 300);
        const Extent before = model_extent_of(scene, plain), after = model_extent_of(scene, shifted);
        EXPECT_NEAR(before.fill(), zoom * 0.78f, 0.002f);
        EXPECT_NEAR(after.fill(), before.fill(), 1e-4f);
        // The key light is at the left: the shadow falls to the right, the model moves to the left.
        EXPECT_LT(after.left, before.left - 0.02f * zoom);
        EXPECT_GE(after.left, zoom * -0.8801f);
        EXPECT_EQ(shifted.view_from_world, plain.view_from_world);
        if (!orthographic) {
          EXPECT_NEAR(zoom * (shifted.top - shifted.bottom), 2.0f * std::tan(glm::radians(17.5f)), 1e-5f);
        }
        framing.focal_point = scene.center();
        EXPECT_EQ(frame_scene(scene, framing, 300, 300).left, -frame_scene(scene, framing, 300, 300).right);
      }
}

TEST(Framing, FillsThePictureAndIsCentered) {
  struct Case {
    const char* name;
    glm::vec3 half, center;
  };
  const Case cases[] = {{"body", {0.08f, 0.1f, 0.07f}, {-0.02f, 0.1f, 0.0f}},
                        {"ground", {5, 0, 5}, {0, 0, 0}},
                        {"wall", {3, 2, 0}, {0, 0, 7}},
                        {"side wall", {0, 2, 3}, {1, 0, 0}},
                        {"tower", {1, 40, 1}, {0, 40, 0}},
                        {"rod", {50, 0.5f, 0.5f}, {0, 0, 0}},
                        {"tiny", {1e-3f, 2e-3f, 1e-3f}, {0, 0, 0}},
                        {"minute", {1e-6f, 1e-6f, 1e-6f}, {0, 0, 0}},
                        {"huge", {1e5f, 3e4f, 1e5f}, {2e5f, 0, 0}},
                        {"far away", {10, 10, 10}, {1e4f, 1e4f, 0}}};
  for (const Case& c : cases) {
    const Scene scene = lump(c.half, c.center);
    ASSERT_EQ(scene.meshes.size(), 1u) << c.name;
    for (const glm::ivec2 size : {glm::ivec2(512, 512), glm::ivec2(1920, 1080), glm::ivec2(300, 900)}) {
      for (const bool orthographic : {false, true}) {
        SCOPED_TRACE(std::string(c.name) + (orthographic ? " orthographic " : " perspective ") +
                     std::to_string(size.x));
        Framing framing;
        framing.orthographic = orthographic;
        const Camera camera = frame_scene(scene, framing, size.x, size.y);
        const Extent extent = extent_of(scene, camera);
        EXPECT_GE(extent.left, -0.95f);
        EXPECT_LE(extent.right, 0.95f);
        EXPECT_GE(extent.bottom, -0.95f);
        EXPECT_LE(extent.top, 0.95f);
        EXPECT_GE(extent.fill(), 0.8f);
        // The default margin of 6 percent is left free on both sides, across or down.
        EXPECT_NEAR(std::max({-extent.left, extent.right, -extent.bottom, extent.top}), 0.88f, 0.012f);
        EXPECT_GT(extent.nearest, 0.0f);
        EXPECT_NEAR(extent.left + extent.right, 0.0f, 0.02f);
        EXPECT_NEAR(extent.bottom + extent.top, 0.0f, 0.02f);
        EXPECT_NEAR((camera.right - camera.left) / (camera.top - camera.bottom), float(size.x) / float(size.y), 1e-4f);
        EXPECT_GT(camera.eye().y, scene.center().y) << "from above";
        EXPECT_GT(camera.eye().z, scene.center().z) << "from the front";
        EXPECT_GT(camera.eye().x, scene.center().x) << "and the right";
      }
    }
  }
}

TEST(Framing, LargeSpheresAreInsideThePicture) {
  Scene scene;
  Mesh& atoms = scene.meshes.emplace_back();
  atoms.points = atoms.spheres = true;
  atoms.positions = {glm::vec3(0.0f), glm::vec3(1.0f, 0.3f, 0.2f), glm::vec3(-0.5f, 0.8f, 0.4f)};
  atoms.radii = {1.7f, 1.2f, 1.2f};
  finish_scene(scene);
  const Camera camera = frame_scene(scene, {.margin = 0.0f}, 200, 100);
  float nearest = -1e9f;  // to a side of the picture, from inside
  for (std::size_t i = 0; i < scene.meshes[0].positions.size(); ++i) {
    const glm::vec3 p(camera.view_from_world * glm::vec4(scene.meshes[0].positions[i], 1.0f));
    const auto outside = [&](float along, float edge) {
      return (along + edge * p.z) / std::sqrt(1.0f + edge * edge) + scene.meshes[0].radii[i];
    };
    nearest = std::max({nearest, outside(p.x, camera.right), outside(-p.x, -camera.left), outside(p.y, camera.top),
                        outside(-p.y, -camera.bottom)});
  }
  EXPECT_NEAR(nearest, 0.0f, 0.02f) << "in radii of 1.2 to 1.7: one touches the border, none crosses it";
}

TEST(Framing, DoesNotDependOnTheOrderOfVertices) {
  // In this order, as in files, consecutive points are close to each other, and most blocks of them are skipped.
  std::vector<glm::vec3> spiral;
  for (int i = 0; i < 20000; ++i) {
    const float height = float(i) / 10000.0f - 1.0f, width = std::sqrt(1.0f - height * height),
                angle = 0.05f * float(i);
    spiral.emplace_back(2.0f * width * std::cos(angle), height, width * std::sin(angle) + 0.3f * height);
  }
  for (const bool points : {false, true})
    for (const bool spheres : {false, true})
      for (const bool orthographic : {false, true}) {
        Mesh mesh{.positions = spiral, .points = points, .spheres = points && spheres};
        if (points)
          for (std::size_t i = 0; i < spiral.size(); ++i) mesh.radii.push_back(0.001f * float(i % 100));
        Scene ordered, shuffled;
        ordered.bounds_min = shuffled.bounds_min = {-2.5f, -0.9f, -1.5f};  // less than the spiral
        ordered.bounds_max = shuffled.bounds_max = {1.5f, 1.5f, 1.5f};
        ordered.meshes = {mesh};
        std::mt19937 random(1);
        for (std::size_t i = spiral.size() - 1; i > 0; --i) {
          const std::size_t other = random() % i;
          std::swap(mesh.positions[i], mesh.positions[other]);
          if (points) std::swap(mesh.radii[i], mesh.radii[other]);
        }
        shuffled.meshes = {mesh};
        add_ground(ordered);
        add_ground(shuffled);
        const Framing framing{.margin = 0.1f, .centers_shadow = true, .orthographic = orthographic};
        const Camera a = frame_scene(ordered, framing, 300, 200), b = frame_scene(shuffled, framing, 300, 200);
        EXPECT_EQ(a.view_from_world, b.view_from_world) << points << spheres << orthographic;
        EXPECT_EQ(a.left, b.left);
        EXPECT_EQ(a.top, b.top);
      }
}

TEST(Framing, LooksAtTheFrontOfFilesWithZUp) {
  Scene scene = lump({1, 2, 3}, {0, 0, 3});
  scene.up = {0, 0, 1};
  const Camera camera = frame_scene(scene, {}, 100, 100);
  EXPECT_LT(camera.eye().y, -2.0f);
  EXPECT_GT(camera.eye().x, 0.0f);
  EXPECT_GT(camera.eye().z, 3.0f);
  EXPECT_GT(camera.view_from_world[2][1], 0.9f) << "z points up in the picture";
}

TEST(Framing, TakesDirectionAngleAndUp) {
  const Scene scene = lump({1, 2, 3}, {5, 5, 5});
  Framing framing;
  framing.direction = glm::vec3(0, 0, -10);
  framing.view_angle_deg = 60.0f;
  framing.view_up = glm::vec3(2, 0, 0);
  const Camera camera = frame_scene(scene, framing, 640, 480);
  expect_near(forward_of(camera), {0, 0, -1}, 1e-5f);
  EXPECT_NEAR(camera.top, std::tan(glm::radians(30.0f)), 1e-5f);
  EXPECT_NEAR(camera.view_from_world[0][1], 1.0f, 1e-5f) << "x points up in the picture";
  const Extent extent = extent_of(scene, camera);
  EXPECT_LE(std::max({-extent.left, extent.right, -extent.bottom, extent.top}), 0.95f);
  EXPECT_GE(extent.fill(), 0.8f);

  framing.direction = glm::vec3(1, 0, 0);  // along the requested up: another up is used
  const Camera along = frame_scene(scene, framing, 640, 480);
  expect_near(forward_of(along), {1, 0, 0}, 1e-5f);
  EXPECT_GE(extent_of(scene, along).fill(), 0.8f);
}

TEST(Framing, TakesPositionAndFocalPoint) {
  const Scene scene = lump({1, 1, 1}, {0, 0, 0});
  Framing framing;
  framing.position = glm::vec3(10, 0, 0);
  framing.focal_point = glm::vec3(10, 0, -5);
  const Camera camera = frame_scene(scene, framing, 100, 100);
  expect_near(camera.eye(), {10, 0, 0}, 1e-4f);
  expect_near(forward_of(camera), {0, 0, -1}, 1e-5f);

  framing.focal_point.reset();
  expect_near(forward_of(frame_scene(scene, framing, 100, 100)), {-1, 0, 0}, 1e-2f);
  framing.direction = glm::vec3(0, -2, 0);
  expect_near(forward_of(frame_scene(scene, framing, 100, 100)), {0, -1, 0}, 1e-5f);

  Framing around;
  around.focal_point = glm::vec3(1, 1, 1);
  const Camera fitted = frame_scene(scene, around, 100, 100);
  const glm::vec4 middle = fitted.view_from_world * glm::vec4(1, 1, 1, 1);
  EXPECT_NEAR(middle.x / middle.z, 0.0f, 1e-5f);
  EXPECT_NEAR(middle.y / middle.z, 0.0f, 1e-5f);
  const Extent extent = extent_of(scene, fitted);
  EXPECT_LE(std::max({-extent.left, extent.right, -extent.bottom, extent.top}), 0.95f);
  EXPECT_GE(std::max({-extent.left, extent.right, -extent.bottom, extent.top}), 0.85f);
}

TEST(Framing, TurnsByAzimuthAndElevationAndZooms) {
  const Scene scene = lump({1, 1, 1}, {0, 0, 0});
  Framing framing;
  framing.position = glm::vec3(0, 0, 10);
  framing.focal_point = glm::vec3(0);
  framing.azimuth_deg = 90.0f;
  expect_near(frame_scene(scene, framing, 100, 100).eye(), {10, 0, 0}, 1e-3f);
  framing.azimuth_deg = 0.0f;
  framing.elevation_deg = 30.0f;
  expect_near(frame_scene(scene, framing, 100, 100).eye(), {0, 5, 10 * std::cos(glm::radians(30.0f))}, 1e-3f);
  framing.elevation_deg = 200.0f;
  const Camera top = frame_scene(scene, framing, 100, 100);
  EXPECT_GT(top.eye().y, 9.9f) << "stops at the pole";
  EXPECT_GT(top.eye().z, 0.0f);

  framing = {};
  const float once = extent_of(scene, frame_scene(scene, framing, 100, 100)).fill();
  framing.zoom = 2.0f;
  EXPECT_NEAR(extent_of(scene, frame_scene(scene, framing, 100, 100)).fill(), 2.0f * once, 1e-3f);
  framing.orthographic = true;
  EXPECT_NEAR(extent_of(scene, frame_scene(scene, framing, 100, 100)).fill(), 2.0f * once, 0.05f);
}

TEST(Framing, PrefersTheViewOfTheScene) {
  Scene scene = lump({1, 1, 1}, {0, 0, 0});
  scene.views.push_back({{0, 0, 8}, {0, 0, 2}, 40.0f});
  const Camera camera = frame_scene(scene, {}, 200, 100);
  expect_near(camera.eye(), {0, 0, 8}, 1e-4f);
  EXPECT_NEAR(camera.top, std::tan(glm::radians(20.0f)), 1e-5f);

  Framing framing;
  framing.orthographic = true;
  framing.azimuth_deg = 90.0f;
  framing.zoom = 2.0f;
  const Camera flat = frame_scene(scene, framing, 200, 100);
  EXPECT_EQ(flat.projection, Projection::kOrthographic);
  expect_near(flat.eye(), {6, 0, 2}, 1e-3f);
  EXPECT_NEAR(flat.top, 6.0f * std::tan(glm::radians(20.0f)) / 2.0f, 1e-4f) << "as large as the cone at the target";

  framing = {};
  framing.direction = glm::vec3(0, -1, -1);
  EXPECT_GT(frame_scene(scene, framing, 200, 100).eye().y, 1.0f) << "a direction goes before the view";
}

TEST(Framing, TakesEmptyScenesAndOddWishes) {
  const Scene empty;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Framing odd;
  odd.direction = glm::vec3(0.0f);
  odd.view_up = glm::vec3(0.0f);
  odd.zoom = nan;
  odd.view_angle_deg = 400.0f;
  Scene point;
  point.meshes.resize(1);
  point.meshes[0].positions = {{1, 2, 3}};
  point.bounds_min = point.bounds_max = {1, 2, 3};
  for (const Scene& scene : {empty, point}) {
    for (const bool orthographic : {false, true}) {
      odd.orthographic = orthographic;
      const Camera camera = frame_scene(scene, odd, 0, 0);
      for (int i = 0; i < 4; ++i) {
        for (int k = 0; k < 4; ++k) EXPECT_TRUE(std::isfinite(camera.view_from_world[i][k]));
      }
      EXPECT_GT(camera.right, camera.left);
      EXPECT_GT(camera.top, camera.bottom);
      EXPECT_TRUE(std::isfinite(camera.top));
    }
  }
}

TEST(Framing, KeyLightComesFromAboveLeftOfTheCamera) {
  Scene scene = lump({1, 2, 3}, {0, 0, 3});
  for (const glm::vec3 up : {glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)}) {
    scene.up = up;
    const Camera camera = frame_scene(scene, {}, 100, 100);
    const Lighting lighting = default_lighting(camera, scene.up);
    const std::vector<Light>& lights = lighting.lights;
    ASSERT_EQ(lights.size(), 1u);
    EXPECT_EQ(lights[0].kind, LightKind::kDirectional);
    EXPECT_TRUE(lights[0].casts_shadow);
    EXPECT_EQ(lights[0].angle_deg, 4.0f);
    const glm::vec3 view = glm::mat3(camera.view_from_world) * lights[0].direction;
    EXPECT_NEAR(glm::length(view), 1.0f, 1e-5f);
    EXPECT_LT(view.x, -0.3f);
    EXPECT_GT(view.y, 0.5f);
    EXPECT_GT(view.z, 0.5f) << "from the side of the viewer";
    // Ambient light is bluish from above and weaker and reddish from below, and the sum is just white.
    const auto ambient = [&](const glm::vec3& normal) { return lighting.ambient + lighting.ambient_shape.at(normal); };
    expect_near(lights[0].color + ambient(lights[0].direction), glm::vec3(1.0f), 0.05f);
    EXPECT_GT(ambient(up).b, 1.1f * ambient(up).r);
    EXPECT_GT(ambient(-up).r, 1.1f * ambient(-up).b);
    EXPECT_GT(ambient(up).g, 1.5f * ambient(-up).g);
  }
}

TEST(Framing, LeavesSpaceFree) {
  for (const bool orthographic : {false, true}) {
    const Scene scene = lump({3.0f, 1.0f, 2.0f}, {5.0f, -2.0f, 1.0f});
    Framing framing;
    framing.orthographic = orthographic;
    const Camera whole = frame_scene(scene, framing, 300, 300);
    framing.free_space = {0.25f, 0.5f};
    const Camera camera = frame_scene(scene, framing, 400, 600);
    // The used part of the window is that of a picture of 300 x 300 pixels.
    EXPECT_NEAR((whole.right - whole.left) / (camera.right - camera.left), 0.75f, 1e-4f);
    EXPECT_NEAR(camera.left, whole.left, 1e-4f * std::abs(whole.left));
    EXPECT_NEAR(camera.top, whole.top, 1e-4f * std::abs(whole.top));
    EXPECT_NEAR((whole.top - whole.bottom) / (camera.top - camera.bottom), 0.5f, 1e-4f);
  }
}

TEST(Explode, MovesObjectsApart) {
  Scene scene;
  for (const float x : {-1.0f, 0.0f, 2.0f}) {
    Mesh& mesh = scene.meshes.emplace_back();
    mesh.positions = {{x, 0.0f, 0.0f}, {x + 1.0f, 0.0f, 0.0f}, {x, 1.0f, 0.0f}};
    mesh.indices = {0, 1, 2};
    mesh.object = x > 1.0f ? 1 : 0;  // the first two are one part
  }
  scene.bounds_min = {-1.0f, 0.0f, 0.0f}, scene.bounds_max = {3.0f, 1.0f, 0.0f};
  explode(0.5f, scene);
  // The centres of the parts are at 0 and 2.5, and that of the scene at 1.
  EXPECT_EQ(scene.meshes[0].positions[0].x, -1.5f);
  EXPECT_EQ(scene.meshes[1].positions[0].x, -0.5f);
  EXPECT_EQ(scene.meshes[2].positions[0].x, 2.75f);
  EXPECT_EQ(scene.bounds_min.x, -1.5f);
  EXPECT_EQ(scene.bounds_max.x, 3.75f);
  EXPECT_TRUE(scene.warnings.empty());
  scene.meshes.pop_back();
  explode(0.5f, scene);
  EXPECT_EQ(scene.warnings.size(), 1u);
}

}  // namespace
}  // namespace umbrage
