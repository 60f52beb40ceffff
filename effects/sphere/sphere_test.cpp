// Compares `sphere` with a literal port of the paper's listing in double, and with pictures of known occlusion.
#include "effects/sphere/sphere.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>

#include "run_effect.h"
#include "support.h"

namespace umbrage {
namespace {

using test::joined;
using test::Settings;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// With these settings, 1 - ao is the fraction of samples that are occluded.
const Settings kPlainFraction = {{"reflect", "none"}, {"threshold", "0"}, {"map", "linear"}};

// The corrected settings, as in Effect::variants but with the default strength.
const Settings kCorrected = {{"shape", "hemisphere"}, {"sample_z", "on"}, {"depth", "linear"}, {"range", "smooth"},
                             {"range_factor", "1"},   {"map", "linear"},  {"threshold", "0"},  {"border", "skip"}};

Plane ao(const GBuffer& g, const Settings& settings) {
  return test::run_effect(*find_effect("sphere"), g, settings, {}).planes[0];
}

SphereConstants constants(const GBuffer& g, const Settings& settings) {
  return test::constants_of<SphereConstants>("sphere", g.info, settings);
}

std::vector<glm::dvec3> points(const GBuffer& g, const Settings& settings) {
  const SphereConstants c = constants(g, settings);
  std::vector<glm::dvec3> all;
  for (int i = 0; i < c.samples; ++i) all.emplace_back(c.points[3 * i], c.points[3 * i + 1], c.points[3 * i + 2]);
  return all;
}

struct Surface {
  double depth;
  glm::dvec3 normal;
};

/// Returns a picture of the surface that the function gives for each position: u to the right and v upwards, -1 to 1.
GBuffer picture(int width, int height, const std::function<Surface(double u, double v)>& surface) {
  GBuffer g = test::empty_gbuffer(width, height);
  for (const char* name : {"depth", "normal.x", "normal.y", "normal.z"}) g.layers[0].add(name);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Surface s = surface(2.0 * (x + 0.5) / width - 1.0, 1.0 - 2.0 * (y + 0.5) / height);
      g.layers[0].planes[0].at(x, y) = float(s.depth);
      for (int k = 0; k < 3; ++k) g.layers[0].planes[1 + k].at(x, y) = float(s.normal[k]);
    }
  return g;
}

/// Returns waves with a raised block and a hole, and normals that roughly match.
GBuffer waves(int width, int height) {
  return picture(width, height, [](double u, double v) -> Surface {
    if (u > 0.1 && u < 0.4 && v > 0.0 && v < 0.5) return {4.0 + 0.1 * u, {0, 0, 1}};
    if ((u + 0.5) * (u + 0.5) + v * v < 0.04) return {kInfinity, {0, 0, 0}};
    return {7.0 + std::sin(7.0 * u) * std::cos(5.0 * v) + 0.2 * v,
            glm::normalize(glm::dvec3(std::cos(7.0 * u), 0.3 * std::sin(5.0 * v), 1.3))};
  });
}

/// Returns a plane through (0, 0, -5), tilted by tilt_deg from facing the camera, with background beyond its horizon.
GBuffer plane(int width, int height, double tilt_deg, double azimuth_deg, bool orthographic) {
  const double tilt = tilt_deg * 3.14159265358979 / 180.0, azimuth = azimuth_deg * 3.14159265358979 / 180.0;
  const glm::dvec3 n(std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth), std::cos(tilt));
  const double half_height = orthographic ? 1.5 : std::tan(20.0 * 3.14159265358979 / 180.0);
  const double half_width = half_height * width / height;
  GBuffer g = picture(width, height, [&](double u, double v) -> Surface {
    const double x = u * half_width, y = v * half_height;
    const double depth = orthographic ? 5.0 + (n.x * x + n.y * y) / n.z : 5.0 * n.z / (n.z - n.x * x - n.y * y);
    return depth > 0.0 && depth < 1e4 ? Surface{depth, n} : Surface{kInfinity, {0, 0, 0}};
  });
  if (orthographic)
    g.info.camera = orthographic_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 3.0f, float(width) / float(height));
  return g;
}

// ---- the listing, in double
// ------------------------------------------------------------------------------------------

unsigned bits(unsigned v) {
  v = (v ^ (v >> 16)) * 0x7feb352du;
  v = (v ^ (v >> 15)) * 0x846ca68bu;
  return v ^ (v >> 16);
}

/// Returns vector (x, y) of the tile of random vectors, scaled to unit length.
glm::dvec3 random_vector(int x, int y) {
  const unsigned seed = bits(unsigned(x) ^ bits(unsigned(y) + 0x9e3779b9u));
  const auto real = [](unsigned v) { return double(v >> 8) * 0x1p-23 - 1.0; };
  return glm::normalize(glm::dvec3(real(seed) + 0x1p-24, real(bits(seed + 1)), real(bits(seed + 2))));
}

glm::dvec3 reflect(glm::dvec3 v, glm::dvec3 n) { return v - 2.0 * glm::dot(n, v) * n; }

struct Listing {
  const GBuffer& g;
  std::vector<glm::dvec3> sample_points;
  bool random = true, limited = false;
  double near_plane = 1.0, far_plane = 10.0;

