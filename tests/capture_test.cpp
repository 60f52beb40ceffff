// Rung 2 of the CPU's capture: scenes for which every plane of the G-buffer is known.
#include "devices/cpu/capture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <numbers>
#include <set>

#include "devices/cpu/cpu_device.h"
#include "effects/effects.h"
#include "generators/shapes.h"
#include "scene/finish.h"
#include "scene/framing.h"
#include "support.h"
#include "vulkan_capture.h"

namespace umbrage {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// ---- scenes
// ------------------------------------------------------------------------------------------------------------

/// The parallelogram origin + s u + t v for s, t in [0, 1], with texture coordinates (s, t) * repeat; front u x v.
Mesh parallelogram(glm::vec3 origin, glm::vec3 u, glm::vec3 v, float repeat = 1.0f) {
  Mesh mesh;
  mesh.positions = {origin, origin + u, origin + u + v, origin + v};
  mesh.normals.assign(4, glm::normalize(glm::cross(u, v)));
  mesh.uvs = {{0, 0}, {repeat, 0}, {repeat, repeat}, {0, repeat}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

/// A square of side 2 half in the plane z = height, seen from +z.
Mesh square(float half, float height = 0.0f, glm::vec2 center = {0, 0}) {
  return parallelogram({center.x - half, center.y - half, height}, {2 * half, 0, 0}, {0, 2 * half, 0});
}

/// A finished scene: mesh k is object k of material k % materials.
Scene scene_of(std::vector<Mesh> meshes, std::vector<Material> materials = {Material{}}) {
  Scene scene;
  scene.name = "test";
  scene.meshes = std::move(meshes);
  scene.materials = std::move(materials);
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    scene.meshes[m].object = int(m);
    scene.meshes[m].material = int(m % scene.materials.size());
  }
  EXPECT_EQ(finish_scene(scene), 0u);
  return scene;
}

Light key_light(glm::vec3 towards) {
  return {.direction = glm::normalize(towards), .color = glm::vec3(1.0f), .casts_shadow = true};
}

Light key_lamp(glm::vec3 where) {
  return {.kind = LightKind::kPoint, .position = where, .color = glm::vec3(1.0f), .casts_shadow = true};
}

struct Picture {
  PictureInfo info;
  Image planes;
  const Plane& operator[](std::string_view name) const { return planes.plane(name); }
  glm::dvec3 normal(int x, int y) const {
    return {(*this)["normal.x"].at(x, y), (*this)["normal.y"].at(x, y), (*this)["normal.z"].at(x, y)};
  }
  float depth(int x, int y) const { return (*this)["depth"].at(x, y); }
};

Picture capture_with(const CaptureSettings& settings, const Scene& scene, const Camera& camera,
                     const CpuSettings& cpu = {}) {
  const auto device = make_cpu_device(cpu);
  const auto ready = device->prepare(scene);
  EXPECT_TRUE(ready) << (ready ? "" : ready.error().message);
  const auto frame = device->capture(camera, settings);
  EXPECT_TRUE(frame);
  constexpr int kMostOnGpu = 20000;  // pixels: a GPU in software takes its time
  const bool small = settings.width * settings.height <= kMostOnGpu && cpu.threads == 0;
  for (const VulkanCapture how : test::kGpuCaptures) {
    Device* const gpu = small ? test::drawing_device(how) : nullptr;
    if (!gpu) continue;
    // What holds for the one holds for the other: almost all pixels show the same. A line of them may lie on a rim.
    const test::NoMessages no_messages;
    const test::Both both{test::captured(*gpu, scene, camera, settings),
                          test::captured(*device, scene, camera, settings)};
    EXPECT_EQ(both.gpu.names, both.cpu.names);
    const test::Deviation d = test::deviation(both, *layer_count(settings));
    EXPECT_LE(d.anywhere, d.pixels / 200 + settings.width) << test::name_of(how);
    for (const auto& [plane, count] : d.inside) EXPECT_LE(count, d.pixels / 500) << test::name_of(how) << ' ' << plane;
  }
  return {frame->info, *device->download(*frame, {})};
}

Picture capture(const Scene& scene, const Camera& camera, int width, int height, const CpuSettings& cpu = {}) {
  return capture_with({width, height, true}, scene, camera, cpu);
}

/// Looks down on the plane z = 0 from above; the picture is `height` units high and y points up in it.
Camera from_above(float height, float aspect = 1.0f, float distance = 10.0f) {
  return orthographic_camera({0, 0, distance}, {0, 0, 0}, {0, 1, 0}, height, aspect);
}

/// The ray through a pixel's centre, in double and world space: its parameter is depth.
struct Ray {
  glm::dvec3 origin, direction;
  glm::dvec3 at(double depth) const { return origin + direction * depth; }
};

Ray ray_of(const PictureInfo& info, int x, int y) {
  const Camera& c = info.camera;
  const glm::dmat4 view(c.view_from_world);
  const glm::dmat3 turn = glm::transpose(glm::dmat3(view));
  const glm::dvec3 eye = -(turn * glm::dvec3(view[3]));
  const double u = c.left + (x + 0.5) / info.width * (double(c.right) - c.left);
  const double v = c.top - (y + 0.5) / info.height * (double(c.top) - c.bottom);
  if (c.projection == Projection::kPerspective) return {eye, turn * glm::dvec3(u, v, -1.0)};
  return {eye + turn * glm::dvec3(u, v, 0.0), turn * glm::dvec3(0.0, 0.0, -1.0)};
}

double degrees_between(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180.0 / M_PI;
}

float linear(int srgb_byte) {
  const double v = srgb_byte / 255.0;
  return float(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
}

void expect_equal(const Image& a, const Image& b, std::string_view what) {
  ASSERT_EQ(a.names, b.names) << what;
  for (std::size_t p = 0; p < a.planes.size(); ++p)
    EXPECT_EQ(test::difference(a.planes[p], b.planes[p], 0.0).most, 0.0) << what << ": " << a.names[p];
}

// ---- depth and normals
// -------------------------------------------------------------------------------------------------

TEST(Capture, PlaneFacingTheCameraHasOneDepth) {
  const Scene scene = scene_of({square(50.0f)});
  const Camera perspective = perspective_camera({0.5f, -1.0f, 7.0f}, {0.5f, -1.0f, 0}, {0, 1, 0}, 60.0f, 1.5f);
  const Camera orthographic = orthographic_camera({0.5f, -1.0f, 7.0f}, {0.5f, -1.0f, 0}, {0, 1, 0}, 9.0f, 1.5f);
  for (const Camera& camera : {perspective, orthographic}) {
    const Picture picture = capture(scene, camera, 90, 60);
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 90; ++x) {
        ASSERT_NEAR(picture.depth(x, y), 7.0, 7e-6) << x << ',' << y;
        ASSERT_EQ(picture.normal(x, y), glm::dvec3(0, 0, 1)) << x << ',' << y;
        ASSERT_EQ(picture["object_id"].at(x, y), 0.0f);
      }
  }
}

TEST(Capture, TiltedPlaneFollowsItsEquation) {
  const glm::vec3 point(1, 2, 3), u(90, 15, -27), v(-12, 84, 33);
  const Scene scene = scene_of({parallelogram(point - 0.5f * (u + v), u, v)});
  const glm::dvec3 normal = glm::normalize(glm::cross(glm::dvec3(u), glm::dvec3(v)));
  const glm::vec3 front(normal), side = glm::normalize(u + 0.3f * v);
  for (const float tilt_deg : {5.0f, 50.0f, 74.0f})  // between the view axis and the normal
    for (const bool orthographic : {false, true}) {
      const float tilt = glm::radians(tilt_deg);
      const glm::vec3 eye = point + 12.0f * (std::cos(tilt) * front + std::sin(tilt) * side);
      const Camera camera = orthographic ? orthographic_camera(eye, point, {0, 0, 1}, 4.0f, 0.8f)
                                         : perspective_camera(eye, point, {0, 0, 1}, 15.0f, 0.8f);
      const Picture picture = capture(scene, camera, 64, 80);
      const glm::dvec3 expected = glm::dmat3(glm::mat3(camera.view_from_world)) * normal;
      for (int y = 0; y < 80; ++y)
        for (int x = 0; x < 64; ++x) {
          const Ray ray = ray_of(picture.info, x, y);
          const double slope = glm::dot(normal, ray.direction);
          const double depth = glm::dot(normal, glm::dvec3(point) - ray.origin) / slope;
          // The closer to edge-on, the more a rounded position moves the hit.
          ASSERT_NEAR(picture.depth(x, y), depth, 3e-6 * depth / std::fabs(slope)) << x << ',' << y;
          ASSERT_LT(degrees_between(picture.normal(x, y), expected), 0.001);
        }
    }
}

TEST(Capture, SphereHasTheNormalsOfASphere) {
  // One sphere with normals of its own, one for which finish_scene makes them.
  Mesh made = shapes::cube_sphere(64, [](glm::vec3) { return 2.0f; });
  made.normals.clear();
  for (const Mesh& mesh : {shapes::sphere(2.0f, 192, 96), made})
    for (const bool orthographic : {false, true}) {
      const Scene scene = scene_of({mesh});
      const glm::vec3 eye(4, 5, 6);
      const Camera camera = orthographic ? orthographic_camera(eye, {0, 0, 0}, {0, 1, 0}, 4.4f, 1.0f)
                                         : perspective_camera(eye, {0, 0, 0}, {0, 1, 0}, 30.0f, 1.0f);
      const Picture picture = capture(scene, camera, 150, 150);
      const glm::dmat3 view(glm::mat3(camera.view_from_world));
      long compared = 0, background = 0;
      for (int y = 0; y < 150; ++y)
        for (int x = 0; x < 150; ++x) {
          const Ray ray = ray_of(picture.info, x, y);
          const double a = glm::dot(ray.direction, ray.direction), b = glm::dot(ray.direction, ray.origin);
          const double root = b * b - a * (glm::dot(ray.origin, ray.origin) - 4.0);
          if (root < 0.0) {
            ASSERT_EQ(picture.depth(x, y), kInfinity);  // the mesh lies inside the sphere
            ++background;
            continue;
          }
          const double depth = (-b - std::sqrt(root)) / a;
          const glm::dvec3 normal = ray.at(depth) / 2.0;
          const double facing = -glm::dot(normal, ray.direction) / std::sqrt(a);
          if (facing < 0.15) continue;  // the mesh's silhouette is a polygon
          ++compared;
          ASSERT_NEAR(picture.depth(x, y), depth, 2e-3 / facing);
          ASSERT_LT(degrees_between(picture.normal(x, y), view * normal), 0.5) << x << ',' << y;
          ASSERT_NEAR(glm::length(picture.normal(x, y)), 1.0, 1e-6);
        }
      EXPECT_GT(compared, 10000);
      EXPECT_GT(background, 2000);
    }
}

/// Points with these radii, which nothing has measured.
Scene points_of(std::vector<glm::vec3> positions, std::vector<glm::vec3> normals, float across,
                std::vector<glm::vec3> colors = {}) {
  Mesh mesh;
  mesh.points = true;
  mesh.positions = std::move(positions);
  mesh.normals = std::move(normals);
  mesh.colors = std::move(colors);
  Scene scene;
  scene.meshes = {mesh};
  scene.materials.emplace_back().albedo = glm::vec3(0.5f);
  EXPECT_EQ(finish_scene(scene, 80.0f, {mesh.normals.empty() ? PointShape::kSpheres : PointShape::kDiscs, {across, 0}}),
            0u);
  return scene;
}

TEST(Capture, PointsAreSpheres) {
  const Scene scene = points_of({{0, 0, 0}}, {}, 4.0f);
  const glm::vec3 eye(4, 5, 6);
  for (const Camera& camera : {perspective_camera(eye, {0, 0, 0}, {0, 1, 0}, 30.0f, 1.0f),
                               orthographic_camera(eye, {0, 0, 0}, {0, 1, 0}, 4.4f, 1.0f)}) {
    const Picture picture = capture_with({97, 97, false, 3}, scene, camera);
    const glm::dmat3 view(glm::mat3(camera.view_from_world));
    long compared = 0;
    for (int y = 0; y < 97; ++y)
      for (int x = 0; x < 97; ++x) {
        const Ray ray = ray_of(picture.info, x, y);
        const double a = glm::dot(ray.direction, ray.direction), b = glm::dot(ray.direction, ray.origin);
        const double root = b * b - a * (glm::dot(ray.origin, ray.origin) - 4.0);
        if (std::abs(root) < 1e-3 * a) continue;  // the rim
        if (root < 0.0) {
          ASSERT_EQ(picture.depth(x, y), kInfinity);
          continue;
        }
        ++compared;
        const double depth = (-b - std::sqrt(root)) / a;
        ASSERT_NEAR(picture.depth(x, y), depth, 2e-5) << x << ',' << y;
        ASSERT_LT(degrees_between(picture.normal(x, y), view * (ray.at(depth) / 2.0)), 0.05) << x << ',' << y;
        const double chord = 2.0 * std::sqrt(root) / a;
        ASSERT_NEAR(picture["layer1.depth"].at(x, y) - picture.depth(x, y), chord, 1e-4) << x << ',' << y;
        ASSERT_EQ(picture["layer2.depth"].at(x, y), kInfinity);
      }
    EXPECT_GT(compared, 4000);
  }
}

TEST(Capture, PointsWithNormalsAreDiscs) {
  const glm::vec3 normal = glm::normalize(glm::vec3(1, 2, 3));
  // The other one shows its back.
  const Scene scene = points_of({{-1, 0, 0}, {1, 0, 1}}, {normal, -normal}, 1.6f, {{1, 0, 0}, {0, 0.5f, 1}});
  const Camera camera = from_above(4.0f);
  const Picture picture = capture(scene, camera, 120, 120);
  long seen[2] = {0, 0};
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 120; ++x) {
      const Ray ray = ray_of(picture.info, x, y);
      const int k = ray.origin.x > 0.0;
      const glm::dvec3 center = k ? glm::dvec3(1, 0, 1) : glm::dvec3(-1, 0, 0);
      const double depth =
          glm::dot(center - ray.origin, glm::dvec3(normal)) / glm::dot(ray.direction, glm::dvec3(normal));
      const double away = glm::distance(ray.at(depth), center);
      if (std::abs(away - 0.8) < 1e-3) continue;
      if (away > 0.8) {
        ASSERT_EQ(picture.depth(x, y), kInfinity) << x << ',' << y;
        continue;
      }
      ++seen[k];
      ASSERT_NEAR(picture.depth(x, y), depth, 2e-5);
      ASSERT_LT(degrees_between(picture.normal(x, y), glm::dvec3(normal)), 0.01);
      const glm::vec3 color = k ? glm::vec3(0, 0.25f, 0.5f) : glm::vec3(0.5f, 0, 0);
      ASSERT_EQ(glm::vec3(picture["albedo.r"].at(x, y), picture["albedo.g"].at(x, y), picture["albedo.b"].at(x, y)),
                color);
    }
  EXPECT_GT(seen[0], 1200);
  EXPECT_GT(seen[1], 1200);
}

TEST(Capture, DiscsOfARoundSurfaceDoNotShadeEachOther) {
  // Points of a ball, lit from the camera: none of the discs, which overlap and tilt, may darken another.
  std::vector<glm::vec3> positions, normals;
  constexpr int kCount = 4000;
  for (int k = 0; k < kCount; ++k) {
    const double z = 1.0 - (2.0 * k + 1.0) / kCount, turn = k * std::numbers::pi * (3.0 - std::sqrt(5.0));
    normals.emplace_back(std::sqrt(1.0 - z * z) * std::cos(turn), std::sqrt(1.0 - z * z) * std::sin(turn), z);
    positions.push_back(normals.back());
  }
  Scene scene = points_of(positions, normals, 0.12f);
  scene.lights = {key_light({0.5f, 0.3f, 1})};
  const Picture picture = capture(scene, from_above(2.4f), 130, 130);
  long lit = 0, dark = 0;
  for (int y = 0; y < 130; ++y)
    for (int x = 0; x < 130; ++x) {
      if (!std::isfinite(picture.depth(x, y))) continue;
      const glm::dvec3 n = picture.normal(x, y);
      if (glm::dot(n, glm::normalize(glm::dvec3(0.5, 0.3, 1))) < 0.3) continue;
      (picture["shadow"].at(x, y) > 0.5f ? lit : dark) += 1;
    }
  EXPECT_GT(lit, 5000);
  EXPECT_EQ(dark, 0);
}

TEST(Capture, ColorsRunFromVertexToVertex) {
  Mesh mesh = square(1.0f);
  mesh.uvs.clear();
  mesh.colors = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};  // red along x, green along y
  Material grey;
  grey.albedo = glm::vec3(0.5f);
  Mesh plain = square(1.0f, 0.0f, {3.0f, 0.0f});
  // The coloured mesh is not the first: its colours are found all the same.
  const Scene scene = scene_of({plain, mesh}, {grey});
  const Picture picture = capture(scene, from_above(2.0f), 100, 100);
  for (int y = 2; y < 98; ++y)
    for (int x = 2; x < 98; ++x) {
      ASSERT_NEAR(picture["albedo.r"].at(x, y), 0.5f * (float(x) + 0.5f) / 100.0f, 1e-4f);
      ASSERT_NEAR(picture["albedo.g"].at(x, y), 0.5f * (1.0f - (float(y) + 0.5f) / 100.0f), 1e-4f);
      ASSERT_EQ(picture["albedo.b"].at(x, y), 0.0f);
    }
}

