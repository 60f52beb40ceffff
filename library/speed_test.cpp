// Measures the overhead of a job beyond its effects. Disabled, since timings are noisy. docs/performance.md has
// results.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <vector>

#include "devices/cpu/cpu_device.h"
#include "library/shared_gbuffer.h"
#include "renderer/shade_file.h"
#include "umbrage/umbrage.h"

namespace umbrage {
namespace {

constexpr int kWidth = 1920, kHeight = 1080;
constexpr std::size_t kPixels = std::size_t(kWidth) * kHeight;

double now_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + long(values.size() / 2), values.end());
  return values[values.size() / 2];
}

/// A sphere in front of a wall, in planar arrays.
struct Planes {
  std::vector<float> depth = std::vector<float>(kPixels), normal = std::vector<float>(3 * kPixels),
                     albedo = std::vector<float>(3 * kPixels, 0.6f), color = std::vector<float>(4 * kPixels);

  Planes() {
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const std::size_t k = std::size_t(kWidth) * std::size_t(y) + std::size_t(x);
        const float a = (float(x) - 0.5f * kWidth) / kHeight, b = (0.5f * kHeight - float(y)) / kHeight;
        const float square = 0.09f - a * a - b * b, out = square > 0.0f ? std::sqrt(square) : 0.0f;
        depth[k] = 3.0f - out;
        normal[k] = out > 0.0f ? a / 0.3f : 0.0f;
        normal[kPixels + k] = out > 0.0f ? b / 0.3f : 0.0f;
        normal[2 * kPixels + k] = out > 0.0f ? out / 0.3f : 1.0f;
      }
  }
  static SharedImage image(std::vector<float>& values, int channels) {
    return {.data = values.data(),
            .width = kWidth,
            .height = kHeight,
            .channels = channels,
            .channel_stride = std::ptrdiff_t(kPixels * sizeof(float)),
            .pixel_stride = sizeof(float),
            .row_stride = kWidth * std::ptrdiff_t(sizeof(float))};
  }
  static UmbImage umb(std::vector<float>& values, int channels) {
    return {values.data(), UMB_TYPE_FLOAT32, kWidth, kHeight, channels, std::ptrdiff_t(kPixels * sizeof(float)), 4, 0};
  }
};

TEST(JobSpeed, DISABLED_SecondShade) {
  Planes planes;
  constexpr int kRuns = 15;
  for (const char* look : {"ao", "studio"}) {
    const UmbDevice device = umbNewDevice("cpu", 0);
    const UmbJob job = umbNewShadeJob(device);
    const UmbImage depth = Planes::umb(planes.depth, 1), normal = Planes::umb(planes.normal, 3),
                   albedo = Planes::umb(planes.albedo, 3), color = Planes::umb(planes.color, 4);
    umbSetJobImage(job, "depth", &depth);
    umbSetJobImage(job, "normal", &normal);
    umbSetJobImage(job, "albedo", &albedo);
    umbSetJobOutput(job, "color", &color);
    umbSetJobString(job, "look", look);

    // The same effects without a job.
    Request request;
    request.look = look;
    request.width = kWidth;
    request.height = kHeight;
    const Recipe recipe = *make_shading_recipe(request);
    const auto own = make_cpu_device();
    const ScopedPlanePool scoped_pool(own->pool());
    const std::vector<NamedImage> images = {{"depth", Planes::image(planes.depth, 1)},
                                            {"normal", Planes::image(planes.normal, 3)},
                                            {"albedo", Planes::image(planes.albedo, 3)}};
    std::vector<double> job_ms, effects_ms, inputs_ms, upload_ms;
    for (int k = 0; k < kRuns; ++k) {  // alternating, so that both see the same noise
      const double begin = now_ms();
      ASSERT_EQ(umbExecuteJob(job), UMB_ERROR_NONE);
      job_ms.push_back(now_ms() - begin);
      const double before = now_ms();
      auto shared = gbuffer_of(request, images);
      inputs_ms.push_back(now_ms() - before);
      StageTimes times;
      ASSERT_TRUE(shade_planes(*own, std::move(shared->gbuffer), recipe, times));
      double sum = 0.0;
      for (const auto& stage : times.stages) (stage.name == "upload" ? upload_ms.emplace_back() : sum) += stage.ms;
      effects_ms.push_back(sum);
    }
    EXPECT_EQ(umbGetJobCounter(job, "planes_copied"), 0);
    std::printf("%s: effects %.1f ms, inputs %.1f and %.1f ms, a job %.1f ms: %.3f\n", look, median(effects_ms),
                median(inputs_ms), median(upload_ms), median(job_ms), median(job_ms) / median(effects_ms));
    umbReleaseJob(job);
    umbReleaseDevice(device);
  }
}

}  // namespace
}  // namespace umbrage
