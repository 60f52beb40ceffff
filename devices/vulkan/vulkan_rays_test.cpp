// Dispatches that trace rays on the GPU, compared with the CPU.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "generators/shapes.h"
#include "renderer/models.h"
#include "run_effect.h"
#include "scene/finish.h"
#include "scene/framing.h"
#include "support.h"
#include "vulkan_capture.h"
#include "vulkan_support.h"

namespace umbrage {
namespace {

/// Returns a frame of the prepared scene with all planes that `traced` reads.
Frame traced_frame(Device& device, const Camera& camera, int width, int height) {
  auto frame = device.capture(camera, {.width = width, .height = height, .ray_offsets = true});
  EXPECT_TRUE(frame) << (frame ? "" : frame.error().message);
  // Ambient light that depends on the direction.
  frame->info.ambient_shape.by_color[0][1][3] = frame->info.ambient_shape.by_color[0][3][1] = 0.2f;
  frame->info.ambient_shape.by_color[1][0][2] = frame->info.ambient_shape.by_color[1][2][0] = 0.1f;
  return *frame;
}

/// Runs `traced` and returns the planes that it writes for these settings.
Image traced(Device& device, Frame& frame, const test::Settings& settings) {
  const Effect& effect = *find_effect("traced");
  const ParameterBytes params = test::parameters_of(effect, settings);
  const auto status = device.run(effect, params, frame);
  EXPECT_TRUE(status) << (status ? "" : status.error().message);
  return *device.download(frame, test::written_planes(effect, params));
}

/// Expects that at most this fraction of the pixels differs by more than 2/255, for numbers of rays relative to the
/// max: where a ray passes close to an edge, rounding decides whether it hits.
void expect_equal(const Image& gpu, const Image& cpu, double max_fraction, const std::string& what) {
  ASSERT_EQ(gpu.names, cpu.names);
  for (std::size_t p = 0; p < cpu.planes.size(); ++p) {
    float max = 1.0f;
    for (int y = 0; y < cpu.height; ++y)
      max = std::max(max, *std::max_element(cpu.planes[p].row(y), cpu.planes[p].row(y) + cpu.width));
    EXPECT_LE(test::difference(gpu.planes[p], cpu.planes[p], 2.0 / 255.0 * max).fraction_over, max_fraction)
        << what << ' ' << cpu.names[p];
  }
}

TEST(VulkanRays, MatchEmbree) {
  // Rasterised pixels on the border of a surface may show another one.
  Device* const gpu = test::capturing_device(VulkanCapture::kRays);
  UMBRAGE_NEEDS_VULKAN(gpu);
  const test::NoMessages no_messages;
  const auto cpu = make_cpu_device();
  const std::vector<test::Settings> all = {
      {{"rays", "2"}, {"filter", "off"}, {"bent", "on"}},
      {{"rays", "0.3"}, {"max_rays", "3"}, {"filter", "off"}},
      {{"rays", "2"}, {"filter", "off"}, {"falloff", "smooth"}, {"normal", "shading"}, {"radius", "40%"}},
      {{"filter", "off"}, {"falloff", "linear"}, {"bent", "on"}, {"radius", "200%"}},
      {{"filter", "off"}, {"bleeding", "1"}, {"bent", "on"}, {"radius", "40%"}},
      {{"filter", "off"}, {"bleeding", "0.5"}, {"falloff", "smooth"}, {"ambient_bounce", "0"}, {"sample_index", "7"}},
      {{"filter", "off"}, {"directional", "1"}, {"radius", "40%"}},
      {{"filter", "off"}, {"directional", "0.5"}, {"bleeding", "1"}, {"falloff", "linear"}, {"radius", "40%"}},
      {{"sample_index", "3"}}};
  for (const char* name : {"scene:solids?detail=3000", "scene:atrium?detail=8000", "scene:tank?detail=5000"})
    for (const bool orthographic : {false, true}) {
      const auto scene = load_scene(name);
      ASSERT_TRUE(scene);
      Framing framing;
      framing.orthographic = orthographic;
      const Camera camera = frame_scene(*scene, framing, 120, 90);
      ASSERT_TRUE(gpu->prepare(*scene));
      ASSERT_TRUE(cpu->prepare(*scene));
      Frame on_gpu = traced_frame(*gpu, camera, 120, 90), on_cpu = traced_frame(*cpu, camera, 120, 90);
      for (const test::Settings& settings : all) {
        std::string what = std::string(name) + (orthographic ? " orthographic" : "");
        for (const auto& [parameter, value] : settings) what += ' ' + parameter + '=' + value;
        const Image a = traced(*gpu, on_gpu, settings), b = traced(*cpu, on_cpu, settings);
        expect_equal(a, b, 1e-3, what);
        double occlusion = 0.0;
        for (int y = 0; y < b.height; ++y)
          for (int x = 0; x < b.width; ++x) occlusion += 1.0 - b.plane("ao").at(x, y);
        EXPECT_GT(occlusion, 0.01 * b.width * b.height) << what << ": rays must hit something";
      }
    }
}

TEST(VulkanRays, MatchEmbreeBehindCapturesOfTheirOwn) {
  const auto cpu = make_cpu_device();
  const auto scene = load_scene("scene:solids?detail=3000");
  ASSERT_TRUE(scene);
  const Camera camera = frame_scene(*scene, {}, 160, 120);
  ASSERT_TRUE(cpu->prepare(*scene));
  Frame on_cpu = traced_frame(*cpu, camera, 160, 120);
  const Image expected = traced(*cpu, on_cpu, {});
  for (const VulkanCapture how : test::kGpuCaptures) {
    Device* const gpu = test::capturing_device(how);
    UMBRAGE_NEEDS_VULKAN(gpu);
    const test::NoMessages no_messages;
    ASSERT_TRUE(gpu->prepare(*scene));
    Frame on_gpu = traced_frame(*gpu, camera, 160, 120);
    // Pixels on the border of a surface show another one, and the filter passes that on.
    expect_equal(traced(*gpu, on_gpu, {}), expected, 1e-2, test::name_of(how));
  }
}

/// Returns a floor of 2 x 2 at height 0 and a ceiling of 2000 x 2000 at this height.
Scene floor_and_ceiling(float height) {
  Scene scene;
  scene.materials.resize(1);
  for (const auto& [half, y] : {std::pair{1.0f, 0.0f}, {1000.0f, height}}) {
    Mesh mesh;
    mesh.positions = {{-half, y, -half}, {-half, y, half}, {half, y, half}, {half, y, -half}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    scene.meshes.push_back(mesh);
  }
  EXPECT_EQ(finish_scene(scene), 0u);
  return scene;
}

TEST(VulkanRays, ACeilingOccludesByItsDistance) {
  // A disc of radius sqrt(r^2 - h^2) at height h blocks the cosine-weighted fraction 1 - (h / r)^2 of the rays of
  // length r from the point below its centre.
  const float height = 0.5f;
  const Scene scene = floor_and_ceiling(height);
  const Camera camera = perspective_camera({0, 0.4f, 0}, {0, 0, 0}, {0, 0, 1}, 40.0f, 1.0f);
  for (const VulkanCapture how : test::kGpuCaptures) {
    Device* const gpu = test::capturing_device(how);
    UMBRAGE_NEEDS_VULKAN(gpu);
    const test::NoMessages no_messages;
    ASSERT_TRUE(gpu->prepare(scene));
    Frame frame = traced_frame(*gpu, camera, 64, 64);
    for (const float radius : {0.45f, 0.55f, 0.8f, 3.0f}) {
      const Image image = traced(
          *gpu, frame, {{"rays", "16"}, {"max_rays", "16"}, {"filter", "off"}, {"radius", std::to_string(radius)}});
      double open = 0.0;
      for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
          ASSERT_FLOAT_EQ(image.plane("traced_confidence").at(x, y), 16.0f / 17.0f);
          open += image.plane("ao").at(x, y) / (64.0 * 64.0);
        }
      const double expected = radius < height ? 1.0 : std::pow(height / radius, 2.0);
      EXPECT_NEAR(open, expected, 0.004) << radius;  // 65536 rays: a standard deviation of 0.002 if independent
    }
  }
}

TEST(VulkanRays, AFrameKeepsItsScene) {
  const Scene low = floor_and_ceiling(0.5f), high = floor_and_ceiling(5.0f);
  const Camera camera = perspective_camera({0, 0.4f, 0}, {0, 0, 0}, {0, 0, 1}, 40.0f, 1.0f);
  const test::Settings settings = {{"radius", "0.8"}};
  for (Device* const gpu : {test::vulkan_device(), test::capturing_device(VulkanCapture::kRaster)}) {
    UMBRAGE_NEEDS_VULKAN(gpu);
    const test::NoMessages no_messages;
    ASSERT_TRUE(gpu->prepare(low));
    Frame before = traced_frame(*gpu, camera, 32, 32);
    Frame branch = gpu->branch(before);
    ASSERT_TRUE(gpu->prepare(high));
    Frame after = traced_frame(*gpu, camera, 32, 32);
    EXPECT_LT(traced(*gpu, branch, settings).plane("ao").at(16, 16), 0.7f);
    EXPECT_EQ(traced(*gpu, after, settings).plane("ao").at(16, 16), 1.0f);
  }
}

TEST(VulkanRays, AFrameWithoutASceneIsRefused) {
  Device* const gpu = test::vulkan_device();
  UMBRAGE_NEEDS_VULKAN(gpu);
  const test::NoMessages no_messages;
  auto frame = gpu->upload(test::bumpy_gbuffer(20, 10, 1));
  ASSERT_TRUE(frame);
  const Effect& effect = *find_effect("traced");
  const auto status = gpu->run(effect, test::parameters_of(effect, {}), *frame);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::kUsage);
  EXPECT_NE(status.error().message.find("traced needs the model"), std::string::npos) << status.error().message;
}

}  // namespace
}  // namespace umbrage
