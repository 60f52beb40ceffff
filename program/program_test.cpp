// Programs of all looks, checked without drawing.
#include "program/program.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "build_paths.h"
#include "core/lists.h"
#include "effects/effects.h"
#include "effects/traced/traced.h"
#include "renderer/passes.h"
#include "renderer/recipe.h"

namespace umbrage {
namespace {

/// Returns the recipe of a look's picture, reduced to what it needs.
Recipe recipe_of(const Look& look, const std::string& quality = "", const std::string& scale = "") {
  const Request request{.look = std::string(look.name),
                        .occlusion = scale.empty() ? "" : "bitmask",
                        .quality = quality,
                        .occlusion_scale = scale};
  auto recipe = make_recipe_of_look(request);
  if (!recipe) fail_check(recipe.error().message);
  reduce_to_passes(*recipe);
  return *recipe;
}

Program program_of(const Recipe& recipe) { return compile(look_run(recipe), *layer_count(recipe.capture)); }

/// Calls `check` with the program of every look, quality and scale of occlusion.
void for_programs(const std::function<void(const Program&)>& check) {
  for (const Look* look : looks())
    for (const std::string quality : {"", "draft", "high"})
      for (const std::string scale : {"", "full", "half", "quarter"}) {
        if (look->needs_beauty && !quality.empty()) continue;
        SCOPED_TRACE(fmt::format("{} {} {}", look->name, quality, scale));
        check(program_of(recipe_of(*look, quality, scale)));
      }
}

TEST(Program, EveryReadHasAWriterANeutralValueOrACapture) {
  // The planes of core/gbuffer.h that have no neutral value, and the finished picture of another renderer.
  const std::vector<std::string> given = {"depth",        "normal.x",     "normal.y", "normal.z", "ray_offset.x",
                                          "ray_offset.y", "ray_offset.z", "beauty.r", "beauty.g", "beauty.b"};
  for_programs([&](const Program& program) {
    std::vector<char> written(program.planes.size());
    for (const Operation& operation : program.operations) {
      for (const int id : operation.reads) {
        const ProgramPlane& plane = program.planes[std::size_t(id)];
        const bool is_own = contains(operation.writes, id);  // of an earlier dispatch or round
        EXPECT_TRUE(written[std::size_t(id)] || is_own || neutral_value(plane.name) ||
                    contains(given, name_on_first_layer(plane.name)))
            << plane.name << " at 1/" << plane.reduced;
      }
      for (const int id : operation.writes) written[std::size_t(id)] = 1;
    }
  });
}

TEST(Program, PlanesLiveFromTheirWriterToTheirLastReader) {
  for_programs([](const Program& program) {
    for (std::size_t id = 0; id < program.planes.size(); ++id) {
      const ProgramPlane& plane = program.planes[id];
      EXPECT_GE(plane.last_user, 0) << plane.name;
      for (std::size_t k = std::size_t(plane.last_user) + 1; k < program.operations.size(); ++k) {
        EXPECT_FALSE(contains(program.operations[k].reads, int(id))) << plane.name;
        EXPECT_FALSE(contains(program.operations[k].writes, int(id))) << plane.name;
      }
    }
    int open = 0;  // frames of reduced resolution
    for (const Operation& operation : program.operations) {
      open += operation.kind == OperationKind::kReduce ? 1 : 0;
      EXPECT_EQ(operation.reduced > 1, open == 1);
      open -= operation.kind == OperationKind::kPlace ? 1 : 0;
    }
    EXPECT_EQ(open, 0);
  });
}

TEST(Program, ReachesAddUp) {
  Look look;
  look.effects = {"occlusion"};
  EffectSettings settings = initial_settings(external_effects());
  auto& params = as<TracedParams>(params_of(settings, "traced"));
  params.rays = 1.0f;
  const PictureInfo info{.width = 64, .height = 48, .scene_radius = 1.0f};
  TracedConstants constants{};
  find_effect("traced")->constants(params_of(settings, "traced"), info, &constants);
  constexpr int kRays = 2, kJoints = 8;  // the joint weights of the farthest neighbours
  int expected = kRays + kJoints;
  for (int round = 0; round < constants.rounds; ++round)
    expected += (constants.far_weight[round] > 0.0f ? 2 : 1) << constants.power[round];
  const LookRun run{.look = &look, .occlusion = "traced", .settings = &settings};
  const Margins margins = margins_before(run, info, {}, {{"ao", {3, 1}}});
  EXPECT_EQ(margins.at("depth").rows, 3 + expected);
  EXPECT_EQ(margins.at("depth").columns, 1 + expected);
  // Screen-space techniques read depth anywhere, and the normal at the pixel alone.
  const LookRun anywhere{.look = &look, .occlusion = "alchemy", .settings = &settings};
  const Margins far = margins_before(anywhere, info, {}, {{"ao", {3, 1}}});
  EXPECT_EQ(far.at("depth").rows, kAnywhere);
  EXPECT_EQ(far.at("normal.x").rows, 3);
  const std::vector<std::string> given = {"depth", "normal.x", "normal.y", "normal.z"};
  const StripNeeds needs = needs_of_strips(anywhere, info, {}, given, {{"ao", {3, 1}}});
  ASSERT_EQ(needs.sweeps.size(), 2u) << "one to gather the depth of all strips";
  EXPECT_EQ(needs.sweeps[0].at("depth").rows, 0);
  EXPECT_EQ(needs.sweeps[1].at("normal.x").rows, 3);
  EXPECT_EQ(needs.whole_planes, 1.0);
}

TEST(Program, TablesAreThoseRecorded) {
  std::string text;
  for (const char* name : {"ao", "cartoon", "studio", "technical"}) {
    text += fmt::format("{}\n", name);
    for (const OperationText& each : described(program_of(recipe_of(*find_look(name)))))
      text += fmt::format("  {}: {}\n", each.name, each.summary);
  }
  std::ifstream file(std::string(test::kSourceFolder) + "/program/programs.txt");
  std::stringstream recorded;
  recorded << file.rdbuf();
  EXPECT_EQ(text, recorded.str());
}

}  // namespace
}  // namespace umbrage
