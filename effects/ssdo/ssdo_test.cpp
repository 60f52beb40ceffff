// Tests `ssdo` beside an infinite wall against closed forms and quadrature, in a white furnace, and against what the
// paper's formulas are known to give.
#include "effects/ssdo/ssdo.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/trigonometric.hpp>
#include <numbers>

#include "run_effect.h"
#include "support.h"

namespace umbrage {
namespace {

using test::joined;
using test::Settings;

constexpr double kPi = std::numbers::pi;
constexpr int kWidth = 400, kHeight = 600;
constexpr double kWindow = 4.0;  // height of the picture, radii
constexpr double kDepth = 20.0;  // of the wall's foot

// One radius is one scene unit. The paper's sample points: uniform directions, weighted by the cosine.
const Settings kPoints = {{"radius", "1"}, {"samples", "64"},  {"noise", "0"},     {"bias", "0"},
                          {"steps", "1"},  {"thickness", "0"}, {"lengths", "root"}};
const Settings kLinear = {{"lengths", "linear"}, {"directions", "uniform"}};

/// A floor in front of an infinite wall that is perpendicular to it, seen without perspective from an elevation above
/// the floor.
struct Corner {
  GBuffer g;
  glm::vec3 towards_wall, up;  // axes in view space
  double elevation;            // radians

  explicit Corner(double elevation_deg)
      : g(test::empty_gbuffer(kWidth, kHeight)), elevation(elevation_deg * kPi / 180) {
    const float s = float(std::sin(elevation)), c = float(std::cos(elevation));
    up = {0.0f, c, s};
    towards_wall = {0.0f, s, -c};
    g.info.camera = orthographic_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, float(kWindow), float(kWidth) / kHeight);
    Image& image = g.layers[0];
    for (const char* name : {"depth", "normal.x", "normal.y", "normal.z", "direct.r", "direct.g", "direct.b"})
      image.add(name) = Plane(kWidth, kHeight, 0.0f);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const double v = height_of(y);
        const bool wall = v > 0.0;
        image.plane("depth").at(x, y) = float(kDepth + (wall ? -v * s / c : v * c / s));
        const glm::vec3 normal = wall ? -towards_wall : up;
        image.plane("normal.y").at(x, y) = normal.y;
        image.plane("normal.z").at(x, y) = normal.z;
      }
  }

  static double height_of(int row) { return kWindow * (0.5 - (row + 0.5) / kHeight); }
  /// Returns the row on the floor nearest to a distance from the wall, and the distance itself.
  int row_at(double distance) const {
    return int(std::lround((0.5 + distance * std::sin(elevation) / kWindow) * kHeight - 0.5));
  }
  double distance_at(int row) const { return -height_of(row) / std::sin(elevation); }

  /// Makes the wall emit this light.
  void light_wall(float light) {
    for (const char* name : test::kDirect)
      for (int y = 0; y < kHeight && height_of(y) > 0.0; ++y)
        for (int x = 0; x < kWidth; ++x) g.layers[0].plane(name).at(x, y) = light;
  }

  /// Sets the radiance of ambient light: of a channel, l.d + d'Qd with d in the frame (towards the wall, along it, up).
  void set_sky(int channel, glm::vec3 linear, const glm::mat3& quadratic) {
    const glm::mat3 axes(towards_wall, glm::cross(up, towards_wall), up);
    glm::mat4 m(axes * quadratic * glm::transpose(axes) * 0.25f);  // irradiance has 1/4 of Q and 2/3 of l
    const glm::vec3 first = axes * linear / 3.0f;
    m[3] = glm::vec4(first, 0.0f);
    for (int k = 0; k < 3; ++k) m[k][3] = first[k];
    g.info.ambient_shape.by_color[std::size_t(channel)] = m;
  }

  /// Returns the mean picture of several seeds.
  Image mean_picture(const Settings& settings) const {
    constexpr int kSeeds = 4;
    Image mean;
    for (int seed = 0; seed < kSeeds; ++seed) {
      const Image image =
          test::run_effect(*find_effect("ssdo"), g, joined(settings, {{"seed", std::to_string(seed)}}), {});
      if (seed == 0) mean = Image(kWidth, kHeight);
      for (std::size_t p = 0; p < image.planes.size(); ++p) {
        if (seed == 0) mean.add(image.names[p]) = Plane(kWidth, kHeight, 0.0f);
        for (int y = 0; y < kHeight; ++y)
          for (int x = 0; x < kWidth; ++x) mean.planes[p].at(x, y) += image.planes[p].at(x, y) / kSeeds;
      }
    }
    return mean;
  }
};