TEST(Capture, OffCentreWindowIsAPartOfTheWhole) {
  const Scene scene = scene_of({shapes::sphere(2.0f, 48, 24), square(9.0f, -1.0f)});
  for (const bool orthographic : {false, true}) {
    const Camera whole = orthographic ? orthographic_camera({4, 5, 6}, {0, 0, 0}, {0, 1, 0}, 8.0f, 1.0f)
                                      : perspective_camera({4, 5, 6}, {0, 0, 0}, {0, 1, 0}, 50.0f, 1.0f);
    // Columns 16 to 47 and rows 32 to 55 of 64 x 64.
    Camera part = whole;
    part.left = whole.left + (whole.right - whole.left) * 0.25f;
    part.right = whole.left + (whole.right - whole.left) * 0.75f;
    part.top = whole.top + (whole.bottom - whole.top) * 0.5f;
    part.bottom = whole.top + (whole.bottom - whole.top) * 0.875f;
    const Picture all = capture(scene, whole, 64, 64), cut = capture(scene, part, 32, 24);
    long different = 0;  // at silhouettes rounding decides who is hit
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 32; ++x) {
        const float a = all.depth(x + 16, y + 32), b = cut.depth(x, y);
        different += !(a == b || std::fabs(a - b) < 2e-5f);
        different += glm::distance(all.normal(x + 16, y + 32), cut.normal(x, y)) > 1e-4;
      }
    EXPECT_LE(different, 4) << orthographic;
  }
}

TEST(Capture, PixelsAreCountedFromTheTopLeft) {
  // One small square up and to the right of the middle.
  const Scene scene = scene_of({square(0.5f, 0.0f, {1.5f, 0.5f})});
  const Picture picture = capture(scene, from_above(4.0f), 4, 4);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) EXPECT_EQ(std::isfinite(picture.depth(x, y)), x == 3 && y == 1) << x << ',' << y;
}

TEST(Capture, BackgroundIsMarkedInEveryPlane) {
  Material material;
  material.albedo = {0.1f, 0.2f, 0.3f};
  material.specular_strength = 0.4f;
  material.specular_exponent = 50.0f;
  Scene scene = scene_of({square(0.5f)}, {material});
  scene.lights = {key_light({0, 0, 1})};
  const Picture picture = capture(scene, from_above(4.0f), 4, 4);
  EXPECT_EQ(picture.depth(0, 0), kInfinity);
  for (const char* name :
       {"normal.x", "normal.y", "normal.z", "albedo.r", "albedo.g", "albedo.b", "specular", "shininess"})
    EXPECT_EQ(picture[name].at(0, 0), 0.0f) << name;
  EXPECT_EQ(picture["object_id"].at(0, 0), -1.0f);
  EXPECT_EQ(picture["material_id"].at(0, 0), -1.0f);
  EXPECT_EQ(picture["shadow"].at(0, 0), 1.0f);
  EXPECT_EQ(picture["albedo.g"].at(2, 2), 0.2f);
  EXPECT_EQ(picture["specular"].at(2, 2), 0.4f);
  EXPECT_EQ(picture["shininess"].at(2, 2), 50.0f);
}

TEST(Capture, ObjectsAndMaterialsAreNumbered) {
  // Four squares in a row, of two materials; the last two are one object.
  std::vector<Mesh> meshes;
  for (int k = 0; k < 4; ++k) meshes.push_back(square(0.5f, 0.1f * k, {k - 1.5f, 0.0f}));
  Scene scene = scene_of(meshes, {Material{}, Material{}});
  scene.meshes[3].object = 2;
  const Picture picture = capture(scene, from_above(1.0f, 4.0f), 4, 1);
  const float objects[] = {0, 1, 2, 2}, materials[] = {0, 1, 0, 1};
  for (int x = 0; x < 4; ++x) {
    EXPECT_EQ(picture["object_id"].at(x, 0), objects[x]);
    EXPECT_EQ(picture["material_id"].at(x, 0), materials[x]);
    EXPECT_NEAR(picture.depth(x, 0), 10.0f - 0.1f * x, 1e-5);
  }
}

TEST(Capture, TheNearestSurfaceIsSeen) {
  const Scene scene = scene_of({square(3.0f, 0.0f), square(1.0f, 2.0f), square(2.0f, 1.0f)});
  const Picture picture = capture(scene, from_above(8.0f), 8, 8);
  const float row[] = {-1, 0, 2, 1, 1, 2, 0, -1};
  for (int x = 0; x < 8; ++x) EXPECT_EQ(picture["object_id"].at(x, 4), row[x]) << x;
}

TEST(Capture, BothSidesShowNormalsTowardsTheCamera) {
  const Scene scene = scene_of({square(2.0f)});
  for (const float side : {1.0f, -1.0f}) {
    const glm::vec3 eye(1.0f, 2.0f, side * 5.0f);
    const Picture picture = capture(scene, perspective_camera(eye, {0, 0, 0}, {0, 1, 0}, 20.0f, 1.0f), 16, 16);
    const glm::dvec3 expected = glm::dmat3(glm::mat3(picture.info.camera.view_from_world)) * glm::dvec3(0, 0, side);
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 16; ++x) {
        ASSERT_TRUE(std::isfinite(picture.depth(x, y)));
        ASSERT_LT(degrees_between(picture.normal(x, y), expected), 0.001) << side;
      }
  }
}

TEST(Capture, NormalsFaceTheCameraOnCoarseMeshesToo) {
  // Sixteen by eight quads with smooth normals: at the silhouette interpolated normals point away.
  const Scene scene = scene_of({shapes::sphere(1.0f, 16, 8)});
  for (const glm::vec3 eye : {glm::vec3(0, 0, 3), glm::vec3(0.2f, 0.1f, -0.3f)}) {  // outside, and inside
    const Picture picture = capture(scene, perspective_camera(eye, {0, 0, 0}, {0, 1, 0}, 50.0f, 1.0f), 90, 90);
    long hits = 0;
    for (int y = 0; y < 90; ++y)
      for (int x = 0; x < 90; ++x) {
        if (!std::isfinite(picture.depth(x, y))) continue;
        ++hits;
        const glm::dmat3 world = glm::transpose(glm::dmat3(glm::mat3(picture.info.camera.view_from_world)));
        const glm::dvec3 direction = ray_of(picture.info, x, y).direction;
        ASSERT_LE(glm::dot(world * picture.normal(x, y), glm::normalize(direction)), 1e-6) << x << ',' << y;
        ASSERT_NEAR(glm::length(picture.normal(x, y)), 1.0, 1e-5);
      }
    EXPECT_GT(hits, 3000);
  }
}

