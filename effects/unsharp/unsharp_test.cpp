// Compares `unsharp` with literal ports of the paper's listing and text in double, and with known results for simple
// scenes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/check.h"
#include "devices/cpu/cpu_device.h"
#include "effects/effects.h"
#include "support.h"
#include "vulkan_support.h"

namespace umbrage {
namespace {

constexpr double kNear = 2.0, kFar = 15.0;  // the listing's

using Settings = std::vector<std::pair<std::string, std::string>>;

ParameterBytes parameters(const Settings& settings) {
  const Effect& effect = *find_effect("unsharp");
  ParameterBytes bytes = initial_parameters(effect.parameters, effect.params_size);
  Settings all = {{"threshold", "0.02"},
                  {"strength", "20"},
                  {"linearization", "linear"},  // of the paper
                  {"background", "far"},
                  {"white_edge", "on"}};
  all.insert(all.end(), settings.begin(), settings.end());
  for (const auto& [name, value] : all) {
    const Parameter* row = find_parameter(effect, name);
    if (!row) fail_check("no parameter " + name);
    const auto status = set_parameter("unsharp", *row, value, bytes);
    EXPECT_TRUE(status) << (status ? "" : status.error().message);
  }
  return bytes;
}

Image run(const GBuffer& gbuffer, const Settings& settings, const CpuSettings& cpu = {}) {
  const auto device = make_cpu_device(cpu);
  auto frame = device->upload(gbuffer);
  EXPECT_TRUE(device->run(*find_effect("unsharp"), parameters(settings), *frame));
  return *device->download(*frame, {"ao", "unsharp_depth"});
}

Plane ao(const GBuffer& gbuffer, const Settings& settings, const CpuSettings& cpu = {}) {
  return run(gbuffer, settings, cpu).planes[0];
}

/// Returns a picture whose depth is a function of the pixel.
GBuffer depth_picture(int width, int height, const std::function<double(int x, int y)>& depth) {
  GBuffer g = test::empty_gbuffer(width, height);
  Plane& plane = g.layers[0].add("depth");
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) plane.at(x, y) = float(depth(x, y));
  return g;
}

/// Returns smooth hills with a raised block and a hole, in which differences near all tested thresholds occur.
GBuffer hills(int width, int height) {
  return depth_picture(width, height, [=](int x, int y) {
    if (x > width / 2 && x < width / 2 + width / 6 && y > height / 3 && y < height / 2) return 4.0 + 0.001 * x;
    if ((x - width / 4) * (x - width / 4) + (y - height / 2) * (y - height / 2) < width * height / 90)
      return double(INFINITY);
    return 7.0 + 2.0 * std::sin(0.05 * x) * std::cos(0.04 * y) + 0.01 * y;
  });
}

// ---- the paper's listing, in double; its row 0 is the lowest
// ---------------------------------------------------

/// Returns the depth buffer's value: 0 at the near plane, 1 at the far plane.
double window_depth(double depth) {
  return std::isfinite(depth) ? kFar * (depth - kNear) / (depth * (kFar - kNear)) : 1.0;
}

double linearize_depth(double z) { return (2.0 * kNear) / (kFar + kNear - z * (kFar - kNear)); }

/// Returns the result of the listing's main() at pixel (i, j).
double listing_shade(const Plane& depth, int i, int j, double kernel_dimension, double threshold) {
  const double screen_x = depth.width, screen_y = depth.height;
  const auto texture = [&](double u, double v) {  // nearest, clamped
    const int x = std::clamp(int(std::floor(u * screen_x)), 0, depth.width - 1);
    const int y = std::clamp(int(std::floor(v * screen_y)), 0, depth.height - 1);
    return linearize_depth(window_depth(depth.at(x, depth.height - 1 - y)));
  };
  double sum = 0.0, neighbor_count = 0.0;
  const double own = texture((i + 0.5) / screen_x, (j + 0.5) / screen_y);
  const int max_x = i + int(std::floor(kernel_dimension / 2.0)), max_y = j + int(std::floor(kernel_dimension / 2.0));
  for (int x = i - int(std::floor(kernel_dimension / 2.0)); x < max_x; ++x)
    for (int y = j - int(std::floor(kernel_dimension / 2.0)); y < max_y; ++y) {
      const double samp_x = double(x) / screen_x, samp_y = double(y) / screen_y;
      // The offset prevents x / screen * screen from being rounded to just below x.
      const double tap = texture(samp_x + 1e-12, samp_y + 1e-12);
      if (samp_x >= 0.0 && samp_x <= 1.0 && samp_y >= 0.0 && samp_y <= 1.0 && std::fabs(own - tap) < threshold) {
        sum += tap;
        neighbor_count++;
      }
    }
  sum = sum / neighbor_count;
  return 20.0 * (own - std::max(0.0, sum));
}

TEST(Unsharp, MatchesThePapersListingForEvenKernels) {
  const GBuffer g = hills(150, 110);
  const Plane& depth = g.layers[0].plane("depth");
  for (const int k : {2, 14, 40})
    for (const double threshold : {0.02, 0.1}) {
      const Plane ours = ao(g, {{"kernel", std::to_string(k)},
                                {"threshold", fmt::format("{}", threshold)},
                                {"linearization", "listing"},
                                {"near", "2"},
                                {"far", "15"}});
      // The change of the result if one sample at the threshold rounds the other way.
      const double flip = 20.0 * threshold / (k * k / 4.0);
      long flips = 0, compared = 0;
      // Excludes pixels whose window extends past the last column or the topmost row: there the listing includes
      // copies.
      for (int j = 0; j < depth.height - k / 2; ++j)
        for (int i = 0; i < depth.width - k / 2; ++i) {
          const int row = depth.height - 1 - j;
          if (!std::isfinite(depth.at(i, row))) continue;
          const double error = std::fabs(1.0 - listing_shade(depth, i, j, k, threshold) - ours.at(i, row));
          EXPECT_LE(error, 2.0 * flip) << k << ' ' << threshold << " at " << i << ',' << j;
          flips += error > 2e-5;
          ++compared;
        }
      // Steps are 2^-24, and samples are spread over more than the threshold. Of k^2 samples per pixel, this many are
      // within a step or two of it.
      const double expected_flips = compared * (k * k) * 0x1p-23 / threshold;
      EXPECT_LE(double(flips), expected_flips + 1.0) << k << ' ' << threshold;
      EXPECT_GT(compared, 4000);
    }
}

// ---- the paper's text, and our own settings, in double
// ------------------------------------------------------------------

struct Oracle {
  int k = 15;
  double threshold = 0.02, strength = 20.0;
  std::string border = "skip", linearization = "linear", background = "far", window = "box";
  bool white_edge = true;
  double near_depth = kNear, far_depth = kFar;

