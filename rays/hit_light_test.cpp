// The light of hit surfaces on scenes for which it is known in closed form.
#include "rays/hit_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "core/hash.h"
#include "devices/shared/capture_info.h"
#include "scene/finish.h"

namespace umbrage {
namespace {

constexpr float kFar = 1e4f;  // size of walls that stand for infinite walls
constexpr float kRed = 0.5f, kGreen = 0.25f, kBlue = 0.125f;

/// Makes the parallelogram origin + s u + t v for s, t in [0, 1].
Mesh parallelogram(glm::vec3 origin, glm::vec3 u, glm::vec3 v) {
  Mesh mesh;
  mesh.positions = {origin, origin + u, origin + u + v, origin + v};
  mesh.normals.assign(4, glm::normalize(glm::cross(u, v)));
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

Mesh floor_mesh() { return parallelogram({-kFar, -kFar, 0}, {2 * kFar, 0, 0}, {0, 2 * kFar, 0}); }
/// A wall in the plane x = `where` that stands on the floor.
Mesh wall_mesh(float where) { return parallelogram({where, -kFar, -kFar}, {0, 2 * kFar, 0}, {0, 0, 2 * kFar}); }
/// A roof at the height 2 over all x > 0.
Mesh roof_mesh() { return parallelogram({0, -kFar, 2}, {kFar, 0, 0}, {0, 2 * kFar, 0}); }

/// A scene of coloured meshes, and the light of the hits of rays straight down on its floor.
class HitLight : public testing::Test {
 protected:
  void build(std::vector<Mesh> meshes, std::vector<Light> lights, glm::vec3 ambient, glm::vec3 emission = {}) {
    scene_.meshes = std::move(meshes);
    Material material;
    material.albedo = {kRed, kGreen, kBlue};
    material.emission = emission;
    scene_.materials = {material};
    scene_.lights = std::move(lights);
    scene_.ambient = ambient;
    ASSERT_EQ(finish_scene(scene_), 0u);
    auto traced = build_traced_scene(scene_);
    ASSERT_TRUE(traced);
    traced_ = std::move(*traced);
    const Camera camera = orthographic_camera({0, 0, 10}, {0, 0, 0}, {0, 1, 0}, 1.0f, 1.0f);
    info_ = picture_info(scene_, camera, {.width = 1, .height = 1});
  }

  /// Returns the light of rays that hit the floor at (x, 0), one for each lane and each of `packets`.
  std::vector<glm::vec3> light_at(float x, int packets, float reach = kFar, float ambient_factor = 1.0f) const {
    const HitLighting lighting = hit_lighting(*traced_, info_, ambient_factor, reach * traced_->scale);
    std::vector<glm::vec3> light;
    for (int n = 0; n < packets; ++n) {
      RayPacket packet;
      std::array<std::uint32_t, kPacket> seeds;
      for (int k = 0; k < kPacket; ++k) {
        seeds[std::size_t(k)] = hash(std::uint32_t(n), std::uint32_t(k));
        packet.set(k, traced_->unit_of({x, 0, 1}), {0, 0, -1}, 0.0f, 2.0f * traced_->scale);
      }
      packet.find_hits(*traced_, Coherence::kIncoherent);
      const PacketLight of_packet = light_of_hits(*traced_, lighting, packet, seeds);
      light.insert(light.end(), of_packet.begin(), of_packet.end());
    }
    return light;
  }

  static Light sun(glm::vec3 direction, glm::vec3 color, bool casts_shadow = true) {
    return {.direction = glm::normalize(direction), .color = color, .casts_shadow = casts_shadow};
  }

  Scene scene_;
  TracedScenePtr traced_;
  PictureInfo info_;
};

void expect_color(glm::vec3 color, glm::vec3 expected, float tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(color[c], expected[c], tolerance) << "channel " << c;
}

glm::vec3 mean_of(const std::vector<glm::vec3>& light) {
  glm::vec3 sum(0.0f);
  for (const glm::vec3 value : light) sum += value;
  return sum / float(light.size());
}

TEST_F(HitLight, OneLightWithoutNoise) {
  build({floor_mesh(), roof_mesh()}, {sun({0, 3, 4}, {1, 2, 4})}, glm::vec3(0.0f), {0.01f, 0.02f, 0.03f});
  // In the open: albedo times colour times the cosine 4 / 5, and emission.
  for (const glm::vec3 light : light_at(-1.0f, 2)) expect_color(light, {0.41f, 0.42f, 0.43f}, 1e-5f);
  // Below the roof: emission alone.
  for (const glm::vec3 light : light_at(1.0f, 2)) expect_color(light, {0.01f, 0.02f, 0.03f}, 1e-6f);
}

TEST_F(HitLight, ALampWithASizeIsNoBrighterThanAtItsSurface) {
  // 0.1 above the floor: without a size 100 times as bright as at the distance 1, with a radius of 0.5 four times.
  Light lamp{.kind = LightKind::kPoint, .position = {-1.0f, 0.0f, 0.1f}, .color = glm::vec3(1.0f), .reach = 1.0f};
  for (const auto& [radius, factor] : {std::pair(0.0f, 100.0f), {0.05f, 100.0f}, {0.5f, 4.0f}}) {
    lamp.radius = radius;
    build({floor_mesh()}, {lamp}, glm::vec3(0.0f));
    for (const glm::vec3 light : light_at(-1.0f, 1)) expect_color(light / factor, {kRed, kGreen, kBlue}, 1e-3f);
  }
}

TEST_F(HitLight, EmissionIsClamped) {
  // To 4 times the light of a white surface in the brightest light, here blocked; the hue stays.
  build({floor_mesh(), roof_mesh()}, {sun({0, 3, 4}, glm::vec3(2.0f))}, glm::vec3(0.0f), {32.0f, 16.0f, 4.0f});
  for (const glm::vec3 light : light_at(1.0f, 2)) expect_color(light, {8.0f, 4.0f, 1.0f}, 1e-5f);
}

TEST_F(HitLight, LightsWithoutShadowReachAll) {
  build({floor_mesh(), roof_mesh()}, {sun({0, 0, 1}, glm::vec3(1.0f), false)}, glm::vec3(0.0f));
  for (const glm::vec3 light : light_at(1.0f, 1)) expect_color(light, {kRed, kGreen, kBlue}, 1e-6f);
}

TEST_F(HitLight, MeanIsTheSumOfAllLights) {
  // One light is blocked by the wall, two are not; each has another colour.
  const glm::vec3 warm(1.0f, 0.5f, 0.1f), cool(0.1f, 0.2f, 0.9f), ambient(0.2f, 0.3f, 0.4f),
      albedo(kRed, kGreen, kBlue);
  build({floor_mesh(), wall_mesh(2.0f)},
        {sun({-1, 0, 1}, warm), sun({-4, 0, 3}, cool), sun({1, 0, 1}, glm::vec3(3.0f))}, ambient);
  const std::vector<glm::vec3> light = light_at(1.99f, 8192);
  // The wall is so near that half of the ambient light arrives.
  const float slope = std::sqrt(0.5f);
  expect_color(mean_of(light), albedo * (warm * slope + cool * 0.6f + ambient * 0.5f), 0.01f);
  const glm::vec3 all = albedo * (warm * slope + cool * 0.6f + ambient + 3.0f * slope);
  for (const glm::vec3 value : light)
    for (int c = 0; c < 3; ++c) EXPECT_LE(value[c], (all.r + all.g + all.b) * 1.0001f);
}

TEST_F(HitLight, AmbientLightIsBlockedWithinTheReach) {
  build({floor_mesh(), wall_mesh(2.0f)}, {}, glm::vec3(1.0f));
  // Without the wall within reach, no light is lost.
  for (const glm::vec3 value : light_at(1.0f, 4, 0.5f)) expect_color(value, {kRed, kGreen, kBlue}, 1e-6f);
  expect_color(mean_of(light_at(1.999f, 512, kFar, 0.4f)), 0.2f * glm::vec3(kRed, kGreen, kBlue), 0.004f);
}

TEST_F(HitLight, ARayWithoutAHitBringsNothing) {
  build({wall_mesh(2.0f)}, {sun({0, 0, 1}, glm::vec3(1.0f))}, glm::vec3(1.0f));
  for (const glm::vec3 light : light_at(1.0f, 1)) EXPECT_EQ(light, glm::vec3(0.0f));
}

}  // namespace
}  // namespace umbrage
