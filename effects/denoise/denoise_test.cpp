// Tests `denoise`: which noise it removes, what it preserves, and at which edges it stops.
#include "effects/denoise/denoise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "run_effect.h"
#include "support.h"
#include "tilted_plane.h"

namespace umbrage {
namespace {

using test::Settings;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
const char* const kFilteredPlanes[] = {"ao", "indirect.r", "indirect.g", "indirect.b"};

double uniform_noise(int x, int y, unsigned seed) {
  return double(test::hash(test::hash(unsigned(x) + 7919u * seed) + unsigned(y)) >> 8) * 0x1p-24;
}

/// Returns a G-buffer of a plane that faces the camera at depth 5, with constant `ao` and `indirect`.
GBuffer flat(int width, int height, float value = 0.0f) {
  GBuffer g = test::empty_gbuffer(width, height);
  for (const char* name : {"normal.x", "normal.y"}) g.layers[0].add(name) = Plane(width, height, 0.0f);
  g.layers[0].add("normal.z") = Plane(width, height, 1.0f);
  g.layers[0].add("depth") = Plane(width, height, 5.0f);
  for (const char* name : kFilteredPlanes) g.layers[0].add(name) = Plane(width, height, value);
  return g;
}

/// Replaces the surface by a tilted plane, whose normal leans by `tilt_deg` from the view axis: up, and half as much to
/// the right.
void tilt(GBuffer& g, double tilt_deg, bool orthographic) {
  Image& image = g.layers[0];
  if (orthographic)
    g.info.camera = orthographic_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 3.0f, float(image.width) / image.height);
  const Camera& camera = g.info.camera;
  const double a = tilt_deg * 3.14159265358979 / 180.0;
  const double nx = std::sin(a) * 0.4472136, ny = std::sin(a) * 0.8944272, nz = std::cos(a);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const double u = camera.left + (camera.right - camera.left) * (x + 0.5) / image.width;
      const double v = camera.top - (camera.top - camera.bottom) * (y + 0.5) / image.height;
      // The plane contains the point (0, 0, -5), or (0, 0, -40) if orthographic.
      const double depth = orthographic ? 40.0 + (nx * u + ny * v) / nz : 5.0 * nz / (nz - nx * u - ny * v);
      image.plane("depth").at(x, y) = depth > 0.0 ? float(depth) : kInfinity;
      image.plane("normal.x").at(x, y) = float(nx);
      image.plane("normal.y").at(x, y) = float(ny);
      image.plane("normal.z").at(x, y) = float(nz);
    }
}

void fill_with_noise(GBuffer& g) {
  for (unsigned k = 0; k < 4; ++k) {
    Plane& plane = g.layers[0].plane(kFilteredPlanes[k]);
    for (int y = 0; y < plane.height; ++y)
      for (int x = 0; x < plane.width; ++x) plane.at(x, y) = float(uniform_noise(x, y, k));
  }
}

Settings filter_both(int rounds) { return {{"rounds", std::to_string(rounds)}, {"occlusion", "1"}, {"indirect", "1"}}; }

double mean_of(const Plane& plane) {
  double sum = 0.0;
  for (int y = 0; y < plane.height; ++y)
    for (int x = 0; x < plane.width; ++x) sum += plane.at(x, y);
  return sum / (double(plane.width) * plane.height);
}

TEST(Denoise, ImpulseBecomesTheWeights) {
  const double weights[5] = {0.125, 0.25, 0.25, 0.25, 0.125};
  for (const bool light : {false, true}) {
    GBuffer g = flat(21, 17);
    for (const char* name : kFilteredPlanes) g.layers[0].plane(name).at(10, 8) = 1.0f;
    test::on_every_target("denoise", g, light ? filter_both(1) : Settings{}, [&](const Image& image) {
      for (const char* name : kFilteredPlanes) {
        if (!light && name != kFilteredPlanes[0]) continue;
        for (int y = 0; y < 17; ++y)
          for (int x = 0; x < 21; ++x) {
            const bool in = std::abs(x - 10) <= 2 && std::abs(y - 8) <= 2;
            EXPECT_NEAR(image.plane(name).at(x, y), in ? weights[x - 8] * weights[y - 6] : 0.0, 1e-7) << x << ',' << y;
          }
      }
    });
  }
}

