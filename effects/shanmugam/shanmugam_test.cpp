// Compares `shanmugam` with its formulas in double and with exact values for spheres, walls and planes.
#include "effects/shanmugam/shanmugam.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <numbers>

#include "core/gbuffer.h"
#include "run_effect.h"
#include "support.h"
#include "waves.h"

namespace umbrage {
namespace {

using namespace test;

constexpr double kPi = std::numbers::pi;

// ---- Far ----

const Settings kFarAlone = {{"near", "off"}, {"near_radius", "0"}, {"radius", "1000"}, {"far_form", "sphere"}};
const Settings kPatches = {{"near", "off"}, {"near_radius", "0"}, {"radius", "1000"}};
constexpr int kX = 20, kY = 14;  // the receiver's pixel

/// Returns a plane that faces the camera, with occluders at these positions relative to the receiver, which looks up z.
GBuffer below(std::vector<Occluder> occluders) {
  GBuffer g = tilted_plane(40, 30, 0.0);
  for (Occluder& occluder : occluders) occluder.center += glm::vec3(position(g, kX, kY));
  g.info.occluders = std::make_shared<const OccluderSet>(OccluderSet{std::move(occluders), 1});
  return g;
}

void expect_occlusion(const GBuffer& g, const Settings& settings, double expected, double tolerance) {
  on_every_target("shanmugam", g, settings, [&](const Image& image) {
    EXPECT_NEAR(1.0 - double(image.plane("ao").at(kX, kY)), expected, tolerance);
  });
}

TEST(Shanmugam, FarSpheresHideWhatTheySubtend) {
  const float exact[][3] = {
      {1.5, 0, .4444}, {1.5, 1, .2560}, {1.5, 2, .0960}, {1.5, 4, .0192}, {1.0, 1, .3536}};  // height, sideways, hidden
  for (const auto& [height, sideways, hidden] : exact) {
    const GBuffer g = below({{.center = {sideways, 0.0f, height}, .radius = 1.0f}});
    expect_occlusion(g, kFarAlone, hidden, 1e-4);
  }
}

TEST(Shanmugam, PatchesFillEachDirectionGradually) {
  // A closed patch right above, in the lobe of z, which holds a half: x / sqrt(1 + (2 x)^2).
  for (const float height : {1.5f, 3.0f, 6.0f}) {
    const double hidden = 1.0 / (height * height);
    expect_occlusion(below({{.center = {0.0f, 0.0f, height}, .radius = 1.0f}}), kPatches,
                     hidden / std::sqrt(1.0 + 4.0 * hidden * hidden), 1e-4);
  }
  // The walls of a closed room fill every lobe once.
  constexpr int kWalls = 250;
  const float wall_radius = 10.0f * std::sqrt(0.5f / float(kWalls));  // of a sphere with the area of one
  std::vector<Occluder> walls;
  for (int k = 0; k < kWalls; ++k) {
    const float turn = float(k) * 2.39996f, z = (float(k) + 0.5f) / float(kWalls), side = std::sqrt(1.0f - z * z);
    const glm::vec3 out(side * std::cos(turn), side * std::sin(turn), z);
    walls.push_back({.center = 10.0f * out, .radius = wall_radius, .mean_normal = -out});
  }
  const Plane ao = run_effect(*find_effect("shanmugam"), below(walls), kPatches, {}).plane("ao");
  EXPECT_NEAR(ao.at(kX, kY), 1.0 - std::sqrt(0.5), 0.01);
}

TEST(Shanmugam, FarSpheresByThePaperHideMore) {
  const float published[][3] = {{1.5, 0, .5093}, {1.5, 1, .2795}, {1.5, 2, .1002}, {1.5, 4, .0195}, {1.0, 1, .4142}};
  for (const auto& [height, sideways, hidden] : published)
    expect_occlusion(below({{.center = {sideways, 0.0f, height}, .radius = 1.0f}}),
                     joined(kFarAlone, {{"far_form", "paper"}}), hidden, 1e-4);
}

// Fractions that spheres hide which the horizon cuts, checked with 400,000 rays; distance in radii, cosine, fraction.
TEST(Shanmugam, TheHorizonCutsSpheres) {
  const float cut[][3] = {{1.05, -.3, .1814}, {1.05, 0, .3089}, {1.05, .3, .4535}, {1.05, .7, .6789},
                          {1.05, 1, .9070},   {2, -.3, .0037},  {2, 0, .0288},     {2, .3, .0787},
                          {2, .7, .1750},     {2, 1, .2500},    {2, -.6, 0}};
  for (const auto& [distance, cosine, hidden] : cut) {
    const auto sine = float(std::sqrt(1.0 - cosine * cosine));
    expect_occlusion(below({{.center = float(distance) * glm::vec3(0.0f, sine, cosine), .radius = 1.0f}}), kFarAlone,
                     hidden, 2e-4);
  }
}

TEST(Shanmugam, OnlyThePartBeyondTheNearRadiusCounts) {
  const float parts[][2] = {{.9, 0}, {1.15, .005}, {1.3, .194}, {1.45, .727}, {1.5, 1}};
  const Settings split = joined(kFarAlone, {{"near_radius", "1"}});
  for (const auto& [distance, part] : parts) {
    const float hidden = 0.25f / (distance * distance);
    const GBuffer g = below({{.center = {0.0f, 0.0f, distance}, .radius = 0.5f}});
    expect_occlusion(g, split, hidden * part, hidden * 1e-3);
    expect_occlusion(g, joined(kFarAlone, {{"radius", "1"}}), hidden * (1.0 - part), hidden * 1e-3);
  }
}

TEST(Shanmugam, FlatPatchesHideOnTheirSideOnly) {
  const auto filled = [](double hidden) { return hidden / std::sqrt(1.0 + 4.0 * hidden * hidden); };  // as above
  const float radius = 0.5f;  // of a sphere with the area of a disc of radius 1
  const auto facing = [&](glm::vec3 normal) {
    return below({{.center = {0.0f, 0.0f, 1.5f}, .radius = radius, .mean_normal = normal}});
  };
  expect_occlusion(facing({0, 0, -1}), kPatches, filled(1.0 / (1.0 + 1.5 * 1.5)), 1e-5);
  expect_occlusion(facing({0, 0, 1}), kPatches, 0.0, 1e-5);
  expect_occlusion(facing({1, 0, 0}), kPatches, 0.0, 1e-5);
}

TEST(Shanmugam, SpheresAddUpInAnObjectAndMultiplyAcrossObjects) {
  const Occluder one{.center = {0.0f, 1.0f, 1.0f}, .radius = 0.8f},
      other{.center = {0.0f, -1.0f, 1.0f}, .radius = 0.8f};
  const double hidden = 0.64 / std::pow(2.0, 1.5);
  expect_occlusion(below({one, other}), kFarAlone, 2.0 * hidden, 1e-4);
  Occluder of_next_object = other;
  of_next_object.object = 1;
  expect_occlusion(below({one, of_next_object}), kFarAlone, 1.0 - (1.0 - hidden) * (1.0 - hidden), 1e-4);
  expect_occlusion(below({one, one, one, one, one, other}), kFarAlone, 1.0, 1e-6);
}

TEST(Shanmugam, WithoutOccludersTheFarPartIsOpen) {
  GBuffer g = waves(64, 48, false);
  on_every_target("shanmugam", g, kFarAlone, [&](const Image& image) {
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x) ASSERT_EQ(image.plane("ao").at(x, y), 1.0f);
  });
}

TEST(Shanmugam, OccludersTurnWithTheCamera) {
  GBuffer g = below({{.center = {0.5f, 0.25f, 1.0f}, .radius = 0.7f, .mean_normal = {0.1f, 0.3f, -0.6f}}});
  const float expected = run_effect(*find_effect("shanmugam"), g, kPatches, {}).plane("ao").at(kX, kY);
  EXPECT_LT(expected, 0.9f);
  // The same picture of a scene that is turned a quarter about y and moved.
  const glm::mat4 world_from_view(glm::vec4(0, 0, -1, 0), glm::vec4(0, 1, 0, 0), glm::vec4(1, 0, 0, 0),
                                  glm::vec4(3, 4, 5, 1));
  OccluderSet set = *g.info.occluders;
  set.occluders[0].center = glm::vec3(world_from_view * glm::vec4(set.occluders[0].center, 1.0f));
  set.occluders[0].mean_normal = glm::mat3(world_from_view) * set.occluders[0].mean_normal;
  g.info.occluders = std::make_shared<const OccluderSet>(set);
  g.info.camera.view_from_world = glm::inverse(world_from_view);
  expect_occlusion(g, kPatches, 1.0 - expected, 1e-5);
}

// ---- Near ----

/// Returns a groove between two planes at right angles, each of which is seen at 45 degrees, along the y axis.
GBuffer groove(int side) {
  GBuffer g = empty_gbuffer(side, side);
  g.info.camera = orthographic_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 4.0f, 1.0f);
  for (const char* name : {"depth", "normal.x", "normal.y", "normal.z"}) g.layers[0].add(name);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const double across = 4.0 * (x + 0.5) / side - 2.0;
      g.layers[0].planes[0].at(x, y) = float(10.0 - std::abs(across));
      g.layers[0].planes[1].at(x, y) = float(across < 0.0 ? std::sqrt(0.5) : -std::sqrt(0.5));
      g.layers[0].planes[2].at(x, y) = 0.0f;
      g.layers[0].planes[3].at(x, y) = float(std::sqrt(0.5));
    }
  return g;
}

