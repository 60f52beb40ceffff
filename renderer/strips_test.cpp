// Pictures in strips: bitwise identical to those drawn whole, for all looks, techniques and strip sizes.
#include "renderer/strips.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "core/guarded.h"
#include "devices/cpu/cpu_device.h"
#include "effects/effects.h"
#include "looks/looks.h"
#include "renderer/draw.h"
#include "renderer/models.h"
#include "renderer/passes.h"
#include "renderer/written_passes.h"
#include "support.h"

namespace umbrage {
namespace {

Image planes_of(const Image& image, const std::vector<std::string>& names) {
  Image chosen(image.width, image.height);
  for (const std::string& name : names) chosen.add(name) = image.plane(name);
  return chosen;
}

/// Draws planes of a picture as they are written, whole (`rows` = 0) or in strips of `rows` rows.
Image drawn(const Request& settings, int rows, const std::vector<std::string>& planes, int threads = 0,
            const char* model = "scene:room?detail=3000", bool alone = false) {
  static std::map<std::string, Scene> scenes;  // one takes a second to make
  if (!scenes.count(model)) scenes[model] = *load_scene(model);
  Scene scene = scenes[model];
  const auto device = make_cpu_device({.threads = threads});
  auto recipe = make_recipe(settings, kMaxStripPixels);
  EXPECT_TRUE(recipe) << recipe.error().message;
  if (alone) reduce_to_passes(*recipe);
  EXPECT_TRUE(complete_scene(scene, *recipe));
  EXPECT_TRUE(device->prepare(scene));
  StageTimes times;
  if (rows == 0) {
    const auto frame = draw(*device, scene, *recipe, times);
    EXPECT_TRUE(frame) << frame.error().message;
    return frame ? planes_of(*download_passes(*device, *frame, planes), planes) : Image();
  }
  Image whole(settings.width, settings.height);
  for (const std::string& name : planes) whole.add(name) = Plane(whole.width, whole.height, -1.0f);
  int next = 0;
  const auto take = [&](const PictureInfo& info, const Image& part, int first) -> Result<void> {
    EXPECT_EQ(info.inner_height(), settings.height);
    EXPECT_EQ(first, next);
    next += part.height;
    for (const std::string& name : planes)
      for (int y = 0; y < part.height; ++y)
        std::copy_n(part.plane(name).row(y), part.width, whole.plane(name).row(first + y));
    return {};
  };
  const auto plan = make_plan(*recipe, scene, device->threads());
  EXPECT_TRUE(plan);
  const auto status = draw_strips(*device, *plan, rows, planes, false, take, times);
  EXPECT_TRUE(status) << status.error().message;
  EXPECT_EQ(next, settings.height);
  return whole;
}

void expect_same(const Image& a, const Image& b) { EXPECT_EQ(test::first_difference(a, b), ""); }

void expect_strips_same(const Request& settings, std::vector<int> rows = {64},
                        const std::vector<std::string>& planes = {"color.r", "color.g", "color.b", "color.a", "depth",
                                                                  "ao"}) {
  const Image whole = drawn(settings, 0, planes);
  for (const int r : rows) {
    SCOPED_TRACE(fmt::format("bands of {} rows", r));
    expect_same(whole, drawn(settings, r, planes));
  }
}

Request of_look(std::string_view look, int width = 200, int height = 150) {
  Request settings;
  settings.look = look;
  settings.width = width;
  settings.height = height;
  return settings;
}

TEST(Strips, EveryLook) {
  for (const Look* look : scene_looks()) {
    SCOPED_TRACE(look->name);
    expect_strips_same(of_look(look->name));
  }
}

TEST(Strips, EveryTechniqueAtEveryScale) {
  for (const Effect* effect : effects()) {
    if (effect->kind != EffectKind::kOcclusion) continue;
    for (const char* scale : {"full", "half", "quarter"}) {
      if (effect->filters_itself && scale != std::string_view("full")) continue;
      SCOPED_TRACE(fmt::format("{} {}", effect->name, scale));
      Request settings = of_look("bleeding", 121, 93);
      settings.occlusion = effect->name;
      settings.occlusion_scale = scale;
      expect_strips_same(settings, {32});
    }
  }
}

TEST(Strips, EveryQualityAndWhatIsAveraged) {
  for (const char* quality : {"draft", "normal", "high"}) {
    SCOPED_TRACE(quality);
    Request settings = of_look("studio", 101, 75);
    settings.quality = quality;
    settings.passes = {"ao"};
    expect_strips_same(settings, {32});
  }
}

TEST(Strips, SettingsThatReadFar) {
  const std::pair<const char*, std::vector<std::string>> all[] = {
      {"studio", {"bitmask.mips=on", "bitmask.bounces=2", "denoise.rounds=3"}},
      {"unsharp", {"unsharp.border=repeat", "unsharp.kernel=150%"}},
      {"unsharp", {"unsharp.window=gaussian"}},
      {"bleeding", {"hemisphere.bounces=3", "hemisphere.tangents=on"}},
      {"cartoon", {"outline.width=12", "gaussian.rounds=9"}},
      {"cartoon", {"denoise.for_height=16"}},
      {"cartoon-paper", {"outline.width=3"}},
      {"bleeding-paper", {"box.size=15"}}};
  for (const auto& [look, assignments] : all) {
    SCOPED_TRACE(assignments[0]);
    Request settings = of_look(look, 101, 107);
    settings.settings = assignments;
    expect_strips_same(settings, {32});
  }
}

TEST(Strips, AnySizeOfPicturesAndStrips) {
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 2}, {47, 33}, {64, 128}, {33, 131}}) {
    SCOPED_TRACE(fmt::format("{} x {}", width, height));
    expect_strips_same(of_look("studio", width, height), {16, 48, 64});
    expect_strips_same(of_look("cartoon", width, height), {16, 48});
  }
}

