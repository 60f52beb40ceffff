// Only requested passes are captured and computed; their values at pixels without surface.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "devices/cpu/cpu_device.h"
#include "renderer/draw.h"
#include "renderer/models.h"
#include "renderer/passes.h"
#include "renderer/written_passes.h"

namespace umbrage {
namespace {

/// A picture and how it was drawn.
struct Made {
  std::vector<std::string> stages;
  Recipe recipe;
  Image planes;
  std::vector<std::string> names;  // all planes of the frame
};

/// Draws only these passes of a look, or the whole picture if there are none. Downloads `planes`.
Made made_for(const std::string& look, const std::vector<std::string>& passes, const std::vector<std::string>& planes) {
  Request request{.look = look, .width = 48, .height = 36, .passes = passes};
  Made made{.stages = {}, .recipe = *make_recipe(request), .planes = {}, .names = {}};
  reduce_to_passes(made.recipe);
  auto scene = load_scene("scene:solids?detail=2000");
  const auto device = make_cpu_device();
  EXPECT_TRUE(complete_scene(*scene, made.recipe));
  EXPECT_TRUE(device->prepare(*scene));
  StageTimes times;
  const auto frame = draw(*device, *scene, made.recipe, times);
  EXPECT_TRUE(frame) << frame.error().message;
  for (const auto& stage : times.stages) made.stages.push_back(stage.name);
  made.planes = *device->download(*frame, planes);
  made.names = device->plane_names(*frame);
  return made;
}

using Names = std::vector<std::string>;

TEST(Wanted, GeometryTakesOneCaptureWithoutShadows) {
  for (const char* look : {"studio", "bleeding", "cartoon"}) {
    SCOPED_TRACE(look);
    const Made made = made_for(look, {"normal", "albedo"}, {"normal.x", "albedo.g"});
    EXPECT_EQ(made.stages, Names({"capture"}));
    EXPECT_EQ(made.recipe.frames, 1);
    EXPECT_EQ(made.recipe.capture.shadows, 0);
    EXPECT_EQ(*layer_count(made.recipe.capture), 1);
  }
  const Made depth = made_for("studio", {"depth"}, {"depth"});
  EXPECT_EQ(depth.stages, Names({"capture", "hide_ground"}));
  EXPECT_EQ(std::count(depth.names.begin(), depth.names.end(), "albedo.r"), 0);
  const Names& captured = *depth.recipe.capture.planes;
  EXPECT_NE(std::count(captured.begin(), captured.end(), "object_id"), 0) << "it identifies the ground";
}

TEST(Wanted, PassesMatchTheWholePicture) {
  for (const char* look : {"studio", "ao", "bleeding", "lit", "cartoon"})
    for (const auto& [pass, planes] : {std::pair<std::string, Names>{"depth", {"depth"}},
                                       {"ao", {"ao"}},
                                       {"albedo", {"albedo.r", "albedo.g", "albedo.b"}},
                                       {"normal", {"normal.x", "normal.y", "normal.z"}},
                                       {"object_id", {"object_id"}},
                                       {"shadow", {"shadow"}}}) {
      SCOPED_TRACE(look + (" " + pass));
      const Made alone = made_for(look, {pass}, planes);
      Request request{.look = look, .width = 48, .height = 36, .passes = {pass}};
      auto scene = load_scene("scene:solids?detail=2000");
      const auto device = make_cpu_device();
      const auto recipe = make_recipe(request);
      EXPECT_TRUE(complete_scene(*scene, *recipe));
      ASSERT_TRUE(device->prepare(*scene));
      StageTimes times;
      const auto frame = draw(*device, *scene, *recipe, times);
      ASSERT_TRUE(frame);
      const Image whole = *device->download(*frame, planes);
      for (std::size_t k = 0; k < planes.size(); ++k)
        for (int y = 0; y < whole.height; ++y)
          for (int x = 0; x < whole.width; ++x)
            ASSERT_EQ(alone.planes.planes[k].at(x, y), whole.planes[k].at(x, y)) << planes[k] << ' ' << x << ' ' << y;
      EXPECT_LT(alone.stages.size(), times.stages.size());
    }
}

TEST(Wanted, APictureKeepsOnlyWhatIsReadAfterIt) {
  const Names color = {"color.r", "color.g", "color.b", "color.a"};
  for (const Look* look : scene_looks()) {
    SCOPED_TRACE(look->name);
    const Made alone = made_for(std::string(look->name), {}, color);
    EXPECT_EQ(std::count(alone.names.begin(), alone.names.end(), "albedo.r"), 0);
    EXPECT_EQ(std::count(alone.names.begin(), alone.names.end(), "lit.r"), 0);
    Request request{.look = std::string(look->name), .width = 48, .height = 36};
    auto scene = load_scene("scene:solids?detail=2000");
    const auto device = make_cpu_device();
    const auto recipe = make_recipe(request);
    EXPECT_TRUE(complete_scene(*scene, *recipe));
    ASSERT_TRUE(device->prepare(*scene));
    StageTimes times;
    const auto frame = draw(*device, *scene, *recipe, times);
    ASSERT_TRUE(frame);
    EXPECT_GT(device->plane_names(*frame).size(), alone.names.size());
    const Image whole = *device->download(*frame, color);
    for (std::size_t k = 0; k < color.size(); ++k)
      for (int y = 0; y < whole.height; ++y)
        for (int x = 0; x < whole.width; ++x)
          ASSERT_EQ(alone.planes.planes[k].at(x, y), whole.planes[k].at(x, y)) << color[k] << ' ' << x << ' ' << y;
  }
}

TEST(Wanted, OcclusionAloneRunsNoOtherEffects) {
  const Made made = made_for("cartoon", {"ao"}, {"ao"});
  EXPECT_EQ(std::count(made.stages.begin(), made.stages.end(), "toon"), 0);
  EXPECT_EQ(std::count(made.stages.begin(), made.stages.end(), "outline"), 0);
  EXPECT_EQ(std::count(made.stages.begin(), made.stages.end(), "output"), 0);
  EXPECT_EQ(std::count(made.stages.begin(), made.stages.end(), "sphere"), 1);
  EXPECT_EQ(made.recipe.frames, 4) << "it is averaged";
}

// make_plan reports passes that neither the capture nor a uniform plane provides. A picture has all passes that
// make_plan accepts.
TEST(Wanted, PlansReportPassesThatTheSceneLacks) {
  auto scene = load_scene("scene:solids?detail=2000");
  const auto device = make_cpu_device();
  int refused = 0, made = 0;
  for (const char* look : {"studio", "bleeding", "lit"})
    for (const char* scale : {"full", "half", "quarter"})
      for (const Names& passes : std::vector<Names>{{"emission"},
                                                    {"shadow1"},
                                                    {"shadow4"},
                                                    {"emission", "color"},
                                                    {"shadow4", "color"},
                                                    {"shadow4", "ao"},
                                                    {"layer1.emission", "color"},
                                                    {"layer1.shadow1", "depth"},
                                                    {"layer1.shadow4", "indirect"}}) {
        Request request{.look = look, .width = 24, .height = 18, .passes = passes};
        request.layers = 2;
        request.occlusion_scale = scale;
        request.anti_aliasing = 1;
        auto recipe = make_recipe(request);
        if (!recipe) continue;  // the look has no such pass
        reduce_to_passes(*recipe);
        const auto plan = make_plan(*recipe, *scene, device->threads());
        Recipe unchecked = *recipe;
        unchecked.passes.clear();
        unchecked.averaged.clear();
        ASSERT_TRUE(device->prepare(*scene));
        StageTimes times;
        const auto frame = draw(*device, *scene, unchecked, times);
        ASSERT_TRUE(frame) << frame.error().message;
        const auto chosen = chosen_planes(passes, device->plane_names(*frame), frame->info);
        EXPECT_EQ(bool(plan), bool(chosen)) << look << ' ' << scale << ' ' << passes[0] << ' ' << passes.back();
        ++(plan ? made : refused);
        if (plan) continue;
        EXPECT_EQ(plan.error().kind, ErrorKind::kUsage);
        EXPECT_NE(plan.error().message.find("`passes`"), std::string::npos) << plan.error().message;
      }
  EXPECT_GT(refused, 10);
  EXPECT_GT(made, 10);
}

TEST(Background, PlanesOfMaterialsHaveThoseOfACaptureWithoutSurface) {
  Image image(3, 1);
  image.add("depth") = Plane(3, 1, 2.0f);
  image.plane("depth").at(1, 0) = std::numeric_limits<float>::infinity();
  image.add("object_id") = Plane(3, 1, 0.0f);
  image.plane("object_id").at(2, 0) = 7.0f;  // the unseen ground
  const std::pair<const char*, float> expected[] = {{"metallic", 0.0f}, {"roughness", -1.0f}, {"material_ao", 1.0f}};
  for (const auto& [name, value] : expected) image.add(name) = Plane(3, 1, 0.5f);
  set_background(image, 7);
  for (const auto& [name, value] : expected) {
    EXPECT_EQ(image.plane(name).at(0, 0), 0.5f) << name;
    EXPECT_EQ(image.plane(name).at(1, 0), value) << name;
    EXPECT_EQ(image.plane(name).at(2, 0), value) << name;
  }
}

}  // namespace
}  // namespace umbrage