TEST(Denoise, OneRoundRemovesTheNoiseOfATile) {
  GBuffer g = flat(40, 36);
  double mean[4] = {0.0, 0.0, 0.0, 0.0};
  for (unsigned k = 0; k < 4; ++k)
    for (int y = 0; y < 36; ++y)
      for (int x = 0; x < 40; ++x) {
        const double v = uniform_noise(x % 4, y % 4, k);
        g.layers[0].plane(kFilteredPlanes[k]).at(x, y) = float(v);
        mean[k] += v / (40.0 * 36.0);
      }
  test::on_every_target("denoise", g, filter_both(1), [&](const Image& image) {
    for (unsigned k = 0; k < 4; ++k)
      for (int y = 2; y < 34; ++y)
        for (int x = 2; x < 38; ++x)
          EXPECT_NEAR(image.plane(kFilteredPlanes[k]).at(x, y), mean[k], 1e-6) << x << ',' << y;
  });
}

TEST(Denoise, WhiteNoiseFallsByTheWeightsAtAnyTilt) {
  // The sum of the squares of [1 2 2 2 1]/8, per axis.
  constexpr double kPerAxis = 14.0 / 64.0, kExpected = kPerAxis * kPerAxis;
  for (const bool orthographic : {false, true})
    for (const double tilt_deg : {0.0, 45.0, 70.0, 80.0}) {
      GBuffer g = flat(128, 128);
      tilt(g, tilt_deg, orthographic);
      fill_with_noise(g);
      test::on_every_target("denoise", g, filter_both(1), [&](const Image& image) {
        for (const char* name : kFilteredPlanes) {
          double squares = 0.0;
          long count = 0;
          for (int y = 2; y < 126; ++y)
            for (int x = 2; x < 126; ++x) {
              bool all_on_plane = true;  // whether the whole window shows the plane
              for (const int i : {-2, 2})
                for (const int j : {-2, 2}) all_on_plane &= std::isfinite(g.layers[0].plane("depth").at(x + i, y + j));
              if (!all_on_plane) continue;
              const double e = image.plane(name).at(x, y) - 0.5;
              squares += e * e;
              ++count;
            }
          ASSERT_GT(count, 4000);
          // Uniform noise in [0, 1] has a variance of 1/12.
          EXPECT_NEAR(12.0 * squares / double(count), kExpected, 0.1 * kExpected)
              << name << ' ' << tilt_deg << (orthographic ? " orthographic" : "");
        }
      });
    }
}

TEST(Denoise, GrazingPlanesAreFilteredButNotAcrossDiscontinuities) {
  GBuffer facing = flat(64, 64);
  fill_with_noise(facing);
  const Image expected = test::run_effect(*find_effect("denoise"), facing, filter_both(2), {});
  test::at_grazing_angles({.error_deg = 2.0}, [&](const test::TiltedPlane& plane) {
    GBuffer g = test::seen(plane);
    for (const char* name : kFilteredPlanes) g.layers[0].add(name) = facing.layers[0].plane(name);
    test::on_every_target("denoise", g, filter_both(2), [&](const Image& image) {
      for (const char* name : kFilteredPlanes)
        EXPECT_LE(test::difference(image.plane(name), expected.plane(name), 0.0).max, 1e-6) << name;
    });
  });
  test::at_grazing_angles({.step_px = 60.0, .depth_ratio = 0.1}, [](const test::TiltedPlane& plane) {
    GBuffer g = test::seen(plane);
    for (const char* name : kFilteredPlanes) {
      Plane& plane_out = g.layers[0].add(name);
      for (int y = 0; y < plane.height; ++y)
        for (int x = 0; x < plane.width; ++x) plane_out.at(x, y) = 2 * x < plane.width ? 0.25f : 1.0f;
    }
    test::on_every_target("denoise", g, filter_both(2), [&](const Image& image) {
      for (const char* name : kFilteredPlanes)
        EXPECT_EQ(test::difference(image.plane(name), g.layers[0].plane(name), 0.0).max, 0.0) << name;
    });
  });
}

