// Tests Dispatch::reach of every effect: no dispatch reads rows beyond it. Pictures drawn in strips rely on it.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "core/lists.h"
#include "devices/shared/dispatches.h"
#include "effects/effects.h"
#include "kernel/kernel_frame.h"
#include "renderer/recipe.h"
#include "support.h"

namespace umbrage {
namespace {

constexpr int kWidth = 32, kHeight = 217;       // so high that `toon` smooths in three rounds
constexpr int kFirst = kHeight / 2, kRows = 3;  // the rows that are computed

using Planes = std::map<std::string, Plane, std::less<>>;

/// Returns a plane of random numbers for an input that no G-buffer and no earlier dispatch has.
Plane random_plane(std::string_view name) {
  unsigned seed = 0;
  for (const char letter : name) seed = test::hash(seed + unsigned(letter));
  Plane plane(kWidth, kHeight, 0.0f);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) plane.at(x, y) = float(test::hash(unsigned(x + 4099 * y) + seed) >> 8) * 0x1p-24f;
  return plane;
}

/// Returns the plane, mirrored in both directions where a row is more than `reach` rows away from the computed ones.
Plane changed_beyond(const Plane& plane, int reach) {
  Plane changed = plane;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth && (y < kFirst - reach || y >= kFirst + kRows + reach); ++x)
      changed.at(x, y) = plane.at(kWidth - 1 - x, kHeight - 1 - y);
  return changed;
}

bool is_same(float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); }

/// Computes the rows of a tile. `changed`: planes that replace those of `planes` as inputs.
Planes computed(const Dispatch& dispatch, CpuKernel kernel, const FrameConstants& frame, const void* constants,
                Planes& planes, Planes& changed, const Tile& tile) {
  Planes outputs;
  std::vector<KernelPlane> of_kernel;
  for (const std::string_view name : dispatch.inputs) {
    const auto replaced = changed.find(name);
    Plane& plane = replaced != changed.end() ? replaced->second : planes.find(name)->second;
    const bool is_output = contains(dispatch.outputs, name);
    if (is_output) outputs.emplace(name, plane);
    of_kernel.push_back({name, is_output ? outputs.find(name)->second.data() : plane.data()});
  }
  for (const std::string_view name : dispatch.outputs)
    if (const auto [output, added] = outputs.try_emplace(std::string(name), Plane(kWidth, kHeight, 0.0f)); added)
      of_kernel.push_back({name, output->second.data()});
  kernel({frame, constants, of_kernel}, tile);
  return outputs;
}

/// Runs all dispatches of an effect, and compares the rows of each with those that it computes from changed planes.
void check_reach(const Effect& effect, const ParameterBytes& params, const GBuffer& g) {
  Planes planes;
  for (std::size_t k = 0; k < g.layers[0].planes.size(); ++k) planes[g.layers[0].names[k]] = g.layers[0].planes[k];
  std::vector<char> constants(effect.constants_size);
  effect.constants(params, g.info, constants.data());
  const int rounds = effect.rounds ? std::min(effect.rounds(params, g.info), 3) : 1;
  for (int round = 0; round < rounds; ++round)
    for (const Dispatch& dispatch : effect.dispatches) {
      if (!runs(dispatch, params)) continue;
      for (const auto* names : {&dispatch.inputs, &dispatch.outputs})
        for (const std::string_view name : *names)
          if (!planes.contains(name)) planes.emplace(name, random_plane(name));
      if (dispatch.host || dispatch.rays) continue;
      SCOPED_TRACE(fmt::format("{}, dispatch {}, round {}", effect.name, dispatch.name, round));
      const FrameConstants frame = frame_constants(g.info, planes.begin()->second.stride, round);
      Planes none;
      if (dispatch.reach) {
        const int reach = dispatch.reach(constants.data(), round);
        EXPECT_LT(reach, kFirst) << "the picture is too low for this test";
        Planes changed;
        const auto& unbounded = dispatch.unbounded_inputs;
        for (const std::string_view name : dispatch.inputs)
          // Planes at reduced resolution have other rows.
          if (!name.starts_with("reduced_") && !contains(unbounded, name))
            changed.emplace(name, changed_beyond(planes.find(name)->second, reach));
        const Tile tile{0, kFirst, kWidth, kFirst + kRows};
        for (const CpuKernel kernel : {dispatch.kernel.scalar, dispatch.kernel.lanes, dispatch.tuned}) {
          if (!kernel) continue;
          const Planes expected = computed(dispatch, kernel, frame, constants.data(), planes, none, tile);
          const Planes found = computed(dispatch, kernel, frame, constants.data(), planes, changed, tile);
          for (const std::string_view name : dispatch.outputs) {
            const Plane &a = expected.find(name)->second, &b = found.find(name)->second;
            int differing = 0;
            for (int y = kFirst; y < kFirst + kRows; ++y)
              for (int x = 0; x < kWidth; ++x) differing += !is_same(a.at(x, y), b.at(x, y));
            EXPECT_EQ(differing, 0) << name << " depends on rows beyond the reach of " << reach;
          }
        }
      }
      Planes all =
          computed(dispatch, dispatch.kernel.lanes, frame, constants.data(), planes, none, {0, 0, kWidth, kHeight});
      for (auto& [name, plane] : all) planes.find(name)->second = std::move(plane);
    }
}

TEST(Reach, NoDispatchReadsRowsBeyondIt) {
  for (const bool orthographic : {false, true}) {
    GBuffer g = test::bumpy_gbuffer(kWidth, kHeight, 11);
    if (orthographic) g.info.camera = orthographic_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 3.0f, 1.5f);
    for (const Effect* effect : effects())
      for (const std::string_view variant : effect->variants) {
        EffectSettings settings;
        const std::string name(effect->name);
        settings.emplace(name, initial_parameters(effect->parameters, effect->params_size));
        ASSERT_TRUE(apply_variant(settings, *effect, variant)) << variant;
        SCOPED_TRACE(variant);
        check_reach(*effect, settings.at(name), g);
      }
  }
}

}  // namespace
}  // namespace umbrage
