// Times on a Vulkan device, by turns. They are printed, not judged: machines are never idle enough for that. Run with
// umbrage_tests --gtest_also_run_disabled_tests --gtest_filter='VulkanSpeed.*'
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "apps/job/job.h"
#include "devices/cpu/cpu_device.h"
#include "devices/vulkan/vulkan_device.h"
#include "run_effect.h"
#include "vulkan_support.h"

namespace umbrage {
namespace {

constexpr int kTurns = 9;

std::unique_ptr<Device> device_without_validation(bool tuned) {
  auto made = make_vulkan_device({.tuned = tuned}, make_cpu_device());
  return made ? std::move(*made) : nullptr;
}

double median(std::vector<double> ms) {
  std::sort(ms.begin(), ms.end());
  return ms[ms.size() / 2];
}

/// The scene as the look `unsharp` captures it.
Result<Frame> captured(Device& device, const char* scene_name, int width, int height) {
  auto scene = load_scene(scene_name);
  if (!scene) return scene.error();
  if (auto ready = device.prepare(*scene); !ready) return ready.error();
  DrawSettings settings;
  settings.width = width;
  settings.height = height;
  settings.look = "unsharp";
  StageTimes ignored;
  return draw(device, *scene, settings, ignored);
}

/// Milliseconds on the GPU of all passes of an effect but those of that name.
double gpu_ms(Device& device, const Effect& effect, const ParameterBytes& params, Frame& frame,
              std::string_view without = {}) {
  device.take_pass_times();
  EXPECT_TRUE(device.run(effect, params, frame));
  EXPECT_TRUE(device.finish());
  double ms = 0.0;
  for (const PassTime& pass : device.take_pass_times())
    if (pass.pass != without) ms += pass.ms;
  return ms;
}

TEST(VulkanSpeed, DISABLED_UnsharpByItsWaysAndPlain) {
  const auto tuned = device_without_validation(true), plain = device_without_validation(false);
  UMBRAGE_NEEDS_VULKAN(tuned && plain);
  fmt::print("{}\nms of unsharp, median of {} by turns: its ways, plain, ratio\n", tuned->description(), kTurns);
  const Effect& effect = *find_effect("unsharp");
  auto a = captured(*tuned, "scene:claw", 512, 512), b = captured(*plain, "scene:claw", 512, 512);
  ASSERT_TRUE(a && b);
  for (const char* threshold : {"0", "0.02"})
    for (const char* kernel : {"8", "12", "15", "40", "121"}) {
      const ParameterBytes params = test::parameters_of(effect, {{"kernel", kernel}, {"threshold", threshold}});
      std::vector<double> ways, whole;
      for (int turn = 0; turn <= kTurns; ++turn) {
        const double of_ways = gpu_ms(*tuned, effect, params, *a, "linearize");
        const double of_plain = gpu_ms(*plain, effect, params, *b, "linearize");
        if (turn == 0) continue;
        ways.push_back(of_ways);
        whole.push_back(of_plain);
      }
      fmt::print("k = {:>3}, threshold {:<5} {:8.2f} {:8.2f} {:6.2f}\n", kernel, threshold, median(ways), median(whole),
                 median(whole) / median(ways));
    }
}

}  // namespace
}  // namespace umbrage