  double s_depth(double s, double t) const {  // window depth, nearest, clamped; t upwards
    const Plane& depth = g.layers[0].plane("depth");
    const int x = std::clamp(int(std::floor(s * depth.width)), 0, depth.width - 1);
    const int y = std::clamp(int(std::floor((1.0 - t) * depth.height)), 0, depth.height - 1);
    const double z = depth.at(x, y);
    return std::isfinite(z) ? far_plane * (z - near_plane) / (z * (far_plane - near_plane)) : 1.0;
  }
  glm::dvec3 vector_at(int x, int y) const {
    if (random) return random_vector(x % 4, y % 4);
    const Image& image = g.layers[0];
    return glm::normalize(glm::dvec3(image.plane("normal.x").at(x, y), image.plane("normal.y").at(x, y),
                                     image.plane("normal.z").at(x, y)));
  }
  /// Returns the result of the listing's main() at a pixel of a square picture.
  double color(int x, int y) const {
    const double s = (x + 0.5) / g.info.width, t = 1.0 - (y + 0.5) / g.info.height;
    const double radius = 16.0 / 512;
    const double f_depth = s_depth(s, t);
    const glm::dvec3 f_norm = vector_at(x, y);
    double occlusion = 0.0;
    for (const glm::dvec3& point : sample_points) {
      const glm::dvec3 offset = radius * reflect(point, f_norm);
      const double depth_sample = f_depth - s_depth(s + offset.x, t + offset.y);
      if (depth_sample > 0 && (!limited || depth_sample < radius * 0.05)) occlusion += 1.0;
    }
    occlusion = occlusion < 5.0 ? 0.0 : occlusion * occlusion / 64.0;
    return 1.0 - occlusion;
  }
};

void expect_listing(const Settings& settings, bool random, bool limited) {
  const GBuffer g = waves(128, 128);
  const Settings all = joined({{"near", "1"}, {"far", "10"}}, settings);
  const Listing listing{g, points(g, all), random, limited};
  test::on_every_target("sphere", g, all, [&](const Image& image) {
    long off = 0, compared = 0, dark = 0;
    for (int y = 0; y < 128; ++y)
      for (int x = 0; x < 128; ++x) {
        if (!std::isfinite(g.layers[0].plane("depth").at(x, y))) continue;
        const double expected = listing.color(x, y);
        off += std::fabs(image.plane("ao").at(x, y) - expected) > 1e-5;
        dark += expected < 1.0;
        ++compared;
      }
    // Samples on a pixel's border, or at the pixel's own depth, may round either way.
    EXPECT_LE(off, compared / 500);
    EXPECT_GT(dark, 300);
  });
}

TEST(Sphere, InitialSettingsAreTheListing) { expect_listing({}, true, false); }
TEST(Sphere, CommentedConditionIsTheRangeLimit) { expect_listing({{"range", "hard"}}, true, true); }
TEST(Sphere, ReflectionByTheNormalIsTheListingsOtherReading) { expect_listing({{"reflect", "normal"}}, false, false); }

// ---- the sample points
// ------------------------------------------------------------------------------------------

TEST(Sphere, PointsAreSpreadEvenlyInTheUnitSphere) {
  const GBuffer g = test::empty_gbuffer(8, 8);
  for (const char* shape : {"sphere", "hemisphere"})
    for (const int n : {1, 2, 5, 8, 16, 33, 64, 256}) {
      const auto all = points(g, {{"samples", std::to_string(n)}, {"shape", shape}});
      ASSERT_EQ(all.size(), std::size_t(n));
      glm::dvec3 sum(0.0);
      double cubes = 0.0, min_apart = 2.0;
      for (int i = 0; i < n; ++i) {
        EXPECT_LE(glm::length(all[i]), 1.0 + 1e-6);
        sum += all[i];
        cubes += std::pow(glm::length(all[i]), 3.0);
        for (int k = 0; k < i; ++k) min_apart = std::min(min_apart, glm::length(all[i] - all[k]));
      }
      if (n < 8) continue;
      // Sums over points of low discrepancy deviate by the logarithm of their number, those of random points by its
      // root.
      const double deviation = std::log2(double(n)) / n;
      const bool is_sphere = shape == std::string("sphere");
      if (is_sphere) {
        EXPECT_LE(glm::length(sum), n % 2 + 1e-5) << n << " of pairs that cancel each other";
      } else {
        EXPECT_LT(glm::length(sum) / n, 0.3 * deviation) << n;
      }
      EXPECT_NEAR(cubes / n, 0.5, std::min(0.12, 0.6 * deviation)) << n << shape;  // uniform in volume
      EXPECT_GT(min_apart, (is_sphere ? 0.35 : 0.6) / std::cbrt(double(n))) << n << shape;
    }
}

TEST(Sphere, PointsOfTheSphereComeInOppositePairs) {
  const auto all = points(test::empty_gbuffer(8, 8), {});
  for (int i = 0; i < 4; ++i) EXPECT_EQ(glm::length(all[i] + all[4 + i]), 0.0) << i;
}

// ---- planes
// ------------------------------------------------------------------------------------------

/// Returns the fraction of the surface's pixels that are not `expected`, except within `margin` of the picture's
/// border, where samples are clamped.
double fraction_off(const GBuffer& g, const Plane& ao, int margin, double expected) {
  const Plane& depth = g.layers[0].plane("depth");
  long off = 0, compared = 0;
  for (int y = margin; y < depth.height - margin; ++y)
    for (int x = margin; x < depth.width - margin; ++x) {
      if (!std::isfinite(depth.at(x, y))) continue;
      off += std::fabs(ao.at(x, y) - expected) > 1e-6;
      ++compared;
    }
  EXPECT_GT(compared, 100);
  return double(off) / compared;
}