  double linear(double z) const {
    const double d = std::clamp(z, near_depth, far_depth);
    if (linearization == "listing") return 2.0 * d / (d + far_depth);
    if (linearization == "extent") return (d - near_depth) / (far_depth - near_depth);
    return d / far_depth;
  }
  Settings settings() const {
    return {{"kernel", std::to_string(k)},
            {"threshold", fmt::format("{}", threshold)},
            {"strength", fmt::format("{}", strength)},
            {"border", border},
            {"linearization", linearization},
            {"background", background},
            {"window", window},
            {"white_edge", white_edge ? "on" : "off"},
            {"near", fmt::format("{}", near_depth)},
            {"far", fmt::format("{}", far_depth)}};
  }
  /// Returns `ao` from k x k samples. Even windows extend one pixel farther to the left and down, as in the listing,
  /// where rows are counted from below.
  double ao(const Plane& depth, int px, int py) const {
    if (!std::isfinite(depth.at(px, py))) return 1.0;
    const double own = linear(depth.at(px, py));
    const int half = k / 2;
    double sum = 0.0, count = 0.0;
    for (int j = half - k + 1; j <= half; ++j)
      for (int i = -half; i < k - half; ++i) {
        int x = px + i, y = py + j;
        const bool inside = x >= 0 && y >= 0 && x < depth.width && y < depth.height;
        if (!inside && border == "skip") continue;
        if (border == "clamp") x = std::clamp(x, 0, depth.width - 1), y = std::clamp(y, 0, depth.height - 1);
        if (border == "repeat") {
          x = (x % depth.width + depth.width) % depth.width;
          y = (y % depth.height + depth.height) % depth.height;
        }
        double tap = 0.0;
        if (!inside && border == "zero") {
          tap = linear(near_depth);
        } else if (const float z = depth.at(x, y); std::isfinite(z)) {
          tap = linear(z);
        } else if (background == "ignore") {
          continue;
        } else {
          tap = 1.0;
        }
        if (threshold > 0.0 && !(std::fabs(tap - own) < threshold)) continue;
        const double sigma = k / 4.0;
        const double weight = window == "gaussian" ? std::exp(-0.5 * (i * i + j * j) / (sigma * sigma)) : 1.0;
        sum += weight * tap;
        count += weight;
      }
    const double value = 1.0 - strength * (own - sum / count);
    return white_edge ? value : std::min(value, 1.0);
  }
};

void expect_oracle(const GBuffer& g, const Oracle& oracle) {
  const Plane ours = ao(g, oracle.settings());
  const Plane& depth = g.layers[0].plane("depth");
  long off = 0;
  double max = 0.0;
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      const double error = std::fabs(ours.at(x, y) - oracle.ao(depth, x, y));
      off += error > 3e-5 * std::max(1.0, oracle.strength / 20.0);
      max = std::max(max, error);
    }
  // Samples within half a step of the threshold may round either way.
  EXPECT_LE(off, depth.width * depth.height / 500) << oracle.k << ' ' << oracle.border << ' ' << oracle.linearization
                                                   << ' ' << oracle.background << ' ' << oracle.window;
  const double reach = oracle.threshold > 0.0 ? oracle.threshold : 1.0;
  EXPECT_LE(max, 2.0 * oracle.strength * reach / std::max(1.0, oracle.k * oracle.k / 8.0));
}

