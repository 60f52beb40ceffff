// Tests what `output` does to saturated colours, and to a gradient that is written with 8 bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>
#include <limits>

#include "core/color.h"
#include "hue.h"
#include "run_effect.h"
#include "support.h"

namespace umbrage {
namespace {

using test::Settings;

TEST(Output, SaturatedColoursStaySoUpToWhite) {
  // Primaries, secondaries and colours near them, from dark to where metering leaves all but highlights.
  for (const glm::dvec3& color : {glm::dvec3(1, 0.01, 0.01),
                                  {0.01, 1, 0.01},
                                  {0.02, 0.02, 1},
                                  {1, 1, 0.01},
                                  {0.01, 1, 1},
                                  {1, 0.01, 1},
                                  {1, 0.2, 0.02}})
    for (const double light : {0.02, 0.1, 0.4, 0.8, 1.0}) {
      GBuffer g = test::empty_gbuffer(1, 1);
      g.layers[0].add("depth") = Plane(1, 1, 3.0f);
      for (int c = 0; c < 3; ++c) g.layers[0].add(test::kLit[c]) = Plane(1, 1, float(light * color[c]));
      test::on_every_target("output", g, {{"tone", "neutral"}}, [&](const Image& image) {
        const auto shown = [&](int c) { return double(srgb_from_linear(float(light * color[c]))); };
        const auto before = test::hue_and_saturation({shown(0), shown(1), shown(2)});
        const auto after = test::hue_and_saturation(
            {image.plane("color.r").at(0, 0), image.plane("color.g").at(0, 0), image.plane("color.b").at(0, 0)});
        EXPECT_LT(test::angle_between_deg(after.hue_deg, before.hue_deg), 5.0) << light;
        EXPECT_GT(after.saturation, 0.9 * before.saturation) << light;
      });
    }
}

/// Returns background of this size, with a surface in column 0 and, in column 1, a black shadow that covers half of it.
GBuffer background_of(int width, int height) {
  GBuffer g = test::empty_gbuffer(width, height);
  Image& image = g.layers[0];
  image.add("depth") = Plane(width, height, std::numeric_limits<float>::infinity());
  for (const char* name : {"lit.r", "lit.g", "lit.b", "cover"}) image.add(name) = Plane(width, height, 0.0f);
  for (int y = 0; y < height; ++y) {
    image.plane("depth").at(0, y) = 1.0f;
    image.plane("lit.g").at(0, y) = 0.3f;
    image.plane("cover").at(1, y) = 0.5f;
  }
  return g;
}

TEST(Output, TheGradientOfEightBitsIsDithered) {
  constexpr int kWidth = 42, kRows = 400;  // a step of 8 bits is about 11 rows high
  const GBuffer g = background_of(kWidth, kRows);
  const Settings plain = {{"background_g", "0.915"}, {"gradient", "0.3"}};
  Settings dithered = plain;
  dithered.emplace_back("dither", "on");
  Plane exact;
  test::on_every_target("output", g, plain, [&](const Image& image) {
    exact = image.plane("color.g");
    for (int y = 0; y < kRows; ++y)
      for (int x = 3; x < kWidth; ++x) ASSERT_EQ(exact.at(x, y), exact.at(2, y)) << "floats are not dithered";
  });
  test::on_every_target("output", g, dithered, [&](const Image& image) {
    const Plane& plane = image.plane("color.g");
    const auto byte = [&](int x, int y) { return int(plane.at(x, y) * 255.0f + 0.5f); };
    for (int y = 0; y < kRows; ++y) {
      ASSERT_NEAR(plane.at(0, y), exact.at(0, y), 1e-6) << "surfaces are not dithered";
      for (int x = 1; x < kWidth; ++x) ASSERT_LT(std::fabs(255.0 * (plane.at(x, y) - exact.at(x, y))), 0.5);
    }
    // The mean of a block of 8 x 8 pixels is exact to a sixth of a step; without dither it is half a step off.
    double worst = 0.0;
    for (int y = 0; y + 8 <= kRows; ++y) {
      double bytes = 0.0, values = 0.0;
      for (int j = y; j < y + 8; ++j)
        for (int x = 2; x < 10; ++x) bytes += byte(x, j), values += 255.0 * exact.at(x, j);
      worst = std::max(worst, std::fabs(bytes - values) / 64.0);
    }
    EXPECT_LT(worst, 1.0 / 6.0);
    int run = 1, longest = 1;
    for (int y = 1; y < kRows; ++y) {
      bool same = true;
      for (int x = 2; x < kWidth; ++x) same = same && byte(x, y) == byte(x, y - 1);
      run = same ? run + 1 : 1;
      longest = std::max(longest, run);
    }
    EXPECT_LE(longest, 2);
  });
  // A strip of the picture has the same values.
  GBuffer strip = background_of(kWidth, 100);
  strip.info.first_row = 150;
  strip.info.whole_rows = kRows;
  test::on_every_target("output", g, dithered, [&](const Image& whole) {
    test::on_every_target("output", strip, dithered, [&](const Image& part) {
      for (int y = 0; y < 100; ++y)
        for (int x = 0; x < kWidth; ++x)
          ASSERT_NEAR(part.plane("color.g").at(x, y), whole.plane("color.g").at(x, 150 + y), 1e-6) << x << ' ' << y;
    });
  });
  // A plain background stays plain, and no background empty.
  for (const Settings& settings : {Settings{{"dither", "on"}, {"background_g", "0.501"}},
                                   Settings{{"dither", "on"}, {"gradient", "0.3"}, {"transparent", "on"}}})
    test::on_every_target("output", g, settings, [&](const Image& image) {
      for (int y = 0; y < kRows; ++y)
        ASSERT_EQ(image.plane("color.g").at(9, y), settings[1].first[0] == 'b' ? 0.501f : 0.0f);
    });
}

}  // namespace
}  // namespace umbrage