TEST(Sphere, HalfOfTheSamplesAreBehindAPlaneAndTheThresholdIgnoresThem) {
  // Of two opposite samples, one is nearer, so 4 of 8 count, in window depth too and at any tilt of the plane. A pair
  // along a line of equal depth does not count.
  for (const bool orthographic : {false, true})
    for (const double tilt : {20.0, 45.0, 65.0}) {
      const GBuffer g = plane(160, 120, tilt, 33.0, orthographic);
      const Settings radius = {{"radius", "9"}, {"far", "40"}, {"near", "0.5"}};
      EXPECT_LT(fraction_off(g, ao(g, radius), 10, 1.0), 1e-4) << tilt;
      const Plane half = ao(g, joined(radius, {{"threshold", "0"}, {"map", "linear"}}));
      EXPECT_LT(fraction_off(g, half, 10, 0.5), 0.06) << tilt;
      const Plane square = ao(g, joined(radius, {{"threshold", "0.5"}}));
      EXPECT_LT(fraction_off(g, square, 10, 0.75), 0.06) << tilt;
    }
}

TEST(Sphere, OddNumbersDarkenAPlaneByTheComputedCounts) {
  const GBuffer g = plane(96, 80, 50.0, 20.0, false);
  const Settings settings = joined(kPlainFraction, {{"samples", "7"}, {"radius", "9"}, {"near", "0.5"}, {"far", "40"}});
  const Plane ours = ao(g, settings);
  const auto all = points(g, settings);
  const Plane& depth = g.layers[0].plane("depth");
  long off = 0;
  for (int y = 0; y < 80; ++y)
    for (int x = 0; x < 96; ++x) {
      int hidden = 0;
      for (const glm::dvec3& v : all) {
        const int column = std::clamp(int(std::floor(x + 0.5 + 9.0 * v.x)), 0, 95);
        const int row = std::clamp(int(std::floor(y + 0.5 - 9.0 * v.y)), 0, 79);
        hidden += depth.at(column, row) < depth.at(x, y);
      }
      off += std::fabs(ours.at(x, y) - (1.0 - hidden / 7.0)) > 1e-6;
    }
  EXPECT_LE(off, 8);
}

TEST(Sphere, PlaneThatFacesTheCameraIsUnoccludedDespiteRounding) {
  GBuffer g = plane(64, 64, 0.0, 0.0, false);
  Plane& depth = g.layers[0].plane("depth");
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) depth.at(x, y) *= 1.0f + 1e-7f * float(test::hash(64u * y + x) % 3);
  for (const Settings& settings : {Settings{}, Settings{{"threshold", "0"}}, Settings{{"depth", "linear"}}})
    EXPECT_EQ(fraction_off(g, ao(g, joined(settings, {{"threshold", "0"}})), 0, 1.0), 0.0);
}

TEST(Sphere, HemisphereLeavesPlanesUnoccludedAtEveryTilt) {
  for (const bool orthographic : {false, true})
    for (const double tilt : {0.0, 10.0, 30.0, 50.0, 65.0, 75.0, 80.0})
      for (const double azimuth : {0.0, 57.0, 180.0, 250.0}) {
        const GBuffer g = plane(128, 96, tilt, azimuth, orthographic);
        for (const Settings& more :
             {Settings{}, Settings{{"reach", "10%"}}, Settings{{"reach", "2"}, {"samples", "32"}},
              Settings{{"sample_z", "off"}, {"border", "clamp"}}, Settings{{"depth", "window"}, {"bias", "0"}},
              Settings{{"reflect", "normal"}, {"reach", "0.3"}}})
          test::on_every_target("sphere", g, joined(kCorrected, more), [&](const Image& image) {
            ASSERT_EQ(fraction_off(g, image.plane("ao"), 0, 1.0), 0.0)
                << tilt << ' ' << azimuth << (orthographic ? " orthographic " : " ") << testing::PrintToString(more);
          });
      }
}

// ---- each parameter, on a step of one unit in an orthographic view
// ------------------------------------------------------------------------------------------

constexpr int kStepWidth = 64, kStepHeight = 48, kStep = 32;  // columns from kStep on are behind
constexpr double kNearSide = 4.0, kFarSide = 5.0;
constexpr double kRadiusPx = 8.0, kRadius = 0.8;  // a pixel is 0.1 units

GBuffer step(int first_far_column = kStep) {
  GBuffer g = picture(kStepWidth, kStepHeight, [&](double u, double) -> Surface {
    return {(u + 1.0) / 2.0 * kStepWidth < first_far_column ? kNearSide : kFarSide, {0, 0, 1}};
  });
  g.info.camera =
      orthographic_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.1f * kStepHeight, float(kStepWidth) / kStepHeight);
  return g;
}

/// Returns the fraction of sample points that satisfy a condition.
double fraction(const std::vector<glm::dvec3>& all, const std::function<bool(glm::dvec3)>& holds) {
  return double(std::count_if(all.begin(), all.end(), holds)) / double(all.size());
}

/// Compares row 20 of the step, in columns away from the picture's border, with 1 - expected(x, fraction of nearer
/// samples).
void expect_step(const Settings& more, const std::function<double(int x, double nearer)>& expected) {
  const GBuffer g = step();
  const Settings settings =
      joined(joined(kPlainFraction, {{"radius", fmt::format("{}", kRadiusPx)}, {"samples", "16"}}), more);
  const auto all = points(g, settings);
  test::on_every_target("sphere", g, settings, [&](const Image& image) {
    for (int x = 10; x < 54; ++x) {
      const double nearer =
          x < kStep ? 0.0 : fraction(all, [&](glm::dvec3 v) { return std::floor(x + 0.5 + kRadiusPx * v.x) < kStep; });
      EXPECT_NEAR(image.plane("ao").at(x, 20), 1.0 - expected(x, nearer), 1e-6) << x;
    }
  });
}