TEST(Capture, NormalsThatContradictTheWindingStillFaceTheCamera) {
  // Files with clockwise triangles and right normals are common.
  Mesh mesh = square(2.0f);
  std::swap(mesh.indices[1], mesh.indices[2]);
  std::swap(mesh.indices[4], mesh.indices[5]);
  const Scene scene = scene_of({mesh});
  for (const float side : {1.0f, -1.0f}) {
    const Camera camera = perspective_camera({3.0f, 2.0f, side * 4.0f}, {0, 0, 0}, {0, 1, 0}, 20.0f, 1.0f);
    const glm::dvec3 expected = glm::dmat3(glm::mat3(camera.view_from_world)) * glm::dvec3(0, 0, side);
    const Picture picture = capture(scene, camera, 8, 8);
    for (int x = 0; x < 8; ++x) EXPECT_LT(degrees_between(picture.normal(x, 3), expected), 0.001) << side;
  }
}

// ---- textures
// ----------------------------------------------------------------------------------------------------------

Texture texture_of(int width, int height, const std::function<glm::ivec4(int x, int y)>& texel) {
  Texture texture;
  texture.name = "made";
  texture.width = width;
  texture.height = height;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const glm::ivec4 t = texel(x, y);
      for (int c = 0; c < 4; ++c) texture.rgba.push_back(std::uint8_t(t[c]));
    }
  return texture;
}

Scene textured(Mesh mesh, Texture texture, glm::vec3 albedo = glm::vec3(1.0f)) {
  Material material;
  material.albedo = albedo;
  material.texture = 0;
  Scene scene;
  scene.meshes = {std::move(mesh)};
  scene.materials = {material};
  scene.textures = {std::move(texture)};
  finish_scene(scene);
  return scene;
}

TEST(Capture, TexelsLandOnTheirPixels) {
  // Texels and pixels coincide: row 0 of the texture is at the top, u runs to the right. Colours are sRGB.
  const auto texel = [](int x, int y) { return glm::ivec4(20 * x, 255 - 30 * y, 10 * x * y, 255); };
  const Scene scene = textured(square(2.0f), texture_of(8, 4, texel), {1.0f, 0.5f, 1.0f});
  const Picture picture = capture(scene, from_above(4.0f), 8, 4);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 8; ++x) {
      EXPECT_NEAR(picture["albedo.r"].at(x, y), linear(20 * x), 2e-5) << x << ',' << y;
      EXPECT_NEAR(picture["albedo.g"].at(x, y), 0.5f * linear(255 - 30 * y), 2e-5) << x << ',' << y;
      EXPECT_NEAR(picture["albedo.b"].at(x, y), linear(10 * x * y), 2e-5) << x << ',' << y;
    }
}

TEST(Capture, TexturesRepeat) {
  const auto texel = [](int x, int y) { return glm::ivec4(60 * x, 60 * y, 0, 255); };
  // Texture coordinates from -3 to 5, and once so far off that a float keeps eleven bits of fraction.
  for (const float shift : {-3.0f, 4096.0f}) {
    Mesh mesh = square(2.0f);
    for (glm::vec2& uv : mesh.uvs) uv = uv * 8.0f + shift;
    const Picture picture = capture(textured(mesh, texture_of(4, 4, texel)), from_above(4.0f), 32, 32);
    const double close = shift < 1000.0f ? 1e-4 : 0.01;
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x) {
        ASSERT_NEAR(picture["albedo.r"].at(x, y), linear(60 * (x % 4)), close) << x << ',' << y;
        ASSERT_NEAR(picture["albedo.g"].at(x, y), linear(60 * (y % 4)), close) << x << ',' << y;
      }
  }
}

Texture checkers() {
  return texture_of(64, 64, [](int x, int y) { return glm::ivec4(glm::ivec3((x / 8 + y / 8) % 2 ? 255 : 0), 255); });
}

TEST(Capture, FarCheckersAverageToTheirMean) {
  // A ground of 4096 x 4096 checkers that runs to the horizon.
  Scene scene = textured(parallelogram({-256, -256, 0}, {512, 0, 0}, {0, 512, 0}, 512.0f), checkers());
  const Camera camera = perspective_camera({0, -256, 2.0f}, {0, 0, 0}, {0, 0, 1}, 40.0f, 1.0f);
  const Picture picture = capture(scene, camera, 200, 200);
  long compared = 0;
  double sum = 0.0;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) {
      if (!(picture.depth(x, y) > 150.0f && picture.depth(x, y) < 400.0f)) continue;
      ++compared;
      sum += picture["albedo.g"].at(x, y);
      // One pixel across is 0.5 units and more: four checkers.
      EXPECT_NEAR(picture["albedo.g"].at(x, y), 0.5, 0.08) << x << ',' << y;
    }
  ASSERT_GT(compared, 400);
  EXPECT_NEAR(sum / compared, 0.5, 0.01);
}

TEST(Capture, NearCheckersAreCrisp) {
  Scene scene = textured(parallelogram({-256, -256, 0}, {512, 0, 0}, {0, 512, 0}, 512.0f), checkers());
  const Camera camera = perspective_camera({0.3f, -0.2f, 2.0f}, {0.3f, 0, 0}, {0, 0, 1}, 20.0f, 1.0f);
  const Picture picture = capture(scene, camera, 200, 200);
  long pure = 0, light = 0;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) {
      const float g = picture["albedo.g"].at(x, y);
      pure += g < 0.01f || g > 0.99f;
      light += g > 0.5f;
    }
  // A checker is 35 pixels wide, the blend between two a texel of 4.4 pixels: (1 - 4.4 / 35)^2 is pure.
  EXPECT_GT(pure, 40000 * 0.72);
  EXPECT_NEAR(light, 20000, 2000);
}

TEST(Capture, CheckersAtAGrazingAngleStaySharpAcross) {
  // Stripes along the view: filtering along the view must not blur across it.
  const auto stripes = texture_of(64, 64, [](int x, int) { return glm::ivec4(glm::ivec3(x / 32 ? 255 : 0), 255); });
  const Scene scene = textured(parallelogram({-32, -32, 0}, {64, 0, 0}, {0, 64, 0}, 64.0f), stripes);
  const Camera camera = perspective_camera({0, -30, 1.5f}, {0, -22, 0}, {0, 0, 1}, 10.0f, 1.0f);
  const Picture picture = capture(scene, camera, 200, 200);
  long pure = 0, all = 0;
  for (int y = 60; y < 140; ++y)
    for (int x = 0; x < 200; ++x) {
      const float g = picture["albedo.g"].at(x, y);
      pure += g < 0.05f || g > 0.95f;
      ++all;
    }
  EXPECT_GT(pure, 0.7 * all);
}

// ---- masks and shadows
// -------------------------------------------------------------------------------------------------

/// A square that throws its shadow on a larger one below it. Object 0 is the ground, 1 the square.
Scene square_over_ground() { return scene_of({square(8.0f), square(1.0f, 2.0f, {0.3f, -0.2f})}); }

/// Shares of ground pixels that are in shadow though they should not be, and the other way round; pixels nearer than
/// `margin` to the shadow's edge are left out.
struct ShadowErrors {
  long wrongly_dark = 0, wrongly_lit = 0, dark = 0, lit = 0;
};

/// Compares the ground's shadow with `blocked`, how deep inside the blocker the way to the light passes (below 0:
/// outside it).
ShadowErrors compare_shadow(const Picture& picture, const std::function<double(glm::dvec3)>& inside, double margin,
                            std::string_view plane = "shadow") {
  ShadowErrors errors;
  for (int y = 0; y < picture.info.height; ++y)
    for (int x = 0; x < picture.info.width; ++x) {
      if (picture["object_id"].at(x, y) != 0.0f) continue;
      const double depth_inside = inside(ray_of(picture.info, x, y).at(picture.depth(x, y)));
      if (std::fabs(depth_inside) < margin) continue;
      const float shadow = picture[plane].at(x, y);
      (depth_inside > 0.0 ? errors.dark : errors.lit) += 1;
      if (depth_inside > 0.0) errors.wrongly_lit += shadow != 0.0f;
      if (depth_inside < 0.0) errors.wrongly_dark += shadow != 1.0f;
    }
  return errors;
}

/// How deep a point of the plane z = 2 lies inside the square of square_over_ground.
double inside_square(const glm::dvec3& p) { return 1.0 - std::max(std::fabs(p.x - 0.3), std::fabs(p.y + 0.2)); }

TEST(Capture, DirectionalLightThrowsTheSquaresShadow) {
  for (const bool orthographic : {true, false}) {
    Scene scene = square_over_ground();
    const glm::vec3 towards(0.9f, 0.5f, 1.0f);
    scene.lights = {key_light(towards)};
    const Camera camera =
        orthographic ? from_above(10.0f) : perspective_camera({-5, -6, 9}, {-1, -1, 0}, {0, 0, 1}, 40.0f, 1.0f);
    const Picture picture = capture(scene, camera, 200, 200);
    const auto inside = [&](glm::dvec3 p) {
      return inside_square(p + glm::dvec3(towards) * ((2.0 - p.z) / towards.z));
    };
    const ShadowErrors errors = compare_shadow(picture, inside, 2e-3);
    EXPECT_EQ(errors.wrongly_dark, 0);
    EXPECT_EQ(errors.wrongly_lit, 0);
    EXPECT_GT(errors.dark, 500);
    EXPECT_GT(errors.lit, 5000);
    for (int y = 0; y < 200; ++y)
      for (int x = 0; x < 200; ++x)
        if (picture["object_id"].at(x, y) == 1.0f) {
          ASSERT_EQ(picture["shadow"].at(x, y), 1.0f);
        }
  }
}

TEST(Capture, PointLightThrowsTheSquaresShadow) {
  Scene scene = square_over_ground();
  const glm::vec3 lamp(1.0f, 0.6f, 4.5f);
  scene.lights = {key_lamp(lamp)};
  const Picture picture = capture(scene, from_above(12.0f), 200, 200);
  const auto inside = [&](glm::dvec3 p) {
    return inside_square(p + (glm::dvec3(lamp) - p) * ((2.0 - p.z) / (lamp.z - p.z)));
  };
  const ShadowErrors errors = compare_shadow(picture, inside, 2e-3);
  EXPECT_EQ(errors.wrongly_dark, 0);
  EXPECT_EQ(errors.wrongly_lit, 0);
  EXPECT_GT(errors.dark, 500);
  EXPECT_GT(errors.lit, 5000);
}

TEST(Capture, EachLightHasItsOwnShadow) {
  Scene scene = square_over_ground();
  const glm::vec3 lamp(1.0f, 0.6f, 4.5f);
  const Light sun = key_light({0.9f, 0.5f, 1.0f});
  Light plain = sun;
  plain.casts_shadow = false;
  const auto shadows = [&](std::vector<Light> lights, int count) {
    scene.lights = std::move(lights);
    return capture_with({.width = 200, .height = 200, .shadows = count}, scene, from_above(12.0f));
  };
  const Picture both = shadows({sun, plain, key_lamp(lamp)}, kMostShadows);
  EXPECT_EQ(both.planes.find("shadow1"), nullptr) << "a light that casts none has no plane";
  EXPECT_EQ(test::difference(both["shadow"], shadows({sun}, kMostShadows)["shadow"], 0.0).most, 0.0);
  EXPECT_EQ(test::difference(both["shadow2"], shadows({key_lamp(lamp)}, kMostShadows)["shadow"], 0.0).most, 0.0);
  const auto inside = [&](glm::dvec3 p) {
    return inside_square(p + (glm::dvec3(lamp) - p) * ((2.0 - p.z) / (lamp.z - p.z)));
  };
  const ShadowErrors errors = compare_shadow(both, inside, 2e-3, "shadow2");
  EXPECT_EQ(errors.wrongly_dark, 0);
  EXPECT_EQ(errors.wrongly_lit, 0);
  EXPECT_GT(errors.dark, 500);
  EXPECT_GT(errors.lit, 5000);
  // No more are traced than are asked for, and no more than there are planes.
  const Picture first = shadows({sun, plain, key_lamp(lamp)}, 1);
  EXPECT_EQ(first.planes.find("shadow2"), nullptr);
  EXPECT_EQ(test::difference(first["shadow"], both["shadow"], 0.0).most, 0.0);
  const Picture many = shadows(std::vector<Light>(12, sun), kMostShadows);
  EXPECT_NE(many.planes.find("shadow7"), nullptr);
  EXPECT_EQ(many.planes.find("shadow8"), nullptr);
  EXPECT_EQ(test::difference(many["shadow7"], both["shadow"], 0.0).most, 0.0);
}

