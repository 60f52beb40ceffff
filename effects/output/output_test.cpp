// Compares `output` with the sRGB curve of [IEC 61966-2-1] in double, and tests the background.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>
#include <limits>

#include "run_effect.h"
#include "support.h"

namespace umbrage {
namespace {

using test::Settings;

double srgb(double v) { return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055; }

/// Returns a row of light values, equal in every channel, all on a surface.
GBuffer row_of(const std::vector<float>& values) {
  const int width = int(values.size());
  GBuffer g = test::empty_gbuffer(width, 1);
  g.layers[0].add("depth") = Plane(width, 1, 3.0f);
  for (const char* name : {"lit.r", "lit.g", "lit.b"}) {
    Plane& plane = g.layers[0].add(name);
    for (int x = 0; x < width; ++x) plane.at(x, 0) = values[x];
  }
  return g;
}

std::vector<float> ramp(double min, double max, int count) {
  std::vector<float> values(count);
  for (int i = 0; i < count; ++i) values[i] = float(min + (max - min) * i / (count - 1));
  return values;
}

TEST(Output, FollowsTheSrgbCurve) {
  // The whole range, and the dark end where the curve is steepest and changes its formula.
  for (const double max : {1.0, 0.01, 0.0032}) {
    const auto values = ramp(0.0, max, 5000);
    const GBuffer g = row_of(values);
    test::on_every_target("output", g, {}, [&](const Image& image) {
      double worst = 0.0;
      for (int x = 0; x < image.width; ++x)
        worst = std::max(worst, std::fabs(image.plane("color.g").at(x, 0) - srgb(values[x])));
      EXPECT_LE(worst, 1e-6) << "up to " << max;
    });
  }
}

TEST(Output, TheEndsOfTheCurveAreExact) {
  test::on_every_target("output", row_of({0.0f, 1.0f}), {}, [](const Image& image) {
    EXPECT_EQ(image.plane("color.r").at(0, 0), 0.0f);
    EXPECT_NEAR(image.plane("color.r").at(1, 0), 1.0f, 2e-7);
  });
}

TEST(Output, EveryEightBitValueSurvivesTheRoundTrip) {
  std::vector<float> values(256);
  for (int i = 0; i < 256; ++i) {
    const double v = i / 255.0;
    values[i] = float(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
  }
  test::on_every_target("output", row_of(values), {}, [](const Image& image) {
    for (int i = 0; i < 256; ++i) EXPECT_NEAR(image.plane("color.b").at(i, 0) * 255.0, i, 1e-3);
  });
}

TEST(Output, LightAboveWhiteIsKept) {
  test::on_every_target("output", row_of({4.0f}), {},
                        [](const Image& image) { EXPECT_NEAR(image.plane("color.r").at(0, 0), srgb(4.0), 4e-6); });
  test::on_every_target("output", row_of({4.0f}), {{"transfer", "none"}},
                        [](const Image& image) { EXPECT_EQ(image.plane("color.r").at(0, 0), 4.0f); });
}

TEST(Output, ExposureCountsInStops) {
  const auto values = ramp(0.0, 2.0, 300);
  const GBuffer g = row_of(values);
  for (const int stops : {-3, -1, 0, 1, 4}) {
    const Settings settings = {{"exposure", fmt::format("{}", stops)}, {"transfer", "none"}};
    test::on_every_target("output", g, settings, [&](const Image& image) {
      for (int x = 0; x < image.width; ++x)
        ASSERT_EQ(image.plane("color.r").at(x, 0), std::ldexp(values[x], stops)) << values[x];
    });
  }
  test::on_every_target("output", g, {{"exposure", "0.5"}}, [&](const Image& image) {
    for (int x = 0; x < image.width; ++x)
      ASSERT_NEAR(image.plane("color.r").at(x, 0), srgb(values[x] * std::sqrt(2.0)), 3e-6) << values[x];
  });
}

TEST(Output, AShoulderBendsLightBelowWhite) {
  const auto values = ramp(0.0, 50.0, 500);
  test::on_every_target(
      "output", row_of(values), {{"shoulder", "0.75"}, {"transfer", "none"}}, [&](const Image& image) {
        for (int x = 0; x < image.width; ++x) {
          const double over = std::max(values[x] - 0.75, 0.0) / 0.25;
          const float bent = image.plane("color.g").at(x, 0);
          ASSERT_NEAR(bent, std::min<double>(values[x], 0.75) + 0.25 * over / (1.0 + over), 1e-6) << values[x];
          ASSERT_LT(bent, 1.0f);
          if (x > 0) {
            ASSERT_GT(bent, image.plane("color.g").at(x - 1, 0)) << values[x];
          }
        }
      });
}

/// The formula of [Khronos 2024], as its specification states it, but with another toe.
glm::dvec3 neutral(const glm::dvec3& in) {
  constexpr double kF90 = 0.04, kKs = 0.8 - kF90, kKd = 0.15, kA = 0.5;
  const double x = std::min({in.r, in.g, in.b});
  const double toe = kA * x - kA * kA * x * x / (4.0 * kF90);
  const glm::dvec3 out = in - (x > 2.0 * kF90 / kA ? kF90 : toe);
  const double p = std::max({out.r, out.g, out.b});
  if (p <= kKs) return out;
  const double pn = 1.0 - (1.0 - kKs) * (1.0 - kKs) / (p + 1.0 - 2.0 * kKs);
  const double g = 1.0 / (kKd * (p - pn) + 1.0);
  return out * (pn / p * g) + pn * (1.0 - g);
}

TEST(Output, TheNeutralCurveFollowsItsFormula) {
  // All colours of these channels: toe, middle, shoulder, and far beyond white.
  const std::vector<float> steps = {0.0f, 1e-4f, 0.02f, 0.079f, 0.159f, 0.161f, 0.2f,
                                    0.5f, 0.79f, 0.81f, 1.0f,   1.7f,   5.0f,   60.0f};
  const int count = int(steps.size());
  GBuffer g = row_of(std::vector<float>(std::size_t(count * count * count)));
  const auto color_of = [&](int x) {
    return glm::vec3(steps[std::size_t(x % count)], steps[std::size_t(x / count % count)],
                     steps[std::size_t(x / count / count)]);
  };
  for (int x = 0; x < count * count * count; ++x)
    for (int c = 0; c < 3; ++c) g.layers[0].plane(test::kLit[c]).at(x, 0) = color_of(x)[c];
  test::on_every_target("output", g, {{"tone", "neutral"}, {"transfer", "none"}}, [&](const Image& image) {
    double worst = 0.0;
    for (int x = 0; x < image.width; ++x) {
      const glm::dvec3 expected = neutral(color_of(x));
      int c = 0;
      for (const char* name : {"color.r", "color.g", "color.b"}) {
        const float v = image.plane(name).at(x, 0);
        worst = std::max(worst, std::fabs(v - expected[c++]));
        ASSERT_GE(v, 0.0f);
        ASSERT_LT(v, 1.0f);
      }
    }
    EXPECT_LE(worst, 1e-6);
  });
  // Exposure comes before the curve, the transfer function after it.
  test::on_every_target("output", row_of({0.4f}), {{"tone", "neutral"}, {"exposure", "1"}}, [](const Image& image) {
    EXPECT_NEAR(image.plane("color.g").at(0, 0), srgb(neutral(glm::dvec3(0.8)).g), 2e-6);
  });
  // Far beyond white it is white, and what is no light is black.
  const float infinity = std::numeric_limits<float>::infinity();
  test::on_every_target("output", row_of({3e38f, infinity, std::nanf("")}), {{"tone", "neutral"}},
                        [](const Image& image) {
                          EXPECT_NEAR(image.plane("color.g").at(0, 0), 1.0f, 1e-6f);
                          EXPECT_EQ(image.plane("color.g").at(1, 0), 0.0f);
                          EXPECT_EQ(image.plane("color.g").at(2, 0), 0.0f);
                        });
}

TEST(Output, TheBackgroundDarkensUpwards) {
  constexpr int kRows = 11, kGuard = 3;
  GBuffer g = test::empty_gbuffer(7 + 2 * kGuard, kRows + 2 * kGuard);
  g.info.guard = kGuard;
  Image& image = g.layers[0];
  image.add("depth") = Plane(image.width, image.height, std::numeric_limits<float>::infinity());
  for (const char* name : {"lit.r", "lit.g", "lit.b", "cover"})
    image.add(name) = Plane(image.width, image.height, 0.0f);
  for (int y = 0; y < image.height; ++y) image.plane("cover").at(kGuard + 2, y) = 0.5f;  // a black shadow
  const double light = std::pow((0.9 + 0.055) / 1.055, 2.4);
  const Settings settings = {{"background_g", "0.9"}, {"gradient", "0.4"}};
  test::on_every_target("output", g, settings, [&](const Image& drawn) {
    ASSERT_EQ(drawn.height, kRows);
    for (int y = 0; y < kRows; ++y) {
      // 0.6 of the light at the upper border of the picture without guard band, all of it at the lower one.
      const double height = 1.0 - (y + 0.5) / kRows;
      for (const int x : {0, 6}) EXPECT_NEAR(drawn.plane("color.g").at(x, y), srgb(light * (1.0 - 0.4 * height)), 3e-6);
      EXPECT_NEAR(drawn.plane("color.g").at(2, y), srgb(0.5 * light * (1.0 - 0.4 * height)), 3e-6);
      EXPECT_EQ(drawn.plane("color.a").at(0, y), 1.0f);
    }
  });
  test::on_every_target("output", g, {{"gradient", "0.4"}, {"transparent", "on"}}, [&](const Image& drawn) {
    EXPECT_EQ(drawn.plane("color.g").at(0, 8), 0.0f);
    EXPECT_EQ(drawn.plane("color.a").at(0, 8), 0.0f);
  });
}

TEST(Output, AMeanForTheEyeAndTheBackgroundMixSo) {
  GBuffer g = row_of({0.5f});
  g.layers[0].plane("depth").at(0, 0) = std::numeric_limits<float>::infinity();
  g.layers[0].add("cover_for_eye").at(0, 0) = 0.5f;
  g.layers[0].plane("lit.r").at(0, 0) = 0.0f;
  test::on_every_target("output", g, {}, [](const Image& image) {
    EXPECT_NEAR(image.plane("color.r").at(0, 0), srgb(0.25), 4e-6);  // black over half of white
  });
  // A shadow is not averaged perceptually: it only has less light.
  g.layers[0].add("cover").at(0, 0) = 0.5f;
  g.layers[0].plane("cover_for_eye").at(0, 0) = 0.0f;
  test::on_every_target("output", g, {},
                        [](const Image& image) { EXPECT_NEAR(image.plane("color.r").at(0, 0), srgb(0.5), 4e-6); });
}

TEST(Output, BackgroundIsWrittenAsItIs) {
  GBuffer g = row_of({0.5f, 0.5f, 0.5f});
  g.layers[0].plane("depth").at(1, 0) = std::numeric_limits<float>::infinity();
  g.layers[0].plane("depth").at(2, 0) = std::nanf("");
  const Settings color = {{"background_r", "0.25"}, {"background_g", "0.5"}, {"background_b", "0.75"}};
  // Exposure and transfer function do not change it.
  for (const char* transfer : {"srgb", "none"}) {
    Settings settings = color;
    settings.insert(settings.end(), {{"transfer", transfer}, {"exposure", "3"}});
    test::on_every_target("output", g, settings, [](const Image& image) {
      for (int x : {1, 2}) {
        EXPECT_EQ(image.plane("color.r").at(x, 0), 0.25f);
        EXPECT_EQ(image.plane("color.g").at(x, 0), 0.5f);
        EXPECT_EQ(image.plane("color.b").at(x, 0), 0.75f);
      }
      for (int x : {0, 1, 2}) EXPECT_EQ(image.plane("color.a").at(x, 0), 1.0f);
      EXPECT_GT(image.plane("color.r").at(0, 0), 1.0f);
    });
  }
  Settings settings = color;
  settings.emplace_back("transparent", "on");
  test::on_every_target("output", g, settings, [](const Image& image) {
    EXPECT_EQ(image.plane("color.a").at(0, 0), 1.0f);
    for (const char* name : {"color.r", "color.g", "color.b", "color.a"}) EXPECT_EQ(image.plane(name).at(1, 0), 0.0f);
  });
}

/// A surface, a shadow that covers half of a pixel, and background, under a line of the colour 0.64.
GBuffer under_a_line(float line) {
  GBuffer g = row_of({0.25f, 0.125f, 0.0f});
  Image& image = g.layers[0];
  for (int x = 1; x < 3; ++x) image.plane("depth").at(x, 0) = std::numeric_limits<float>::infinity();
  for (const char* name : {"outline", "line.r", "cover"}) image.add(name) = Plane(3, 1, 0.0f);
  for (int x = 0; x < 3; ++x) {
    image.plane("outline").at(x, 0) = line;
    image.plane("line.r").at(x, 0) = 0.64f;
  }
  image.plane("cover").at(1, 0) = 0.5f;
  return g;
}

double mixed(double light, double line, double fraction) {
  const double root = fraction * std::sqrt(line) + (1.0 - fraction) * std::sqrt(light);
  return root * root;
}

TEST(Output, LinesLieOverTheFinishedLight) {
  // Neither exposure nor the shoulder changes a line. The surface's light becomes 1, and is compressed to 0.75.
  const Settings settings = {{"transfer", "none"}, {"background_r", "0.8"}, {"exposure", "2"}, {"shoulder", "0.5"}};
  for (const float line : {0.0f, 0.25f, 1.0f})
    test::on_every_target("output", under_a_line(line), settings, [&](const Image& image) {
      const double light[] = {0.75, 0.5 * 0.75 + 0.5 * 0.8, 0.8};
      for (int x = 0; x < 3; ++x) {
        EXPECT_NEAR(image.plane("color.r").at(x, 0), mixed(light[x], 0.64, line), 1e-6) << x << ", " << line;
        EXPECT_EQ(image.plane("color.a").at(x, 0), 1.0f);
      }
    });
}

/// The beauty of pixels of a surface, of a shadow, and of nothing, without lines.
GBuffer for_beauty() {
  GBuffer g = under_a_line(0.0f);
  Image& image = g.layers[0];
  image.plane("cover").at(1, 0) = 0.0f;
  image.add("shadow_catcher") = Plane(3, 1, 0.0f);
  image.plane("shadow_catcher").at(1, 0) = 0.5f;
  image.plane("lit.r").at(1, 0) = 0.0f;
  return g;
}

double linear(double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); }

TEST(Output, BeautyIsLightBeforeTheDisplayTransform) {
  const Settings settings = {
      {"beauty", "light"}, {"exposure", "3"}, {"tone", "neutral"}, {"shoulder", "0.5"}, {"background_r", "0.8"}};
  for (const char* transfer : {"srgb", "none"})
    test::on_every_target("output", for_beauty(), test::joined(settings, {{"transfer", transfer}}),
                          [](const Image& image) {
                            const Plane& r = image.plane("beauty.r");
                            EXPECT_EQ(r.at(0, 0), 2.0f);
                            EXPECT_NEAR(r.at(1, 0), 0.5 * linear(0.8), 1e-6);
                            EXPECT_NEAR(r.at(2, 0), linear(0.8), 1e-6);
                            for (int x = 0; x < 3; ++x) EXPECT_EQ(image.plane("beauty.a").at(x, 0), 1.0f) << x;
                          });
}

TEST(Output, BeautyIsPremultiplied) {
  GBuffer g = for_beauty();
  Image& image = g.layers[0];
  // A surface that covers 0.25 of the last pixel, in the mean of several pictures, and a line over half of the shadow.
  image.plane("cover").at(2, 0) = 0.25f;
  image.plane("lit.r").at(2, 0) = 0.25f * 0.8f;
  image.plane("outline").at(1, 0) = 0.5f;
  test::on_every_target("output", g, {{"beauty", "light"}, {"transparent", "on"}}, [](const Image& drawn) {
    const Plane &r = drawn.plane("beauty.r"), &a = drawn.plane("beauty.a");
    EXPECT_EQ(a.at(0, 0), 1.0f);
    EXPECT_FLOAT_EQ(a.at(1, 0), 0.75f);
    EXPECT_NEAR(r.at(1, 0), 0.75 * mixed(0.0, 0.64, 0.5 / 0.75), 1e-6);
    EXPECT_EQ(a.at(2, 0), 0.25f);
    EXPECT_FLOAT_EQ(r.at(2, 0), 0.25f * 0.8f);
    EXPECT_NEAR(drawn.plane("color.r").at(2, 0), srgb(0.8), 2e-6) << "the picture is not";
  });
  test::on_every_target("output", row_of({std::nanf(""), -1.0f, 3e38f}), {{"beauty", "light"}, {"exposure", "9"}},
                        [](const Image& drawn) {
                          for (int x = 0; x < 3; ++x) EXPECT_EQ(drawn.plane("beauty.g").at(x, 0), 0.0f) << x;
                        });
}

TEST(Output, BeautyDecodesDisplayValues) {
  const Settings settings = {{"beauty", "display"}, {"transfer", "none"}, {"background_r", "0.8"}};
  test::on_every_target("output", for_beauty(), settings, [](const Image& image) {
    for (int x = 0; x < 3; ++x)
      EXPECT_NEAR(srgb(image.plane("beauty.r").at(x, 0)), image.plane("color.r").at(x, 0), 1e-6) << x;
  });
  // The shadow of a transparent picture is that of its viewer: as light it has another opacity.
  test::on_every_target("output", for_beauty(), {{"beauty", "light"}, {"transparent", "on"}, {"blend", "display"}},
                        [](const Image& image) {
                          EXPECT_EQ(image.plane("color.a").at(1, 0), 0.5f);
                          EXPECT_NEAR(image.plane("beauty.a").at(1, 0), 1.0 - linear(0.5), 1e-6);
                        });
}

TEST(Output, ThePartsOfBeautyAddUp) {
  GBuffer g = for_beauty();
  Image& image = g.layers[0];
  for (const char* name : {"lit_direct.r", "lit_indirect.r"}) image.add(name) = Plane(3, 1, 0.0625f);
  image.plane("outline").at(0, 0) = 0.5f;
  for (const char* transparent : {"on", "off"})
    test::on_every_target("output", g,
                          {{"beauty", "light"}, {"parts", "on"}, {"exposure", "1"}, {"transparent", transparent}},
                          [](const Image& drawn) {
                            EXPECT_EQ(drawn.plane("beauty_direct.r").at(0, 0), 0.125f);
                            EXPECT_EQ(drawn.plane("beauty_indirect.r").at(0, 0), 0.125f);
                            EXPECT_EQ(drawn.plane("beauty_ambient.r").at(0, 0), 0.25f);
                            for (int x = 0; x < 3; ++x) {
                              float sum = 0.0f;
                              for (const char* part : {"direct", "ambient", "indirect", "background"})
                                sum += drawn.plane(fmt::format("beauty_{}.r", part)).at(x, 0);
                              EXPECT_NEAR(sum, drawn.plane("beauty.r").at(x, 0), 1e-6) << x;
                              if (x > 0) {
                                EXPECT_EQ(drawn.plane("beauty_direct.r").at(x, 0), 0.0f) << x;
                              }
                            }
                          });
}

TEST(Output, LinesHaveTheirAlphaWhereNothingIsBehind) {
  const Settings settings = {{"transfer", "none"}, {"transparent", "on"}};
  for (const float line : {0.0f, 0.25f, 1.0f})
    test::on_every_target("output", under_a_line(line), settings, [&](const Image& image) {
      EXPECT_EQ(image.plane("color.a").at(0, 0), 1.0f);
      EXPECT_FLOAT_EQ(image.plane("color.a").at(1, 0), line + 0.5f * (1.0f - line));
      EXPECT_EQ(image.plane("color.a").at(2, 0), line);
      EXPECT_NEAR(image.plane("color.r").at(1, 0), mixed(0.25, 0.64, line / (line + 0.5 * (1.0 - line))), 1e-6);
      EXPECT_FLOAT_EQ(image.plane("color.r").at(2, 0), line > 0.0f ? 0.64f : 0.0f);
    });
}

TEST(Output, WhatIsNoLightIsBlack) {
  const float infinity = std::numeric_limits<float>::infinity();
  const GBuffer g = row_of({std::nanf(""), infinity, -infinity, -1.0f, -0.0f, 3e38f});
  for (const char* transfer : {"srgb", "none"})
    test::on_every_target("output", g, {{"transfer", transfer}, {"exposure", "20"}}, [](const Image& image) {
      for (int x = 0; x < image.width; ++x) {
        EXPECT_EQ(image.plane("color.r").at(x, 0), 0.0f) << x;
        EXPECT_EQ(image.plane("color.a").at(x, 0), 1.0f) << x;
      }
    });
}

TEST(Output, UnderAShoulderLightIsANumber) {
  const float infinity = std::numeric_limits<float>::infinity();
  const GBuffer g = row_of({std::nanf(""), infinity, 3e38f, 1e38f, 1e20f});
  for (const char* shoulder : {"0", "0.8", "0.999"})
    test::on_every_target("output", g, {{"shoulder", shoulder}}, [](const Image& image) {
      for (int x = 0; x < image.width; ++x) {
        const float v = image.plane("color.r").at(x, 0);
        EXPECT_GE(v, 0.0f) << x;
        EXPECT_LE(v, 1.0f) << x;
        if (x > 1) {
          EXPECT_GT(v, 0.99f) << x;
        }
      }
    });
}

TEST(Output, NeedsDepthAndLight) {
  const auto device = make_cpu_device();
  const Effect& effect = *find_effect("output");
  for (const char* missing : {"depth", "lit.g"}) {
    GBuffer g = row_of({1.0f});
    GBuffer without = test::empty_gbuffer(1, 1);
    for (std::size_t p = 0; p < g.layers[0].planes.size(); ++p)
      if (g.layers[0].names[p] != missing) without.layers[0].add(g.layers[0].names[p]) = g.layers[0].planes[p];
    auto frame = device->upload(without);
    const auto status = device->run(effect, test::parameters_of(effect, {}), *frame);
    ASSERT_FALSE(status) << missing;
    EXPECT_EQ(status.error().kind, ErrorKind::kUsage);
    EXPECT_NE(status.error().message.find(fmt::format("'{}'", missing)), std::string::npos) << status.error().message;
    EXPECT_NE(status.error().message.find("output"), std::string::npos) << status.error().message;
  }
}

TEST(Output, ASkyLiesBehindAsBrightAsTheRest) {
  const float infinity = std::numeric_limits<float>::infinity();
  GBuffer g = row_of({0.25f, 0.25f, 0.0f, 0.0f, 0.0f});
  const float depth[] = {3.0f, infinity, infinity, infinity, infinity}, sky[] = {0.5f, 0.5f, 0.1f, 8.0f, NAN};
  for (const char* name : {"sky.r", "sky.g", "sky.b", "cover"}) g.layers[0].add(name) = Plane(5, 1, 0.0f);
  for (int x = 0; x < 5; ++x) {
    g.layers[0].plane("depth").at(x, 0) = depth[x];
    for (const char* name : {"sky.r", "sky.g", "sky.b"}) g.layers[0].plane(name).at(x, 0) = sky[x];
  }
  g.layers[0].plane("cover").at(2, 0) = 0.75f;  // a black shadow
  const auto compressed = [](double v) { return v <= 0.8 ? v : 0.8 + 0.2 * (1.0 - 1.0 / ((v - 0.8) / 0.2 + 1.0)); };
  const Settings settings = {{"sky", "on"}, {"exposure", "1"}, {"shoulder", "0.8"}, {"transfer", "none"}};
  test::on_every_target("output", g, settings, [&](const Image& image) {
    const double expected[] = {0.5, compressed(1.0), 0.25 * 0.2, compressed(16.0), 0.0};
    for (int x = 0; x < 5; ++x) {
      EXPECT_NEAR(image.plane("color.g").at(x, 0), expected[x], 1e-6) << x;
      EXPECT_EQ(image.plane("color.a").at(x, 0), 1.0f) << x;
    }
  });
  // Without a shoulder light is not compressed.
  test::on_every_target("output", g, {{"sky", "on"}},
                        [&](const Image& image) { EXPECT_NEAR(image.plane("color.r").at(3, 0), srgb(8.0), 1e-5); });
  // Without the setting the planes are ignored.
  test::on_every_target("output", g, {{"background_g", "0.5"}},
                        [&](const Image& image) { EXPECT_EQ(image.plane("color.g").at(3, 0), 0.5f); });
}

}  // namespace
}  // namespace umbrage
