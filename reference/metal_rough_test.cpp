// Surfaces with metalness and roughness: the reference against known results, and `lighting` against the reference on a
// chart of spheres.
#include "reference/metal_rough.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "core/reflection_map.h"
#include "devices/cpu/cpu_device.h"
#include "effects/effects.h"
#include "generators/shapes.h"
#include "reference/trace.h"
#include "renderer/hdri.h"
#include "run_effect.h"
#include "scene/environment.h"
#include "scene/finish.h"
#include "support.h"
#include "vulkan_support.h"

namespace umbrage {
namespace {

constexpr int kSide = 5;  // spheres per side of the chart: metalness upwards, roughness to the right
constexpr int kSize = 240;

/// Makes the chart. Spheres are in the plane z = 0, and far enough apart for any light.
Scene chart() {
  Scene scene;
  scene.name = "chart";
  for (int row = 0; row < kSide; ++row)
    for (int column = 0; column < kSide; ++column) {
      Mesh mesh = shapes::sphere(0.45f, 64, 32);
      for (glm::vec3& p : mesh.positions) p += glm::vec3(float(column), float(row), 0.0f);
      mesh.object = mesh.material = int(scene.meshes.size());
      scene.meshes.push_back(std::move(mesh));
      scene.materials.push_back({.albedo = {0.9f, 0.6f, 0.3f},
                                 .metallic = float(row) / float(kSide - 1),
                                 .roughness = float(column) / float(kSide - 1)});
    }
  EXPECT_EQ(finish_scene(scene), 0u);
  return scene;
}

Camera camera_of_chart() { return orthographic_camera({2, 2, 10}, {2, 2, 0}, {0, 1, 0}, 5.2f, 1.0f); }

double luminance(const Image& image, const std::string& name, int x, int y) {
  return 0.2126 * image.plane(name + ".r").at(x, y) + 0.7152 * image.plane(name + ".g").at(x, y) +
         0.0722 * image.plane(name + ".b").at(x, y);
}

/// Returns the mean luminance of a colour on each sphere.
std::vector<double> means(const Image& image, const std::string& name, const Plane& objects) {
  std::vector<double> sums(std::size_t(kSide * kSide)), counts(sums.size());
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      if (objects.at(x, y) < 0.0f) continue;
      sums[std::size_t(objects.at(x, y))] += luminance(image, name, x, y);
      counts[std::size_t(objects.at(x, y))] += 1.0;
    }
  for (std::size_t k = 0; k < sums.size(); ++k) sums[k] /= counts[k];
  return sums;
}

/// Draws the chart under this light with `lighting` and with the reference, and compares `plane`, direct or ambient.
void expect_agreement(const Lighting& lighting, const std::function<glm::vec3(glm::vec3)>& environment,
                      const std::string& plane) {
  const Scene scene = chart();
  const CaptureSettings settings{.width = kSize, .height = kSize, .lighting = lighting};
  const auto device = make_cpu_device({});
  ASSERT_TRUE(device->prepare(scene));
  auto frame = device->capture(camera_of_chart(), settings);
  ASSERT_TRUE(frame);
  const Effect& effect = *find_effect("lighting");
  ASSERT_TRUE(device->run(effect, test::parameters_of(effect, {}), *frame));
  const auto image = device->download_all(*frame);
  ASSERT_TRUE(image);
  const auto traced = build_traced_scene(scene);
  ASSERT_TRUE(traced);
  const auto truth = trace_light(
      **traced, frame->info, {.samples = 64, .bounce = false, .captured_shadows = true, .environment = environment});
  ASSERT_TRUE(truth);
  const auto ours = means(*image, plane, image->plane("object_id")),
             theirs = means(*truth, plane, image->plane("object_id"));
  double sum = 0.0;
  for (std::size_t k = 0; k < ours.size(); ++k) {
    const double error = ours[k] / theirs[k] - 1.0;
    sum += std::abs(error);
    EXPECT_LT(std::abs(error), 0.05) << plane << ", metallic " << scene.materials[k].metallic << ", roughness "
                                     << scene.materials[k].roughness << ": " << ours[k] << " instead of " << theirs[k];
  }
  const double mean = sum / double(ours.size());
  EXPECT_LT(mean, 0.02) << plane;
  testing::Test::RecordProperty("mean_error_of_" + plane, std::to_string(mean));
}

TEST(MetalRough, ChartAgreesUnderADirectionalLight) {
  for (const glm::vec3 direction : {glm::vec3(0.3f, 0.5f, 0.8f), glm::vec3(0.9f, 0.2f, -0.1f)}) {
    Lighting lighting;
    lighting.lights = {{.direction = glm::normalize(direction), .color = glm::vec3(1.0f, 0.9f, 0.8f)}};
    expect_agreement(lighting, {}, "direct");
  }
}

/// Returns by how much the light of a disc behind a dark sphere, 18 degrees wide as the rim light of `studio`, differs
/// from the truth: the sum of the differences as a fraction of all light. `azimuth_deg`: of the light; 180 is opposite
/// to the camera.
double rim_error(float roughness, float azimuth_deg) {
  Scene scene;
  scene.materials = {{.albedo = glm::vec3(0.02f), .metallic = 0.0f, .roughness = roughness}};
  scene.meshes = {shapes::sphere(1.0f, 128, 64)};
  EXPECT_EQ(finish_scene(scene), 0u);
  const float azimuth = azimuth_deg * 3.14159265f / 180.0f;
  Lighting lighting;
  lighting.lights = {
      {.direction = {std::sin(azimuth), 0.0f, std::cos(azimuth)}, .angle_deg = 18.0f, .casts_shadow = true}};
  const auto device = make_cpu_device({});
  EXPECT_TRUE(device->prepare(scene));
  auto frame = device->capture(orthographic_camera({0, 0, 10}, {0, 0, 0}, {0, 1, 0}, 2.2f, 1.0f),
                               {.width = kSize, .height = kSize, .shadow_rays = 8, .lighting = lighting});
  EXPECT_TRUE(frame);
  const Effect& effect = *find_effect("lighting");
  EXPECT_TRUE(device->run(effect, test::parameters_of(effect, {}), *frame));
  const auto image = device->download(*frame, {"direct.r"});
  EXPECT_TRUE(image);
  const auto traced = build_traced_scene(scene);
  EXPECT_TRUE(traced);
  const auto truth = trace_light(**traced, frame->info, {.samples = 256, .bounce = false});
  EXPECT_TRUE(truth);
  const Plane &ours = image->plane("direct.r"), &theirs = truth->plane("direct.r");
  double sum = 0.0, error = 0.0;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      sum += theirs.at(x, y);
      error += std::abs(ours.at(x, y) - theirs.at(x, y));
    }
  return error / sum;
}