/// Returns the mean of a row of a plane, without the columns whose sample points may be outside the picture.
double mean_of_row(const Plane& plane, int row) {
  constexpr int kMargin = 152;
  double sum = 0.0;
  for (int x = kMargin; x < kWidth - kMargin; ++x) sum += plane.at(x, row);
  return sum / (kWidth - 2 * kMargin);
}

/// Returns the fraction of the hemisphere that sample points with lengths uniform in [0, 1] find hidden by an infinite
/// wall at distance k.
double hidden_linear(double k) {
  const double s = std::sqrt(1.0 - k * k);
  return (std::acos(k) + k * s - 2.0 * k * std::log((1.0 + s) / k)) / kPi;
}
/// The same for square roots of uniform lengths.
double hidden_root(double k) {
  const double s = std::sqrt(1.0 - k * k);
  return ((1.0 + 2.0 * k * k) * std::acos(k) - 3.0 * k * s) / kPi;
}
/// The same for rays of length 1.
double hidden_rays(double k) { return (std::acos(k) - k * std::sqrt(1.0 - k * k)) / kPi; }

TEST(Ssdo, WallHidesWhatItsSamplePointsFind) {
  const Corner corner(45.0);
  const Image linear = corner.mean_picture(joined(kPoints, kLinear)), root = corner.mean_picture(kPoints);
  const Image many = corner.mean_picture(joined(kPoints, {{"steps", "16"}}));
  for (const double distance : {0.1, 0.25, 0.5, 0.75}) {
    const int row = corner.row_at(distance);
    const double k = corner.distance_at(row);
    EXPECT_NEAR(1.0 - mean_of_row(linear.plane("ao"), row), hidden_linear(k), 0.006) << k;
    EXPECT_NEAR(1.0 - mean_of_row(root.plane("ao"), row), hidden_root(k), 0.006) << k;
    EXPECT_NEAR(1.0 - mean_of_row(many.plane("ao"), row), hidden_rays(k), 0.012) << k;
  }
}

TEST(Ssdo, LightComesFromTheOpenDirections) {
  Corner corner(45.0);
  glm::mat3 quadratic(0.0f);
  quadratic[0][2] = quadratic[2][0] = 0.5f;  // x z
  quadratic[0][0] = 1.0f;
  corner.set_sky(0, {0.5f, 0.0f, 0.0f}, glm::mat3(0.0f));
  corner.set_sky(1, {0.0f, 0.0f, 0.8f}, glm::mat3(0.0f));
  corner.set_sky(2, glm::vec3(0.0f), quadratic);
  const auto radiance = [](int channel, double x, double z) {
    return channel == 0 ? 0.5 * x : channel == 1 ? 0.8 * z : x * z + x * x;
  };
  const int row = corner.row_at(0.25);
  const double k = corner.distance_at(row);
  const Image ours = corner.mean_picture(kPoints),
              papers = corner.mean_picture(joined(kPoints, {{"difference", "off"}}));
  for (int channel = 0; channel < 3; ++channel) {
    // Over cosine-distributed directions: the probability that a length sqrt(t) ends in front of the wall.
    double open = 0.0, all = 0.0, visible = 0.0;
    constexpr int kSteps = 1000;
    for (int i = 0; i < kSteps; ++i)
      for (int j = 0; j < kSteps; ++j) {
        const double u = (i + 0.5) / kSteps, x = std::sqrt(u) * std::cos(2.0 * kPi * (j + 0.5) / kSteps);
        const double probability = x > k ? k * k / (x * x) : 1.0;
        const double light = radiance(channel, x, std::sqrt(1.0 - u)) / (kSteps * kSteps);
        open += light * probability;
        all += light;
        visible += probability / (kSteps * kSteps);
      }
    for (const Image* image : {&ours, &papers})
      EXPECT_NEAR(mean_of_row(image->plane(test::kIndirect[channel]), row), open - visible * all, 0.004) << channel;
  }
}