TEST(Capture, EmissionIsAPlaneWhereAnyMaterialShines) {
  Scene scene = square_over_ground();
  scene.materials.push_back({.emission = {3.0f, 0.5f, 0.25f}});
  scene.meshes[1].material = 1;
  const Picture picture = capture(scene, from_above(24.0f), 96, 96);
  long shining = 0, background = 0;
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x) {
      const float object = picture["object_id"].at(x, y);
      ASSERT_EQ(picture["emission.r"].at(x, y), object == 1.0f ? 3.0f : 0.0f);
      ASSERT_EQ(picture["emission.g"].at(x, y), object == 1.0f ? 0.5f : 0.0f);
      ASSERT_EQ(picture["emission.b"].at(x, y), object == 1.0f ? 0.25f : 0.0f);
      shining += object == 1.0f;
      background += object == -1.0f;
    }
  EXPECT_GT(shining, 30);
  EXPECT_GT(background, 1000);
  EXPECT_EQ(capture(square_over_ground(), from_above(24.0f), 8, 8).planes.find("emission.r"), nullptr);
}

TEST(Capture, EmissionIsTextured) {
  // White on the left; two texels of a kind, so that their middle is not blended.
  Texture halves{"halves", 4, 1, {255, 255, 255, 255, 255, 255, 255, 255, 0, 0, 0, 255, 0, 0, 0, 255}};
  Material lamp;
  lamp.emission = {4, 2, 0};
  lamp.emission_texture = 0;
  Scene scene;
  scene.meshes = {square(1.0f)};
  scene.materials = {lamp};
  scene.textures = {halves};
  ASSERT_EQ(finish_scene(scene), 0u);
  constexpr int kSize = 150;  // too large for capture_with's own look at the GPU, whose blends differ in the last bit
  const CaptureSettings settings{kSize, kSize};
  const Camera camera = from_above(2.0f);
  std::vector<Image> pictures = {capture_with(settings, scene, camera).planes};
  for (const VulkanCapture how : test::kGpuCaptures)
    if (Device* const gpu = test::drawing_device(how)) {
      const test::NoMessages no_messages;
      pictures.push_back(test::captured(*gpu, scene, camera, settings));
    }
  for (const Image& picture : pictures)
    for (int y = 5; y < kSize; y += 10) {
      EXPECT_NEAR(picture.plane("emission.r").at(30, y), 4.0f, 1e-4f);
      EXPECT_NEAR(picture.plane("emission.g").at(30, y), 2.0f, 1e-4f);
      EXPECT_NEAR(picture.plane("emission.r").at(120, y), 0.0f, 1e-4f);
      EXPECT_EQ(picture.plane("albedo.r").at(30, y), picture.plane("albedo.r").at(120, y)) << "it has no texture";
    }
}

TEST(Capture, WhatIsBehindAPointLightThrowsNoShadow) {
  Scene scene = square_over_ground();
  scene.lights = {key_lamp({3.0f, -0.2f, 1.0f})};  // lower than the square, which it would darken from x = 4.7 on
  const Picture picture = capture(scene, from_above(12.0f), 64, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const float object = picture["object_id"].at(x, y);
      if (object == 0.0f) {
        ASSERT_EQ(picture["shadow"].at(x, y), 1.0f) << x << ',' << y;
      }
      if (object == 1.0f) {
        ASSERT_EQ(picture["shadow"].at(x, y), 0.0f) << "the upper side is turned away";
      }
    }
}

TEST(Capture, ShadowsBeginWhereTheNormalsOfACoarseBallTurnAway) {
  // A ball of few triangles with a ball's normals: where light grazes it, its triangles stand in each other's way. Its
  // shadow begins where the smooth ball's does, and is not jagged by more than a few degrees.
  constexpr int kRings = 16;
  Mesh ball;
  for (int j = 0; j <= kRings; ++j)
    for (int i = 0; i <= 2 * kRings; ++i) {
      const double polar = std::numbers::pi * j / kRings, turn = std::numbers::pi * i / kRings;
      const glm::dvec3 at(std::sin(polar) * std::cos(turn), std::cos(polar), std::sin(polar) * std::sin(turn));
      ball.positions.push_back(glm::vec3(at));
      ball.normals.push_back(glm::vec3(at));
    }
  for (int j = 0; j < kRings; ++j)
    for (int i = 0; i < 2 * kRings; ++i) {
      const std::uint32_t a = std::uint32_t(j * (2 * kRings + 1) + i), b = a + 2 * kRings + 1;
      if (j > 0) ball.indices.insert(ball.indices.end(), {a, a + 1, b});
      if (j + 1 < kRings) ball.indices.insert(ball.indices.end(), {b, a + 1, b + 1});
    }
  Scene scene = scene_of({ball});
  const glm::dvec3 towards = glm::normalize(glm::dvec3(1.0, 0.37, 0.21));  // along no edge
  scene.lights = {key_light(glm::vec3(towards))};
  const Picture planes = capture(scene, from_above(1.2f), 160, 160);
  int lit = 0, dark = 0, wrong = 0;
  for (int y = 0; y < 160; ++y)
    for (int x = 0; x < 160; ++x) {
      if (!std::isfinite(planes.depth(x, y))) continue;
      const double facing = glm::dot(planes.normal(x, y), towards);  // the camera's axes are the world's
      const bool shines = planes["shadow"].at(x, y) > 0.5f;
      (facing > 0.0 ? lit : dark) += 1;
      wrong += shines != (facing > 0.0);
    }
  EXPECT_GT(lit, 3000);
  EXPECT_GT(dark, 3000);
  EXPECT_LT(wrong, (lit + dark) / 200);
}

TEST(Capture, LightFromBelowLeavesTheUpperSideInShadow) {
  Scene scene = scene_of({square(8.0f)});
  scene.lights = {key_light({0.3f, 0.1f, -1.0f})};
  const Picture picture = capture(scene, from_above(4.0f), 8, 8);
  for (int x = 0; x < 8; ++x) EXPECT_EQ(picture["shadow"].at(x, 5), 0.0f);
  // From below it is lit.
  const Camera below = orthographic_camera({0, 0, -10}, {0, 0, 0}, {0, 1, 0}, 4.0f, 1.0f);
  const Picture other = capture(scene, below, 8, 8);
  for (int x = 0; x < 8; ++x) EXPECT_EQ(other["shadow"].at(x, 5), 1.0f);
}

TEST(Capture, OnlyAKeyLightThatCastsHasAShadow) {
  Scene scene = square_over_ground();
  Light light = key_light({0.9f, 0.5f, 1.0f});
  const auto darkest = [&](const std::vector<Light>& lights) {
    scene.lights = lights;
    const Picture picture = capture(scene, from_above(10.0f), 64, 64);
    float least = 1.0f;
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) least = std::min(least, picture["shadow"].at(x, y));
    return least;
  };
  EXPECT_EQ(darkest({light}), 0.0f);
  Light plain = light;
  plain.casts_shadow = false;
  EXPECT_EQ(darkest({plain}), 1.0f);
  EXPECT_EQ(darkest({plain, light}), 1.0f);
  EXPECT_EQ(darkest({}), 1.0f);
  EXPECT_EQ(darkest({{.kind = LightKind::kHead, .casts_shadow = true}}), 1.0f);
}

TEST(Capture, ShadowsCanBeLeftOut) {
  Scene scene = square_over_ground();
  scene.lights = {key_light({0.9f, 0.5f, 1.0f})};
  const auto device = make_cpu_device();
  ASSERT_TRUE(device->prepare(scene));
  const auto frame = device->capture(from_above(10.0f), {32, 32, false});
  const Image image = *device->download(*frame, {"shadow"});
  EXPECT_EQ(test::difference(image.planes[0], Plane(32, 32, 1.0f), 0.0).most, 0.0);
}

/// square_over_ground with a square hole of side 1 cut into the middle of the upper square.
Scene holed_square_over_ground() {
  Scene scene = square_over_ground();
  scene.textures = {texture_of(64, 64, [](int x, int y) {
    const bool hole = x >= 16 && x < 48 && y >= 16 && y < 48;
    return glm::ivec4(200, 200, 200, hole ? 0 : 255);
  })};
  Material leaf;
  leaf.albedo = glm::vec3(1.0f);
  leaf.texture = 0;
  leaf.alpha_mask = true;
  scene.materials.push_back(leaf);
  scene.meshes[1].material = 1;
  return scene;
}

TEST(Capture, MasksCutHoles) {
  const Picture picture = capture(holed_square_over_ground(), from_above(4.0f), 128, 128);
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 128; ++x) {
      const glm::dvec3 p = ray_of(picture.info, x, y).origin;
      const double square = inside_square(p), hole = square - 0.5;
      if (std::fabs(square) < 0.02 || std::fabs(hole) < 0.04) continue;  // a texel is 1/32 wide
      const bool solid = square > 0.0 && hole < 0.0;
      ASSERT_EQ(picture["object_id"].at(x, y), solid ? 1.0f : 0.0f) << x << ',' << y;
      ASSERT_NEAR(picture.depth(x, y), solid ? 8.0 : 10.0, 1e-4);
      if (solid) {
        ASSERT_NEAR(picture["albedo.r"].at(x, y), linear(200), 0.01);
      }
    }
}

TEST(Capture, MasksCutHolesIntoShadows) {
  Scene scene = holed_square_over_ground();
  const glm::vec3 towards(0.9f, 0.5f, 1.0f);
  scene.lights = {key_light(towards)};
  const Picture picture = capture(scene, from_above(12.0f), 256, 256);
  const auto inside = [&](glm::dvec3 p) {
    const double square = inside_square(p + glm::dvec3(towards) * ((2.0 - p.z) / towards.z));
    return std::min(square, 0.5 - square);
  };
  const ShadowErrors errors = compare_shadow(picture, inside, 0.04);
  EXPECT_EQ(errors.wrongly_dark, 0);
  EXPECT_EQ(errors.wrongly_lit, 0);
  EXPECT_GT(errors.dark, 500);
}

TEST(Capture, AMaskWithoutAlphaOrCoordinatesCutsNothing) {
  Scene scene = holed_square_over_ground();
  scene.meshes[1].uvs.clear();
  const Picture picture = capture(scene, from_above(4.0f), 64, 64);
  EXPECT_EQ(picture["object_id"].at(36, 35), 1.0f);  // the middle of the square
}

struct Place {
  float scale, offset;  // offset from the origin in sizes of the scene
};

class ShadowAcne : public testing::TestWithParam<Place> {};

