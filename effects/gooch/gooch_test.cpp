// Compares `gooch` with the formula of [Gooch et al. 1998] in double and with closed values, and tests its light and
// its highlight.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "core/color.h"
#include "run_effect.h"
#include "scene/scene.h"
#include "support.h"

namespace umbrage {
namespace {

using namespace test;

// Light from the right, so that the x of a normal is n.l.
const Settings kFromTheRight = {
    {"light_azimuth", "90"}, {"light_elevation", "0"}, {"highlight", "0"}, {"values", "display"}};
const Settings kWithoutHighlight = {{"highlight", "0"}, {"values", "display"}};

/// Tones as display values.
struct Tones {
  double blue, yellow, alpha, beta;
};
constexpr Tones kDefault = {0.55, 0.3, 0.25, 0.5}, kPaper = {0.4, 0.4, 0.2, 0.6};

glm::dvec3 expected_color(const Tones& tones, const glm::dvec3& kd, double cosine) {
  const double t = 0.5 * (1.0 + cosine);
  const glm::dvec3 cool = glm::dvec3(0.0, 0.0, tones.blue) + tones.alpha * kd;
  const glm::dvec3 warm = glm::dvec3(tones.yellow, tones.yellow, 0.0) + tones.beta * kd;
  return (1.0 - t) * cool + t * warm;
}

double luminance(const glm::dvec3& color) { return glm::dot(color, glm::dvec3(0.2126, 0.7152, 0.0722)); }

void set_color(GBuffer& g, int x, const char* const (&planes)[3], const glm::dvec3& color) {
  for (int c = 0; c < 3; ++c) g.layers[0].plane(planes[c]).at(x, 0) = float(color[c]);
}

glm::dvec3 lit_at(const Image& image, int x, int y = 0) {
  return {image.plane("lit.r").at(x, y), image.plane("lit.g").at(x, y), image.plane("lit.b").at(x, y)};
}

/// Returns a row of surfaces in an orthographic view that face the camera and have this colour, as display values.
GBuffer row(int width, double display_value = 0.5) {
  GBuffer g = empty_gbuffer(width, 1);
  g.info.camera = orthographic_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 3.0f, float(width));
  Image& image = g.layers[0];
  image.add("depth") = Plane(width, 1, 5.0f);
  for (int c = 0; c < 3; ++c) {
    image.add(kNormal[c]) = Plane(width, 1, c == 2 ? 1.0f : 0.0f);
    image.add(kAlbedo[c]) = Plane(width, 1, linear_from_srgb(float(display_value)));
  }
  return g;
}

/// Returns a row in which n.l with light from the right goes from -1 to 1.
GBuffer turning_row(int width, double display_value = 0.5) {
  GBuffer g = row(width, display_value);
  for (int x = 0; x < width; ++x) {
    const double cosine = 2.0 * x / (width - 1.0) - 1.0;
    set_color(g, x, kNormal, {cosine, 0.0, std::sqrt(1.0 - cosine * cosine)});
  }
  return g;
}

void expect_near(const glm::dvec3& color, const glm::dvec3& expected, double bound) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(color[c], expected[c], bound) << "channel " << c;
}

// ---- tones

TEST(Gooch, GreyHasTheTonesOfTheFormula) {
  on_every_target("gooch", turning_row(3), kFromTheRight, [](const Image& out) {
    expect_near(lit_at(out, 0), {0.125, 0.125, 0.675}, 1e-6);
    expect_near(lit_at(out, 1), {0.3375, 0.3375, 0.4625}, 1e-6);
    expect_near(lit_at(out, 2), {0.55, 0.55, 0.25}, 1e-6);
  });
  on_every_target("gooch", turning_row(3), joined(kFromTheRight, {{"tones", "paper"}}), [](const Image& out) {
    expect_near(lit_at(out, 0), {0.1, 0.1, 0.5}, 1e-6);
    expect_near(lit_at(out, 1), {0.4, 0.4, 0.4}, 1e-6);
    expect_near(lit_at(out, 2), {0.7, 0.7, 0.3}, 1e-6);
  });
}

