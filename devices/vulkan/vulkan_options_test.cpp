// Tests that the right constants of a kernel become part of its shader, and that the shader remains valid.
#include "devices/vulkan/options.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>

#include "devices/vulkan/pipelines.h"
#include "effects/bitmask/bitmask.h"
#include "effects/effects.h"
#include "effects/hemisphere/hemisphere.h"

namespace umbrage {
namespace {

const Dispatch& dispatch_of(std::string_view effect, std::string_view name) {
  const auto& dispatches = find_effect(effect)->dispatches;
  return *std::find_if(dispatches.begin(), dispatches.end(),
                       [&](const Dispatch& dispatch) { return dispatch.name == name; });
}

const KernelOption* option_at(const KernelOptions& options, std::size_t offset) {
  for (const KernelOption& option : options.options)
    if (option.offset == offset) return &option;
  return nullptr;
}

TEST(KernelOptions, AreTheConstantsThatTheKernelCompares) {
  const KernelOptions options = options_of(dispatch_of("hemisphere", "occlusion").kernel.spirv);
  const std::size_t effect = sizeof(FrameConstants);
  const KernelOption* range = option_at(options, effect + offsetof(HemisphereConstants, range));
  ASSERT_NE(range, nullptr);
  EXPECT_EQ(range->count, 1);
  const KernelOption* other = option_at(options, effect + offsetof(HemisphereConstants, other));
  ASSERT_NE(other, nullptr);
  EXPECT_EQ(other->count, kLayersRead);
  EXPECT_NE(option_at(options, effect + offsetof(HemisphereConstants, layer_count)), nullptr);
  EXPECT_NE(option_at(options, offsetof(FrameConstants, orthographic)), nullptr);
  // Counters and operands are not options: all their values share one shader.
  EXPECT_EQ(option_at(options, effect + offsetof(HemisphereConstants, samples)), nullptr);
  EXPECT_EQ(option_at(options, effect + offsetof(HemisphereConstants, seed)), nullptr);
  EXPECT_EQ(option_at(options, offsetof(FrameConstants, width)), nullptr);
}

TEST(KernelOptions, AreReadFromTheBlock) {
  KernelOptions options;
  options.options = {{4, 1}, {8, 3}, {20, 2}};
  const std::int32_t block[] = {9, -5, 7, 7, 7, 1, 2};
  const auto values = option_values(options, std::as_bytes(std::span(block)));
  ASSERT_EQ(values.size(), 3u);
  EXPECT_EQ(values[0], -5);
  EXPECT_EQ(values[1], 7);
  EXPECT_EQ(values[2], std::nullopt);  // elements differ
}

TEST(KernelOptions, ReplaceLoads) {
  for (const Effect* effect : effects())
    for (const Dispatch& dispatch : effect->dispatches) {
      if (dispatch.host) continue;
      const KernelOptions options = options_of(dispatch.kernel.spirv);
      std::vector<std::optional<std::int32_t>> values(options.options.size(), 3);
      const auto words = with_options(dispatch.kernel.spirv, options, values);
      EXPECT_EQ(words.size(), dispatch.kernel.spirv.size() + 4 * options.loads.size()) << effect->name;
      EXPECT_EQ(slots_of(words).size(), slots_of(dispatch.kernel.spirv).size()) << effect->name;
      // Nothing is left to replace, and the shader is unchanged if no value is known.
      EXPECT_TRUE(options_of(words).loads.empty()) << effect->name << ' ' << dispatch.name;
      std::fill(values.begin(), values.end(), std::nullopt);
      const auto same = with_options(dispatch.kernel.spirv, options, values);
      EXPECT_TRUE(std::equal(same.begin(), same.end(), dispatch.kernel.spirv.begin(), dispatch.kernel.spirv.end()))
          << effect->name;
    }
}

}  // namespace
}  // namespace umbrage