TEST_P(ShadowAcne, OpenGroundIsLitEverywhere) {
  const auto [scale, offset] = GetParam();
  // A tilted ground of many triangles, whose corners are rounded to floats where it stands.
  const glm::vec3 middle = offset * scale * glm::normalize(glm::vec3(0.6f, 0.3f, -0.8f));
  const glm::vec3 u1(2.0f, 0.1f, 0.3f), v1(-0.2f, 1.9f, 0.4f);
  Mesh ground = shapes::quad(-0.5f * (u1 + v1), 0.5f * (u1 - v1), 0.5f * (u1 + v1), 0.5f * (v1 - u1), 40, 40);
  for (glm::vec3& p : ground.positions) p = p * scale + middle;
  const glm::vec3 normal = glm::normalize(glm::cross(u1, v1));
  const glm::vec3 along = glm::normalize(u1);
  for (const float lamp : {0.0f, 0.5f, 2.0f, 6.0f, 30.0f})  // how far; 0: the sun
    for (const float sine : {0.06f, 0.3f, 1.0f}) {
      Scene scene = scene_of({ground});
      const glm::vec3 towards = sine * normal + std::sqrt(1.0f - sine * sine) * along;
      scene.lights = {lamp > 0.0f ? key_lamp(middle + lamp * scale * towards) : key_light(towards)};
      for (const float elevation : {0.15f, 0.9f}) {
        const glm::vec3 eye = middle + scale * (4.0f * elevation * normal - 3.0f * glm::normalize(v1));
        const Picture picture = capture(scene, perspective_camera(eye, middle, normal, 35.0f, 1.0f), 160, 160);
        long dark = 0, hits = 0;
        for (int y = 0; y < 160; ++y)
          for (int x = 0; x < 160; ++x) {
            if (!std::isfinite(picture.depth(x, y))) continue;
            ++hits;
            dark += picture["shadow"].at(x, y) != 1.0f;
          }
        EXPECT_EQ(dark, 0) << "of " << hits << (lamp > 0.0f ? ", lamp " : ", sun ") << lamp << " at " << sine
                           << ", seen from " << elevation;
        EXPECT_GT(hits, 1000);
      }
    }
}

TEST_P(ShadowAcne, ThingsOnTheGroundKeepTheirShadow) {
  const auto [scale, offset] = GetParam();
  // A box on the ground throws a shadow as long as it is high, which begins at its foot.
  const glm::vec3 middle = offset * scale * glm::normalize(glm::vec3(0.6f, 0.3f, -0.8f));
  Mesh ground = square(2.0f), box = shapes::box({-0.5f, -0.5f, 0.0f}, {0.5f, 0.5f, 0.5f});
  for (Mesh* mesh : {&ground, &box})
    for (glm::vec3& p : mesh->positions) p = p * scale + middle;
  Scene scene = scene_of({ground, box});
  scene.lights = {key_light({-1.0f, 0.0f, 1.0f})};
  const Camera camera =
      orthographic_camera(middle + glm::vec3(0, 0, 5.0f * scale), middle, {0, 1, 0}, 4.0f * scale, 1.0f);
  const Picture picture = capture(scene, camera, 100, 100);
  // Row 50 runs across the middle of the box; the shadow lies from x = 0.5 to 1, which is pixels 62 to 74.
  long dark = 0;
  for (int x = 0; x < 100; ++x) dark += picture["object_id"].at(x, 50) == 0.0f && picture["shadow"].at(x, 50) == 0.0f;
  EXPECT_NEAR(dark, 12, 2);
  EXPECT_EQ(picture["shadow"].at(66, 50), 0.0f);
  EXPECT_EQ(picture["shadow"].at(80, 50), 1.0f);
  EXPECT_EQ(picture["shadow"].at(30, 50), 1.0f);
}

INSTANTIATE_TEST_SUITE_P(Scales, ShadowAcne,
                         testing::Values(Place{1e-12f, 0.0f}, Place{1e12f, 0.0f}, Place{1e-3f, 0.0f}, Place{1.0f, 0.0f},
                                         Place{1e4f, 0.0f}, Place{1e-3f, 1e3f}, Place{1.0f, 1e3f}, Place{1e4f, 1e3f}),
                         [](const auto& info) {
                           const long power = std::lround(std::log10(info.param.scale));
                           return fmt::format("Scale{}1e{}{}", power < 0 ? "Minus" : "", std::abs(power),
                                              info.param.offset > 0.0f ? "Far" : "AtOrigin");
                         });

// ---- sizes, threads, devices ----

Scene mixed_scene() {
  Scene scene = holed_square_over_ground();
  Mesh ball = shapes::sphere(1.0f, 40, 20);
  for (glm::vec3& p : ball.positions) p += glm::vec3(-2.0f, 1.0f, 1.0f);
  ball.object = 2;
  scene.meshes.push_back(ball);
  finish_scene(scene);
  scene.lights = {key_light({0.9f, 0.5f, 1.0f})};
  return scene;
}

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
        const Ray ray = ray_of(picture.info, x, y);
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

TEST(Capture, ThreadsDoNotMatter) {
  const Scene scene = mixed_scene();
  const Camera camera = perspective_camera({-5, -6, 9}, {-1, -1, 0}, {0, 0, 1}, 40.0f, 0.6f);
  const Picture one = capture(scene, camera, 120, 200, {.threads = 1});
  for (const int threads : {1, 2, 7})
    expect_equal(one.planes, capture(scene, camera, 120, 200, {.threads = threads}).planes,
                 fmt::format("{} threads", threads));
}

TEST(Capture, ADeviceTakesOneSceneAfterTheOther) {
  const Scene first = mixed_scene(), second = scene_of({square(3.0f, 1.5f)});
  const Camera camera = from_above(10.0f);
  const auto device = make_cpu_device();
  const auto draw = [&](const Scene& scene) {
    EXPECT_TRUE(device->prepare(scene));
    return *device->download(*device->capture(camera, {64, 64, true}), {});
  };
  const Image a = draw(first), b = draw(second), again = draw(first), twice = draw(first);
  expect_equal(a, capture(first, camera, 64, 64).planes, "first");
  expect_equal(b, capture(second, camera, 64, 64).planes, "second");
  expect_equal(a, again, "first again");
  expect_equal(a, twice, "prepared twice");
  EXPECT_GT(test::difference(a.plane("depth"), b.plane("depth"), 0.0).most, 0.5);
}

TEST(Capture, FramesOfOneDeviceAreApart) {
  const Scene scene = mixed_scene();
  const auto device = make_cpu_device();
  ASSERT_TRUE(device->prepare(scene));
  const auto small = device->capture(from_above(10.0f), {20, 10, true});
  const auto large = device->capture(from_above(5.0f), {40, 30, true});
  EXPECT_EQ(device->download(*small, {})->width, 20);
  EXPECT_EQ(device->download(*large, {"depth"})->height, 30);
  EXPECT_EQ(small->info.width, 20);
}

TEST(Device, SaysWhichPlaneIsMissing) {
  const auto device = make_cpu_device();
  GBuffer g = test::empty_gbuffer(4, 3);
  const Effect& effect = *find_effect("lighting");
  const ParameterBytes params = initial_parameters(effect.parameters, effect.params_size);
  auto frame = device->upload(g);
  ASSERT_TRUE(frame);
  const auto done = device->run(effect, params, *frame);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().kind, ErrorKind::kUsage);
  EXPECT_NE(done.error().message.find("lighting needs the plane 'depth'"), std::string::npos) << done.error().message;
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
  const Image image = *device->download(*frame, {});
  EXPECT_EQ(image.planes.size(), 2 * g.layers[0].planes.size());
  for (std::size_t p = 0; p < g.layers[0].planes.size(); ++p)
    EXPECT_EQ(test::difference(image.plane(g.layers[0].names[p]), g.layers[0].planes[p], 0.0).most, 0.0);
  EXPECT_EQ(image.plane("layer1.depth").at(5, 6), 99.0f);
  const Image two = *device->download(*frame, {"normal.y", "depth"});
  EXPECT_EQ(two.names, (std::vector<std::string>{"normal.y", "depth"}));
}

TEST(Device, NeutralValuesStandInForPlanesThatAreMissing) {
  // Depth and normals alone are enough to light a picture.
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

// ---- picture_info
// ------------------------------------------------------------------------------------------------------

TEST(PictureInfo, DepthsSpanTheScene) {
  const Scene scene = scene_of({shapes::box({-1, -2, -3}, {1, 2, 3})});
  const PictureInfo info = picture_info(scene, from_above(4.0f, 2.0f, 10.0f), {.width = 64, .height = 32});
  EXPECT_EQ(info.width, 64);
  EXPECT_EQ(info.height, 32);
  EXPECT_NEAR(info.depth_min, 7.0f, 1e-5);
  EXPECT_NEAR(info.depth_max, 13.0f, 1e-5);
  EXPECT_NEAR(info.scene_radius, std::sqrt(1.0 + 4.0 + 9.0), 1e-5);
}

TEST(PictureInfo, CapturedDepthsLieWithin) {
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
        // From inside, surfaces may be nearer than the share of the farthest depth that depth_min keeps.
        ASSERT_GE(depth, std::min(picture.info.depth_min, 1e-3f * picture.info.depth_max) * 0.999999f);
      }
    EXPECT_GT(hits, 1000);
  }
}

TEST(PictureInfo, IsSaneWhereTheSceneIsBehindTheCamera) {
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

// ---- depth layers
// ------------------------------------------------------------------------------------------------------

/// How many surfaces a pixel has, which lie in its first layers.
int surfaces_at(const Picture& picture, int layers, int x, int y) {
  int count = 0;
  for (int layer = 0; layer < layers; ++layer)
    if (std::isfinite(picture[layer_plane(layer, "depth")].at(x, y))) {
      EXPECT_EQ(count, layer) << "a surface behind an empty layer at " << x << ',' << y;
      ++count;
    }
  return count;
}

void expect_empty(const Picture& picture, int layer, int x, int y) {
  SCOPED_TRACE(fmt::format("layer {} at {},{}", layer, x, y));
  const auto value = [&](const char* name) { return picture[layer_plane(layer, name)].at(x, y); };
  EXPECT_EQ(value("depth"), kInfinity);
  for (const char* name :
       {"normal.x", "normal.y", "normal.z", "albedo.r", "albedo.g", "albedo.b", "specular", "shininess"})
    EXPECT_EQ(value(name), 0.0f) << name;
  for (const char* name : {"object_id", "material_id"}) EXPECT_EQ(value(name), -1.0f) << name;
  EXPECT_EQ(value("shadow"), 1.0f);
}

glm::dvec3 layer_normal(const Picture& picture, int layer, int x, int y) {
  const auto value = [&](const char* name) { return double(picture[layer_plane(layer, name)].at(x, y)); };
  return {value("normal.x"), value("normal.y"), value("normal.z")};
}

TEST(CaptureLayers, ParallelSheetsComeInOrder) {
  const float heights[] = {0.5f, 2.0f, -1.0f, 1.0f};
  std::vector<Mesh> sheets;
  for (const float height : heights) sheets.push_back(square(8.0f, height));
  const Scene scene = scene_of(sheets, {Material{}, Material{}});
  const int order[] = {1, 3, 0, 2};
  for (const Camera& camera : {perspective_camera({0.3f, -0.2f, 7.0f}, {0.3f, -0.2f, 0}, {0, 1, 0}, 40.0f, 1.0f),
                               orthographic_camera({0.3f, -0.2f, 7.0f}, {0, 0, 0}, {0, 1, 0}, 6.0f, 1.0f)}) {
    const Picture picture = capture_with({33, 33, false, 6}, scene, camera);
    ASSERT_EQ(picture.planes.planes.size(), 6u * 12u);
    for (int y = 0; y < 33; ++y)
      for (int x = 0; x < 33; ++x) {
        const Ray ray = ray_of(picture.info, x, y);
        for (int layer = 0; layer < 4; ++layer) {
          const int sheet = order[layer];
          const double depth = (heights[sheet] - ray.origin.z) / ray.direction.z;
          ASSERT_NEAR(picture[layer_plane(layer, "depth")].at(x, y), depth, 2e-6 * depth) << layer;
          ASSERT_EQ(picture[layer_plane(layer, "object_id")].at(x, y), float(sheet));
          ASSERT_EQ(picture[layer_plane(layer, "material_id")].at(x, y), float(sheet % 2));
        }
        expect_empty(picture, 4, x, y);
        expect_empty(picture, 5, x, y);
      }
  }
}

TEST(CaptureLayers, ABoxHasItsBackBehindItsFront) {
  const Scene scene = scene_of({shapes::box({-1, -1, -1}, {1, 1, 1})});
  const Picture picture =
      capture_with({64, 64, true, 3}, scene, perspective_camera({0, 0, 6}, {0, 0, 0}, {0, 1, 0}, 25.0f, 1.0f));
  long seen = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const glm::dvec3 at_back = ray_of(picture.info, x, y).at(7.0);
      if (std::max(std::fabs(at_back.x), std::fabs(at_back.y)) > 0.99) continue;  // leaves through a side
      ++seen;
      ASSERT_NEAR(picture.depth(x, y), 5.0f, 1e-5);
      ASSERT_NEAR(picture["layer1.depth"].at(x, y), 7.0f, 1e-5);
      ASSERT_EQ(layer_normal(picture, 0, x, y), glm::dvec3(0, 0, 1));
      ASSERT_EQ(layer_normal(picture, 1, x, y), glm::dvec3(0, 0, 1)) << "the inside of the back faces the camera";
      expect_empty(picture, 2, x, y);
    }
  EXPECT_GT(seen, 500);
}