TEST(Denoise, MoreRoundsReachFarther) {
  GBuffer g = flat(160, 160);
  fill_with_noise(g);
  // Per axis, sums of the squares of [1 2 2 2 1]/8 and of its convolutions with copies of 2 times the spacing, and of 2
  // and 4 times.
  const double kPerAxis[] = {0.21875, 0.09863281, 0.04824829};
  for (int rounds = 1; rounds <= 3; ++rounds) {
    const Image image = test::run_effect(*find_effect("denoise"), g, filter_both(rounds), {});
    double squares = 0.0;
    for (int y = 40; y < 120; ++y)
      for (int x = 40; x < 120; ++x) squares += std::pow(image.plane("ao").at(x, y) - 0.5, 2.0);
    const double expected = kPerAxis[rounds - 1] * kPerAxis[rounds - 1] / 12.0;
    EXPECT_NEAR(squares / 6400.0, expected, 0.25 * expected) << rounds;
  }
}

TEST(Denoise, ConstantsAndMeansArePreserved) {
  for (const int rounds : {1, 3}) {
    for (const bool hostile : {false, true}) {
      GBuffer g = hostile ? test::hostile_gbuffer(191, 63, 3) : test::bumpy_gbuffer(191, 63, 3);
      for (const char* name : kFilteredPlanes) g.layers[0].add(name) = Plane(191, 63, 0.3f);
      test::on_every_target("denoise", g, filter_both(rounds), [&](const Image& image) {
        for (const char* name : kFilteredPlanes)
          EXPECT_EQ(test::difference(image.plane(name), g.layers[0].plane(name), 0.0).max, 0.0);
      });
    }
    // The surfaces are bumpy, with many holes and depth discontinuities; values depend on depth.
    constexpr float kContrast = 0.16f;
    GBuffer g = test::bumpy_gbuffer(191, 347, 8);
    for (const char* name : kFilteredPlanes) g.layers[0].add(name) = Plane(191, 347, 0.0f);
    fill_with_noise(g);
    for (const char* name : kFilteredPlanes)
      for (int y = 0; y < 347; ++y)
        for (int x = 0; x < 191; ++x) {
          Plane& plane = g.layers[0].plane(name);
          // Nearer surfaces are darker, so that asymmetric leaking across an edge would change the mean.
          const float depth = g.layers[0].plane("depth").at(x, y);
          const float v = 0.2f * plane.at(x, y) + (std::isfinite(depth) ? 0.08f * depth : 1.0f);
          // The contrast is low, so that neighbours do not limit the values of isolated pixels.
          plane.at(x, y) = 0.8f + kContrast * v;
        }
    test::on_every_target(
        "denoise", g, {{"rounds", std::to_string(rounds)}, {"indirect", "1"}, {"angle", "180"}},
        [&](const Image& image) {
          for (const char* name : kFilteredPlanes) {
            EXPECT_NEAR(mean_of(image.plane(name)), mean_of(g.layers[0].plane(name)), 1e-4 * kContrast);
            EXPECT_GT(test::difference(image.plane(name), g.layers[0].plane(name), 0.0).mean, 0.01 * kContrast);
          }
        });
  }
}