TEST(Unsharp, MatchesTheTextForOddKernels) {
  for (const int k : {1, 3, 15, 33}) expect_oracle(hills(90, 70), {.k = k});
}

TEST(Unsharp, MatchesTheFormulaInEveryMode) {
  const GBuffer g = hills(60, 50);
  for (const char* border : {"skip", "zero", "clamp", "repeat"})
    for (const double threshold : {0.0, 0.05}) {
      expect_oracle(g, {.k = 16, .threshold = threshold, .border = border});
      expect_oracle(g, {.k = 71, .threshold = threshold, .border = border, .background = "ignore"});
    }
  for (const char* linearization : {"linear", "listing", "extent"})
    for (const char* window : {"box", "gaussian"})
      expect_oracle(g, {.k = 13, .linearization = linearization, .window = window});
  expect_oracle(g, {.k = 12, .threshold = 0.1, .strength = 50.0, .white_edge = false});
  expect_oracle(g, {.k = 12, .threshold = 0.4});
}

TEST(Unsharp, LinearizationIsEquationOne) {
  // Equation (1) with window depth stretched to [-1, 1] is `linear`; with [0, 1], as in the listing, it is `listing`.
  const GBuffer g = depth_picture(64, 1, [](int x, int) { return 2.0 + 13.0 * x / 63.0; });
  for (const std::string mode : {"linear", "listing"}) {
    const Image image = run(g, {{"linearization", mode}, {"near", "2"}, {"far", "15"}});
    for (int x = 0; x < 64; ++x) {
      const double z = window_depth(g.layers[0].plane("depth").at(x, 0));
      const double expected = linearize_depth(mode == "linear" ? 2.0 * z - 1.0 : z);
      EXPECT_NEAR(image.plane("unsharp_depth").at(x, 0) * 0x1p-24, expected, 2e-7) << mode << ' ' << x;
    }
  }
}

TEST(Unsharp, PlaneFacingTheCameraIsUnoccluded) {
  const GBuffer g = depth_picture(100, 80, [](int, int) { return 6.78; });
  for (const char* kernel : {"1", "2", "15", "40", "121", "1023"})
    for (const char* threshold : {"0.02", "0", "0.3", "1"})
      for (const char* border : {"skip", "clamp", "repeat"}) {
        const Plane plane = ao(g, {{"kernel", kernel}, {"threshold", threshold}, {"border", border}});
        for (int y = 0; y < 80; ++y)
          for (int x = 0; x < 100; ++x) ASSERT_EQ(plane.at(x, y), 1.0f) << kernel << threshold << border;
      }
}

TEST(Unsharp, StepDarkensByTheFractionOfTheWindowBehindIt) {
  // The left half is nearer by 0.01 in D. A pixel near the step averages over columns on both sides of it.
  const double near_d = 0.50, far_d = 0.51;
  const GBuffer g = depth_picture(80, 60, [&](int x, int) { return 15.0 * (x < 40 ? near_d : far_d); });
  const Plane plane = ao(g, {{"kernel", "15"}, {"threshold", "0.02"}, {"near", "2"}, {"far", "15"}});
  for (int x = 20; x < 60; ++x) {
    const double columns_near = std::clamp(40 - (x - 7), 0, 15);
    const double mean = (columns_near * near_d + (15 - columns_near) * far_d) / 15.0;
    EXPECT_NEAR(plane.at(x, 30), 1.0 - 20.0 * ((x < 40 ? near_d : far_d) - mean), 1e-5) << x;
  }
  EXPECT_LT(plane.at(40, 30), 0.95f);
  EXPECT_GT(plane.at(39, 30), 1.05f);
  // With a threshold below the step neither side affects the other.
  const Plane apart = ao(g, {{"kernel", "15"}, {"threshold", "0.005"}, {"near", "2"}, {"far", "15"}});
  for (int x = 0; x < 80; ++x) EXPECT_EQ(apart.at(x, 30), 1.0f) << x;
}