TEST(CaptureLayers, ASphereIsAsThickAsItsChord) {
  constexpr double kRadius = 2.0;
  const Scene scene = scene_of({shapes::sphere(float(kRadius), 192, 96)});
  const glm::vec3 eye(4, 5, 6);
  for (const Camera& camera : {perspective_camera(eye, {0, 0, 0}, {0, 1, 0}, 30.0f, 1.0f),
                               orthographic_camera(eye, {0, 0, 0}, {0, 1, 0}, 4.4f, 1.0f)}) {
    const Picture picture = capture_with({97, 97, false, 3}, scene, camera);
    long compared = 0;
    for (int y = 0; y < 97; ++y)
      for (int x = 0; x < 97; ++x) {
        const Ray ray = ray_of(picture.info, x, y);
        const double a = glm::dot(ray.direction, ray.direction), b = glm::dot(ray.direction, ray.origin);
        const double root = b * b - a * (glm::dot(ray.origin, ray.origin) - kRadius * kRadius);
        if (root < 0.0) {
          expect_empty(picture, 0, x, y);
          continue;
        }
        const double facing = std::sqrt(root / a) / kRadius;
        if (facing < 0.15) continue;  // the mesh's silhouette is a polygon
        ++compared;
        const double chord = 2.0 * std::sqrt(root) / a;
        ASSERT_NEAR(picture["layer1.depth"].at(x, y) - picture.depth(x, y), chord, 2e-3 / facing) << x << ',' << y;
        for (const int layer : {0, 1})
          ASSERT_LT(glm::dot(layer_normal(picture, layer, x, y),
                             glm::dmat3(glm::mat3(camera.view_from_world)) * ray.direction),
                    0.0)
              << "layer " << layer;
        expect_empty(picture, 2, x, y);
      }
    EXPECT_GT(compared, 4000);
  }
}

TEST(CaptureLayers, RaysEnterAndLeaveClosedSolids) {
  // Rays through edges and vertices meet several triangles in one place; that is one surface.
  struct Solid {
    const char* name;
    Mesh mesh;
    bool convex;
  };
  const auto round = [](glm::vec3) { return 1.0f; };
  Mesh cone = shapes::cone(0.9f, 0.3f, 0.8f, 24, 3);
  for (glm::vec3& p : cone.positions) p.y -= 0.41f;  // its foot is in the plane of no ray
  const Solid solids[] = {{"coarse sphere", shapes::sphere(1.0f, 16, 8), true},
                          {"fine sphere", shapes::sphere(1.0f, 90, 60), true},
                          {"box", shapes::box({-0.7f, -0.8f, -0.9f}, {0.9f, 0.8f, 0.7f}), true},
                          {"cone", cone, true},
                          {"sphere of quads that are not flat", shapes::cube_sphere(8, round), false},
                          {"torus", shapes::torus(0.7f, 0.3f, 48, 24), false}};
  for (const Solid& solid : solids) {
    const Scene scene = scene_of({solid.mesh});
    for (const glm::vec3 eye : {glm::vec3(0, 0, 5), glm::vec3(5, 0, 0), glm::vec3(3.0f, 3.1f, 2.9f)})
      for (const Camera& camera : {perspective_camera(eye, {0, 0, 0}, {0.1f, 1, 0}, 40.0f, 1.0f),
                                   orthographic_camera(eye, {0, 0, 0}, {0, 1, 0.1f}, 3.0f, 1.0f)}) {
        constexpr int kLayers = 6;
        const Picture picture = capture_with({65, 65, false, kLayers}, scene, camera);
        long hit = 0, wrong = 0;
        for (int y = 0; y < 65; ++y)
          for (int x = 0; x < 65; ++x) {
            const int count = surfaces_at(picture, kLayers, x, y);
            hit += count > 0;
            wrong += solid.convex ? count != 0 && count != 2 : count % 2 != 0;
          }
        EXPECT_EQ(wrong, 0) << solid.name << ", of " << hit;
        EXPECT_GT(hit, 300) << solid.name;
      }
  }
}

TEST(CaptureLayers, AGridsVerticesAndDiagonalsAreOneSurface) {
  // Pixel centres fall on the vertices of 17 x 17, and on the diagonals of 16 x 16.
  const auto grid = [](float half, int cells) {
    return scene_of(
        {shapes::quad({-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}, cells, cells)});
  };
  for (const auto& [pixels, height] : {std::pair{17, 4.25f}, {16, 4.0f}}) {
    const Picture picture = capture_with({pixels, pixels, false, 3}, grid(2.25f, 18), from_above(height));
    for (int y = 0; y < pixels; ++y)
      for (int x = 0; x < pixels; ++x) ASSERT_EQ(surfaces_at(picture, 3, x, y), 1) << x << ',' << y;
  }
  // Whether a rim that falls on pixel centres belongs to the surface is a matter of rounding: with fused multiply-adds
  // all of it does for Embree's rays, without (SSE4.2) a half, as where triangles are drawn. So the rim is cut off.
  const auto inside = [](Image image) {
    Image out(image.width - 2, image.height - 2);
    for (std::size_t p = 0; p < image.planes.size(); ++p) out.add(image.names[p]) = cropped(image.planes[p], 1);
    return out;
  };
  if (Device* const gpu = test::drawing_device(VulkanCapture::kRays)) {
    const Scene scene = grid(2.0f, 16);
    const CaptureSettings settings{.width = 17, .height = 17, .layers = 3};
    const test::Deviation d =
        test::deviation({inside(test::captured(*gpu, scene, from_above(4.25f), settings)),
                         inside(test::captured(*make_cpu_device(), scene, from_above(4.25f), settings))},
                        settings.layers);
    EXPECT_LE(d.anywhere, d.pixels / 200);
    for (const auto& [plane, count] : d.inside) EXPECT_LE(count, d.pixels / 500) << plane;
  }
}

TEST(CaptureLayers, SheetsOfPaperAreOneFromAfarAndTwoFromNear) {
  for (const float scale : {1.0f, 0x1p-20f, 0x1p30f}) {
    const float distance = 8.0f * scale;
    for (const auto& [share, surfaces] : {std::pair{0.8e-5f, 1}, {1e-4f, 2}}) {
      const Scene scene = scene_of({square(scale), square(scale, -share * distance)});
      const glm::vec3 eye(0, 0, distance), middle(0, 0, 0), up(0, 1, 0);
      for (const Camera& camera : {perspective_camera(eye, middle, up, 10.0f, 1.0f),
                                   orthographic_camera(eye, middle, up, 1.5f * scale, 1.0f)}) {
        const Picture picture = capture_with({16, 16, false, 3}, scene, camera);
        for (int y = 0; y < 16; ++y)
          for (int x = 0; x < 16; ++x)
            ASSERT_EQ(surfaces_at(picture, 3, x, y), surfaces) << share << " at scale " << scale;
      }
    }
  }
}

TEST(CaptureLayers, MasksCutHolesInEveryLayer) {
  const Scene scene = holed_square_over_ground();
  const glm::vec3 above(0, 0, 10), below(0, 0, -10), origin(0, 0, 0);
  for (const glm::vec3 eye : {above, below}) {
    const Picture picture =
        capture_with({96, 96, false, 3}, scene, orthographic_camera(eye, origin, {0, 1, 0}, 4.0f, 1.0f));
    long holes = 0, solids = 0;
    for (int y = 0; y < 96; ++y)
      for (int x = 0; x < 96; ++x) {
        const double square = inside_square(ray_of(picture.info, x, y).origin), hole = square - 0.5;
        if (std::fabs(square) < 0.02 || std::fabs(hole) < 0.04) continue;  // a texel is 1/32 wide
        const bool solid = square > 0.0 && hole < 0.0;
        (solid ? solids : holes) += 1;
        ASSERT_EQ(surfaces_at(picture, 3, x, y), solid ? 2 : 1) << x << ',' << y;
        const int ground = solid && eye == above ? 1 : 0;
        ASSERT_EQ(picture[layer_plane(ground, "object_id")].at(x, y), 0.0f);
        if (solid) {
          ASSERT_EQ(picture[layer_plane(1 - ground, "object_id")].at(x, y), 1.0f);
        }
      }
    EXPECT_GT(holes, 1000);
    EXPECT_GT(solids, 500);
  }
}

TEST(CaptureLayers, EveryLayerHasItsShadow) {
  Scene scene = square_over_ground();
  scene.lights = {key_light({0, 0, 1})};
  const Picture picture = capture_with({64, 64, true, 2}, scene, from_above(4.0f));
  long under = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const double inside = inside_square(ray_of(picture.info, x, y).origin);
      if (std::fabs(inside) < 2e-3) continue;
      ASSERT_EQ(picture["shadow"].at(x, y), 1.0f);
      ASSERT_EQ(picture["layer1.shadow"].at(x, y), inside > 0.0 ? 0.0f : 1.0f);
      under += inside > 0.0;
    }
  EXPECT_GT(under, 900);
}

TEST(CaptureLayers, TriangleSoupMatchesALiteralSearch) {
  Mesh soup;
  constexpr unsigned kTriangles = 120;
  const auto random = [](unsigned i) { return 2.0f * (float(test::hash(i) >> 8) * 0x1p-24f) - 1.0f; };
  for (unsigned i = 0; i < 3 * kTriangles; ++i) {
    soup.positions.emplace_back(random(3 * i), random(3 * i + 1), random(3 * i + 2));
    soup.indices.push_back(i);
  }
  const Scene scene = scene_of({soup});
  for (const Camera& camera : {perspective_camera({2, 3, 4}, {0, 0, 0}, {0, 1, 0}, 30.0f, 1.0f),
                               orthographic_camera({2, 3, 4}, {0, 0, 0}, {0, 1, 0}, 3.0f, 1.0f),
                               perspective_camera({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 80.0f, 1.0f)}) {  // inside
    const Picture picture = capture_with({60, 60, false, kMostLayers}, scene, camera);
    long compared = 0, most = 0;
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 60; ++x) {
        const Ray ray = ray_of(picture.info, x, y);
        std::vector<double> depths;
        bool clear = true;  // no edge and no second surface so near that rounding decides
        for (unsigned i = 0; i < kTriangles; ++i) {
          const glm::dvec3 a(soup.positions[3 * i]), b(soup.positions[3 * i + 1]), c(soup.positions[3 * i + 2]);
          // [Moeller and Trumbore 1997]
          const glm::dvec3 p = glm::cross(ray.direction, c - a), q = glm::cross(ray.origin - a, b - a);
          const double whole = glm::dot(b - a, p);
          const double u = glm::dot(ray.origin - a, p) / whole, v = glm::dot(ray.direction, q) / whole;
          const double depth = glm::dot(c - a, q) / whole, margin = std::min({u, v, 1.0 - u - v});
          constexpr double kMargin = 1e-4;
          clear = clear && std::fabs(margin) > kMargin && std::fabs(depth) > kMargin;
          if (margin > 0.0 && depth > 0.0) depths.push_back(depth);
        }
        std::sort(depths.begin(), depths.end());
        constexpr double kApart = 5e-4;
        for (std::size_t k = 1; k < depths.size(); ++k) clear = clear && depths[k] - depths[k - 1] > kApart;
        if (!clear) continue;
        ++compared;
        most = std::max(most, long(depths.size()));
        ASSERT_EQ(surfaces_at(picture, kMostLayers, x, y), int(std::min(depths.size(), std::size_t(kMostLayers))))
            << x << ',' << y;
        for (std::size_t k = 0; k < depths.size() && k < std::size_t(kMostLayers); ++k)
          ASSERT_NEAR(picture[layer_plane(int(k), "depth")].at(x, y), depths[k], 1e-4);
      }
    EXPECT_GT(compared, 2000);
    EXPECT_GT(most, 8);
  }
}