TEST(MetalRough, RimOfALargeLightFollowsTheTruth) {
  for (const float roughness : {0.3f, 0.45f, 0.6f, 0.8f}) {
    EXPECT_LT(rim_error(roughness, 145.0f), 0.29) << roughness;
    // Half of this light's disc or more is below the horizon of most of what it reaches.
    EXPECT_LT(rim_error(roughness, 165.0f), 0.34) << roughness;
  }
}

TEST(MetalRough, ChartAgreesUnderAnEnvironment) {
  // A bright side, a dark side and a ground, nowhere as bright as a light.
  Panorama panorama{"test", 256, 128, {}};
  for (int y = 0; y < panorama.height; ++y)
    for (int x = 0; x < panorama.width; ++x) {
      const glm::vec3 d = panorama_direction((float(x) + 0.5f) / 256.0f, (float(y) + 0.5f) / 128.0f);
      const float side = std::pow(std::max(0.5f + 0.5f * d.x, 0.0f), 3.0f), ground = d.z < 0.0f ? 0.3f : 1.0f;
      for (const float color : {1.0f, 0.8f, 0.6f}) panorama.rgb.push_back(ground * (0.3f + 0.9f * side * color));
    }
  Hdri hdri;
  hdri.file = "test";
  hdri.panorama = std::make_shared<const Panorama>(panorama);
  const glm::vec3 up(0.0f, 1.0f, 0.0f);
  const Lighting lighting = image_lighting(hdri, up, true);
  EXPECT_TRUE(lighting.lights.empty());
  const glm::mat3 from_world = glm::transpose(panorama_axes(up, 0.0f));
  expect_agreement(
      lighting, [&](glm::vec3 d) { return panorama_radiance(panorama, from_world * d); }, "ambient");
}

