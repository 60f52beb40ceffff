// Tests `gaussian` against its 3x3 stencil in double, and tests its behaviour at edges.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "run_effect.h"
#include "support.h"
#include "tilted_plane.h"

namespace umbrage {
namespace {

using test::Settings;

/// Returns a G-buffer of two surfaces that face the camera: at depth 5, and from column `first_far` on at 9. Its `ao`
/// is constant.
GBuffer step(int width, int height, int first_far, float occlusion = 1.0f) {
  GBuffer g = test::empty_gbuffer(width, height);
  Image& image = g.layers[0];
  for (const char* name : {"normal.x", "normal.y"}) image.add(name) = Plane(width, height, 0.0f);
  image.add("normal.z") = Plane(width, height, 1.0f);
  image.add("ao") = Plane(width, height, occlusion);
  Plane& depth = image.add("depth");
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) depth.at(x, y) = x < first_far ? 5.0f : 9.0f;
  return g;
}

Plane& ao_of(GBuffer& g) { return g.layers[0].plane("ao"); }

void fill_randomly(Plane& plane) {
  for (int y = 0; y < plane.height; ++y)
    for (int x = 0; x < plane.width; ++x) plane.at(x, y) = float(test::hash(x + 4099u * y) >> 8) * 0x1p-24f;
}

Settings rounds(int n, const char* edges = "off") { return {{"rounds", std::to_string(n)}, {"edges", edges}}; }

double binomial(int n, int k) {
  return k < 0 || k > n ? 0.0 : std::round(std::tgamma(n + 1.0) / (std::tgamma(k + 1.0) * std::tgamma(n - k + 1.0)));
}

TEST(Gaussian, ImpulseBecomesTheBinomialCoefficients) {
  for (const char* edges : {"off", "on"})
    for (const int n : {0, 1, 2, 4, 7}) {
      GBuffer g = step(41, 31, 99, 0.0f);
      ao_of(g).at(20, 15) = 1.0f;
      test::on_every_target("gaussian", g, rounds(n, edges), [&](const Image& image) {
        for (int y = 0; y < 31; ++y)
          for (int x = 0; x < 41; ++x) {
            const double expected = binomial(2 * n, x - 20 + n) * binomial(2 * n, y - 15 + n) / std::pow(4.0, 2.0 * n);
            EXPECT_NEAR(image.plane("ao").at(x, y), expected, 1e-7) << n << ' ' << x << ',' << y;
          }
      });
    }
}

/// Returns the result of one round as the paper describes it: the weighted average of 3x3 pixels, clamped at borders.
std::vector<double> blurred(const std::vector<double>& input, int width, int height) {
  std::vector<double> output(input.size());
  const double weights[3] = {0.25, 0.5, 0.25};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i)
          output[y * width + x] += weights[i + 1] * weights[j + 1] *
                                   input[std::clamp(y + j, 0, height - 1) * width + std::clamp(x + i, 0, width - 1)];
  return output;
}

TEST(Gaussian, MatchesTheThreeByThreeStencilUpToTheBorder) {
  for (const auto& [width, height] : {std::pair{37, 23}, {1, 9}, {17, 1}, {2, 2}}) {
    GBuffer g = step(width, height, 99);
    fill_randomly(ao_of(g));
    for (const int n : {1, 2, 5}) {
      std::vector<double> expected;
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) expected.push_back(ao_of(g).at(x, y));
      for (int k = 0; k < n; ++k) expected = blurred(expected, width, height);
      test::on_every_target("gaussian", g, rounds(n), [&](const Image& image) {
        for (int y = 0; y < height; ++y)
          for (int x = 0; x < width; ++x)
            EXPECT_NEAR(image.plane("ao").at(x, y), expected[y * width + x], 1e-6) << n << ' ' << x << ',' << y;
      });
    }
  }
}

TEST(Gaussian, ConstantStaysBitwiseIdentical) {
  for (const char* edges : {"off", "on"})
    for (const float value : {1.0f, 0.7f, 0.1234567f, 1.7f}) {
      const GBuffer g = step(35, 20, 13, value);
      test::on_every_target("gaussian", g, rounds(64, edges), [&](const Image& image) {
        EXPECT_EQ(test::difference(image.plane("ao"), Plane(35, 20, value), 0.0).max, 0.0) << value;
      });
    }
}

