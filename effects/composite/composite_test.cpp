// Tests `composite` against its formulas in double, and tests properties of its modes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "run_effect.h"
#include "support.h"

namespace umbrage {
namespace {

using namespace test;

/// Returns a G-buffer with random light and occlusion; occlusion is from -0.5 to 2, as `unsharp` may produce.
GBuffer light_and_occlusion() {
  constexpr int kWidth = 67, kHeight = 29;
  GBuffer g = test::empty_gbuffer(kWidth, kHeight);
  const auto fill = [&](const char* name, double min, double max, unsigned seed) {
    Plane& plane = g.layers[0].add(name);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        plane.at(x, y) = float(min + (max - min) * (test::hash(seed * 7919u + 31u * x + 4099u * y) / 4294967295.0));
  };
  for (int c = 0; c < 3; ++c) {
    fill(kDirect[c], 0.0, 3.0, 1 + c);
    fill(kAmbient[c], 0.0, 0.5, 11 + c);
    fill(kIndirect[c], 0.0, 1.5, 31 + c);
    fill(kAlbedo[c], 0.0, 1.0, 41 + c);
  }
  fill("ao", -0.5, 2.0, 21);
  return g;
}

struct Modulation {
  double darkness = 1.0, chroma = 0.0, contrast = 0.0;
};

/// The light at a pixel, in double precision.
struct PixelLight {
  glm::dvec3 direct, ambient, bounced;
  PixelLight(const Image& image, int x, int y) {
    for (int c = 0; c < 3; ++c) {
      direct[c] = image.plane(kDirect[c]).at(x, y);
      ambient[c] = image.plane(kAmbient[c]).at(x, y);
      bounced[c] = double(image.plane(kAlbedo[c]).at(x, y)) * image.plane(kIndirect[c]).at(x, y);
    }
  }
};

glm::dvec3 expected_light(const std::string& mode, const PixelLight& arriving, double ao, const Modulation& m) {
  const auto& [direct, ambient, bounced] = arriving;
  const glm::dvec3 light = direct + ambient + bounced;
  if (mode == "ambient") return direct + bounced + ambient * ao;
  if (mode == "subtract") return light - (1.0 - ao);
  if (mode == "multiply") return (direct + ambient) * ao + bounced;
  if (mode == "occlusion") return glm::dvec3(ao);
  const double d = ao - 1.0;
  const double luminance = 0.2126 * light.r + 0.7152 * light.g + 0.0722 * light.b;
  const glm::dvec3 colored = luminance + (light - luminance) * std::max(0.0, 1.0 + d * m.chroma);
  const glm::dvec3 contrasted = 0.5 + (colored - 0.5) * std::max(0.0, 1.0 + d * m.contrast);
  return contrasted + d * m.darkness;
}

void expect_formula(const std::string& mode, const Modulation& m) {
  const GBuffer g = light_and_occlusion();
  const Settings settings = {{"mode", mode},
                             {"darkness", fmt::format("{}", m.darkness)},
                             {"chroma", fmt::format("{}", m.chroma)},
                             {"contrast", fmt::format("{}", m.contrast)}};
  const double scale = (1.0 + std::fabs(m.chroma)) * (1.0 + std::fabs(m.contrast)) + m.darkness;
  test::on_every_target("composite", g, settings, [&](const Image& image) {
    double max_error = 0.0;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const glm::dvec3 expected =
            expected_light(mode, PixelLight(g.layers[0], x, y), g.layers[0].plane("ao").at(x, y), m);
        for (int c = 0; c < 3; ++c)
          max_error = std::max(max_error, std::fabs(image.plane(kLit[c]).at(x, y) - expected[c]));
      }
    EXPECT_LE(max_error, 2e-6 * scale) << mode;
  });
}

TEST(Composite, EveryModeMatchesItsFormula) {
  for (const char* mode : {"ambient", "subtract", "multiply", "occlusion"}) expect_formula(mode, {});
}

TEST(Composite, BleedingDampsBouncedLightWhereDirectLightIsWeak) {
  GBuffer g = light_and_occlusion();
  for (int c = 0; c < 3; ++c)  // direct light from 0 to far above the damping
    for (int y = 0; y < g.info.height; ++y)
      for (int x = 0; x < 20; ++x) g.layers[0].plane(kDirect[c]).at(x, y) *= float(x) / 200.0f;
  for (const double damping : {0.0, 0.1, 0.7})
    test::on_every_target(
        "composite", g, {{"mode", "bleeding"}, {"damping", fmt::format("{}", damping)}}, [&](const Image& image) {
          double max_error = 0.0;
          int faded = 0;
          for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x) {
              const auto [direct, ambient, bounced] = PixelLight(g.layers[0], x, y);
              const double luminance = 0.2126 * direct.r + 0.7152 * direct.g + 0.0722 * direct.b;
              const double fraction = damping > 0.0 ? std::min(luminance / damping, 1.0) : 1.0;
              const glm::dvec3 expected =
                  direct + bounced * fraction + ambient * double(g.layers[0].plane("ao").at(x, y));
              for (int c = 0; c < 3; ++c)
                max_error = std::max(max_error, std::fabs(image.plane(kLit[c]).at(x, y) - expected[c]));
              faded += fraction < 1.0;
            }
          EXPECT_LE(max_error, 2e-6);
          EXPECT_EQ(faded > 100, damping > 0.0);
        });
}