TEST(MetalRough, ChartAgreesUnderAmbientLightOfALook) {
  Lighting lighting;
  lighting.ambient = glm::vec3(0.4f);
  for (glm::mat4& shape : lighting.ambient_shape.by_color) shape[1][3] = shape[3][1] = 0.1f;
  // The radiance whose diffuse reflection is 0.4 + 0.2 y.
  expect_agreement(
      lighting, [](glm::vec3 d) { return glm::vec3(0.4f + 0.3f * d.y); }, "ambient");
}

TEST(MetalRough, MirrorsAndConservesLight) {
  const SampleTable table = sample_table(1024);
  const auto white = [](glm::vec3) { return glm::vec3(1.0f); };
  const glm::vec3 slanted = glm::normalize(glm::vec3(1.0f, 0.0f, 1.0f)), normal(0.0f, 0.0f, 1.0f);
  const MetalRough mirror{normal, slanted, glm::vec3(1.0f), 1.0f, 0.0f};
  EXPECT_NEAR(reflected_environment(mirror, white, table, 1024, 1).r, 1.0f, 0.01f);
  // A mirror shows what is in the mirrored direction.
  const auto left = [](glm::vec3 d) { return glm::vec3(d.x < 0.0f ? 1.0f : 0.0f); };
  EXPECT_NEAR(reflected_environment(mirror, left, table, 1024, 1).r, 1.0f, 0.01f);
  for (const float roughness : {0.0f, 0.3f, 0.6f, 1.0f})
    for (const float metallic : {0.0f, 1.0f})
      EXPECT_LT(reflected_environment({normal, slanted, glm::vec3(1.0f), metallic, roughness}, white, table, 1024, 1).r,
                1.01f);
}

TEST(MetalRough, TableOfTheEnvironmentBrdfIsTheReferences) {
  const SampleTable table = sample_table(4096);
  const EnvironmentBrdf& brdf = environment_brdf();
  constexpr int kTableSide = EnvironmentBrdf::kSide;
  for (int y = 1; y < kTableSide; y += 2)
    for (int x = 1; x < kTableSide; x += 2) {
      const float cosine = float(y) / float(kTableSide - 1), roughness = float(x) / float(kTableSide - 1);
      const glm::vec3 eye(std::sqrt(1.0f - cosine * cosine), 0.0f, cosine);
      const MetalRough metal{{0.0f, 0.0f, 1.0f}, eye, glm::vec3(0.5f), 1.0f, roughness};
      const float truth = reflected_environment(
                              metal, [](glm::vec3) { return glm::vec3(1.0f); }, table, 4096, 1)
                              .r;
      const std::size_t at = std::size_t(y * kTableSide + x);
      EXPECT_NEAR(0.5f * brdf.scale[at] + brdf.bias[at], truth, 0.01f) << roughness << ' ' << cosine;
    }
}

/// Returns a bumpy G-buffer in which most pixels have a roughness, under two lights and a map of reflections.
GBuffer rough_gbuffer(int width, int height) {
  GBuffer g = test::bumpy_gbuffer(width, height, 7);
  g.info.lights.push_back({.kind = LightKind::kPoint, .position = {1.0f, 2.0f, -1.0f}, .color = glm::vec3(0.5f)});
  g.info.reflections = std::make_shared<const ReflectionMap>(
      reflection_map([](glm::vec3 d) { return glm::vec3(0.5f + 0.4f * d.y, 0.5f, 0.5f - 0.3f * d.x); }));
  Image& image = g.layers[0];
  for (const char* name : {"metallic", "roughness", "material_ao"}) image.add(name);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto random = [&](unsigned k) { return float(test::hash(unsigned(x + 991 * y) * 3u + k) >> 8) * 0x1p-24f; };
      image.plane("metallic").at(x, y) = random(0);
      image.plane("roughness").at(x, y) = random(1) < 0.2f ? kNoRoughness : 0.3f + 0.7f * random(1);
      image.plane("material_ao").at(x, y) = random(2);
    }
  return g;
}

