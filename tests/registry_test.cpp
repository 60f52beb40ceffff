// Tests that the registry and its parameter tables are complete and consistent, and of the parsing of values.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>

#include "build_paths.h"
#include "devices/vulkan/pipelines.h"
#include "effects/effects.h"
#include "looks/looks.h"

namespace umbrage {
namespace {

TEST(Registry, TablesCoverEveryFieldOfTheirParams) {
  for (const Effect* effect : effects()) {
    std::set<std::size_t> bytes;
    for (const Parameter& row : effect->parameters)
      for (std::size_t k = 0; k < parameter_size(row.type); ++k)
        EXPECT_TRUE(bytes.insert(row.offset + k).second) << effect->name << '.' << row.name << " overlaps another row";
    EXPECT_EQ(bytes.size(), effect->params_size) << effect->name << " has fields without a row";
  }
}

TEST(Registry, RowsAreUsable) {
  for (const Effect* effect : effects()) {
    EXPECT_FALSE(effect->summary.empty()) << effect->name;
    std::set<std::string_view> names;
    for (const Parameter& row : effect->parameters) {
      EXPECT_TRUE(names.insert(row.name).second) << effect->name << '.' << row.name << " twice";
      EXPECT_FALSE(row.help.empty()) << effect->name << '.' << row.name;
      ParameterBytes bytes = initial_parameters(effect->parameters, effect->params_size);
      const std::string text = parameter_text(row, bytes);
      EXPECT_TRUE(set_parameter(effect->name, row, text, bytes)) << effect->name << '.' << row.name << " = " << text;
      EXPECT_EQ(parameter_text(row, bytes), text);
      EXPECT_FALSE(set_parameter(effect->name, row, "nonsense", bytes));
      EXPECT_FALSE(set_parameter(effect->name, row, "", bytes));
      EXPECT_FALSE(set_parameter(effect->name, row, "nan", bytes));
      EXPECT_FALSE(set_parameter(effect->name, row, "1e99", bytes));
    }
  }
}

TEST(Registry, PassesHaveAllTheirKernelsAndConsistentPlanes) {
  for (const Effect* effect : effects())
    for (const Dispatch& dispatch : effect->dispatches) {
      EXPECT_FALSE(dispatch.outputs.empty()) << effect->name;
      if (dispatch.host) {
        EXPECT_TRUE(!dispatch.kernel.scalar && !dispatch.kernel.lanes && !dispatch.tuned &&
                    dispatch.kernel.spirv.empty() && dispatch.gpu_variants.empty())
            << effect->name << ": a host step has no kernel";
        EXPECT_TRUE(!dispatch.reach && dispatch.for_all && !dispatch.for_missing)
            << effect->name << ": a host step works on whole planes";
        continue;
      }
      EXPECT_NE(dispatch.kernel.scalar, nullptr) << effect->name;
      EXPECT_NE(dispatch.kernel.lanes, nullptr) << effect->name;
      ASSERT_GT(dispatch.kernel.spirv.size(), 5u) << effect->name;
      EXPECT_EQ(dispatch.kernel.spirv[0], 0x07230203u) << effect->name << ": not SPIR-V";
      EXPECT_EQ(dispatch.tile.width % 16, 0) << effect->name;
    }
}

void expect_exactly_its_planes(const GpuStep& step, std::string_view effect) {
  std::set<std::string> slots;
  std::set<std::uint32_t> constants;
  for (const Slot& slot : slots_of(step.spirv)) {
    slots.insert(slot.plane);
    EXPECT_TRUE(constants.insert(slot.constant).second) << slot.plane << " shares its number";
  }
  std::set<std::string> expected;
  for (std::string_view name : plane_table(step)) expected.insert(slot_name(name));
  EXPECT_EQ(slots, expected) << effect << ", pass " << step.name;
}

TEST(Registry, ShadersReachExactlyTheirPlanes) {
  for (const Effect* effect : effects())
    for (const Dispatch& dispatch : effect->dispatches) {
      GpuStep step = plain_step(dispatch);
      if (dispatch.rays) {  // the kernel makes the rays, and the device reads depth and writes the outputs
        std::erase(step.inputs, "depth");
        step.outputs = {"ray.x", "ray.y", "ray.z"};
      }
      if (!dispatch.host) expect_exactly_its_planes(step, effect->name);
      for (std::string_view name : dispatch.later_inputs)
        EXPECT_NE(std::find(dispatch.inputs.begin(), dispatch.inputs.end(), name), dispatch.inputs.end())
            << effect->name << name;
      for (const GpuVariant& variant : dispatch.gpu_variants) {
        std::set<std::string_view> available(dispatch.inputs.begin(), dispatch.inputs.end()), written;
        for (const GpuStep& step : variant.steps) {
          expect_exactly_its_planes(step, effect->name);
          for (std::string_view name : step.inputs)
            EXPECT_TRUE(available.contains(name)) << effect->name << ' ' << name;
          written.insert(step.outputs.begin(), step.outputs.end());
          available.insert(step.outputs.begin(), step.outputs.end());
        }
        for (std::string_view name : dispatch.outputs)
          EXPECT_TRUE(written.contains(name)) << effect->name << ' ' << name;
      }
    }
}

TEST(Registry, EveryEffectHasACompleteFolder) {
  for (const Effect* effect : effects()) {
    const std::string folder = fmt::format("{}/effects/{}/", test::kSourceFolder, effect->name);
    // A host step has no kernel text.
    const bool on_host =
        std::any_of(effect->dispatches.begin(), effect->dispatches.end(), [](const Dispatch& p) { return p.host; });
    const std::string text = fmt::format("{}.{}", effect->name, on_host ? "cpp" : "kernel.h");
    for (const std::string& file :
         {std::string("README.md"), fmt::format("{}.h", effect->name), text, fmt::format("{}_test.cpp", effect->name)})
      EXPECT_TRUE(std::ifstream(folder + file)) << folder << file << " is missing";
    std::stringstream readme;
    readme << std::ifstream(folder + "README.md").rdbuf();
    for (const Parameter& row : effect->parameters)
      EXPECT_NE(readme.str().find(fmt::format("`{}`", row.name)), std::string::npos)
          << folder << "README.md does not explain " << row.name;
  }
}

TEST(Registry, LooksNameEffectsAndParametersThatExist) {
  for (const Look* look : looks()) {
    look_settings(*look);  // aborts on an invalid preset
    for (std::string_view name : look->effects)
      EXPECT_TRUE(name == "occlusion" || find_effect(name)) << look->name << ": " << name;
    const auto techniques = occlusion_names();
    EXPECT_NE(std::find(techniques.begin(), techniques.end(), look->occlusion), techniques.end()) << look->name;
  }
}

TEST(Settings, AssignmentsSayWhatIsWrong) {
  EffectSettings settings = look_settings(*find_look("ao"));
  EXPECT_TRUE(apply_setting(settings, "unsharp.kernel=40"));
  EXPECT_TRUE(apply_setting(settings, "unsharp.kernel=4%"));
  const auto message = [&](std::string_view text) {
    const auto status = apply_setting(settings, text);
    EXPECT_FALSE(status) << text;
    return status ? std::string() : status.error().message;
  };
  EXPECT_NE(message("unsharp.kernel=0").find("1 to 1023 px"), std::string::npos);
  EXPECT_NE(message("unsharp.kernel=1024").find("'1024'"), std::string::npos);
  EXPECT_NE(message("unsharp.kernel=-3%").find("-3%"), std::string::npos);
  EXPECT_NE(message("unsharp.border=clmp").find("did you mean 'clamp'"), std::string::npos);
  EXPECT_NE(message("unsharp.kernl=3").find("did you mean 'kernel'"), std::string::npos);
  EXPECT_NE(message("unshrp.kernel=3").find("did you mean 'unsharp'"), std::string::npos);
  EXPECT_NE(message("unsharp.kernel").find("effect.parameter=value"), std::string::npos);
  EXPECT_NE(message("unsharp=3").find("effect.parameter=value"), std::string::npos);
}

}  // namespace
}  // namespace umbrage