TEST(CaptureLayers, TheNumberOfLayersChangesNoLayer) {
  const Scene scene = mixed_scene();
  const Camera camera = perspective_camera({-5, -6, 9}, {-1, -1, 0}, {0, 0, 1}, 40.0f, 0.6f);
  const Picture four = capture_with({61, 103, true, 4}, scene, camera);
  for (const int layers : {1, 2, 3}) {
    const Picture fewer = capture_with({61, 103, true, layers}, scene, camera);
    ASSERT_EQ(fewer.planes.planes.size(), std::size_t(layers) * 12u);
    for (std::size_t p = 0; p < fewer.planes.planes.size(); ++p) {
      ASSERT_EQ(fewer.planes.names[p], four.planes.names[p]);
      EXPECT_EQ(test::difference(fewer.planes.planes[p], four.planes.planes[p], 0.0).most, 0.0)
          << layers << ": " << fewer.planes.names[p];
    }
  }
}

TEST(CaptureLayers, ThreadsDoNotMatter) {
  const Scene scene = mixed_scene();
  const Camera camera = perspective_camera({-5, -6, 9}, {-1, -1, 0}, {0, 0, 1}, 40.0f, 0.6f);
  const CaptureSettings settings{.width = 90, .height = 150, .layers = 3};
  const Picture one = capture_with(settings, scene, camera, {.threads = 1});
  for (const int threads : {2, 7})
    expect_equal(one.planes, capture_with(settings, scene, camera, {.threads = threads}).planes,
                 fmt::format("{} threads", threads));
}

TEST(CaptureLayers, SmallAndOddSizes) {
  const Scene scene = scene_of({square(8.0f, 1.0f), square(8.0f)});
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 2}, {2, 3}, {17, 5}, {5, 67}}) {
    const Picture picture =
        capture_with({width, height, true, 3}, scene, from_above(4.0f, float(width) / float(height)));
    ASSERT_EQ(picture["layer2.depth"].width, width);
    ASSERT_EQ(picture["layer2.depth"].height, height);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) ASSERT_EQ(surfaces_at(picture, 3, x, y), 2) << x << ',' << y;
  }
}

TEST(CaptureLayers, PowersOfTwoScaleDepthsAlone) {
  const auto picture_at = [](float scale) {
    Scene scene = mixed_scene();
    for (Mesh& mesh : scene.meshes)
      for (glm::vec3& p : mesh.positions) p *= scale;
    finish_scene(scene);
    const glm::vec3 eye(-5, -6, 9), target(-1, -1, 0);
    return capture_with({70, 70, true, 3}, scene,
                        perspective_camera(eye * scale, target * scale, {0, 0, 1}, 40.0f, 1.0f));
  };
  const Picture plain = picture_at(1.0f);
  for (const float scale : {0x1p-30f, 0x1p20f}) {
    Picture scaled = picture_at(scale);
    for (std::size_t p = 0; p < scaled.planes.planes.size(); ++p) {
      const std::string& name = scaled.planes.names[p];
      Plane& plane = scaled.planes.planes[p];
      if (name.ends_with("depth"))
        for (int y = 0; y < 70; ++y)
          for (int x = 0; x < 70; ++x) plane.at(x, y) /= scale;
      EXPECT_EQ(test::difference(plane, plain.planes.planes[p], 0.0).most, 0.0) << name << " at " << scale;
    }
  }
}

TEST(CaptureLayers, OutOfReachEveryLayerIsEmpty) {
  const Scene scene = scene_of({square(1.0f)});
  const Picture picture =
      capture_with({5, 3, true, 3}, scene, orthographic_camera({0, 0, 1e19f}, {0, 0, 0}, {0, 1, 0}, 4.0f, 1.0f));
  for (int layer = 0; layer < 3; ++layer) expect_empty(picture, layer, 2, 1);
}

// ---- other sides, other cameras
// ----------------------------------------------------------------------------------------

TEST(CaptureBackSides, AThinSheetLitFromBehindIsDarkInFrontAndLitBehind) {
  for (const bool point : {false, true}) {
    // Below the sheet the sun or a lamp shines; a smaller sheet still lower takes a part of its light.
    Scene scene = scene_of({square(4.0f), square(0.5f, -1.0f)}, {Material{.specular_strength = 0.5f}});
    scene.lights = {point ? key_lamp({0, 0, -2}) : key_light({0, 0, -1}), key_light({0, 0, 1})};
    const Picture picture = capture_with({.width = 65, .height = 65, .back_sides = true}, scene, from_above(4.0f));
    ASSERT_EQ(picture.info.more_layers.size(), 1u);
    EXPECT_EQ(picture.info.more_layers[0].kind, LayerKind::kBack);
    EXPECT_EQ(picture.info.more_layers[0].of, 0);
    const double blocked = point ? 1.0 : 0.5;  // half the width of the lower sheet's shadow
    long lit = 0, dark = 0;
    for (int y = 0; y < 65; ++y)
      for (int x = 0; x < 65; ++x) {
        const glm::dvec3 p = ray_of(picture.info, x, y).origin;
        for (const char* name : {"depth", "albedo.r", "albedo.g", "albedo.b", "object_id", "material_id"})
          ASSERT_EQ(picture[name].at(x, y), picture[layer_plane(1, name)].at(x, y)) << name;
        ASSERT_EQ(layer_normal(picture, 1, x, y), -picture.normal(x, y));
        ASSERT_EQ(picture["layer1.specular"].at(x, y), 0.0f);
        ASSERT_EQ(picture["shadow"].at(x, y), 0.0f);
        ASSERT_EQ(picture["shadow1"].at(x, y), 1.0f);
        ASSERT_EQ(picture["layer1.shadow1"].at(x, y), 0.0f) << "the upper light does not reach the lower side";
        const double outside = std::max(std::fabs(p.x), std::fabs(p.y)) - blocked;
        if (std::fabs(outside) < 2e-3) continue;
        ASSERT_EQ(picture["layer1.shadow"].at(x, y), outside > 0.0 ? 1.0f : 0.0f) << x << ',' << y;
        (outside > 0.0 ? lit : dark) += 1;
      }
    EXPECT_GT(lit, 500);
    EXPECT_GT(dark, 200);
  }
}

TEST(CaptureBackSides, InsideASolidNoLightArrives) {
  Scene scene = scene_of({shapes::sphere(1.0f, 48, 24), shapes::box({-3, -3, -1.6f}, {3, 3, -1.2f})});
  scene.lights = {key_light({0.3f, 0.2f, 1.0f}), key_lamp({2.0f, -3.0f, 1.0f}), key_light({-1.0f, 0.1f, -0.2f})};
  const Picture picture = capture_with({.width = 90, .height = 90, .layers = 2, .back_sides = true}, scene,
                                       perspective_camera({3, -4, 5}, {0, 0, -0.5f}, {0, 0, 1}, 40.0f, 1.0f));
  ASSERT_EQ(picture.info.more_layers.size(), 3u);
  EXPECT_EQ(picture.info.more_layers[0].kind, LayerKind::kBehind);
  EXPECT_EQ(picture.info.more_layers[0].of, 0);
  EXPECT_EQ(picture.info.more_layers[1].kind, LayerKind::kBack);
  EXPECT_EQ(picture.info.more_layers[1].of, 0);
  EXPECT_EQ(picture.info.more_layers[2].kind, LayerKind::kBack);
  EXPECT_EQ(picture.info.more_layers[2].of, 1);
  long inside = 0, lit = 0, outer = 0;
  for (int y = 0; y < 90; ++y)
    for (int x = 0; x < 90; ++x) {
      if (!std::isfinite(picture.depth(x, y))) continue;
      // The first surface is a solid's outside: its other side is inside. The second one is the far side of that solid,
      // seen from inside; its other side is outside again.
      for (const char* name : {"layer2.shadow", "layer2.shadow1", "layer2.shadow2"})
        inside += picture[name].at(x, y) == 0.0f;
      lit += 3;
      outer += std::isfinite(picture["layer3.depth"].at(x, y)) && picture["layer3.shadow2"].at(x, y) == 1.0f;
    }
  EXPECT_GT(lit, 3000);
  EXPECT_EQ(inside, lit);
  EXPECT_GT(outer, 100) << "the light from below and behind reaches what the camera does not see";
}

TEST(CaptureBackSides, LayersInFrontStayAsTheyAre) {
  const Scene scene = mixed_scene();
  const Camera camera = perspective_camera({-5, -6, 9}, {-1, -1, 0}, {0, 0, 1}, 40.0f, 0.6f);
  const Picture plain = capture_with({.width = 61, .height = 103, .layers = 3}, scene, camera);
  const Picture more =
      capture_with({.width = 61, .height = 103, .layers = 3, .back_sides = true, .extra_views = 2}, scene, camera);
  ASSERT_EQ(more.info.more_layers.size(), 7u);
  ASSERT_EQ(more.planes.planes.size(), plain.planes.planes.size() / 3 * 8);
  for (std::size_t p = 0; p < plain.planes.planes.size(); ++p) {
    ASSERT_EQ(plain.planes.names[p], more.planes.names[p]);
    EXPECT_EQ(test::difference(plain.planes.planes[p], more.planes.planes[p], 0.0).most, 0.0) << plain.planes.names[p];
  }
}

/// A room of 12 x 8 x 5, a pillar in it, and before the pillar a sheet that hides it from the camera.
Scene room_with_drape() {
  Scene scene = scene_of(
      {parallelogram({-6, 0, -4}, {12, 0, 0}, {0, 0, 8}), parallelogram({-6, 5, -4}, {12, 0, 0}, {0, 0, 8}),
       parallelogram({-6, 0, -4}, {12, 0, 0}, {0, 5, 0}), parallelogram({-6, 0, 4}, {12, 0, 0}, {0, 5, 0}),
       parallelogram({-6, 0, -4}, {0, 5, 0}, {0, 0, 8}), parallelogram({6, 0, -4}, {0, 5, 0}, {0, 0, 8}),
       shapes::box({0.6f, 0, -0.4f}, {1.4f, 5, 0.4f}), parallelogram({-0.5f, 0.5f, -1.5f}, {0, 3.5f, 0}, {0, 0, 3})});
  scene.up = {0, 1, 0};
  return scene;
}