TEST(Composite, TintAddsInterreflectionsOfTheSameColour) {
  // [Jimenez et al. 2016, equation 10].
  const auto with_interreflections = [](double v, double albedo) {
    const double a = 2.0404 * albedo - 0.3324, b = -4.7951 * albedo + 0.6417, c = 2.7552 * albedo + 0.6903;
    return std::max(v, std::min(((v * a + b) * v + c) * v, 1.0));  // the fit exceeds 1 by up to 1e-4
  };
  const GBuffer g = light_and_occlusion();
  for (const double tint : {0.0, 0.5, 1.0})
    test::on_every_target("composite", g, {{"tint", fmt::format("{}", tint)}}, [&](const Image& image) {
      double max_error = 0.0;
      long lifted = 0;
      for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
          const PixelLight arriving(g.layers[0], x, y);
          const double ao = g.layers[0].plane("ao").at(x, y), open = std::clamp(ao, 0.0, 1.0);
          for (int c = 0; c < 3; ++c) {
            const double fraction =
                ao + tint * (with_interreflections(open, g.layers[0].plane(kAlbedo[c]).at(x, y)) - open);
            const double expected = arriving.direct[c] + arriving.bounced[c] + arriving.ambient[c] * fraction;
            max_error = std::max(max_error, std::fabs(expected - image.plane(kLit[c]).at(x, y)));
            lifted += fraction > ao + 0.05;
          }
        }
      EXPECT_LE(max_error, 2e-6) << tint;
      EXPECT_EQ(lifted > 100, tint > 0.0) << tint;
    });
}

TEST(Composite, OcclusionDarkensDirectLightAsRequested) {
  const GBuffer g = light_and_occlusion();
  for (const char* mode : {"ambient", "bleeding"})
    for (const double direct : {0.0, 0.6, 1.0})
      test::on_every_target("composite", g, {{"mode", mode}, {"damping", "0"}, {"direct", fmt::format("{}", direct)}},
                            [&](const Image& image) {
                              double worst = 0.0;
                              for (int y = 0; y < image.height; ++y)
                                for (int x = 0; x < image.width; ++x) {
                                  const PixelLight arriving(g.layers[0], x, y);
                                  const double ao = g.layers[0].plane("ao").at(x, y);
                                  const double darker = 1.0 - direct * (1.0 - std::clamp(ao, 0.0, 1.0));
                                  const glm::dvec3 lit =
                                      arriving.direct * darker + arriving.bounced + arriving.ambient * ao;
                                  for (int c = 0; c < 3; ++c)
                                    worst = std::max(worst, std::fabs(lit[c] - image.plane(kLit[c]).at(x, y)));
                                }
                              EXPECT_LE(worst, 2e-6) << mode << ' ' << direct;
                            });
}

