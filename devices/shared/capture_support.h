// Scenes, and captured pictures with their information, for all tests of captures.
#pragma once
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

namespace umbrage::test {

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Returns the parallelogram origin + s u + t v for s, t in [0, 1], with texture coordinates (s, t) * repeat. Its front
/// faces along u x v.
inline Mesh parallelogram(glm::vec3 origin, glm::vec3 u, glm::vec3 v, float repeat = 1.0f) {
  Mesh mesh;
  mesh.positions = {origin, origin + u, origin + u + v, origin + v};
  mesh.normals.assign(4, glm::normalize(glm::cross(u, v)));
  mesh.uvs = {{0, 0}, {repeat, 0}, {repeat, repeat}, {0, repeat}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

/// Returns a square with sides of length 2 * half in the plane z = height. Its front faces +z.
inline Mesh square(float half, float height = 0.0f, glm::vec2 center = {0, 0}) {
  return parallelogram({center.x - half, center.y - half, height}, {2 * half, 0, 0}, {0, 2 * half, 0});
}

/// Returns a finished scene: mesh k is object k of material k % materials.
inline Scene scene_of(std::vector<Mesh> meshes, std::vector<Material> materials = {Material{}}) {
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

inline Light key_light(glm::vec3 towards) {
  return {.direction = glm::normalize(towards), .color = glm::vec3(1.0f), .casts_shadow = true};
}

inline Light key_lamp(glm::vec3 where) {
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

/// Captures on the CPU; small pictures also on the GPU, if there is one, and compares both.
inline Picture capture_with(const CaptureSettings& settings, const Scene& scene, const Camera& camera,
                            const CpuSettings& cpu = {}) {
  const auto device = make_cpu_device(cpu);
  const auto ready = device->prepare(scene);
  EXPECT_TRUE(ready) << (ready ? "" : ready.error().message);
  const auto frame = device->capture(camera, settings);
  EXPECT_TRUE(frame);
  constexpr int kMaxOnGpu = 20000;  // pixels: a software GPU is slow
  const bool small = settings.width * settings.height <= kMaxOnGpu && cpu.threads == 0;
  for (const VulkanCapture how : test::kGpuCaptures) {
    Device* const gpu = small ? test::capturing_device(how) : nullptr;
    if (!gpu) continue;
    // CPU and GPU must agree at almost all pixels. A whole row of pixels may lie on a silhouette.
    const test::NoMessages no_messages;
    const test::Both both{test::captured(*gpu, scene, camera, settings),
                          test::captured(*device, scene, camera, settings)};
    EXPECT_EQ(both.gpu.names, both.cpu.names);
    const test::Deviation d = test::deviation(both, *layer_count(settings));
    EXPECT_LE(d.anywhere, d.pixels / 200 + settings.width) << test::name_of(how);
    for (const auto& [plane, count] : d.inside) EXPECT_LE(count, d.pixels / 500) << test::name_of(how) << ' ' << plane;
  }
  return {frame->info, *device->download_all(*frame)};
}

inline Picture capture(const Scene& scene, const Camera& camera, int width, int height, const CpuSettings& cpu = {}) {
  return capture_with({width, height, true}, scene, camera, cpu);
}

/// Returns a camera that looks down on the plane z = 0; the picture is `height` units high, and +y is up in it.
inline Camera from_above(float height, float aspect = 1.0f, float distance = 10.0f) {
  return orthographic_camera({0, 0, distance}, {0, 0, 0}, {0, 1, 0}, height, aspect);
}

inline double degrees_between(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180.0 / M_PI;
}

inline float linear(int srgb_byte) {
  const double v = srgb_byte / 255.0;
  return float(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
}

inline void expect_equal(const Image& a, const Image& b, std::string_view what) {
  ASSERT_EQ(a.names, b.names) << what;
  for (std::size_t p = 0; p < a.planes.size(); ++p)
    EXPECT_EQ(test::difference(a.planes[p], b.planes[p], 0.0).max, 0.0) << what << ": " << a.names[p];
}

inline Texture texture_of(int width, int height, const std::function<glm::ivec4(int x, int y)>& texel) {
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

/// Returns a square that casts its shadow on a larger one below it. Object 0 is the ground, 1 the square.
inline Scene square_over_ground() { return scene_of({square(8.0f), square(1.0f, 2.0f, {0.3f, -0.2f})}); }

/// Returns the distance of a point of the plane z = 2 from the border of the square of square_over_ground, > 0 inside.
inline double inside_square(const glm::dvec3& p) { return 1.0 - std::max(std::fabs(p.x - 0.3), std::fabs(p.y + 0.2)); }

/// Returns square_over_ground with a square hole of side 1 in the middle of the upper square.
inline Scene holed_square_over_ground() {
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

/// Returns holed_square_over_ground with a sphere next to the square, and a directional light.
inline Scene mixed_scene() {
  Scene scene = holed_square_over_ground();
  Mesh ball = shapes::sphere(1.0f, 40, 20);
  for (glm::vec3& p : ball.positions) p += glm::vec3(-2.0f, 1.0f, 1.0f);
  ball.object = 2;
  scene.meshes.push_back(ball);
  finish_scene(scene);
  scene.lights = {key_light({0.9f, 0.5f, 1.0f})};
  return scene;
}

inline glm::dvec3 layer_normal(const Picture& picture, int layer, int x, int y) {
  const auto value = [&](const char* name) { return double(picture[layer_plane(layer, name)].at(x, y)); };
  return {value("normal.x"), value("normal.y"), value("normal.z")};
}

}  // namespace umbrage::test
