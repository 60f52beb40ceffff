// Tests `antialias` against the coverage of half-planes in double, and that it leaves everything else as it was.
#include <gtest/gtest.h>

#include <cmath>

#include "run_effect.h"
#include "support.h"

namespace umbrage {
namespace {

using namespace test;

constexpr const char* kColor[] = {"color.r", "color.g", "color.b", "color.a"};
constexpr int kWidth = 75, kHeight = 53;

struct Rgba {
  float channels[4];
};

/// Returns a finished picture whose pixel is `color_of(x, y)`.
template <class ColorOf>
GBuffer picture_of(ColorOf color_of) {
  GBuffer g = test::empty_gbuffer(kWidth, kHeight);
  for (int c = 0; c < 4; ++c) g.layers[0].add(kColor[c]) = Plane(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const Rgba color = color_of(x, y);
      for (int c = 0; c < 4; ++c) g.layers[0].plane(kColor[c]).at(x, y) = color.channels[c];
    }
  return g;
}

/// Returns the fraction of pixel (x, y) below the line at height `offset` + `slope` x, from 32 x 32 points.
double fraction_below(double slope, double offset, int x, int y) {
  constexpr int kPoints = 32;
  int count = 0;
  for (int j = 0; j < kPoints; ++j)
    for (int i = 0; i < kPoints; ++i)
      count += y + (j + 0.5) / kPoints > offset + slope * (x + (i + 0.5) / kPoints) ? 1 : 0;
  return double(count) / (kPoints * kPoints);
}

/// Returns the root mean square of the error of red against `exact`, over pixels that are not within `margin` of the
/// border.
template <class Exact>
double error(const Image& image, Exact exact, int margin) {
  double sum = 0.0;
  int count = 0;
  for (int y = margin; y < kHeight - margin; ++y)
    for (int x = margin; x < kWidth - margin; ++x, ++count)
      sum += std::pow(image.plane("color.r").at(x, y) - exact(x, y), 2.0);
  return std::sqrt(sum / count);
}

TEST(Antialias, StairStepsBecomeLines) {
  for (const double slope : {0.07, -0.21, 0.5, 0.93}) {
    const double offset = slope > 0.0 ? 3.2 : 3.2 - slope * kWidth;
    for (const bool upright : {false, true}) {
      const auto fraction = [&](int x, int y) {
        return upright ? fraction_below(slope, offset, y, x) : fraction_below(slope, offset, x, y);
      };
      const auto jagged = [&](int x, int y) {
        const double v = upright ? x + 0.5 - offset - slope * (y + 0.5) : y + 0.5 - offset - slope * (x + 0.5);
        const float shade = v > 0.0 ? 0.9f : 0.1f;
        return Rgba{{shade, shade, shade, 1.0f}};
      };
      const auto exact = [&](int x, int y) { return 0.1 + 0.8 * fraction(x, y); };
      const GBuffer g = picture_of(jagged);
      const double before = error(g.layers[0], exact, 3);
      on_every_target("antialias", g, {}, [&](const Image& image) {
        // Long steps are reconstructed well; near 45 degrees the steps are too short to tell the slope.
        EXPECT_LT(error(image, exact, 3), (std::abs(slope) < 0.25 ? 0.35 : 0.65) * before) << slope << ' ' << upright;
        for (int c = 0; c < 4; ++c)
          for (const float v : {image.plane(kColor[c]).at(0, 0), image.plane(kColor[c]).at(kWidth - 1, kHeight - 1)})
            EXPECT_TRUE(v == (c < 3 ? 0.9f : 1.0f) || v == (c < 3 ? 0.1f : 1.0f));
      });
    }
  }
}

TEST(Antialias, AStepOfOnePixelIsALineOfItsLength) {
  // Two edges of 10 pixels that meet in a step: the line falls by a pixel over both their halves.
  const GBuffer g = picture_of([](int x, int y) {
    const float shade = y > (x < 30 ? 20 : 21) ? 1.0f : 0.0f;
    return Rgba{{x >= 20 && x < 40 ? shade : 0.5f, 0.0f, 0.0f, 1.0f}};
  });
  on_every_target("antialias", g, {{"threshold", "0.5"}}, [](const Image& image) {
    // Pixel k pixels before the step: the mean of 0.5 (1 - t/5) for t from k to k + 1.
    for (int k = 0; k < 5; ++k) {
      const double covered = 0.5 * (1.0 - (k + 0.5) / 5.0), tolerance = k == 0 ? 0.003 : 1e-6;  // 0: also at the riser
      EXPECT_NEAR(image.plane("color.r").at(29 - k, 21), 1.0 - covered, tolerance) << k;
      EXPECT_NEAR(image.plane("color.r").at(30 + k, 21), covered, tolerance) << k;
    }
    EXPECT_EQ(image.plane("color.r").at(24, 21), 1.0f) << "beyond the middle of the edge";
    EXPECT_EQ(image.plane("color.r").at(35, 21), 0.0f);
  });
}

TEST(Antialias, StraightEdgesAndSmallDifferencesStay) {
  const GBuffer g = picture_of([](int x, int y) {
    const float detail = 0.04f * float(test::hash(unsigned(x + 997 * y)) / 4294967295.0);
    return Rgba{{(y > 20 ? 0.9f : 0.1f) + detail, x > 40 ? 0.9f : 0.2f, 0.3f, 1.0f}};
  });
  on_every_target("antialias", g, {}, [&](const Image& image) {
    for (int c = 0; c < 4; ++c)
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
          if (std::abs(x - 40) < 2 && std::abs(y - 20) < 2) continue;  // the corner where two edges cross
          ASSERT_EQ(image.plane(kColor[c]).at(x, y), g.layers[0].plane(kColor[c]).at(x, y))
              << c << ' ' << x << ' ' << y;
        }
  });
}

TEST(Antialias, TransparentPixelsGiveNoColour) {
  // A red triangle on nothing, whose pixels have a green that no mixture may show.
  const GBuffer g = picture_of([](int x, int y) {
    return y > 10 + x / 4 ? Rgba{{0.8f, 0.0f, 0.0f, 1.0f}} : Rgba{{0.0f, 1.0f, 0.0f, 0.0f}};
  });
  on_every_target("antialias", g, {}, [](const Image& image) {
    int partial = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const float alpha = image.plane("color.a").at(x, y);
        if (alpha == 0.0f || alpha == 1.0f) continue;
        ++partial;
        EXPECT_NEAR(image.plane("color.r").at(x, y), 0.8f, 1e-6f);
        EXPECT_EQ(image.plane("color.g").at(x, y), 0.0f);
      }
    EXPECT_GT(partial, 50);
  });
}

TEST(Antialias, OffChangesNothing) {
  const GBuffer g = picture_of([](int x, int y) { return Rgba{{y > 10 + x / 4 ? 1.0f : 0.0f, 0.0f, 0.0f, 1.0f}}; });
  const auto params = parameters_of(*find_effect("antialias"), {{"search", "0"}});
  EXPECT_TRUE(written_planes(*find_effect("antialias"), params).empty());
  on_every_target("antialias", g, {}, [&](const Image& image) {
    bool changed = false;
    for (int x = 0; x < kWidth; ++x)
      changed |= image.plane("color.r").at(x, 20) != g.layers[0].plane("color.r").at(x, 20);
    EXPECT_TRUE(changed);
  });
}

}  // namespace
}  // namespace umbrage