TEST(Sphere, CountsTheSamplesThatFallOnNearerSurfaces) {
  expect_step({}, [](int, double nearer) { return nearer; });
  expect_step({{"samples", "100"}}, [](int, double nearer) { return nearer; });
  expect_step({{"depth", "linear"}}, [](int, double nearer) { return nearer; });
}

TEST(Sphere, ThresholdMapAndStrength) {
  expect_step({{"threshold", "0.375"}}, [](int, double nearer) { return nearer < 0.375 ? 0.0 : nearer; });
  expect_step({{"map", "quadratic"}}, [](int, double nearer) { return nearer * nearer; });
  expect_step({{"strength", "3"}}, [](int, double nearer) { return std::min(1.0, 3.0 * nearer); });
  expect_step({{"strength", "0"}}, [](int, double) { return 0.0; });
}

TEST(Sphere, RangeLimitInLinearDepth) {
  const auto with = [](const char* range, const char* factor) {
    return Settings{{"depth", "linear"}, {"range", range}, {"range_factor", factor}};
  };
  // The occluder is 1 nearer, the radius is 0.8.
  expect_step(with("hard", "1.2"), [](int, double) { return 0.0; });
  expect_step(with("hard", "1.3"), [](int, double nearer) { return nearer; });
  expect_step(with("smooth", "1.3"), [](int, double nearer) { return nearer; });
  const double t = kRadius;
  expect_step(with("smooth", "1"), [&](int, double nearer) { return nearer * t * t * (3.0 - 2.0 * t); });
  expect_step(with("smooth", "0"), [&](int, double) { return 0.0; });
}

TEST(Sphere, RangeLimitAndPlanesInWindowDepth) {
  const auto with = [](const char* factor) {
    return Settings{{"near", "2"}, {"far", "10"}, {"range", "hard"}, {"range_factor", factor}};
  };
  // Window depth Z = 10/8 (1 - 2/z) differs by 0.125, and so does the radius, 8 of 64 pixels.
  expect_step(with("0.98"), [](int, double) { return 0.0; });
  expect_step(with("1.02"), [](int, double nearer) { return nearer; });
  // In front of the near plane and behind the far plane all depths are equal.
  expect_step({{"near", "6"}, {"far", "10"}}, [](int, double) { return 0.0; });
  expect_step({{"near", "1"}, {"far", "3.5"}}, [](int, double) { return 0.0; });
  expect_step({{"near", "20"}, {"far", "10"}}, [](int, double) { return 0.0; });
}

TEST(Sphere, SamplesWithTheirOwnDepthAreOccludedBehindTheSurface) {
  const GBuffer g = step();
  const Settings settings = joined(kPlainFraction, {{"radius", "8"}, {"samples", "16"}, {"sample_z", "on"}});
  const auto all = points(g, settings);
  test::on_every_target("sphere", g, settings, [&](const Image& image) {
    for (int x = 10; x < 54; ++x) {
      const double own = x < kStep ? kNearSide : kFarSide;
      const double hidden = fraction(all, [&](glm::dvec3 v) {
        const double surface = std::floor(x + 0.5 + kRadiusPx * v.x) < kStep ? kNearSide : kFarSide;
        return own - kRadius * v.z > surface + 1e-6;
      });
      EXPECT_NEAR(image.plane("ao").at(x, 20), 1.0 - hidden, 1e-6) << x;
    }
    EXPECT_NEAR(image.plane("ao").at(12, 20), 0.5, 0.01);
  });
}

TEST(Sphere, HemisphereTurnsSamplesToTheSurfacesSide) {
  const GBuffer g = step();
  for (const char* sample_z : {"on", "off"}) {
    const Settings settings =
        joined(kPlainFraction, {{"radius", "8"}, {"samples", "16"}, {"shape", "hemisphere"}, {"sample_z", sample_z}});
    const auto all = points(g, settings);
    test::on_every_target("sphere", g, settings, [&](const Image& image) {
      for (int x = 10; x < 54; ++x) {
        const double hidden = x < kStep ? 0.0 : fraction(all, [&](glm::dvec3 v) {
          return std::floor(x + 0.5 + kRadiusPx * (v.z < 0.0 ? -v.x : v.x)) < kStep;
        });
        EXPECT_NEAR(image.plane("ao").at(x, 20), 1.0 - hidden, 1e-6) << x;
      }
    });
  }
}

TEST(Sphere, BiasIgnoresLowOccluders) {
  const GBuffer g = step();
  const Settings settings = joined(kPlainFraction, {{"radius", "16"}, {"shape", "hemisphere"}});
  // The step is 1 high, the radius 1.6.
  EXPECT_EQ(fraction_off(g, ao(g, joined(settings, {{"bias", "0.64"}})), 0, 1.0), 0.0);
  EXPECT_GT(fraction_off(g, ao(g, joined(settings, {{"bias", "0.61"}})), 0, 1.0), 0.1);
}

TEST(Sphere, SamplesOutsideAreClampedOrLeftOut) {
  const GBuffer g = step(60);
  const Settings settings = joined(kPlainFraction, {{"radius", "8"}, {"samples", "32"}});
  const auto all = points(g, settings);
  const int x = 61, y = 20;
  const double nearer = fraction(all, [&](glm::dvec3 v) { return std::floor(x + 0.5 + kRadiusPx * v.x) < 60; });
  const double inside = fraction(all, [&](glm::dvec3 v) { return std::floor(x + 0.5 + kRadiusPx * v.x) < kStepWidth; });
  EXPECT_LT(inside, 0.8);
  EXPECT_NEAR(ao(g, settings).at(x, y), 1.0 - nearer, 1e-6);
  EXPECT_NEAR(ao(g, joined(settings, {{"border", "skip"}})).at(x, y), 1.0 - nearer / inside, 1e-6);
}