TEST(Denoise, PixelsGiveEachOtherEqualWeight) {
  // Short rows, or columns, with background between them. Normals and depths are random, so that one pixel may be far
  // off the other's plane, but not the other way round. What a pixel gains another must lose, in each row alone.
  constexpr int kLength = 7, kLines = 200, kSpacing = 3;  // kSpacing: the filter does not reach the next line
  for (const bool orthographic : {false, true})
    for (const bool along_x : {true, false}) {
      GBuffer g = along_x ? flat(kLength, kLines * kSpacing, 0.5f) : flat(kLines * kSpacing, kLength, 0.5f);
      tilt(g, 0.0, orthographic);
      Image& image = g.layers[0];
      const double size = orthographic ? 1.0 : 5.0;  // of a pixel, relative to the width of its ray
      const double pixel = size * double(g.info.camera.right - g.info.camera.left) / image.width;
      const auto at = [&](const Plane& plane, int line, int i) {
        return along_x ? plane.at(i, line * kSpacing) : plane.at(line * kSpacing, i);
      };
      for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
          if ((along_x ? y : x) % kSpacing != 0) {
            image.plane("depth").at(x, y) = kInfinity;
            continue;
          }
          const double lean = 0.7 * uniform_noise(x, y, 5), azimuth = 6.2832 * uniform_noise(x, y, 6);
          image.plane("normal.x").at(x, y) = float(std::sin(lean) * std::cos(azimuth));
          image.plane("normal.y").at(x, y) = float(std::sin(lean) * std::sin(azimuth));
          image.plane("normal.z").at(x, y) = float(std::cos(lean));
          image.plane("depth").at(x, y) += float(3.0 * pixel * (uniform_noise(x, y, 7) - 0.5));
          for (unsigned k = 0; k < 4; ++k) image.plane(kFilteredPlanes[k]).at(x, y) = float(uniform_noise(x, y, k));
        }
      test::on_every_target(
          "denoise", g, {{"rounds", "1"}, {"indirect", "1"}, {"angle", "180"}}, [&](const Image& out) {
            for (const char* name : kFilteredPlanes) {
              double changes = 0.0;
              for (int line = 0; line < kLines; ++line) {
                double before = 0.0, after = 0.0;
                for (int i = 0; i < kLength; ++i) {
                  before += at(image.plane(name), line, i);
                  after += at(out.plane(name), line, i);
                  changes += std::abs(at(out.plane(name), line, i) - at(image.plane(name), line, i));
                }
                EXPECT_NEAR(after, before, 2e-6) << name << ", line " << line << (along_x ? " of rows" : " of columns");
              }
              EXPECT_GT(changes, 0.05 * kLines * kLength) << "nothing is filtered";
            }
          });
    }
}

TEST(Denoise, StopsAtDiscontinuitiesCreasesAndBackground) {
  enum Edge { kStep, kCrease, kBackground };
  for (const Edge edge : {kStep, kCrease, kBackground})
    for (const bool across : {false, true}) {
      SCOPED_TRACE(fmt::format("edge {}, across {}", int(edge), across));
      GBuffer g = flat(48, 48);
      Image& image = g.layers[0];
      const double pixel = double(g.info.camera.right - g.info.camera.left) / 48.0 * 5.0;
      for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 48; ++x) {
          const int along = across ? x : y;
          const bool second = along >= 21;
          for (unsigned k = 0; k < 4; ++k)
            image.plane(kFilteredPlanes[k]).at(x, y) = (second ? 0.7f : 0.2f) + 0.1f * float(uniform_noise(x, y, k));
          if (!second) continue;
          if (edge == kStep) image.plane("depth").at(x, y) = float(5.0 + 3.0 * pixel);
          if (edge == kBackground) image.plane("depth").at(x, y) = kInfinity;
          if (edge == kCrease) {  // normals differ by 90 degrees: towards the right or the bottom of the picture
            image.plane("normal.z").at(x, y) = 0.0f;
            image.plane(across ? "normal.x" : "normal.y").at(x, y) = across ? 1.0f : -1.0f;
          }
        }
      test::on_every_target("denoise", g, filter_both(3), [&](const Image& out) {
        for (const char* name : kFilteredPlanes)
          for (int y = 0; y < 48; ++y)
            for (int x = 0; x < 48; ++x) {
              const float v = out.plane(name).at(x, y), was = image.plane(name).at(x, y);
              const bool second = (across ? x : y) >= 21;
              if (second && edge == kBackground)
                EXPECT_EQ(v, was);
              else
                EXPECT_TRUE(second ? v >= 0.7f && v <= 0.8f : v >= 0.2f && v <= 0.3f) << v << " at " << x << ',' << y;
            }
      });
    }
}