TEST(Gooch, ParametersAreThoseOfTheFormula) {
  const Tones tones = {0.9, 0.125, 0.75, 0.0625};
  const Settings settings = joined(
      kFromTheRight, {{"blue", "0.9"}, {"yellow", "0.125"}, {"alpha", "0.75"}, {"beta", "0.0625"}, {"hue", "0"}});
  GBuffer g = turning_row(9);
  const glm::dvec3 kd = {0.8, 0.4, 0.1};
  for (int x = 0; x < 9; ++x)
    set_color(g, x, kAlbedo, {linear_from_srgb(0.8f), linear_from_srgb(0.4f), linear_from_srgb(0.1f)});
  on_every_target("gooch", g, settings, [&](const Image& out) {
    for (int x = 0; x < 9; ++x) expect_near(lit_at(out, x), expected_color(tones, kd, 0.25 * x - 1.0), 2e-6);
  });
  on_every_target("gooch", g, joined(settings, {{"tones", "paper"}}), [&](const Image& out) {
    for (int x = 0; x < 9; ++x) expect_near(lit_at(out, x), expected_color(kPaper, kd, 0.25 * x - 1.0), 2e-6);
  });
}

TEST(Gooch, EveryPixelHasTheColorOfTheFormula) {
  for (const bool perspective : {true, false}) {
    GBuffer g = bumpy_gbuffer(131, 97, 5);
    if (!perspective) g.info.camera = orthographic_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 3.0f, 131.0f / 97.0f);
    const Image& image = g.layers[0];
    const double azimuth = 110.0 * std::numbers::pi / 180.0, elevation = 25.0 * std::numbers::pi / 180.0;
    const glm::dvec3 light = {std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                              std::cos(elevation) * std::cos(azimuth)};
    const Settings settings =
        joined(kWithoutHighlight, {{"light_azimuth", "110"}, {"light_elevation", "25"}, {"hue", "0"}});
    on_every_target("gooch", g, settings, [&](const Image& out) {
      double worst = 0.0;
      long surfaces = 0, away = 0;
      for (int y = 0; y < 97; ++y)
        for (int x = 0; x < 131; ++x) {
          glm::dvec3 expected(0.0);
          if (std::isfinite(image.plane("depth").at(x, y))) {
            glm::dvec3 n, kd;
            for (int c = 0; c < 3; ++c) {
              n[c] = image.plane(kNormal[c]).at(x, y);
              kd[c] = srgb_from_linear(image.plane(kAlbedo[c]).at(x, y));
            }
            const double cosine = glm::dot(glm::normalize(n), light);
            expected = expected_color(kDefault, kd, cosine);
            ++surfaces;
            away += cosine < -0.1;
          }
          const glm::dvec3 difference = glm::abs(lit_at(out, x, y) - expected);
          worst = std::max({worst, difference.r, difference.g, difference.b});
        }
      EXPECT_LE(worst, 3e-6);
      EXPECT_GT(surfaces, 5000);
      EXPECT_GT(away, 300) << "n.l is not clamped";
    });
  }
}

/// Returns the hue of a colour, degrees from red to green.
double hue_deg(const glm::dvec3& v) {
  return std::atan2(std::sqrt(3.0) * (v.g - v.b), 2.0 * v.r - v.g - v.b) * 180.0 / std::numbers::pi;
}

TEST(Gooch, SaturatedSurfacesKeepTheirHue) {
  const Settings of_look = {{"blue", "0.4"}, {"yellow", "0.4"}, {"alpha", "0.2"}, {"beta", "0.6"}};
  for (const Settings& tones : {Settings{}, of_look})
    for (int angle = 0; angle < 360; angle += 15)
      for (const double saturation : {0.3, 0.6, 1.0})
        for (const double value : {0.4, 0.9}) {
          glm::dvec3 kd;  // the colour of a circle of hues
          for (int c = 0; c < 3; ++c) {
            const double away = std::fabs(std::remainder(angle - 120.0 * c, 360.0)) / 60.0;
            kd[c] = value * (1.0 - saturation * std::clamp(away - 1.0, 0.0, 1.0));
          }
          GBuffer g = turning_row(11);
          for (int x = 0; x < 11; ++x)
            set_color(g, x, kAlbedo,
                      {linear_from_srgb(float(kd.r)), linear_from_srgb(float(kd.g)), linear_from_srgb(float(kd.b))});
          on_every_target("gooch", g, joined(kFromTheRight, tones), [&](const Image& out) {
            for (int x = 0; x < 11; ++x) {
              const double turn = std::remainder(hue_deg(lit_at(out, x)) - hue_deg(kd), 360.0);
              EXPECT_LT(std::fabs(turn), 15.0) << angle << " degrees, " << saturation << ", " << value << ", " << x;
              if (x > 0) {
                EXPECT_GT(luminance(lit_at(out, x)), luminance(lit_at(out, x - 1)));
              }
            }
          });
        }
}

TEST(Gooch, TonesOfThePaperIgnoreTheHue) {
  GBuffer g = turning_row(3);
  for (int x = 0; x < 3; ++x) set_color(g, x, kAlbedo, {1.0, 0.0, 0.0});
  on_every_target("gooch", g, joined(kFromTheRight, {{"tones", "paper"}}), [](const Image& out) {
    for (int x = 0; x < 3; ++x) expect_near(lit_at(out, x), expected_color(kPaper, {1, 0, 0}, x - 1.0), 2e-6);
  });
}