TEST(Composite, ModulateMatchesItsFormula) {
  expect_formula("modulate", {});
  expect_formula("modulate", {.darkness = 0.0, .chroma = 1.0});
  expect_formula("modulate", {.darkness = 0.0, .chroma = -2.5});
  expect_formula("modulate", {.darkness = 0.0, .contrast = 1.0});
  expect_formula("modulate", {.darkness = 0.7, .chroma = 3.0, .contrast = -1.5});
}

TEST(Composite, UnoccludedSurfacesKeepTheirLight) {
  GBuffer g = light_and_occlusion();
  g.layers[0].plane("ao") = Plane(g.info.width, g.info.height, 1.0f);
  for (const char* mode : {"ambient", "subtract", "multiply", "modulate"})
    test::on_every_target(
        "composite", g, {{"mode", mode}, {"chroma", "2"}, {"contrast", "3"}}, [&](const Image& image) {
          double max_error = 0.0;
          for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x) {
              const PixelLight light(g.layers[0], x, y);
              for (int c = 0; c < 3; ++c)
                max_error = std::max(max_error, std::fabs(image.plane(kLit[c]).at(x, y) - light.direct[c] -
                                                          light.ambient[c] - light.bounced[c]));
            }
          EXPECT_LE(max_error, 3e-6) << mode;
        });
}

TEST(Composite, BouncedLightIsAlbedoTimesIndirect) {
  // There is no light but `indirect`, and `ao` is 0 everywhere.
  GBuffer g = light_and_occlusion();
  const int width = g.info.width, height = g.info.height;
  g.layers[0].plane("ao") = Plane(width, height, 0.0f);
  for (int c = 0; c < 3; ++c)
    for (const auto* names : {kDirect, kAmbient}) g.layers[0].plane(names[c]) = Plane(width, height, 0.0f);
  const auto expect_bounced = [&](const char* mode, double factor, double offset) {
    test::on_every_target("composite", g, {{"mode", mode}}, [&](const Image& image) {
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(image.plane(kLit[c]).at(5, 7), factor * PixelLight(g.layers[0], 5, 7).bounced[c] + offset, 1e-6)
            << mode;
    });
  };
  expect_bounced("ambient", 1.0, 0.0);
  expect_bounced("multiply", 1.0, 0.0);
  expect_bounced("subtract", 1.0, -1.0);
  expect_bounced("modulate", 1.0, -1.0);
  expect_bounced("occlusion", 0.0, 0.0);
  // Without the planes of the albedo, the albedo is 0.8.
  Image bare(width, height);
  for (int c = 0; c < 3; ++c) bare.add(kIndirect[c]) = Plane(width, height, 0.5f);
  test::on_every_target("composite", {.info = g.info, .layers = {bare}}, {},
                        [](const Image& image) { EXPECT_NEAR(image.plane("lit.g").at(3, 3), 0.8 * 0.5, 1e-6); });
}

TEST(Composite, EachModeAtFullOcclusion) {
  GBuffer g = test::empty_gbuffer(1, 1);
  for (int c = 0; c < 3; ++c) {
    g.layers[0].add(kDirect[c]) = Plane(1, 1, 0.2f * (c + 1));
    g.layers[0].add(kAmbient[c]) = Plane(1, 1, 0.1f);
  }
  g.layers[0].add("ao") = Plane(1, 1, 0.0f);
  const auto expect_lit = [&](const Settings& settings, glm::dvec3 expected) {
    test::on_every_target("composite", g, settings, [&](const Image& image) {
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(image.plane(kLit[c]).at(0, 0), expected[c], 1e-6) << settings[0].second;
    });
  };
  const double luminance = 0.2126 * 0.3 + 0.7152 * 0.5 + 0.0722 * 0.7;
  expect_lit({{"mode", "ambient"}}, {0.2, 0.4, 0.6});      // direct light is kept
  expect_lit({{"mode", "subtract"}}, {-0.7, -0.5, -0.3});  // below 0; the output effect clamps it
  expect_lit({{"mode", "multiply"}}, {0.0, 0.0, 0.0});
  expect_lit({{"mode", "occlusion"}}, {0.0, 0.0, 0.0});
  expect_lit({{"mode", "modulate"}, {"darkness", "0"}, {"chroma", "1"}}, glm::dvec3(luminance));  // no chroma remains
  expect_lit({{"mode", "modulate"}, {"darkness", "0"}, {"contrast", "1"}}, {0.5, 0.5, 0.5});      // no contrast remains
  expect_lit({{"mode", "modulate"}, {"darkness", "0.25"}}, {0.05, 0.25, 0.45});
}

