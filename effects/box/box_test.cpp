// Tests `box` against means that are computed in double.
#include "effects/box/box.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "run_effect.h"
#include "support.h"

namespace umbrage {
namespace {

using test::kIndirect;
using test::Settings;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Returns a G-buffer with random occlusion and light in [0, 1], and with holes in its surface.
GBuffer random_gbuffer() {
  GBuffer g = test::empty_gbuffer(53, 37);
  unsigned seed = 1;
  for (const char* name : {"depth", "ao", "indirect.r", "indirect.g", "indirect.b"}) {
    Plane& plane = g.layers[0].add(name);
    ++seed;
    for (int y = 0; y < plane.height; ++y)
      for (int x = 0; x < plane.width; ++x) {
        plane.at(x, y) = float(test::hash(seed * 7919u + 31u * x + 4099u * y) / 4294967295.0);
        if (std::string_view(name) == "depth")
          plane.at(x, y) = (x / 6 + y / 5) % 3 == 0 ? kInfinity : 2.0f + plane.at(x, y);
      }
  }
  return g;
}

/// Returns the mean of the pixels that count in the window around a pixel; `if_none` if no pixel counts.
double mean(const GBuffer& g, const char* name, int x, int y, int size, bool skip, double if_none) {
  double sum = 0.0, count = 0.0;
  for (int j = y - size / 2; j < y - size / 2 + size; ++j)
    for (int i = x - size / 2; i < x - size / 2 + size; ++i) {
      if (i < 0 || i >= g.info.width || j < 0 || j >= g.info.height) continue;
      if (skip && !std::isfinite(g.layers[0].plane("depth").at(i, j))) continue;
      sum += g.layers[0].plane(name).at(i, j);
      count += 1.0;
    }
  return count > 0.0 ? sum / count : if_none;
}

TEST(Box, IsTheMeanOfThePixelsThatCount) {
  const GBuffer g = random_gbuffer();
  for (const int size : {1, 2, 4, 5, 15})
    for (const bool skip : {true, false})
      test::on_every_target(
          "box", g, {{"size", std::to_string(size)}, {"background", skip ? "skip" : "mix"}}, [&](const Image& image) {
            double max_error = 0.0;
            for (int y = 0; y < image.height; ++y)
              for (int x = 0; x < image.width; ++x) {
                max_error =
                    std::max(max_error, std::fabs(image.plane("ao").at(x, y) - mean(g, "ao", x, y, size, skip, 1.0)));
                for (const char* name : kIndirect)
                  max_error =
                      std::max(max_error, std::fabs(image.plane(name).at(x, y) - mean(g, name, x, y, size, skip, 0.0)));
              }
            EXPECT_LT(max_error, 1e-6) << size << skip;
          });
}

TEST(Box, EachPlaneCanBeLeftUnchanged) {
  const GBuffer g = random_gbuffer();
  const auto device = make_cpu_device({});
  const Effect& effect = *find_effect("box");
  for (const char* off : {"ao", "indirect"}) {
    auto frame = device->upload(g);
    ASSERT_TRUE(device->run(effect, test::parameters_of(effect, {{off, "off"}}), *frame));
    const auto image = device->download(*frame, {"ao", "indirect.g"});
    for (const char* name : {"ao", "indirect.g"}) {
      const bool same = test::difference(image->plane(name), g.layers[0].plane(name), 0.0).max == 0.0;
      EXPECT_EQ(same, std::string_view(name).starts_with(off)) << name << " with " << off << " off";
    }
  }
}

TEST(Box, WindowOfTheTileSizeRemovesTheNoise) {
  GBuffer g = random_gbuffer();
  g.layers[0].plane("depth") = Plane(g.info.width, g.info.height, 3.0f);
  double tile_mean = 0.0;
  for (int y = 0; y < g.info.height; ++y)
    for (int x = 0; x < g.info.width; ++x) {
      const double v = test::hash(unsigned(x % 4 + 4 * (y % 4))) / 4294967295.0;
      g.layers[0].plane("ao").at(x, y) = float(v);
      if (x < 4 && y < 4) tile_mean += v / 16.0;
    }
  test::on_every_target("box", g, {}, [&](const Image& image) {
    for (int y = 2; y < image.height - 1; ++y)
      for (int x = 2; x < image.width - 1; ++x) ASSERT_NEAR(image.plane("ao").at(x, y), tile_mean, 1e-6);
  });
}

TEST(Box, NonFiniteValuesCountAsUnoccludedAndDark) {
  GBuffer g = random_gbuffer();
  g.layers[0].plane("depth") = Plane(g.info.width, g.info.height, 3.0f);
  g.layers[0].plane("ao") = Plane(g.info.width, g.info.height, 0.5f);
  g.layers[0].plane("indirect.r") = Plane(g.info.width, g.info.height, 0.5f);
  for (const float value : {std::nanf(""), kInfinity, -kInfinity}) {
    g.layers[0].plane("ao").at(20, 20) = value;
    g.layers[0].plane("indirect.r").at(20, 20) = value;
    test::on_every_target("box", g, {}, [&](const Image& image) {
      EXPECT_NEAR(image.plane("ao").at(20, 20), 0.5 + 0.5 / 16.0, 1e-6);
      EXPECT_NEAR(image.plane("indirect.r").at(20, 20), 0.5 - 0.5 / 16.0, 1e-6);
    });
  }
}

}  // namespace
}  // namespace umbrage