TEST(Denoise, OnePixelWideFeaturesAreLimited) {
  // A wire in front of a wall, with fireflies in `indirect` and with `ao` 0. Across the wire, no neighbours are on its
  // surface.
  for (const bool upright : {true, false})
    for (const int rounds : {1, 3}) {
      GBuffer g = flat(48, 48, 0.4f);
      Image& image = g.layers[0];
      for (int k = 0; k < 48; ++k) {
        const int x = upright ? 20 : k, y = upright ? k : 20;
        image.plane("depth").at(x, y) = 3.0f;
        image.plane("ao").at(x, y) = 0.0f;
        for (const char* name : {"indirect.r", "indirect.g", "indirect.b"})
          image.plane(name).at(x, y) = k % 4 == 0 ? 40.0f : 0.2f;
      }
      test::on_every_target("denoise", g, filter_both(rounds), [&](const Image& out) {
        for (int y = 0; y < 48; ++y)
          for (int x = 0; x < 48; ++x) {
            const float light = out.plane("indirect.g").at(x, y), ao = out.plane("ao").at(x, y);
            const int along = upright ? y : x;
            if ((upright ? x : y) != 20) {
              EXPECT_EQ(light, 0.4f);
              EXPECT_EQ(ao, 0.4f);
            } else if (along < 12 || along >= 36) {
              continue;  // near the ends, fewer pixels of the wire are averaged
            } else if (rounds == 1) {
              EXPECT_GT(light, 5.0f);
              EXPECT_EQ(ao, 0.0f);
            } else {
              EXPECT_LE(light, 0.4f * 1.35f + 1e-5f);
              EXPECT_GT(light, 0.4f * 1.3f);
              EXPECT_NEAR(ao, 0.4f * 0.75f, 1e-5f);
            }
          }
      });
    }
  // In front of the background, an isolated column keeps its values.
  GBuffer g = flat(48, 48, 0.4f);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 48; ++x)
      if (x != 20) g.layers[0].plane("depth").at(x, y) = kInfinity;
  for (int y = 0; y < 48; ++y) g.layers[0].plane("indirect.g").at(20, y) = 7.0f;
  const Image out = test::run_effect(*find_effect("denoise"), g, filter_both(3), {});
  for (int y = 0; y < 48; ++y) EXPECT_EQ(out.plane("indirect.g").at(20, y), 7.0f);
}

TEST(Denoise, StrengthsAffectTheirOwnPlanesOnly) {
  GBuffer g = flat(32, 32);
  fill_with_noise(g);
  const auto changed = [&](const Settings& settings, const char* name) {
    const Image image = test::run_effect(*find_effect("denoise"), g, settings, {});
    const Plane* plane = image.find(name);
    return plane ? test::difference(*plane, g.layers[0].plane(name), 0.0).mean : 0.0;
  };
  const double ao = changed(filter_both(1), "ao"), light = changed(filter_both(1), "indirect.g");
  EXPECT_GT(ao, 0.1);
  EXPECT_GT(light, 0.1);
  EXPECT_EQ(changed({}, "ao"), ao);
  EXPECT_EQ(changed({}, "indirect.g"), 0.0);
  EXPECT_EQ(changed({{"occlusion", "0"}, {"indirect", "1"}}, "ao"), 0.0);
  EXPECT_EQ(changed({{"occlusion", "0"}, {"indirect", "1"}}, "indirect.g"), light);
  EXPECT_EQ(changed({{"rounds", "0"}, {"indirect", "1"}}, "ao"), 0.0);
  EXPECT_GT(changed({{"occlusion", "0.5"}}, "ao"), 0.4 * ao);
  EXPECT_LT(changed({{"occlusion", "0.5"}}, "ao"), 0.9 * ao);
}

TEST(Denoise, LightMayHaveOtherRoundsThanOcclusion) {
  GBuffer g = flat(64, 48);
  fill_with_noise(g);
  const auto run = [&](const char* rounds, const char* light_rounds) {
    return test::run_effect(*find_effect("denoise"), g,
                            {{"rounds", rounds}, {"indirect", "1"}, {"light_rounds", light_rounds}}, {});
  };
  const Image one = run("1", "0"), three = run("3", "0"), more_light = run("1", "3"), less_light = run("3", "1");
  const auto same = [](const Image& a, const Image& b, const char* name) {
    return test::difference(a.plane(name), b.plane(name), 0.0).max == 0.0;
  };
  EXPECT_FALSE(same(one, three, "ao"));
  EXPECT_FALSE(same(one, three, "indirect.g"));
  EXPECT_TRUE(same(more_light, one, "ao"));
  EXPECT_TRUE(same(more_light, three, "indirect.g"));
  EXPECT_TRUE(same(less_light, three, "ao"));
  EXPECT_TRUE(same(less_light, one, "indirect.g"));
  EXPECT_TRUE(same(run("0", "3"), three, "indirect.g"));
}