TEST(Gooch, LuminanceRisesTowardsTheLight) {
  for (const char* tones : {"own", "paper"})
    for (const double value : {0.0, 0.25, 0.5, 1.0})
      on_every_target("gooch", turning_row(101, value), joined(kFromTheRight, {{"tones", tones}}),
                      [&](const Image& out) {
                        for (int x = 1; x < 101; ++x) {
                          const glm::dvec3 darker = lit_at(out, x - 1), brighter = lit_at(out, x);
                          EXPECT_GT(luminance(brighter), luminance(darker) + 1e-3) << tones << ' ' << value << ' ' << x;
                          EXPECT_LT(brighter.b - brighter.r, darker.b - darker.r) << "warmer";
                        }
                      });
  on_every_target("gooch", turning_row(3), kFromTheRight, [](const Image& out) {
    EXPECT_NEAR(luminance(lit_at(out, 0)), 0.165, 5e-4);
    EXPECT_NEAR(luminance(lit_at(out, 2)), 0.528, 5e-4);
  });
}

TEST(Gooch, LightIsTheDecodedDisplayValue) {
  const GBuffer g = turning_row(17);
  on_every_target("gooch", g, kFromTheRight, [&](const Image& display) {
    const Image light = run_effect(*find_effect("gooch"), g, joined(kFromTheRight, {{"values", "light"}}), {});
    for (int x = 0; x < 17; ++x)
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(srgb_from_linear(float(lit_at(light, x)[c])), lit_at(display, x)[c], 2e-6) << x;
  });
}

// ---- light and highlight

TEST(Gooch, LightIsRelativeToTheFirstCamera) {
  GBuffer g = row(4);
  set_color(g, 0, kNormal, {0, 0, 1});
  set_color(g, 1, kNormal, {1, 0, 0});
  set_color(g, 2, kNormal, {0, 1, 0});
  set_color(g, 3, kNormal, {0, 0, -1});
  const auto cosines = [&](const Settings& light) {
    std::array<double, 4> found{};
    on_every_target("gooch", g, joined(kWithoutHighlight, light), [&](const Image& out) {
      // red of a grey: 0.125 in the shade, 0.55 in the light
      for (int x = 0; x < 4; ++x) found[std::size_t(x)] = 2.0 * (lit_at(out, x).r - 0.125) / 0.425 - 1.0;
    });
    return found;
  };
  const auto expect = [&](const Settings& light, const std::array<double, 4>& expected) {
    const auto found = cosines(light);
    for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(found[k], expected[k], 1e-5) << light[0].second << ' ' << k;
  };
  expect({{"light_azimuth", "0"}, {"light_elevation", "0"}}, {1, 0, 0, -1});
  expect({{"light_azimuth", "-90"}, {"light_elevation", "0"}}, {0, -1, 0, 0});
  expect({{"light_azimuth", "30"}, {"light_elevation", "90"}}, {0, 0, 1, 0});
  const auto by_default = cosines({});
  EXPECT_GT(by_default[0], 0.1) << "towards the camera";
  EXPECT_LT(by_default[1], -0.3) << "from the left";
  EXPECT_GT(by_default[2], 0.3) << "from above";
  // A camera that is turned by 90 degrees about y sees light from its right in front of it.
  g.info.view_from_first = glm::mat4(0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1);
  expect({{"light_azimuth", "0"}, {"light_elevation", "0"}}, {0, 1, 0, 0});
}

TEST(Gooch, HighlightIsWhiteAndHalfwayToTheLight) {
  const double angle = 30.0 * std::numbers::pi / 180.0;  // half of that between camera and light
  constexpr int kWidth = 121;
  GBuffer g = row(kWidth);
  for (int x = 0; x < kWidth; ++x) {
    const double turn = (x - 60) / 60.0 * 0.5 * std::numbers::pi;
    set_color(g, x, kNormal, {std::sin(turn), 0.0, std::cos(turn)});
  }
  const int middle = 80;  // turned by 30 degrees
  const Settings side = {{"light_azimuth", "60"}, {"light_elevation", "0"}, {"values", "display"}};
  for (const double strength : {1.0, 0.5}) {
    const Settings settings = joined(side, {{"highlight", fmt::format("{}", strength)}, {"shininess", "40"}});
    on_every_target("gooch", g, settings, [&](const Image& out) {
      for (int x = 0; x < kWidth; ++x) {
        const double turn = (x - 60) / 60.0 * 0.5 * std::numbers::pi;
        const double fraction = strength * std::pow(std::max(std::cos(turn - angle), 0.0), 40.0);
        const glm::dvec3 plain = expected_color(kDefault, glm::dvec3(0.5), std::cos(turn - 2.0 * angle));
        expect_near(lit_at(out, x), plain + fraction * (glm::dvec3(1.0) - plain), 1e-5);
      }
    });
  }
  on_every_target("gooch", g, joined(side, {{"highlight", "1"}}),
                  [&](const Image& out) { expect_near(lit_at(out, middle), glm::dvec3(1.0), 1e-5); });
  // In perspective it depends on where the surface is.
  g.info.camera = perspective_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 40.0f, float(kWidth));
  on_every_target("gooch", g, joined(side, {{"highlight", "1"}}),
                  [&](const Image& out) { EXPECT_LT(lit_at(out, middle).b, 0.99); });
}

