// Tests `relight` against its formulas in double, and the alpha and background that `output` makes of its planes.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "run_effect.h"
#include "support.h"

namespace umbrage {
namespace {

using namespace test;

constexpr const char* kBeauty[] = {"beauty.r", "beauty.g", "beauty.b"};
constexpr const char* kEmission[] = {"emission.r", "emission.g", "emission.b"};
constexpr const char* kSky[] = {"sky.r", "sky.g", "sky.b"};

/// Returns a random finished picture from dark to far above white, its ambient part, emission at some pixels, and
/// alpha.
GBuffer finished_picture() {
  constexpr int kWidth = 61, kHeight = 27;
  GBuffer g = test::empty_gbuffer(kWidth, kHeight);
  const auto random = [](int x, int y, unsigned seed) {
    return test::hash(seed * 7919u + 31u * unsigned(x) + 4099u * unsigned(y)) / 4294967295.0;
  };
  for (unsigned c = 0; c < 3; ++c) {
    Plane beauty(kWidth, kHeight), ambient(kWidth, kHeight), emission(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        beauty.at(x, y) = float(std::exp2(14.0 * random(x, y, 1 + c) - 10.0));
        ambient.at(x, y) = float(1.2 * random(x, y, 11 + c)) * beauty.at(x, y);  // noise may exceed the whole
        emission.at(x, y) = x % 7 == 0 ? float(1.5 * random(x, y, 21 + c)) * beauty.at(x, y) : 0.0f;
      }
    g.layers[0].add(kBeauty[c]) = std::move(beauty);
    g.layers[0].add(kAmbient[c]) = std::move(ambient);
    g.layers[0].add(kEmission[c]) = std::move(emission);
  }
  Plane& alpha = g.layers[0].add("beauty.a") = Plane(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) alpha.at(x, y) = float(random(x, y, 31));
  return g;
}

glm::dvec3 color_at(const Image& image, const char* const (&names)[3], int x, int y) {
  return {image.plane(names[0]).at(x, y), image.plane(names[1]).at(x, y), image.plane(names[2]).at(x, y)};
}

/// Expects the split of the picture in which `ambient_of` returns the ambient part of the reflected light.
template <class AmbientOf>
void expect_split(const Settings& settings, const AmbientOf& ambient_of) {
  const GBuffer g = finished_picture();
  const Image& in = g.layers[0];
  test::on_every_target("relight", g, settings, [&](const Image& out) {
    double worst = 0.0, alpha = 0.0;
    for (int y = 0; y < in.height; ++y)
      for (int x = 0; x < in.width; ++x) {
        const glm::dvec3 beauty = color_at(in, kBeauty, x, y), emission = color_at(in, kEmission, x, y);
        glm::dvec3 reflected;
        for (int c = 0; c < 3; ++c) reflected[c] = std::max(beauty[c] - emission[c], 0.0);
        const glm::dvec3 ambient = ambient_of(reflected, color_at(in, kAmbient, x, y));
        for (int c = 0; c < 3; ++c) {
          const double scale = std::max(beauty[c], 1e-3);
          worst = std::max(worst, std::abs(out.plane(kAmbient[c]).at(x, y) - ambient[c]) / scale);
          worst = std::max(worst, std::abs(out.plane(kDirect[c]).at(x, y) - (beauty[c] - ambient[c])) / scale);
          EXPECT_EQ(out.plane(kSky[c]).at(x, y), in.plane(kBeauty[c]).at(x, y));
        }
        alpha = std::max(alpha, double(std::abs(out.plane("coverage").at(x, y) - in.plane("beauty.a").at(x, y))));
      }
    EXPECT_LE(worst, 2e-6);
    EXPECT_EQ(alpha, 0.0);
  });
}

TEST(Relight, AmbientLightOfTheFileIsAtMostTheReflectedLight) {
  expect_split({{"source", "planes"}}, [](const glm::dvec3& reflected, const glm::dvec3& given) {
    return glm::dvec3(std::min(reflected.r, given.r), std::min(reflected.g, given.g), std::min(reflected.b, given.b));
  });
}

TEST(Relight, EstimatedAmbientLightIsLessInBrightLight) {
  for (const double highlights : {0.0, 0.4, 1.0})
    for (const double fraction : {0.0, 0.5, 1.0})
      expect_split({{"highlights", fmt::format("{}", highlights)}, {"fraction", fmt::format("{}", fraction)}},
                   [&](const glm::dvec3& reflected, const glm::dvec3&) {
                     const double luminance = 0.2126 * reflected.r + 0.7152 * reflected.g + 0.0722 * reflected.b;
                     const double relative = highlights > 0.0 ? luminance / highlights : 0.0;
                     return reflected * (fraction / (1.0 + relative * relative));
                   });
}

TEST(Relight, BrighterPixelsStayBrighterUnderTheSameOcclusion) {
  constexpr int kLevels = 400;
  GBuffer g = test::empty_gbuffer(kLevels, 1);
  for (const char* name : kBeauty) {
    Plane& plane = g.layers[0].add(name) = Plane(kLevels, 1);
    for (int x = 0; x < kLevels; ++x) plane.at(x, 0) = float(std::exp2(x * 0.03 - 6.0));  // to 64
  }
  test::on_every_target("relight", g, {{"fraction", "0.99"}}, [&](const Image& out) {
    for (int x = 1; x < kLevels; ++x)  // occlusion 1: all ambient light is blocked
      ASSERT_GT(out.plane("direct.g").at(x, 0), out.plane("direct.g").at(x - 1, 0)) << x;
  });
}

TEST(Relight, ValuesThatAreNotFiniteAreBlack) {
  GBuffer g = finished_picture();
  g.layers[0].plane("beauty.r").at(3, 3) = std::numeric_limits<float>::infinity();
  g.layers[0].plane("beauty.g").at(4, 3) = std::numeric_limits<float>::quiet_NaN();
  g.layers[0].plane("ambient.b").at(5, 3) = -std::numeric_limits<float>::infinity();
  test::on_every_target("relight", g, {{"source", "planes"}}, [&](const Image& out) {
    for (const auto* names : {kAmbient, kDirect, kSky})
      for (int c = 0; c < 3; ++c)
        for (int x = 3; x <= 5; ++x) EXPECT_TRUE(std::isfinite(out.plane(names[c]).at(x, 3))) << names[c] << ' ' << x;
    EXPECT_EQ(out.plane("sky.r").at(3, 3), 0.0f);
    EXPECT_EQ(out.plane("ambient.b").at(5, 3), 0.0f);
  });
}

TEST(Relight, OutputKeepsAlphaAndBackgroundOfThePicture) {
  GBuffer g = finished_picture();
  Image& in = g.layers[0];
  for (int c = 0; c < 3; ++c)
    for (const char* name : {kLit[c], kSky[c]}) {
      const Plane copy = in.plane(kBeauty[c]);
      in.add(name) = copy;
    }
  const Plane alpha = in.plane("beauty.a");
  in.add("coverage") = alpha;
  in.add("depth") = Plane(in.width, in.height);
  for (int y = 0; y < in.height; ++y)
    for (int x = 0; x < in.width; ++x)
      in.plane("depth").at(x, y) = (x + y) % 2 ? 2.0f : std::numeric_limits<float>::infinity();
  test::on_every_target("output", g, {{"sky", "on"}, {"transfer", "none"}, {"beauty", "light"}}, [&](const Image& out) {
    for (int y = 0; y < in.height; ++y)
      for (int x = 0; x < in.width; ++x) {
        const float covered = alpha.at(x, y), light = in.plane("lit.g").at(x, y);
        ASSERT_EQ(out.plane("color.a").at(x, y), covered);
        ASSERT_EQ(out.plane("color.g").at(x, y), light);
        ASSERT_EQ(out.plane("beauty.a").at(x, y), covered);
        ASSERT_NEAR(out.plane("beauty.g").at(x, y), light * covered, 1e-6f * light);
      }
  });
}

}  // namespace
}  // namespace umbrage
