// Tests of looks with several depth layers: the effects that run on each, and the layers that a look captures.
#include <gtest/gtest.h>

#include "core/lists.h"
#include "devices/cpu/cpu_device.h"
#include "generators/builtin.h"
#include "renderer/devices.h"
#include "renderer/draw.h"
#include "renderer/models.h"

namespace umbrage {
namespace {

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
