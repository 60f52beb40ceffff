// Tests of what the looks `ao` and `lit` show without further options, and of looks with several depth layers: the
// effects that run on each, and the layers that a look captures.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/lists.h"
#include "devices/cpu/cpu_device.h"
#include "draw_picture.h"
#include "generators/builtin.h"
#include "renderer/devices.h"
#include "renderer/draw.h"
#include "renderer/models.h"
#include "scene/finish.h"

namespace umbrage {
namespace {

constexpr int kSide = 128;

/// Adds a box without the faces in `open`, a bit each: -x, +x, -y, +y, -z, +z.
void add_box(const glm::vec3& min, const glm::vec3& max, Mesh& mesh, unsigned open = 0) {
  const auto first = std::uint32_t(mesh.positions.size());
  for (int k = 0; k < 8; ++k)
    mesh.positions.emplace_back(k & 1 ? max.x : min.x, k & 2 ? max.y : min.y, k & 4 ? max.z : min.z);
  constexpr std::uint32_t kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                          {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (unsigned face = 0; face < 6; ++face)
    if ((open >> face & 1) == 0)
      for (const int corner : {0, 1, 2, 0, 2, 3}) mesh.indices.push_back(first + kFaces[face][corner]);
}

Scene scene_of(Mesh mesh) {
  Scene scene;
  scene.name = "boxes";
  scene.materials.resize(1);
  scene.meshes = {std::move(mesh)};
  finish_scene(scene);
  return scene;
}

/// Returns a picture of a scene, seen from the front.
Image drawn(const Scene& scene, Request request, const std::vector<std::string>& planes) {
  request.width = request.height = kSide;
  request.camera.direction = Vector3{0.0f, 0.0f, -1.0f};
  return test::drawn_picture(scene, request, planes).image;
}

constexpr unsigned kFront = 1u << 5;

TEST(DefaultLooks, AoHasNeitherHalosNorRims) {
  Mesh mesh;
  add_box({-2.0f, -2.0f, -0.2f}, {2.0f, 2.0f, 0.0f}, mesh);
  add_box({-0.1f, -1.0f, 1.5f}, {0.1f, 1.0f, 1.7f}, mesh);
  const Image picture = drawn(scene_of(mesh), {.look = "ao"}, {"color.r", "depth"});
  const float nearest = *std::min_element(picture.planes[1].row(kSide / 2), picture.planes[1].row(kSide / 2) + kSide);
  int wall = 0, post = 0;
  for (int x = 12; x < kSide - 12; ++x) {
    const float depth = picture.planes[1].at(x, kSide / 2);
    (depth < nearest + 0.1f ? post : wall) += 1;
    EXPECT_GE(picture.planes[0].at(x, kSide / 2), 0.97f) << x;
  }
  EXPECT_GT(wall, 60);
  EXPECT_GT(post, 4);
}

TEST(DefaultLooks, AoDarkensCavities) {
  Mesh mesh;
  add_box({-1.0f, -1.0f, -1.0f}, {1.0f, 1.0f, 1.0f}, mesh, kFront);
  const Image picture = drawn(scene_of(mesh), {.look = "ao"}, {"color.r", "depth"});
  const float* row = picture.planes[0].row(kSide / 2);
  const float* depth = picture.planes[1].row(kSide / 2);
  const float back = depth[kSide / 2];
  int left = kSide / 2;  // the leftmost pixel of the back wall
  while (std::fabs(depth[left - 1] - back) < 0.01f) --left;
  EXPECT_LT(row[left + 1], 0.7f);
  EXPECT_GT(row[kSide / 2], row[left + 1] + 0.25f);
  // From the corner the wall lightens without steps.
  for (int x = left + 2; x < kSide / 2; ++x) EXPECT_GT(row[x], row[x - 1] - 0.02f) << x;
}

TEST(DefaultLooks, AmbientLightOfLitComesFromAbove) {
  Mesh mesh;
  add_box({-1.0f, -1.0f, -1.0f}, {1.0f, 1.0f, 1.0f}, mesh);
  const auto mean = [&](float elevation_deg, int channel) {
    Request request{.look = "lit", .occlusion = "none", .settings = {"lighting.diffuse=0"}, .ground = "off"};
    request.camera.elevation_deg = elevation_deg;
    const Image picture = drawn(scene_of(mesh), request, {"ambient.r", "ambient.b"});
    return picture.planes[std::size_t(channel)].at(kSide / 2, kSide / 2);
  };
  const float above = mean(80.0f, 0), front = mean(0.0f, 0), below = mean(-80.0f, 0);
  EXPECT_GT(above, 1.15f * front);
  EXPECT_GT(front, 1.15f * below);
  EXPECT_GT(mean(80.0f, 1) / above, 1.1f * mean(-80.0f, 1) / below);  // the sky is bluer than the ground
}

TEST(DefaultLooks, ShadowOfLitEndsSoftlyOnTheGround) {
  Mesh mesh;
  add_box({-0.3f, 0.0f, -0.3f}, {0.3f, 2.0f, 0.3f}, mesh);
  const auto soft_pixels = [&](std::optional<float> light_size_deg) {
    const Image picture = drawn(scene_of(mesh), {.look = "lit", .occlusion = "none", .light_size_deg = light_size_deg},
                                {"shadow_catcher"});
    const Plane& shadow = picture.planes[0];
    float max = 0.0f;
    for (int y = 0; y < kSide; ++y) max = std::max(max, *std::max_element(shadow.row(y), shadow.row(y) + kSide));
    EXPECT_GT(max, 0.2f);
    int count = 0;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) count += shadow.at(x, y) > 0.1f * max && shadow.at(x, y) < 0.9f * max;
    return count;
  };
  EXPECT_GT(soft_pixels({}), 1.2 * soft_pixels(0.0f));
}

bool never(const ParameterBytes&) { return false; }

/// Returns a technique that reads `input`. No device runs it.
Effect reader_of(std::string_view input, bool (*needed)(const ParameterBytes&) = nullptr) {
  Effect effect{.name = "reader", .summary = "reads a plane", .kind = EffectKind::kOcclusion};
  effect.dispatches = {{.name = "reader", .inputs = {"depth", input}, .outputs = {"ao"}, .needed = needed}};
  return effect;
}

/// Returns the names of the planes after the look `lit` with this technique and these capture settings.
std::vector<std::string> planes_with(const Effect& technique, const CaptureSettings& settings) {
  const Scene scene = *make_builtin_scene("scene:solids?detail=2000");
  const auto device = make_cpu_device();
  EXPECT_TRUE(device->prepare(scene));
  auto frame = device->capture(frame_scene(scene, {}, settings.width, settings.height), settings);
  EXPECT_TRUE(frame);
  const Effect* const external_effects[] = {&technique};
  EffectSettings effect_settings = look_settings(*find_look("lit"));
  effect_settings["reader"] = {};
  std::vector<std::string> stages;
  const auto status =
      run_look({.look = find_look("lit"),
                .occlusion = "reader",
                .settings = &effect_settings,
                .after = [&](std::string_view name) { stages.emplace_back(name); },
                .external_effects = external_effects,
                .run_external_effect = [](const Effect&, const ParameterBytes&, Frame&) -> Result<void> { return {}; }},
               *device, *frame);
  EXPECT_TRUE(status);
  EXPECT_EQ(stages, (std::vector<std::string>{"lighting", "reader", "denoise", "composite", "ground", "hide_ground",
                                              "output", "antialias"}));
  return device->download_all(*frame)->names;
}

TEST(LookLayers, PlanesReadOnLayersAreMadeOnAllLayers) {
  const CaptureSettings settings{.width = 16, .height = 16, .layers = 2, .back_sides = true, .extra_views = 1};
  const auto names = planes_with(reader_of("layer1.direct.r"), settings);
  for (int layer = 0; layer < 5; ++layer)
    for (const char* plane : {"direct.r", "ambient.b"})
      EXPECT_TRUE(contains(names, layer_plane(layer, plane))) << layer;
  EXPECT_FALSE(contains(names, "layer5.direct.r"));
  EXPECT_FALSE(contains(names, "layer1.color.r")) << "no effect reads it on that layer";
}

TEST(LookLayers, OtherPlanesAreMadeOnTheFirstLayerOnly) {
  const CaptureSettings settings{.width = 16, .height = 16, .layers = 2};
  for (const Effect& effect : {reader_of("direct.r"), reader_of("layer1.depth"), reader_of("layer1.direct.r", never)}) {
    const auto names = planes_with(effect, settings);
    EXPECT_TRUE(contains(names, "direct.r"));
    EXPECT_FALSE(contains(names, "layer1.direct.r"));
  }
}

TEST(LookLayers, TheUserWinsOverTheLook) {
  const Look look{.name = "deep", .layers = 3, .back_sides = true, .extra_views = 1};
  Request draw;
  draw.look = "ao";
  auto settings = capture_settings(draw, look, 1);
  ASSERT_TRUE(settings);
  EXPECT_EQ(settings->layers, 3);
  EXPECT_TRUE(settings->back_sides);
  EXPECT_EQ(settings->extra_views, 1);
  EXPECT_EQ(settings->shadows, 1);
  draw.layers = 1;
  draw.extra_views = 4;
  settings = capture_settings(draw, look, 1);
  ASSERT_TRUE(settings);
  EXPECT_EQ(settings->layers, 1);
  EXPECT_EQ(settings->extra_views, 4);
  draw.layers = 3;
  const auto refused = capture_settings(draw, look, 1);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kUsage);
  EXPECT_NE(refused.error().message.find("4 extra views are 10"), std::string::npos) << refused.error().message;
  draw.layers = draw.extra_views = 1;
  draw.width = draw.height = 8192;
  EXPECT_FALSE(capture_settings(draw, look, 1)) << "three layers of this size";
}

// An object close to another camera hides much of the scene from that camera, but does not occlude it.
TEST(LookLayers, FurtherCamerasDoNotDarkenUnoccludedSurfaces) {
  auto scene = load_scene("scene:room?detail=12000");
  ASSERT_TRUE(scene);
  const auto device = make_device("cpu", 0);
  ASSERT_TRUE((*device)->prepare(*scene));
  const auto occlusion_with = [&](int views) {
    Request settings;
    settings.width = 160;
    settings.height = 120;
    settings.look = "ao";
    settings.occlusion = "hemisphere";
    settings.settings = {"hemisphere.radius=25%"};
    settings.extra_views = views;
    StageTimes times;
    const auto frame = draw(**device, *scene, settings, times);
    EXPECT_TRUE(frame);
    return *(*device)->download(*frame, {"ao"});
  };
  const Image alone = occlusion_with(0), with_more_views = occlusion_with(3);
  double darker = 0.0;
  for (int y = 0; y < alone.height; ++y)
    for (int x = 0; x < alone.width; ++x)
      darker += std::max(alone.plane("ao").at(x, y) - with_more_views.plane("ao").at(x, y), 0.0f);
  // The additional cameras see occluders beyond the border, so pixels near it may be darker.
  EXPECT_LT(darker / (alone.width * alone.height), 0.02);
}

}  // namespace
}  // namespace umbrage