TEST(Gaussian, ZeroRoundsChangeNothing) {
  GBuffer g = step(35, 20, 13);
  fill_randomly(ao_of(g));
  for (const char* edges : {"off", "on"})
    test::on_every_target("gaussian", g, rounds(0, edges), [&](const Image& image) {
      EXPECT_EQ(test::difference(image.plane("ao"), ao_of(g), 0.0).max, 0.0);
    });
}

TEST(Gaussian, EdgesKeepADiscontinuityOfOcclusionWhereDepthHasOne) {
  for (const bool background : {false, true}) {
    GBuffer g = step(40, 20, 17);
    for (int y = 0; y < 20; ++y)
      for (int x = 0; x < 40; ++x) {
        ao_of(g).at(x, y) = x < 17 ? 0.25f : 1.0f;
        if (background && x >= 17) g.layers[0].plane("depth").at(x, y) = std::numeric_limits<float>::infinity();
      }
    test::on_every_target("gaussian", g, rounds(8, "on"), [&](const Image& image) {
      EXPECT_EQ(test::difference(image.plane("ao"), ao_of(g), 0.0).max, 0.0);
    });
    test::on_every_target("gaussian", g, rounds(8, "off"), [&](const Image& image) {
      EXPECT_NEAR(image.plane("ao").at(16, 10) + image.plane("ao").at(17, 10), 1.25, 1e-6);
      EXPECT_GT(image.plane("ao").at(16, 10), 0.5f);
    });
  }
}

TEST(Gaussian, EdgesDoNotChangeTheBlurOfTiltedPlanes) {
  // Depth changes by many pixel sizes from row to row, but the rows are neighbours on one surface.
  for (const bool orthographic : {false, true})
    for (const double tilt_deg : {30.0, 69.0, 80.0}) {
      GBuffer g = step(48, 64, 99);
      if (orthographic) g.info.camera = orthographic_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 3.0f, 0.75f);
      fill_randomly(ao_of(g));
      const int horizon = test::tilt_about_x(g, tilt_deg);
      const Image without = test::run_effect(*find_effect("gaussian"), g, rounds(3, "off"), {});
      test::on_every_target("gaussian", g, rounds(3, "on"), [&](const Image& image) {
        const int first = horizon > 0 ? horizon + 3 : 0;  // three rounds reach three rows
        EXPECT_LT(first, 30);
        for (int y = first; y < 64; ++y)
          for (int x = 0; x < 48; ++x)
            EXPECT_NEAR(image.plane("ao").at(x, y), without.plane("ao").at(x, y), 1e-6) << tilt_deg << ' ' << y;
      });
    }
}

TEST(Gaussian, EdgesBlurGrazingPlanesAndStopAtSteps) {
  test::at_grazing_angles({.error_deg = 2.0}, [](const test::TiltedPlane& plane) {
    GBuffer g = test::seen(plane);
    g.layers[0].add("ao");
    fill_randomly(ao_of(g));
    const Image without = test::run_effect(*find_effect("gaussian"), g, rounds(3, "off"), {});
    test::on_every_target("gaussian", g, rounds(3, "on"), [&](const Image& image) {
      EXPECT_LE(test::difference(image.plane("ao"), without.plane("ao"), 0.0).max, 1e-6);
    });
  });
  test::at_grazing_angles({.step_px = 60.0, .depth_ratio = 0.1}, [](const test::TiltedPlane& plane) {
    GBuffer g = test::seen(plane);
    Plane& ao = g.layers[0].add("ao");
    for (int y = 0; y < plane.height; ++y)
      for (int x = 0; x < plane.width; ++x) ao.at(x, y) = 2 * x < plane.width ? 0.25f : 1.0f;
    test::on_every_target("gaussian", g, rounds(3, "on"), [&](const Image& image) {
      EXPECT_EQ(test::difference(image.plane("ao"), ao, 0.0).max, 0.0);
    });
  });
}

TEST(Gaussian, NonFiniteOcclusionIsUnoccluded) {
  GBuffer g = step(20, 10, 99, 0.5f);
  const float invalid_values[] = {std::nanf(""), std::numeric_limits<float>::infinity(),
                                  -std::numeric_limits<float>::infinity(), 3e38f};
  for (int k = 0; k < 4; ++k) ao_of(g).at(4 * k + 2, 5) = invalid_values[k];
  test::on_every_target("gaussian", g, rounds(1), [&](const Image& image) {
    for (int k = 0; k < 4; ++k) EXPECT_FLOAT_EQ(image.plane("ao").at(4 * k + 2, 5), 0.625f) << k;
  });
}

}  // namespace
}  // namespace umbrage