TEST(Sphere, RandomVectorsAreTiled) {
  const GBuffer g = step();
  const auto column = [&](const char* size, int from) {
    const Plane plane = ao(g, joined(kPlainFraction, {{"radius", "8"}, {"reflect", "random"}, {"noise_size", size}}));
    std::vector<float> values;
    for (int y = from; y < from + 16; ++y) values.push_back(plane.at(kStep + 2, y));
    return values;
  };
  EXPECT_EQ(column("4", 8), column("4", 12));
  EXPECT_NE(column("4", 8), column("4", 10));
  EXPECT_EQ(column("5", 8), column("5", 13));
  EXPECT_NE(column("5", 8), column("5", 12));
  EXPECT_EQ(column("1", 8), column("1", 9));
  EXPECT_NE(column("0", 8), column("0", 12));
}

TEST(Sphere, ReachIsARadiusInTheScene) {
  const GBuffer g = step();
  const Plane px = ao(g, joined(kPlainFraction, {{"radius", "8"}}));
  const auto same = [&](const char* reach) {
    return test::difference(px, ao(g, joined(kPlainFraction, {{"radius", "3"}, {"reach", reach}})), 0.0).fraction_over;
  };
  EXPECT_LT(same("0.8"), 1e-3);
  EXPECT_LT(same("16%"), 1e-3);  // 16% of the scene's radius, 5
  EXPECT_GT(same("0.4"), 0.05);

  const Effect& effect = *find_effect("sphere");
  ParameterBytes bytes = test::parameters_of(effect, {{"radius", "3"}});
  effect.set_radius(0.8f, g.info, bytes);
  EXPECT_EQ(as<SphereParams>(bytes).reach.value, 0.8f);
  EXPECT_EQ(as<SphereParams>(bytes).reach.relative, 0);
}

TEST(Sphere, PercentOfTheWidthExcludesTheGuardBand) {
  GBuffer g = test::empty_gbuffer(100, 60);
  EXPECT_FLOAT_EQ(constants(g, {{"radius", "5%"}}).radius_px, 5.0f);
  g.info = with_guard(g.info, 20);
  EXPECT_FLOAT_EQ(constants(g, {{"radius", "5%"}}).radius_px, 5.0f);
  EXPECT_FLOAT_EQ(constants(g, {{"radius", "7"}}).radius_px, 7.0f);
}

// ---- the corrected settings, in double, with perspective
// ------------------------------------------------------------------------------------------

/// Returns `ao`, computed directly: the samples are projected, and the height of each tap above the plane is computed.
double corrected_in_double(const GBuffer& g, const std::vector<glm::dvec3>& all, int x, int y, double radius) {
  const Image& image = g.layers[0];
  const Camera& camera = g.info.camera;
  const auto position = [&](int i, int j, double depth) {
    return depth * glm::dvec3(camera.left + (camera.right - camera.left) * (i + 0.5) / g.info.width,
                              camera.top - (camera.top - camera.bottom) * (j + 0.5) / g.info.height, -1.0);
  };
  const double depth = image.planes[0].at(x, y);
  const glm::dvec3 p = position(x, y, depth);
  const glm::dvec3 n =
      glm::normalize(glm::dvec3(image.planes[1].at(x, y), image.planes[2].at(x, y), image.planes[3].at(x, y)));
  double hidden = 0.0, count = 0.0;
  for (glm::dvec3 v : all) {
    v = reflect(v, random_vector(x % 4, y % 4));
    if (glm::dot(v, n) < 0.0) v = -v;
    const glm::dvec3 s = p + radius * v;
    const double u = (s.x / -s.z - camera.left) / (camera.right - camera.left) * g.info.width;
    const double w = (camera.top - s.y / -s.z) / (camera.top - camera.bottom) * g.info.height;
    if (u < 0.0 || u >= g.info.width || w < 0.0 || w >= g.info.height) continue;
    count += 1.0;
    const int column = int(u), row = int(w);
    const double tap = image.planes[0].at(column, row);
    if (!(tap < -s.z) || !(glm::dot(position(column, row, tap) - p, n) > 0.02 * radius)) continue;
    const double t = std::min(1.0, radius / std::max(depth - tap, 1e-9));
    hidden += depth - tap <= radius ? 1.0 : t * t * (3.0 - 2.0 * t);
  }
  return 1.0 - hidden / std::max(count, 1.0);
}

TEST(Sphere, CorrectedSettingsMatchProjectionInDouble) {
  GBuffer g = waves(120, 90);
  g.info.camera.left *= 0.7f;  // off-centre
  g.info.camera.top *= 1.3f;
  const Settings settings = joined(kCorrected, {{"reach", "1"}, {"samples", "16"}});
  const auto all = points(g, settings);
  test::on_every_target("sphere", g, settings, [&](const Image& image) {
    long off = 0, compared = 0;
    double sum = 0.0;
    for (int y = 0; y < 90; ++y)
      for (int x = 0; x < 120; ++x) {
        if (!std::isfinite(g.layers[0].planes[0].at(x, y))) continue;
        const double expected = corrected_in_double(g, all, x, y, 1.0);
        off += std::fabs(image.plane("ao").at(x, y) - expected) > 1e-4;
        sum += expected;
        ++compared;
      }
    EXPECT_LE(off, compared / 200);
    EXPECT_LT(sum / compared, 0.9);  // occlusion is visible
  });
}