TEST(Unsharp, TiltedPlaneHasTheComputedOcclusion) {
  // A plane through z = 6 tilted about the vertical axis: depth is not linear in the image.
  const double slope = 0.5, focal = 1.0 / std::tan(20.0 * 3.14159265358979 / 180.0);
  const int width = 200, height = 60;
  const auto depth_at = [&](double x) {
    const double ray = (2.0 * (x + 0.5) / width - 1.0) * (double(width) / height) / focal;
    return 6.0 / (1.0 - slope * ray);
  };
  const GBuffer g = depth_picture(width, height, [&](int x, int) { return depth_at(x); });
  const Plane plane = ao(g, {{"kernel", "31"}, {"threshold", "0"}, {"near", "2"}, {"far", "30"}});
  double max_inside = 0.0;
  for (int x = 0; x < width; ++x) {
    double sum = 0.0;
    int count = 0;
    for (int i = std::max(x - 15, 0); i <= std::min(x + 15, width - 1); ++i, ++count) sum += depth_at(i) / 30.0;
    const double expected = 1.0 - 20.0 * (depth_at(x) / 30.0 - sum / count);
    EXPECT_NEAR(plane.at(x, 30), expected, 2e-5) << x;
    if (x >= 15 && x < width - 15) max_inside = std::max(max_inside, std::fabs(expected - 1.0));
  }
  EXPECT_GT(max_inside, 1e-3);                          // not 0, so that the test detects a missing term
  EXPECT_GT(std::fabs(plane.at(0, 30) - 1.0f), 0.02f);  // the clipped window at the border
}

TEST(Unsharp, BorderZeroDarkensTheSides) {
  const GBuffer g = depth_picture(100, 80, [](int, int) { return 6.0; });
  const Plane plane = ao(g, {{"kernel", "15"}, {"threshold", "0"}, {"border", "zero"}, {"near", "2"}, {"far", "15"}});
  // At the left edge seven of fifteen columns are outside, on the near plane.
  EXPECT_NEAR(plane.at(0, 40), 1.0 - 20.0 * (0.4 - (8 * 0.4 + 7 * 2.0 / 15.0) / 15.0), 1e-5);
  EXPECT_EQ(plane.at(50, 40), 1.0f);
}

TEST(Unsharp, TunedIsBitwiseIdenticalForLargeWindows) {
  const GBuffer g = hills(150, 100);
  for (const char* kernel : {"5", "16", "40", "63", "121", "200"})
    for (const char* threshold : {"0", "0.002", "0.02", "0.24", "0.6"})
      for (const char* border : {"skip", "zero"}) {
        const Settings settings = {
            {"kernel", kernel}, {"threshold", threshold}, {"border", border}, {"near", "2"}, {"far", "15"}};
        const Plane plain = ao(g, settings, {.tuned = false});
        const Plane tuned = ao(g, settings, {.tuned = true});
        EXPECT_EQ(test::difference(plain, tuned, 0.0).max, 0.0) << kernel << ' ' << threshold << ' ' << border;
      }
}

TEST(Unsharp, TunedEqualsPlainForTheLargestWindowAndThreshold) {
  // A million samples, each of which differs by nearly the whole range, need all bits of the sums.
  const GBuffer g = depth_picture(48, 20, [](int x, int y) { return x < 4 && y < 9 ? 1.0 : 99990.0 - x; });
  for (const char* kernel : {"800", "1023"}) {
    const Settings settings = {
        {"kernel", kernel}, {"threshold", "0.9999"}, {"border", "clamp"}, {"near", "1"}, {"far", "100000"}};
    const Plane plain = ao(g, settings, {.tuned = false});
    const Plane tuned = ao(g, settings, {.tuned = true});
    EXPECT_EQ(test::difference(plain, tuned, 0.0).max, 0.0) << kernel;
  }
}

/// Returns `ao`, computed by a Vulkan device.
Plane ao_on(Device& device, const GBuffer& gbuffer, const Settings& settings) {
  auto frame = device.upload(gbuffer);
  const auto status = device.run(*find_effect("unsharp"), parameters(settings), *frame);
  EXPECT_TRUE(status) << (status ? "" : status.error().message);
  return device.download(*frame, {"ao"})->planes[0];
}