TEST(Gooch, OcclusionMovesTowardsTheCoolTone) {
  GBuffer g = turning_row(5);
  g.layers[0].add("ao") = Plane(5, 1, 0.5f);
  on_every_target("gooch", g, kFromTheRight, [](const Image& out) {
    expect_near(lit_at(out, 4), {0.3375, 0.3375, 0.4625}, 1e-6);  // t = 1/2
    expect_near(lit_at(out, 0), {0.125, 0.125, 0.675}, 1e-6);
  });
  on_every_target("gooch", g, joined(kFromTheRight, {{"occlusion", "2"}}), [](const Image& out) {
    expect_near(lit_at(out, 4), {0.125, 0.125, 0.675}, 1e-6);
  });
  on_every_target("gooch", g, joined(kFromTheRight, {{"occlusion", "0"}}), [](const Image& out) {
    expect_near(lit_at(out, 4), {0.55, 0.55, 0.25}, 1e-6);
  });
  g.layers[0].plane("ao") = Plane(5, 1, 2.0f);  // as unsharp masking may produce
  on_every_target("gooch", g, kFromTheRight, [](const Image& out) {
    expect_near(lit_at(out, 4), {0.55, 0.55, 0.25}, 1e-6);
  });
}

// ---- pixels and planes that are missing

TEST(Gooch, MissingAlbedoIsThatOfClay) {
  GBuffer g = turning_row(3);
  GBuffer bare = empty_gbuffer(3, 1);
  bare.info = g.info;
  for (const char* name : {"depth", "normal.x", "normal.y", "normal.z"})
    bare.layers[0].add(name) = g.layers[0].plane(name);
  on_every_target("gooch", bare, kFromTheRight, [](const Image& out) {
    const glm::dvec3 clay(srgb_from_linear(Material{}.albedo.r));
    for (int x = 0; x < 3; ++x) expect_near(lit_at(out, x), expected_color(kDefault, clay, x - 1.0), 1e-6);
  });
}

TEST(Gooch, PixelsThatAreNotFiniteAreDefined) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
  GBuffer g = turning_row(18);
  Image& image = g.layers[0];
  for (int x = 0; x < 18; ++x) set_color(g, x, kNormal, {0, 0, 1});
  image.add("ao") = Plane(18, 1, 1.0f);
  image.plane("depth").at(0, 0) = kInfinity;
  image.plane("depth").at(1, 0) = kNan;
  image.plane("depth").at(2, 0) = -kInfinity;
  image.plane("normal.x").at(3, 0) = kNan;
  set_color(g, 4, kNormal, {0, 0, 0});
  image.plane("ao").at(5, 0) = kNan;
  image.plane("albedo.r").at(6, 0) = kNan;
  image.plane("albedo.r").at(7, 0) = kInfinity;
  image.plane("albedo.r").at(8, 0) = -3.0f;
  image.plane("albedo.r").at(9, 0) = 50.0f;
  on_every_target("gooch", g, joined(kFromTheRight, {{"hue", "0"}}), [](const Image& out) {
    const glm::dvec3 plain = {0.3375, 0.3375, 0.4625};
    for (const int x : {0, 1, 2}) EXPECT_EQ(lit_at(out, x), glm::dvec3(0.0)) << x;
    for (const int x : {3, 4, 5, 10, 17}) expect_near(lit_at(out, x), plain, 1e-6);
    for (const int x : {6, 7, 8, 9}) {
      const double red = x == 9 ? 1.0 : 0.0;
      EXPECT_NEAR(lit_at(out, x).r, expected_color(kDefault, {red, 0.5, 0.5}, 0.0).r, 1e-6) << x;
      EXPECT_NEAR(lit_at(out, x).b, plain.b, 1e-6) << x;
    }
  });
}

}  // namespace
}  // namespace umbrage