TEST(Sphere, ResolutionDoesNotMatter) {
  for (const Settings& settings :
       {Settings{{"samples", "64"}}, joined(kCorrected, {{"reach", "0.5"}, {"samples", "64"}})}) {
    const Plane small = ao(waves(128, 96), settings), large = ao(waves(256, 192), settings);
    double sum = 0.0, difference = 0.0;
    for (int by = 0; by < 12; ++by)
      for (int bx = 0; bx < 16; ++bx) {
        double mean_small = 0.0, mean_large = 0.0;
        for (int y = 0; y < 8; ++y)
          for (int x = 0; x < 8; ++x) mean_small += small.at(8 * bx + x, 8 * by + y) / 64.0;
        for (int y = 0; y < 16; ++y)
          for (int x = 0; x < 16; ++x) mean_large += large.at(16 * bx + x, 16 * by + y) / 256.0;
        sum += mean_small - mean_large;
        difference += std::fabs(mean_small - mean_large);
      }
    EXPECT_NEAR(sum / 192.0, 0.0, 0.01);
    EXPECT_LT(difference / 192.0, 0.02);
    EXPECT_LT(test::difference(small, Plane(128, 96, 1.0f), 0.0).mean, 0.9);
    EXPECT_GT(test::difference(small, Plane(128, 96, 1.0f), 0.0).mean, 0.02);  // occlusion is visible
  }
}

// ---- the shader of Mittring 2007
// ------------------------------------------------------------------------------------------

/// Returns the settings of a preset: variant `index` of those with the points of the shader, of which the first has 8
/// samples and the second has 16.
Settings crytek(int index = 0) {
  std::vector<Settings> presets;
  for (const std::string_view variant : find_effect("sphere")->variants) {
    if (variant.find("distribution=corners") == std::string_view::npos) continue;
    Settings& settings = presets.emplace_back();
    for (std::size_t at = 0, end = 0; at < variant.size(); at = end + 1) {
      end = std::min(variant.find(' ', at), variant.size());
      const std::size_t equals = variant.find('=', at);
      settings.emplace_back(variant.substr(at, equals - at), variant.substr(equals + 1, end - equals - 1));
    }
  }
  return presets.at(std::size_t(index));
}

const Settings kRaw = {{"gain", "1"}, {"offset", "0"}};  // the grey picture
const Settings kManySeeds = {{"noise_size", "0"}};

constexpr int kProfileWidth = 513, kProfileHeight = 900;
constexpr int kProfileMargin = 40;  // above the radius, 32 px

/// Returns a picture with a field of view of 90 degrees and depth 1 in the middle. Its depth depends on the column: u
/// is the distance from the middle, in scene units at depth 1. The radius is 1/8 of a unit.
GBuffer profile(const std::function<double(double u)>& depth, bool orthographic) {
  GBuffer g = picture(kProfileWidth, kProfileHeight, [&](double u, double) -> Surface {
    const double z = depth(u);
    return z > 0.0 ? Surface{z, {0, 0, 1}} : Surface{kInfinity, {0, 0, 0}};
  });
  const float half_height = float(kProfileHeight) / kProfileWidth;
  if (orthographic)
    g.info.camera = orthographic_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 2.0f * half_height, 1.0f / half_height);
  g.info.camera.left = -1.0f;
  g.info.camera.right = 1.0f;
  g.info.camera.bottom = -half_height;
  g.info.camera.top = half_height;
  return g;
}

/// Returns the mean over some columns, thus over many random vectors.
double mean_of_columns(const Plane& plane, const std::vector<int>& columns) {
  double sum = 0.0;
  for (const int x : columns)
    for (int y = kProfileMargin; y < kProfileHeight - kProfileMargin; ++y) sum += plane.at(x, y);
  return sum / double(columns.size()) / (kProfileHeight - 2 * kProfileMargin);
}

/// Compares the mean over some columns of a profile with the value of the shader for all random vectors: the grey
/// visibility and the final one.
void expect_means(const std::function<double(double u)>& depth, const std::vector<int>& columns, double raw,
                  double final_value, int preset = 0) {
  for (const bool orthographic : {false, true}) {
    const GBuffer g = profile(depth, orthographic);
    const Settings settings = joined(crytek(preset), kManySeeds);
    const double grey = mean_of_columns(ao(g, joined(settings, kRaw)), columns);
    const double white = mean_of_columns(ao(g, settings), columns);
    EXPECT_NEAR(grey, raw, 0.01) << orthographic;
    EXPECT_NEAR(white, final_value, 0.01) << orthographic;
  }
}

const std::vector<int> kMiddle = {254, 255, 256, 257, 258};

TEST(Sphere, CrytekWallsAreGrey) {
  const auto wall = [](double) { return 1.0; };
  expect_means(wall, kMiddle, 0.457, 0.840);
  expect_means(wall, kMiddle, 0.424, 0.773, 1);
}

TEST(Sphere, CrytekWallsBrightenWithTheirSlope) {
  const auto slope = [](double k) { return [k](double u) { return 1.0 + k * u; }; };
  expect_means(slope(1.0), kMiddle, 0.470, 0.864);
  expect_means(slope(2.0), kMiddle, 0.502, 0.926);
  expect_means(slope(4.0), kMiddle, 0.534, 0.971);
}

/// Returns the distance of u from the nearest of the lines that are 80 pixels apart, one of them in the middle.
double from_line(double u) {
  const double apart = 160.0 / kProfileWidth;
  return std::fabs(u - apart * std::round(u / apart));
}
const std::vector<int> kLines = {96, 176, 256, 336, 416};