// In high pictures lines are followed farther, and light is smoothed over more rows.
TEST(Strips, HighPictures) { expect_strips_same(of_look("cartoon", 32, 1300), {400}); }

TEST(Strips, GuardBandsAndFurtherViews) {
  Request settings = of_look("bleeding", 101, 75);
  settings.guard_band = 20.0f;
  settings.extra_views = 2;
  settings.layers = 1;
  expect_strips_same(settings, {16, 64});
}

// Lines are those of the whole picture, traced once, in sample 0.
TEST(Strips, LinesOverAveragedFrames) {
  Request settings = of_look("cartoon", 181, 203);
  settings.settings = {"outline.width=3", "outline.r=0.5"};
  settings.guard_band = 20.0f;
  const std::vector<std::string> planes = {"color.r", "color.b", "outline", "normal.x", "depth"};
  for (const bool averaged : {false, true}) {
    if (averaged) settings.passes = {"outline"};
    for (const int frames : {2, 3, 4, 18}) {
      SCOPED_TRACE(fmt::format("{} frames, lines {}", frames, averaged ? "averaged" : "of one"));
      settings.anti_aliasing = frames;
      expect_strips_same(settings, {48}, planes);
    }
  }
}

// Includes passes of lines, which are those of sample 0.
TEST(Strips, PassesAlone) {
  for (const auto& [look, passes] : {std::pair<std::string_view, std::vector<std::string>>{"cartoon", {"outline"}},
                                     {"cartoon", {"outline", "ao"}},
                                     {"studio", {"depth"}},
                                     {"studio", {"ao", "shadow"}}}) {
    SCOPED_TRACE(fmt::format("{} {}", look, passes[0]));
    Request settings = of_look(look, 101, 107);
    settings.passes = passes;
    const Image whole = drawn(settings, 0, passes, 0, "scene:room?detail=3000", true);
    expect_same(whole, drawn(settings, 32, passes, 0, "scene:room?detail=3000", true));
    expect_same(whole, drawn(settings, 0, passes));
  }
}

TEST(Strips, DoNotDependOnThreads) {
  const Request settings = of_look("studio", 101, 75);
  const std::vector<std::string> planes = {"color.r", "color.g", "color.b", "ao"};
  const Image whole = drawn(settings, 0, planes, 3);
  for (const int threads : {1, 2, 4}) expect_same(whole, drawn(settings, 32, planes, threads));
}

TEST(Strips, SoftShadowsOfAModelInTheOpen) {
  Request settings = of_look("studio", 160, 240);
  settings.quality = "draft";
  const std::vector<std::string> planes = {"color.r", "shadow", "shadow_catcher"};
  for (const char* model : {"scene:tank?detail=2000", "scene:solids?detail=2000"})
    expect_same(drawn(settings, 0, planes, 0, model), drawn(settings, 32, planes, 0, model));
}

/// A plan of `scene:solids`, and a device to draw it.
struct Planned {
  explicit Planned(const Request& request, const char* model = "scene:solids?detail=2000") {
    Recipe recipe = *make_recipe(request, kMaxStripPixels);
    reduce_to_passes(recipe);
    scene = *load_scene(model);
    EXPECT_TRUE(complete_scene(scene, recipe));
    plan = *make_plan(recipe, scene, device->threads());
  }