TEST(MetalRough, LightingOnEveryTargetIsTheReferences) {
  const GBuffer g = rough_gbuffer(67, 43);
  const Image& in = g.layers[0];
  test::on_every_target("lighting", g, {}, [&](const Image& out) {
    int compared = 0;
    for (int y = 0; y < g.info.height; ++y)
      for (int x = 0; x < g.info.width; ++x) {
        const float roughness = in.plane("roughness").at(x, y), depth = in.plane("depth").at(x, y);
        if (roughness < 0.0f || !std::isfinite(depth)) continue;
        const auto color = [&](const char* const(&names)[3]) {
          return glm::vec3(in.plane(names[0]).at(x, y), in.plane(names[1]).at(x, y), in.plane(names[2]).at(x, y));
        };
        const float across = g.info.camera.left + (float(x) + 0.5f) * g.info.pixel_width(),
                    up = g.info.camera.top - (float(y) + 0.5f) * g.info.pixel_height();
        const glm::vec3 position(across * depth, up * depth, -depth);
        const MetalRough finish{color(test::kNormal), glm::normalize(-position), color(test::kAlbedo),
                                in.plane("metallic").at(x, y), roughness};
        const glm::vec3 sum =
            in.plane("shadow").at(x, y) * g.info.lights[0].color * reflected_light(finish, g.info.lights[0].direction) +
            g.info.lights[1].color * reflected_light(finish, glm::normalize(g.info.lights[1].position - position));
        for (int c = 0; c < 3; ++c)
          EXPECT_NEAR(out.plane(test::kDirect[c]).at(x, y), sum[c], 1e-4f + 1e-3f * sum[c]) << x << ' ' << y;
        ++compared;
      }
    EXPECT_GT(compared, 500);
  });
}

TEST(MetalRough, MaterialAoDarkensOnlyAmbientLight) {
  GBuffer g = rough_gbuffer(16, 16);
  const Image with = test::run_effect(*find_effect("lighting"), g, {}, {});
  g.layers[0].plane("material_ao") = Plane(16, 16, 1.0f);
  const Image without = test::run_effect(*find_effect("lighting"), g, {}, {});
  const GBuffer first = rough_gbuffer(16, 16);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) {
      EXPECT_EQ(with.plane("direct.r").at(x, y), without.plane("direct.r").at(x, y));
      EXPECT_NEAR(with.plane("ambient.r").at(x, y),
                  without.plane("ambient.r").at(x, y) * first.layers[0].plane("material_ao").at(x, y), 1e-6f);
    }
}

TEST(MetalRough, VulkanAgreesWithTheCpu) {
  Device* const device = test::vulkan_device();
  UMBRAGE_NEEDS_VULKAN(device);
  const GBuffer g = rough_gbuffer(67, 43);
  const Effect& effect = *find_effect("lighting");
  const Image cpu = test::run_effect(effect, g, {}, {.scalar = true});
  auto frame = device->upload(g);
  ASSERT_TRUE(frame);
  ASSERT_TRUE(device->run(effect, test::parameters_of(effect, {}), *frame));
  const auto gpu = device->download(*frame, cpu.names);
  ASSERT_TRUE(gpu);
  for (std::size_t p = 0; p < cpu.planes.size(); ++p)
    EXPECT_LT(test::difference(cpu.planes[p], gpu->planes[p], 0.0).max, 1e-4 * test::scale_of(cpu.planes[p]))
        << cpu.names[p];
}

}  // namespace
}  // namespace umbrage