/// Returns the mean occlusion of the pixels of one column of the groove, whose distance from the other plane is k
/// radii.
double occlusion_in_groove(double k, const Settings& settings) {
  constexpr int kSide = 256, kColumn = kSide / 2 + 11;
  const double across = 4.0 * (kColumn + 0.5) / kSide - 2.0, radius = across * std::sqrt(2.0) / k;
  const GBuffer g = groove(kSide);
  const std::string text = fmt::format("{:.9g}", radius);
  const Image image =
      run_effect(*find_effect("shanmugam"), g,
                 joined({{"far", "off"}, {"bias", "0"}, {"radius", text}, {"near_radius", text}}, settings), {});
  double sum = 0.0;
  for (int y = kSide / 2 - 8; y < kSide / 2 + 8; ++y) sum += 1.0 - image.plane("ao").at(kColumn, y);
  return sum / 16.0;
}

TEST(Shanmugam, NearDiscsHideWhatAWallHides) {
  EXPECT_NEAR(occlusion_in_groove(0.25, {{"samples", "4096"}}), 0.342, 3e-3);
  EXPECT_NEAR(occlusion_in_groove(0.5, {{"samples", "4096"}}), 0.195, 3e-3);
}

// The sum over spheres with the frontal area of the pixels is too dark: they have no cosine at the occluder, here
// cos 45 degrees. [Derived in the README]
TEST(Shanmugam, NearSpheresHideMore) {
  const double k = 0.25, sum = 2.0 / kPi * (std::acosh(1.0 / k) - std::sqrt(1.0 - k * k));
  EXPECT_NEAR(sum, 0.697, 1e-3);
  EXPECT_NEAR(occlusion_in_groove(k, {{"form", "sphere"}, {"samples", "4096"}}), sum * std::sqrt(0.5), 0.01);
}