TEST(Sphere, CrytekFoldsAreDarkAndRidgesWhite) {
  expect_means([](double u) { return 1.0 - from_line(u); }, kLines, 0.252, 0.429);
  expect_means([](double u) { return 1.0 + from_line(u); }, kLines, 0.686, 1.000);
}

TEST(Sphere, CrytekHasNoHaloBesideNearerObjects) {
  // Strips at a distance beyond the range alternate with strips at depth 1; columns at both edges.
  const auto strip = [](double u) { return int(std::floor((u + 1.0) / 2.0 * kProfileWidth / 64.0)) % 2 != 0; };
  const std::vector<int> edges = {128, 191, 256, 319};
  expect_means([&](double u) { return strip(u) ? 0.3 : 1.0; }, edges, 0.505, 0.926);
  expect_means([&](double u) { return strip(u) ? 50.0 : 1.0; }, edges, 0.618, 0.996);
}

TEST(Sphere, CornersHaveGrowingDistances) {
  const GBuffer g = test::empty_gbuffer(8, 8);
  for (const int n : {1, 8, 16, 256}) {
    const auto all = points(g, {{"distribution", "corners"}, {"samples", std::to_string(n)}});
    ASSERT_EQ(all.size(), std::size_t(n));
    const int rings = (n + 7) / 8;
    for (int i = 0; i < n; ++i) {
      const double distance = (i % 8 + 1) / 8.0 * (rings - i / 8) / rings;
      EXPECT_NEAR(glm::length(all[i]), distance, 1e-6) << i;
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(std::fabs(all[i][k]), distance / std::sqrt(3.0), 1e-6) << i;
      for (int j = i / 8 * 8; j < i; ++j)  // no corner twice
        EXPECT_LT(glm::dot(all[i], all[j]) / glm::length(all[i]) / glm::length(all[j]), 0.34) << i << ' ' << j;
    }
  }
}

/// Returns the visibility before `gain` in the shader's own terms: its scale s is 1/0.35 of the largest distance.
double crytek_in_double(const GBuffer& g, const std::vector<glm::dvec3>& all, int x, int y) {
  const Plane& depth = g.layers[0].plane("depth");
  const Camera& camera = g.info.camera;
  const double z = depth.at(x, y);
  const double radius_px = 0.0625 * g.info.width;
  const double radius = radius_px * double(camera.right - camera.left) / g.info.width * z;
  const double s = radius / 0.35;
  double sum = 0.0;
  for (const glm::dvec3& point : all) {
    const glm::dvec3 v = reflect(point, random_vector(x % 4, y % 4));
    const int column = std::clamp(int(std::floor(x + 0.5 + radius_px * v.x)), 0, g.info.width - 1);
    const int row = std::clamp(int(std::floor(y + 0.5 - radius_px * v.y)), 0, g.info.height - 1);
    const double tap = depth.at(column, row);
    const double behind = z - radius * v.z - (std::isfinite(tap) ? tap : 1e9);
    const double access = std::clamp(-32.0 * behind / s, 0.0, 1.0);
    const double out = 0.85 * behind / s;
    const double invalid = (std::min(1.0, std::fabs(out)) + std::clamp(out, 0.0, 1.0)) / 2.0;
    sum += access + (0.55 - access) * invalid;
  }
  return sum / double(all.size());
}

TEST(Sphere, CrytekMatchesItsShaderInDouble) {
  GBuffer g = waves(128, 96);
  g.info.camera.left *= 0.8f;  // off-centre
  for (const int preset : {0, 1}) {
    const auto all = points(g, crytek(preset));
    ASSERT_EQ(all.size(), preset == 0 ? 8u : 16u);
    for (const bool raw : {false, true})
      test::on_every_target("sphere", g, joined(crytek(preset), raw ? kRaw : Settings{}), [&](const Image& image) {
        long off = 0, compared = 0;
        for (int y = 0; y < 96; ++y)
          for (int x = 0; x < 128; ++x) {
            if (!std::isfinite(g.layers[0].plane("depth").at(x, y))) continue;
            const double grey = crytek_in_double(g, all, x, y);
            const double expected = raw ? grey : std::clamp(2.0 * grey - 0.075, 0.0, 1.0);
            off += std::fabs(image.plane("ao").at(x, y) - expected) > 2e-3;
            ++compared;
          }
        EXPECT_GT(compared, 9000);
        EXPECT_LE(off, compared / 500);
      });
  }
}

/// Compares row 20 of the step with 1 - expected(x, nearer, farther), where nearer and farther are the fractions of
/// samples on a surface that is 1 in front of the pixel and 1 behind it.
void expect_soft_step(const Settings& more, const std::function<double(double nearer, double farther)>& expected) {
  const GBuffer g = step();
  const Settings settings = joined(joined(kPlainFraction, {{"radius", fmt::format("{}", kRadiusPx)}}), more);
  const auto all = points(g, settings);
  test::on_every_target("sphere", g, settings, [&](const Image& image) {
    for (int x = 10; x < 54; ++x) {
      const auto on_other_side = [&](glm::dvec3 v) {
        return (std::floor(x + 0.5 + kRadiusPx * v.x) < kStep) != (x < kStep);
      };
      const double other = fraction(all, on_other_side);
      EXPECT_NEAR(image.plane("ao").at(x, 20), 1.0 - expected(x < kStep ? 0.0 : other, x < kStep ? other : 0.0), 1e-6)
          << x;
    }
  });
}