  StripSizes sizes(double memory) const { return *plan_strips(*device, plan, memory); }
  /// Draws the picture, in strips if `rows` > 0. Returns the max memory of its planes, bytes.
  double drawn_bytes(int rows) {
    EXPECT_TRUE(device->prepare(scene));
    StageTimes times;
    const ScopedPlanePool pool(device->pool());
    device->pool()->take_peak();
    const auto take = [](const PictureInfo&, const Image&, int) { return Result<void>(); };
    if (rows > 0)
      EXPECT_TRUE(draw_strips(*device, plan, rows, {"color.r"}, false, take, times));
    else
      EXPECT_TRUE(draw(*device, scene, plan, times));
    return double(device->pool()->take_peak());
  }

  std::unique_ptr<Device> device = make_cpu_device({.threads = 2});
  Scene scene;
  Plan plan;
};

// A strip of the min height is as large as a low picture, and lines need whole planes besides.
TEST(Strips, AreNotPlannedWhereTheySaveNothing) {
  for (const char* look : {"cartoon", "studio"}) {
    const Planned picture(of_look(look, 8192, 64));
    const StripSizes whole = picture.sizes(6e9), low = picture.sizes(1e8);
    EXPECT_EQ(low.rows, 0) << look;
    EXPECT_EQ(low.bytes, whole.bytes) << look;
    EXPECT_TRUE(low.exceeds) << look;
    EXPECT_FALSE(whole.exceeds) << look;
  }
}

TEST(Strips, MemoryIsThatOfThePlan) {
  constexpr double kFixed = 60e6;  // for the program and the scene
  for (const Look* look : scene_looks())
    for (const char* quality : {"draft", "normal"}) {
      Request request = of_look(std::string(look->name).c_str(), 1000, 1000);
      request.quality = quality;
      SCOPED_TRACE(fmt::format("{} {}", look->name, quality));
      Planned picture(request);
      for (const double memory : {6e9, 1e6}) {
        const StripSizes sizes = picture.sizes(memory);
        const double drawn = picture.drawn_bytes(sizes.rows);
        EXPECT_NEAR((sizes.bytes - kFixed) / drawn, 1.0, 0.1) << sizes.rows;
      }
    }
}

TEST(Strips, MemoryOfBlendedSurfacesIsThatOfThePlan) {
  Planned picture(of_look("studio", 1000, 1000));
  for (Material& material : picture.scene.materials) material.blended = true, material.opacity = 0.4f;
  picture.plan = *make_plan(picture.plan.recipe, picture.scene, 2);
  ASSERT_TRUE(picture.plan.marked && picture.plan.has_blended);
  for (const double memory : {6e9, 1e6}) {
    const StripSizes sizes = picture.sizes(memory);
    const double drawn = picture.drawn_bytes(sizes.rows);
    EXPECT_NEAR((sizes.bytes - 60e6) / drawn, 1.0, 0.1) << sizes.rows;
  }
}

TEST(Strips, OnePlaneLessThanThePeakIsTooLittleMemory) {
  Planned picture(of_look("studio", 300, 200));
  const auto drawn = [&]() -> Result<void> {
    return guarded([] { return std::string("the picture"); },
                   [&]() -> Result<void> {
                     StageTimes times;
                     const auto frame = draw(*picture.device, picture.scene, picture.plan, times);
                     return frame ? Result<void>() : frame.error();
                   });
  };
  const auto peak = std::size_t(picture.drawn_bytes(0));
  PlanePool& pool = *picture.device->pool();
  pool.set_limit(peak);
  EXPECT_TRUE(drawn());
  pool.set_limit(peak - plane_bytes(300, 200));
  const auto failed = drawn();
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().kind, ErrorKind::kDevice) << failed.error().message;
}

TEST(Strips, ArePlannedWhereMemoryIsShort) {
  Request settings = of_look("studio", 1024, 1024);
  const Planned small(settings);
  EXPECT_EQ(small.sizes(6e9).rows, 0);
  EXPECT_FALSE(small.sizes(6e9).exceeds);
  EXPECT_GT(small.sizes(1.5e8).rows, 0);
  EXPECT_FALSE(small.sizes(1.5e8).exceeds);
  EXPECT_GT(small.sizes(1e6).rows, 0);
  EXPECT_TRUE(small.sizes(1e6).exceeds);
  settings.width = settings.height = 16384;
  const Planned large(settings);
  EXPECT_GT(large.sizes(6e9).rows, 0);
  EXPECT_EQ(large.sizes(6e9).rows % 4, 0);
  EXPECT_LT(large.sizes(6e9).bytes, 6e9);
  // The limit on pictures drawn whole does not depend on memory.
  EXPECT_GT(large.sizes(1e12).rows, 0);
  settings.passes = {"depth", "ao"};
  EXPECT_TRUE(make_recipe(settings, kMaxStripPixels));
  settings.occlusion = "reference";
  const Planned traced(settings);
  EXPECT_EQ(plan_strips(*traced.device, traced.plan, 6e9).error().kind, ErrorKind::kUsage);
}

}  // namespace
}  // namespace umbrage