TEST(Denoise, HigherPicturesGetMoreRounds) {
  struct Case {
    int rounds, light_rounds, for_height, expected_rounds, expected_light_rounds;  // for a picture of 64 rows
  };
  for (const Case& c :
       {Case{1, 0, 0, 1, 1}, Case{1, 0, 64, 1, 1}, Case{1, 0, 32, 2, 2}, Case{1, 2, 32, 2, 3}, Case{1, 0, 46, 1, 1},
        Case{1, 0, 45, 2, 2}, Case{2, 0, 8, 5, 5}, Case{3, 0, 1, 6, 6}, Case{2, 0, 256, 2, 2}, Case{0, 0, 16, 0, 0}})
    for (const bool light : {false, true}) {
      GBuffer g = flat(80, 64);
      fill_with_noise(g);
      Settings explicit_rounds = {{"rounds", std::to_string(c.expected_rounds)}, {"indirect", light ? "1" : "0"}};
      Settings automatic = {{"rounds", std::to_string(c.rounds)}, {"indirect", light ? "1" : "0"}};
      explicit_rounds.push_back({"light_rounds", std::to_string(c.expected_light_rounds)});
      automatic.push_back({"light_rounds", std::to_string(c.light_rounds)});
      automatic.push_back({"for_height", std::to_string(c.for_height)});
      const Image expected = test::run_effect(*find_effect("denoise"), g, explicit_rounds, {});
      test::on_every_target("denoise", g, automatic, [&](const Image& image) {
        for (const char* name : kFilteredPlanes) {
          if (!light && name != kFilteredPlanes[0]) continue;
          for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 80; ++x)
              ASSERT_NEAR(image.plane(name).at(x, y), expected.plane(name).at(x, y), 1e-6)
                  << name << ' ' << x << ',' << y << ", " << c.rounds << " rounds for " << c.for_height;
        }
      });
    }
  // With a guard band or at reduced resolution, the height of the picture differs from that of its planes.
  for (const bool reduced : {false, true}) {
    GBuffer g = flat(80, 64);
    fill_with_noise(g);
    const Settings explicit_rounds = {{"rounds", "2"}, {"indirect", "1"}};
    // The picture has 32 rows without the guard band, or 66 at full resolution: two rounds. The 64 rows of the planes
    // alone would give three.
    g.info.guard = reduced ? 0 : 16;
    if (reduced) g.info.reduced = 2, g.info.whole_height = 66;
    const Image expected = test::run_effect(*find_effect("denoise"), g, explicit_rounds, {});
    const Settings automatic = {{"rounds", "1"}, {"indirect", "1"}, {"for_height", "16"}};
    const Image image = test::run_effect(*find_effect("denoise"), g, automatic, {});
    for (const char* name : kFilteredPlanes)
      EXPECT_EQ(test::difference(image.plane(name), expected.plane(name), 0.0).max, 0.0) << name << ' ' << reduced;
  }
}

TEST(Denoise, PixelWithNonFiniteNormalIsIsolated) {
  GBuffer g = flat(30, 12, 0.5f);
  g.layers[0].plane("normal.x").at(9, 5) = std::nanf("");
  g.layers[0].plane("ao").at(9, 5) = 0.9f;
  test::on_every_target("denoise", g, filter_both(1), [&](const Image& image) {
    EXPECT_FLOAT_EQ(image.plane("ao").at(9, 5), 0.9f);
    for (const int x : {7, 8, 10, 11}) EXPECT_FLOAT_EQ(image.plane("ao").at(x, 5), 0.5f) << x;
  });
}

TEST(Denoise, NonFiniteInputsAreUnoccludedAndDark) {
  GBuffer g = flat(30, 12, 0.5f);
  const float invalid_values[] = {std::nanf(""), kInfinity, -kInfinity, 3e38f};
  for (const char* name : kFilteredPlanes)
    for (int k = 0; k < 4; ++k) g.layers[0].plane(name).at(6 * k + 4, 5) = invalid_values[k];
  test::on_every_target("denoise", g, filter_both(1), [&](const Image& image) {
    for (int k = 0; k < 4; ++k) {
      EXPECT_FLOAT_EQ(image.plane("ao").at(6 * k + 4, 5), 0.53125f);
      EXPECT_FLOAT_EQ(image.plane("indirect.b").at(6 * k + 4, 5), 0.46875f);
    }
  });
}

}  // namespace
}  // namespace umbrage