TEST(Ssdo, WhiteFurnaceStaysWhite) {
  Corner corner(45.0);
  corner.light_wall(1.0f);
  for (const char* directions : {"cosine", "uniform"})
    for (const char* samples : {"1", "7"}) {
      const Settings settings = joined(kPoints, {{"directions", directions}, {"samples", samples}, {"bleeding", "1"}});
      test::on_every_target("ssdo", corner.g, settings, [&](const Image& image) {
        double darkest = 1.0;
        for (int y = corner.row_at(0.02); y < corner.row_at(0.3); ++y)
          for (int x = 0; x < kWidth; ++x) {
            const float ao = image.plane("ao").at(x, y);
            // Light is packed with an error below 1e-4.
            ASSERT_NEAR(ao + image.plane("indirect.g").at(x, y), 1.0f, 2e-4f) << x << ' ' << y;
            darkest = std::min(darkest, double(ao));
          }
        EXPECT_LT(darkest, 0.6) << "the wall hides nothing";
      });
    }
}

TEST(Ssdo, LightOfAWallDoesNotDependOnTheEyeUnlikeThePapers) {
  const double published[] = {0.255, 0.193, 0.111};
  int k = 0;
  for (const double elevation : {20.0, 45.0, 70.0}) {
    Corner corner(elevation);
    corner.light_wall(1.0f);
    const int row = corner.row_at(0.25);
    const Settings lit = joined(joined(kPoints, kLinear), {{"bleeding", "1"}});
    const Image ours = corner.mean_picture(lit);
    const Image papers = corner.mean_picture(joined(lit, {{"bounce", "sender"}, {"min_distance", "0"}}));
    EXPECT_NEAR(mean_of_row(ours.plane("indirect.g"), row), hidden_linear(corner.distance_at(row)), 0.006) << elevation;
    EXPECT_NEAR(mean_of_row(papers.plane("indirect.g"), row), published[k++], 0.02) << elevation;
  }
}

TEST(Ssdo, OpenPlanesAreFreeOfNoiseUnlikeThePapers) {
  Corner corner(45.0);
  for (int channel = 0; channel < 3; ++channel) corner.set_sky(channel, {0.5f, 0.3f, 0.2f}, glm::mat3(0.0f));
  const int first = corner.row_at(1.2), end = corner.row_at(1.6);
  const auto deviation = [&](const Settings& settings, const std::string& plane, double mean) {
    constexpr int kSeeds = 16;
    double squares = 0.0;
    for (int seed = 0; seed < kSeeds; ++seed) {
      const Image image = test::run_effect(*find_effect("ssdo"), corner.g,
                                           joined(joined(kPoints, settings), {{"seed", std::to_string(seed)}}), {});
      for (int y = first; y < end; ++y)
        for (int x = 0; x < kWidth; ++x) squares += std::pow(image.plane(plane).at(x, y) - mean, 2.0);
    }
    return std::sqrt(squares / (kSeeds * (end - first) * kWidth));
  };
  const Settings few = {{"samples", "16"}};
  EXPECT_LT(deviation(few, "ao", 1.0), 1e-6);
  EXPECT_LT(deviation(few, "indirect.g", 0.0), 1e-6);
  EXPECT_GT(deviation(joined(few, {{"difference", "off"}}), "indirect.g", 0.0), 0.01);
  // 16 random uniform directions, weighted by twice the cosine: 1 / sqrt(3 N).
  EXPECT_NEAR(deviation(joined(few, {{"directions", "paper"}, {"border", "open"}}), "ao", 1.0), 0.144, 0.01);
}

TEST(Ssdo, ThinSurfacesHideOnlyWhatIsInThem) {
  // A plate in front of a plane, a quarter of a radius thick: the plane, a radius behind it, is open again.
  GBuffer g = test::empty_gbuffer(200, 200);
  g.info.camera = orthographic_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 4.0f, 1.0f);
  Image& image = g.layers[0];
  for (const char* name : {"depth", "normal.x", "normal.y", "normal.z"}) image.add(name) = Plane(200, 200, 0.0f);
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) {
      image.plane("depth").at(x, y) = x < 90 ? 3.0f : 5.0f;
      image.plane("normal.z").at(x, y) = 1.0f;
    }
  const auto darkest = [&](const char* thickness) {
    const Image result =
        test::run_effect(*find_effect("ssdo"), g, {{"radius", "1"}, {"samples", "64"}, {"thickness", thickness}}, {});
    float min = 1.0f;
    for (int y = 60; y < 140; ++y)
      for (int x = 90; x < 200; ++x) min = std::min(min, result.plane("ao").at(x, y));
    return min;
  };
  EXPECT_FLOAT_EQ(darkest("0.25"), 1.0f);
  EXPECT_LT(darkest("0"), 0.6f);
}

}  // namespace
}  // namespace umbrage