TEST(Unsharp, GpuVariantsAreBitwiseIdenticalToTheKernel) {
  Device* const tuned = test::vulkan_device();
  const auto plain = test::new_vulkan_device({.tuned = false});
  UMBRAGE_NEEDS_VULKAN(tuned && plain);
  const test::NoMessages no_messages;
  // The windows have various remainders modulo 16 and 4, and some are larger than the picture. A wide picture spans
  // more than one workgroup's part of a row.
  const GBuffer small = hills(44, 29), wide = hills(300, 9);
  const auto expect_equal = [&](const GBuffer& g, const Settings& settings) {
    const Plane a = ao_on(*plain, g, settings), b = ao_on(*tuned, g, settings);
    EXPECT_EQ(test::difference(a, b, 0.0).max, 0.0)
        << settings[0].second << ' ' << settings[1].second << ' ' << settings[2].second << ' ' << settings[3].second;
  };
  for (const char* kernel : {"2", "13", "40", "71"})
    for (const char* threshold : {"0", "0.002", "0.02", "0.6"})
      for (const char* border : {"skip", "zero", "clamp", "repeat"}) {
        const std::string background = kernel[0] == '4' ? "ignore" : "far";
        expect_equal(small, {{"kernel", kernel},
                             {"threshold", threshold},
                             {"border", border},
                             {"background", background},
                             {"near", "2"},
                             {"far", "15"}});
      }
  for (const char* border : {"skip", "zero", "clamp", "repeat"})
    expect_equal(wide, {{"kernel", "239"}, {"threshold", "0"}, {"border", border}, {"background", "ignore"}});
}

TEST(Unsharp, GpuVariantsHaveRoomForTheLargestWindow) {
  Device* const device = test::vulkan_device();
  UMBRAGE_NEEDS_VULKAN(device);
  const test::NoMessages no_messages;
  // A million samples, each of which differs by nearly the whole range, need all bits of the sums. The reference is the
  // CPU, since lavapipe ends loops, including those of the plain kernel, after 65535 iterations.
  const GBuffer g = depth_picture(48, 20, [](int x, int y) { return x < 4 && y < 9 ? 1.0 : 99990.0 - x; });
  for (const char* threshold : {"0", "0.9999"})
    for (const char* border : {"skip", "zero"}) {
      const Settings settings = {
          {"kernel", "1023"}, {"threshold", threshold}, {"border", border}, {"near", "1"}, {"far", "100000"}};
      const Plane cpu = ao(g, settings), gpu = ao_on(*device, g, settings);
      EXPECT_LE(test::difference(cpu, gpu, 0.0).max, 2e-5) << threshold << ' ' << border;
    }
}

TEST(Unsharp, LargestWindowDoesNotOverflow) {
  // 1023 x 1023 samples on the far plane around one pixel of surface on the near plane.
  const GBuffer g = depth_picture(1100, 1030, [](int x, int y) { return x == 550 && y == 515 ? 2.0 : 14.999999; });
  const Plane plane = ao(g, {{"kernel", "1023"}, {"threshold", "0"}, {"near", "2"}, {"far", "15"}, {"strength", "1"}});
  const double near_d = 2.0 / 15.0, samples = 1023.0 * 1023.0;
  EXPECT_NEAR(plane.at(550, 515), 1.0 - (near_d - (near_d + (samples - 1.0)) / samples), 1e-5);
  EXPECT_NEAR(plane.at(551, 515), 1.0 - (1.0 - (near_d + (samples - 1.0)) / samples), 1e-5);
}

TEST(Unsharp, AutomaticPlanesKeepTheSceneInFront) {
  // With an automatic far plane, the scene's max depth is at D = 0.9, at any scale of the scene.
  for (const float scale : {1e-3f, 1.0f, 1e4f}) {
    GBuffer g = depth_picture(8, 8, [&](int x, int) { return scale * (1.0 + x); });
    g.info.depth_min = scale;
    g.info.depth_max = 8.0f * scale;
    const Image image = run(g, {});
    EXPECT_NEAR(image.plane("unsharp_depth").at(7, 0) * 0x1p-24, 0.9, 1e-6) << scale;
  }
}

TEST(Unsharp, BackgroundIsUnoccluded) {
  const GBuffer g = hills(90, 70);
  for (const char* background : {"far", "ignore"}) {
    const Plane plane = ao(g, {{"background", background}, {"threshold", "0"}});
    const Plane& depth = g.layers[0].plane("depth");
    for (int y = 0; y < 70; ++y)
      for (int x = 0; x < 90; ++x)
        if (!std::isfinite(depth.at(x, y))) {
          ASSERT_EQ(plane.at(x, y), 1.0f);
        }
  }
}

}  // namespace
}  // namespace umbrage