TEST(CaptureExtraViews, AgreeWithTheFirstCameraAboutWhereThingsAre) {
  const Scene scene = room_with_drape();
  for (const bool orthographic : {false, true}) {
    const Camera camera = orthographic ? orthographic_camera({-4.5f, 4.4f, 2.5f}, {2, 0.5f, 0}, {0, 1, 0}, 4.5f, 1.5f)
                                       : perspective_camera({-5.5f, 2.6f, 0.3f}, {6, 2.2f, 0}, {0, 1, 0}, 60.0f, 1.5f);
    const Picture picture = capture_with({.width = 181, .height = 121, .extra_views = 4}, scene, camera);
    ASSERT_EQ(picture.info.more_layers.size(), 4u);
    const auto of_layer = [&](int layer, const char* name) -> const Plane& {
      return picture[layer_plane(layer, name)];
    };
    const glm::dvec3 axis = ray_of(picture.info, 90, 60).direction, eye = ray_of(picture.info, 90, 60).origin;
    glm::dvec3 common(0.0);
    for (int layer = 1; layer <= 4; ++layer) {
      ASSERT_EQ(picture.info.more_layers[std::size_t(layer) - 1].kind, LayerKind::kOther);
      const PictureInfo other = layer_info(picture.info, layer);
      EXPECT_EQ(other.camera.projection, camera.projection);
      EXPECT_EQ(other.width, 181);
      if (!orthographic) {
        EXPECT_LE(std::max(other.camera.right, other.camera.top), std::tan(glm::radians(55.0f)) * 1.0001f);
      }
      // Where a surface is seen by both, the point of one lies in the plane of the other.
      const glm::dmat4 other_from_world(other.camera.view_from_world);
      long agree = 0, disagree = 0;
      for (int y = 0; y < 121; ++y)
        for (int x = 0; x < 181; ++x) {
          const glm::dvec3 p = ray_of(picture.info, x, y).at(picture.depth(x, y));
          const glm::dvec3 q = glm::dvec3(other_from_world * glm::dvec4(p, 1.0));
          const double spread = orthographic ? 1.0 : -q.z;
          const double u =
              (q.x / spread - other.camera.left) / (double(other.camera.right) - other.camera.left) * 181.0;
          const double v = (other.camera.top - q.y / spread) / (double(other.camera.top) - other.camera.bottom) * 121.0;
          if (!(q.z < 0.0 && u >= 0.0 && u < 181.0 && v >= 0.0 && v < 121.0)) continue;
          const int i = int(u), j = int(v);
          if (of_layer(layer, "object_id").at(i, j) != picture["object_id"].at(x, y)) continue;
          const glm::dvec3 there = ray_of(other, i, j).at(of_layer(layer, "depth").at(i, j));
          const glm::dvec3 normal = glm::transpose(glm::dmat3(other_from_world)) * layer_normal(picture, layer, i, j);
          const glm::dvec3 own = glm::transpose(glm::dmat3(glm::dmat4(camera.view_from_world))) * picture.normal(x, y);
          if (glm::dot(normal, own) < 0.999) continue;  // another face of the pillar, the other side of the sheet
          const double off = std::fabs(glm::dot(p - there, normal));
          (off < 1e-4 * std::max(-q.z, double(picture.depth(x, y))) ? agree : disagree) += 1;
        }
      EXPECT_EQ(disagree, 0) << layer;
      EXPECT_GT(agree, 500) << layer << (orthographic ? " orthographic" : "");
      // The eye sees the point that all look at: it lies on the first camera's axis too.
      const Ray middle = ray_of(other, 90, 60);
      const glm::dvec3 d = glm::normalize(middle.direction), e = glm::normalize(axis), w = middle.origin - eye;
      const double de = glm::dot(d, e), bottom = 1.0 - de * de;
      const double along = bottom > 1e-9 ? (de * glm::dot(e, w) - glm::dot(d, w)) / bottom : -1.0;
      if (bottom > 1e-9) {
        const glm::dvec3 c = middle.origin + d * along;
        if (common == glm::dvec3(0.0)) common = c;
        EXPECT_LT(glm::distance(c, common), 1e-3) << layer;
        EXPECT_LT(glm::length(glm::cross(c - eye, e)), 1e-3) << layer;
      }
    }
    ASSERT_NE(common, glm::dvec3(0.0));
    for (int layer = 1; layer <= 4; ++layer) {
      const Ray middle = ray_of(layer_info(picture.info, layer), 90, 60);
      const double to_common = glm::dot(common - middle.origin, glm::normalize(middle.direction));
      EXPECT_GT(to_common, 0.0) << layer;
      EXPECT_LT(glm::length(glm::cross(common - middle.origin, glm::normalize(middle.direction))), 2e-3) << layer;
      EXPECT_GT(of_layer(layer, "depth").at(90, 60) * glm::length(middle.direction), to_common) << layer;
      EXPECT_LT(to_common, glm::dot(common - eye, glm::normalize(axis)) * 1.0001) << "no farther than the first";
    }
  }
}

TEST(CaptureExtraViews, SeeWhatTheFirstCameraDoesNot) {
  // The pillar stands behind the sheet; from behind or beside both it is in sight.
  const Scene scene = room_with_drape();
  const Picture picture = capture_with({.width = 120, .height = 80, .extra_views = 3}, scene,
                                       perspective_camera({-5.5f, 2.2f, 0.0f}, {6, 2.2f, 0}, {0, 1, 0}, 40.0f, 1.5f));
  long seen[4] = {};
  for (int layer = 0; layer < 4; ++layer)
    for (int y = 0; y < 80; ++y)
      for (int x = 0; x < 120; ++x) seen[layer] += picture[layer_plane(layer, "object_id")].at(x, y) == 6.0f;
  EXPECT_LT(seen[0], 400) << "above and below the sheet";
  EXPECT_GT(seen[1] + seen[2] + seen[3], 1000);
}

TEST(CaptureExtraViews, TheirNumberTheLayersAndTheGuardBandDoNotMoveThem) {
  const Scene scene = room_with_drape();
  const Camera camera = perspective_camera({-5.5f, 2.6f, 0.3f}, {6, 2.2f, 0}, {0, 1, 0}, 60.0f, 1.5f);
  const Picture four = capture_with({.width = 90, .height = 60, .extra_views = 4}, scene, camera);
  const Picture two = capture_with({.width = 90, .height = 60, .layers = 2, .extra_views = 2}, scene, camera);
  for (int view = 0; view < 2; ++view)
    for (const char* name : {"depth", "normal.x", "albedo.g", "object_id"})
      EXPECT_EQ(test::difference(four[layer_plane(1 + view, name)], two[layer_plane(2 + view, name)], 0.0).most, 0.0);
  const auto device = make_cpu_device();
  ASSERT_TRUE(device->prepare(scene));
  const auto wide = device->capture(camera, {.width = 90, .height = 60, .extra_views = 4, .guard = 7});
  const PictureInfo inner = inner_info(wide->info);
  ASSERT_EQ(inner.more_layers.size(), 4u);
  for (int view = 0; view < 4; ++view) {
    const Camera &a = inner.more_layers[view].camera, &b = four.info.more_layers[view].camera;
    EXPECT_LT(glm::distance(a.eye(), b.eye()), 1e-4f);
    EXPECT_NEAR(a.left, b.left, 1e-5f * b.right);
    EXPECT_NEAR(a.top, b.top, 1e-5f * b.top);
  }
}

TEST(CaptureExtraViews, ScenesAndCamerasThatShowNothingStillGiveThem) {
  for (const Scene& scene :
       {scene_of({square(1.0f)}), scene_of({shapes::sphere(1.0f, 16, 8)}), scene_of({square(1e-20f)})})
    for (const Camera& camera : {perspective_camera({0, 0, 5}, {0, 0, 9}, {0, 1, 0}, 40.0f, 1.0f), from_above(3.0f),
                                 perspective_camera({0, 0, 0.5f}, {0, 0, 0}, {0, 1, 0}, 170.0f, 1.0f),
                                 perspective_camera({0, 0, 1e16f}, {0, 0, 0}, {0, 1, 0}, 40.0f, 1.0f),
                                 // On the surface, which half of the rays leave at once.
                                 perspective_camera({0, 0, 0}, {1, 0.01f, 0.001f}, {0, 0, 1}, 40.0f, 1.0f)}) {
      // By one thread, and so not by a GPU: what a camera on a surface sees, rounding decides.
      const Picture picture = capture_with({.width = 5, .height = 5, .extra_views = 4}, scene, camera, {.threads = 1});
      ASSERT_EQ(picture.info.more_layers.size(), 4u);
      for (const LayerInfo& layer : picture.info.more_layers) {
        for (int c = 0; c < 16; ++c) EXPECT_TRUE(std::isfinite((&layer.camera.view_from_world[0][0])[c]));
        EXPECT_GT(layer.camera.right, layer.camera.left);
        EXPECT_GT(layer.camera.top, layer.camera.bottom);
      }
    }
}

TEST(CaptureExtraViews, TooManyLayersAreRefused) {
  const Scene scene = scene_of({square(1.0f)});
  const auto device = make_cpu_device();
  ASSERT_TRUE(device->prepare(scene));
  const auto capture_of = [&](const CaptureSettings& settings) { return device->capture(from_above(3.0f), settings); };
  EXPECT_TRUE(capture_of({.width = 4, .height = 4, .layers = kMostLayers}));
  EXPECT_TRUE(capture_of({.width = 4, .height = 4, .layers = 4, .back_sides = true}));
  EXPECT_TRUE(capture_of({.width = 4, .height = 4, .layers = 4, .extra_views = 4}));
  for (const CaptureSettings& settings :
       {CaptureSettings{.width = 4, .height = 4, .layers = 4, .back_sides = true, .extra_views = 1},
        CaptureSettings{.width = 4, .height = 4, .layers = 5, .back_sides = true},
        CaptureSettings{.width = 4, .height = 4, .layers = 8, .extra_views = 1}}) {
    const auto frame = capture_of(settings);
    ASSERT_FALSE(frame);
    EXPECT_EQ(frame.error().kind, ErrorKind::kUsage);
    EXPECT_NE(frame.error().message.find("at most 8"), std::string::npos) << frame.error().message;
  }
}

TEST(CaptureExtraViews, LightsStandWhereTheyStand) {
  // What a surface gets of a light does not depend on who looks: matt light of both views agrees on the same surface.
  Scene scene = room_with_drape();
  scene.lights = {key_lamp({-3.0f, 4.0f, 2.0f}), {.kind = LightKind::kHead, .color = glm::vec3(0.5f)}};
  const Camera camera = perspective_camera({-5.5f, 2.6f, 0.3f}, {6, 2.2f, 0}, {0, 1, 0}, 60.0f, 1.5f);
  const auto device = make_cpu_device();
  ASSERT_TRUE(device->prepare(scene));
  for (const char* rig : {"scene", "head", "key"}) {
    auto frame = device->capture(camera, {.width = 181, .height = 121, .extra_views = 2});
    ASSERT_TRUE(frame);
    const Effect& lighting = *find_effect("lighting");
    ParameterBytes params = initial_parameters(lighting.parameters, lighting.params_size);
    ASSERT_TRUE(set_parameter("lighting", *find_parameter(lighting, "rig"), rig, params));
    for (int layer = 0; layer < 3; ++layer) ASSERT_TRUE(device->run(lighting, params, *frame, layer));
    const Picture picture{frame->info, *device->download(*frame, {})};
    for (int layer = 1; layer < 3; ++layer) {
      const PictureInfo other = layer_info(picture.info, layer);
      long agree = 0, disagree = 0;
      for (int y = 0; y < 121; ++y)
        for (int x = 0; x < 181; ++x) {
          const auto plane = [&](const char* name) -> const Plane& { return picture[layer_plane(layer, name)]; };
          if (plane("object_id").at(x, y) != 1.0f) continue;  // the ceiling
          const glm::dvec3 p = ray_of(other, x, y).at(plane("depth").at(x, y));
          const glm::dvec3 q = glm::dvec3(glm::dmat4(camera.view_from_world) * glm::dvec4(p, 1.0));
          const double u = (q.x / -q.z - camera.left) / (camera.right - camera.left) * 181.0;
          const double v = (camera.top - q.y / -q.z) / (camera.top - camera.bottom) * 121.0;
          if (!(q.z < 0.0 && u >= 0.0 && u < 181.0 && v >= 0.0 && v < 121.0)) continue;
          if (picture["object_id"].at(int(u), int(v)) != 1.0f) continue;
          if (picture["shadow"].at(int(u), int(v)) != plane("shadow").at(x, y)) continue;  // beside a shadow's edge
          const double a = picture["direct.g"].at(int(u), int(v)), b = plane("direct.g").at(x, y);
          (std::fabs(a - b) < 0.05 * std::max(a, b) + 0.002 ? agree : disagree) += 1;
        }
      EXPECT_GT(agree, 200) << rig << layer;
      EXPECT_LT(disagree, agree / 50) << rig << layer;
    }
  }
}

}  // namespace
}  // namespace umbrage