TEST(Shanmugam, PlanesAreUnoccludedAtAnyTilt) {
  for (const char* form : {"disc", "sphere"})
    for (const double tilt : {0.0, 0.5, 1.0, 1.3, 1.5})
      for (const char* bias : {"0.01", "0"}) {
        const GBuffer g = tilted_plane(96, 64, tilt);
        on_every_target("shanmugam", g, {{"radius", "2"}, {"near_radius", "2"}, {"bias", bias}, {"form", form}},
                        [&](const Image& image) {
                          double min = 1.0;
                          for (int y = 0; y < 64; ++y)
                            for (int x = 0; x < 96; ++x) min = std::min(min, double(image.plane("ao").at(x, y)));
                          EXPECT_GE(min, bias[1] ? 1.0 : 0.999) << tilt << ' ' << form;
                        });
      }
}

/// Returns `ao` of a pixel by the formulas of the README.
double expected_ao(const GBuffer& g, const ShanmugamParams& params, double radius, int px, int py) {
  const Camera& camera = g.info.camera;
  const bool orthographic = camera.projection == Projection::kOrthographic;
  const glm::dvec3 at = position(g, px, py), n = normal(g, px, py);
  const double depth = -at.z, spread = orthographic ? 1.0 : depth;
  const double radius_px = radius / (spread * (double(camera.right) - camera.left) / g.info.width);
  const int x = px & 3, y = py & 3;
  const int turn = (((x + y) & 3) << 2) + x, step = (((y - x) & 3) << 2) + (((x >> 1) + (y << 1)) & 3);
  const double start = 2.0 * kPi * (turn + 0.5) / 16.0 - kPi;  // direction_of_turn() subtracts half a turn
  double sum = 0.0;
  double inside = 0.0, whole = 0.0;
  for (int i = 0; i < params.samples; ++i) {
    const double first = std::min(1.0, 0.5 * radius_px);
    const double length = first + (i + (step + 0.5) / 16.0) / params.samples * (radius_px - first);
    whole += length;
    const double angle = start + i * kPi * (3.0 - std::sqrt(5.0));
    const double dx = px + 0.5 + length * std::cos(angle), dy = py + 0.5 - length * std::sin(angle);
    if (dx < 0.0 || dy < 0.0 || dx >= g.info.width || dy >= g.info.height) continue;
    inside += length;
    const int column = int(dx), row = int(dy);
    if (!std::isfinite(g.layers[0].planes[0].at(column, row))) continue;
    const glm::dvec3 tap = position(g, column, row), v = tap - at, tap_normal = normal(g, column, row);
    const double d = glm::length(v);
    if (d >= radius || d == 0.0) continue;
    const double cosine = std::max(0.0, glm::dot(n, v) / d - params.bias);
    const double ratio = orthographic ? 1.0 : tap.z / at.z;
    const double ring = 2.0 * kPi * length * (radius_px - first) / params.samples;  // square pixels
    const double area = ring * radius * radius / (radius_px * radius_px) * ratio * ratio;
    if (params.form == kShanmugamSphere) {
      const double r = std::sqrt(area / kPi);
      sum += 2.0 * (1.0 - std::cos(std::asin(std::min(1.0, r / d)))) * cosine;
    } else {
      const double to_eye = orthographic ? tap_normal.z : glm::dot(tap_normal, tap / tap.z);
      const double behind = area / std::max(0.05, to_eye), facing = -glm::dot(tap_normal, v) / d;
      const double hidden = behind / (kPi * d * d + 0.25 * behind) * (facing > 0.0 ? facing : -params.behind * facing);
      sum += std::min(1.0, hidden) * cosine;
    }
  }
  return 1.0 - std::clamp(sum * whole / inside, 0.0, 1.0);
}

TEST(Shanmugam, NearPartMatchesItsFormulas) {
  const Effect& effect = *find_effect("shanmugam");
  for (const bool orthographic : {false, true})
    for (const Settings& base :
         {Settings{}, Settings{{"form", "sphere"}}, Settings{{"samples", "37"}, {"behind", "1"}, {"bias", "0.1"}}}) {
      const Settings settings = joined({{"far", "off"}, {"radius", "0.6"}, {"near_radius", "2"}}, base);
      const GBuffer g = waves(128, 96, orthographic);
      const ParameterBytes params = parameters_of(effect, settings);
      on_every_target("shanmugam", g, settings, [&](const Image& image) {
        expect_matches_formula(g, image.plane("ao"), 0.9, 300,
                               [&](int x, int y) { return expected_ao(g, as<ShanmugamParams>(params), 0.6, x, y); });
      });
    }
}

}  // namespace
}  // namespace umbrage