TEST(Sphere, SoftnessIsARampInFrontOfTheSurface) {
  // A ramp 2 long: half of it is between the two surfaces. On a surface, a sample is occluded.
  const auto half = [](double, double farther) { return 1.0 - 0.5 * farther; };
  expect_soft_step({{"depth", "linear"}, {"softness", "2.5"}}, half);
  expect_soft_step({{"depth", "linear"}, {"softness", "1.25"}}, [](double, double farther) { return 1.0 - farther; });
  // Window depth differs by 0.125, which is also the radius.
  expect_soft_step({{"near", "2"}, {"far", "10"}, {"softness", "2"}}, half);
}

TEST(Sphere, BlendTendsToTheRangeValue) {
  const auto with = [](const char* factor, const char* value) {
    return Settings{{"depth", "linear"}, {"range", "blend"}, {"range_factor", factor}, {"range_value", value}};
  };
  // The other surface is at half the range: 1 of 2. Occluded samples get half of the constant, open ones a quarter.
  expect_soft_step(with("2.5", "0.2"),
                   [](double nearer, double farther) { return nearer * (0.5 + 0.5 * 0.8) + farther * 0.25 * 0.8; });
  // Beyond the range: all and half.
  expect_soft_step(with("0.5", "0.2"), [](double nearer, double farther) { return 0.8 * nearer + 0.4 * farther; });
  expect_soft_step(with("0", "0.7"), [](double nearer, double farther) { return 0.3 * nearer + 0.15 * farther; });
}

TEST(Sphere, BlendTakesBackgroundForADistantSurface) {
  GBuffer g = step(), far = step();
  for (int y = 0; y < kStepHeight; ++y)
    for (int x = kStep; x < kStepWidth; ++x) {
      g.layers[0].planes[0].at(x, y) = kInfinity;
      far.layers[0].planes[0].at(x, y) = 1e6f;
    }
  const Settings settings = joined(crytek(), kRaw);
  const Plane expected = ao(far, settings);
  EXPECT_LT(expected.at(kStep - 1, 20), 0.9f);
  test::on_every_target("sphere", g, settings, [&](const Image& image) {
    for (int x = 0; x < kStep; ++x) EXPECT_NEAR(image.plane("ao").at(x, 20), expected.at(x, 20), 1e-6) << x;
  });
}

TEST(Sphere, GainAndOffsetOfTheVisibility) {
  expect_step({{"gain", "0.5"}, {"offset", "0.25"}},
              [](int, double nearer) { return 1.0 - (0.5 * (1.0 - nearer) + 0.25); });
  expect_step({{"gain", "2"}, {"offset", "-0.5"}},
              [](int, double nearer) { return 1.0 - std::clamp(2.0 * (1.0 - nearer) - 0.5, 0.0, 1.0); });
  expect_step({{"gain", "0"}, {"offset", "-1"}}, [](int, double) { return 1.0; });
}

TEST(Sphere, OlderPresetsAreUnchanged) {
  // Sums of `ao`, as they were before the parameters of the shader of 2007 were added.
  const GBuffer g = waves(128, 96);
  const auto sum = [&](const Settings& settings) {
    const Plane plane = ao(g, settings);
    double sum = 0.0;
    for (int y = 0; y < 96; ++y)
      for (int x = 0; x < 128; ++x) sum += plane.at(x, y);
    return sum;
  };
  EXPECT_NEAR(sum({}), 11686.59, 0.5);
  EXPECT_NEAR(sum({{"samples", "16"}}), 11933.29, 0.5);
  EXPECT_NEAR(sum({{"samples", "32"}}), 11981.49, 0.5);
  EXPECT_NEAR(sum(joined(kCorrected, {{"strength", "1.3"}})), 7371.55, 0.5);
}

// ---- invalid pixels
// ------------------------------------------------------------------------------------------

TEST(Sphere, BackgroundIsUnoccludedAndOccludesNothing) {
  GBuffer g = step();
  for (int y = 0; y < kStepHeight; ++y)
    for (int x = 0; x < kStep; ++x) g.layers[0].planes[0].at(x, y) = kInfinity;
  for (const Settings& settings : {kPlainFraction, kCorrected})
    test::on_every_target("sphere", g, settings, [&](const Image& image) {
      EXPECT_EQ(test::difference(image.plane("ao"), Plane(kStepWidth, kStepHeight, 1.0f), 0.0).max, 0.0);
    });
}

TEST(Sphere, InvalidDepthIsBackground) {
  GBuffer g = step();
  const float odd[] = {std::nanf(""), -kInfinity, 0.0f, -1.0f};
  for (int y = 0; y < kStepHeight; ++y)
    for (int x = 0; x < kStep; ++x) g.layers[0].planes[0].at(x, y) = odd[(x + y) % 4];
  test::on_every_target("sphere", g, kPlainFraction, [&](const Image& image) {
    EXPECT_EQ(test::difference(image.plane("ao"), Plane(kStepWidth, kStepHeight, 1.0f), 0.0).max, 0.0);
  });
}

TEST(Sphere, InvalidNormalsFaceTheCamera) {
  const GBuffer g = step();
  const Plane expected = ao(g, kCorrected);
  for (const float odd : {0.0f, std::nanf(""), kInfinity}) {
    GBuffer without = g;
    for (int k = 1; k <= 3; ++k) without.layers[0].planes[k] = Plane(kStepWidth, kStepHeight, odd);
    test::on_every_target("sphere", without, kCorrected, [&](const Image& image) {
      EXPECT_EQ(test::difference(image.plane("ao"), expected, 1e-5).fraction_over, 0.0) << odd;
    });
  }
}

}  // namespace
}  // namespace umbrage