TEST(Composite, PartsAreThoseOfTheLight) {
  GBuffer g = light_and_occlusion();
  for (int c = 0; c < 3; ++c) g.layers[0].plane(kAmbient[c]) = Plane(g.info.width, g.info.height, 0.0f);
  // Without ambient light they are all of it.
  for (const char* mode : {"ambient", "multiply", "bleeding"})
    test::on_every_target("composite", g, {{"mode", mode}, {"direct", "0.6"}, {"parts", "on"}},
                          [&](const Image& image) {
                            for (const char* channel : {"r", "g", "b"}) {
                              const auto plane = [&](const char* name) -> const Plane& {
                                return image.plane(std::string(name) + channel);
                              };
                              for (int y = 0; y < image.height; ++y)
                                for (int x = 0; x < image.width; ++x)
                                  ASSERT_NEAR(plane("lit_direct.").at(x, y) + plane("lit_indirect.").at(x, y),
                                              plane("lit.").at(x, y), 2e-6)
                                      << mode;
                            }
                          });
  // The occlusion alone has none.
  test::on_every_target("composite", g, {{"mode", "occlusion"}, {"parts", "on"}}, [&](const Image& image) {
    EXPECT_EQ(image.plane("lit_direct.r").at(5, 5), 0.0f);
    EXPECT_EQ(image.plane("lit_indirect.r").at(5, 5), 0.0f);
  });
}

TEST(Composite, MissingPlanesAreBlackAndUnoccluded) {
  GBuffer g = test::empty_gbuffer(3, 2);
  test::on_every_target("composite", g, {}, [](const Image& image) { EXPECT_EQ(image.plane("lit.g").at(2, 1), 0.0f); });
  test::on_every_target("composite", g, {{"mode", "occlusion"}},
                        [](const Image& image) { EXPECT_EQ(image.plane("lit.g").at(2, 1), 1.0f); });
}

TEST(Composite, NonFiniteInputsAreBlack) {
  GBuffer g = light_and_occlusion();
  g.layers[0].plane("ao").at(0, 0) = std::nanf("");
  g.layers[0].plane("direct.r").at(1, 0) = std::numeric_limits<float>::infinity();
  g.layers[0].plane("ambient.g").at(2, 0) = -std::nanf("");
  g.layers[0].plane("indirect.b").at(3, 0) = std::numeric_limits<float>::infinity();
  g.layers[0].plane("albedo.b").at(4, 0) = std::nanf("");
  for (const char* mode : {"ambient", "subtract", "multiply", "modulate", "occlusion"})
    test::on_every_target("composite", g, {{"mode", mode}}, [&](const Image& image) {
      for (int c = 0; c < 3; ++c) EXPECT_EQ(image.plane(kLit[c]).at(0, 0), 0.0f) << mode;
      if (mode != std::string_view("occlusion")) {
        EXPECT_EQ(image.plane("lit.r").at(1, 0), 0.0f) << mode;
        EXPECT_EQ(image.plane("lit.g").at(2, 0), 0.0f) << mode;
        EXPECT_EQ(image.plane("lit.b").at(3, 0), 0.0f) << mode;
        EXPECT_EQ(image.plane("lit.b").at(4, 0), 0.0f) << mode;
      }
      for (int x = 0; x < image.width; ++x) EXPECT_TRUE(std::isfinite(image.plane("lit.b").at(x, 0))) << mode;
    });
}

}  // namespace
}  // namespace umbrage
