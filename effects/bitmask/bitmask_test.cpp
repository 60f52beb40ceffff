// Tests `bitmask` against quadrature and closed forms (infinite walls at several tilts of the camera, corners, slabs,
// spheres, the light of a wall), and tests what its result must not depend on.
#include "effects/bitmask/bitmask.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <numbers>
#include <random>

#include "effects/bitmask/bitmask_test_scenes.h"
#include "generators/builtin.h"
#include "run_effect.h"
#include "scene/framing.h"
#include "support.h"

namespace umbrage {
namespace {

using test::camera_of;
using test::floor_from_above;
using test::joined;
using test::kFineSettings;
using test::kInfinity;
using test::kPi;
using test::kRadian;
using test::kSide;
using test::mean_values_at_middle;
using test::picture;
using test::Settings;
using test::view_ray_of;
using test::ViewRay;
using test::Wall;

// ---- infinite walls

constexpr int kWallSide = 2049;       // width and height; only the middle pixel is tested
constexpr double kWallDepth = 5.0;    // depth of the middle pixel
constexpr double kGapRadius = 850.0;  // radius of empty pixels around it; beyond, the angle of one pixel is negligible

/// Returns a G-buffer of a surface in the middle pixel, and of a wall that rises from this surface at an elevation. The
/// surface is seen at a tilt from its normal; if the tilt is above 0, the camera looks towards the wall.
GBuffer wall_picture(double elevation_deg, double tilt_deg, bool orthographic) {
  const double tilt = tilt_deg * kRadian, elevation = elevation_deg * kRadian;
  // The crease between surface and wall is perpendicular to x and to the view ray. The wall is on the side of +x; the
  // camera is tilted from the normal to the other side.
  const glm::dvec3 normal(std::sin(tilt), 0.0, std::cos(tilt)), along(std::cos(tilt), 0.0, -std::sin(tilt));
  const glm::dvec3 up_the_wall = std::cos(elevation) * along + std::sin(elevation) * normal;
  const glm::dvec3 wall_normal = std::cos(elevation) * normal - std::sin(elevation) * along;
  const glm::dvec3 middle(0.0, 0.0, -kWallDepth);
  const Camera camera = camera_of(orthographic, 0.5, kWallSide, kWallSide);
  GBuffer g = picture(kWallSide, kWallSide, camera,
                      {{middle, wall_normal, [=](glm::dvec3 p) { return glm::dot(p - middle, up_the_wall) > 0.0; }}});
  const int m = kWallSide / 2;
  for (int y = 0; y < kWallSide; ++y)
    for (int x = 0; x < kWallSide; ++x)
      if ((x - m) * (x - m) + (y - m) * (y - m) < kGapRadius * kGapRadius) g.layers[0].planes[0].at(x, y) = kInfinity;
  g.layers[0].planes[0].at(m, m) = float(kWallDepth);
  for (int k = 0; k < 3; ++k) g.layers[0].planes[1 + k].at(m, m) = float(normal[k]);
  return g;
}

const Settings kExactSettings = {{"slices", "64"}, {"steps", "512"},   {"distribution", "3"}, {"mips", "off"},
                                 {"radius", "2"},  {"border", "open"}, {"slope", "1e-6"},     {"thickness", "1e2"}};

TEST(Bitmask, WallsMatchTheMeasures) {
  // The expected values are by quadrature.
  struct Row {
    double elevation_deg, tilt_deg, exact, uniform, sectors;
  };
  for (const Row& row : {Row{30, 0, .9330, .8905, .9647}, Row{30, 75, .9330, .8335, .9263},
                         Row{60, 0, .7500, .7560, .8432}, Row{90, 60, .5000, .6466, .6561}}) {
    SCOPED_TRACE(fmt::format("wall of {} degrees, camera tilted by {}", row.elevation_deg, row.tilt_deg));
    const GBuffer g = wall_picture(row.elevation_deg, row.tilt_deg, false);
    const auto ao = [&](const Settings& settings) {
      return mean_values_at_middle(g, joined(kExactSettings, settings), {"ao"})[0];
    };
    EXPECT_NEAR(ao({{"measure", "exact"}}), row.exact, 1e-3);
    EXPECT_NEAR(ao({{"measure", "exact"}, {"mode", "infinite"}}), row.exact, 1e-3) << "by the horizon";
    EXPECT_NEAR(ao({{"measure", "uniform"}}), row.uniform, 1e-3);
    EXPECT_NEAR(ao({{"measure", "sectors"}}), row.sectors, 1e-3);
  }
}

TEST(Bitmask, MeanOpenDirectionBesideAWall) {
  // Cosine-weighted mean over a quarter of a sphere: 2/3 away from the wall, pi/3 along the normal.
  const double length = std::hypot(2.0 / 3.0, kPi / 3.0);
  for (const double tilt : {20.0, 45.0, 70.0}) {
    const auto bent = mean_values_at_middle(wall_picture(90, tilt, false), joined(kExactSettings, {{"bent", "on"}}),
                                            {"bent.x", "bent.y", "bent.z"});
    const double s = std::sin(tilt * kRadian), c = std::cos(tilt * kRadian);
    EXPECT_NEAR(bent[0], (s * kPi / 3.0 - c * 2.0 / 3.0) / length, 0.02) << tilt;
    EXPECT_NEAR(bent[1], 0.0, 0.01) << tilt;
    EXPECT_NEAR(bent[2], (c * kPi / 3.0 + s * 2.0 / 3.0) / length, 0.02) << tilt;
  }
}

TEST(Bitmask, LightOfAWallIsExact) {
  for (const auto& [elevation, tilt] : {std::pair{90.0, 20.0}, {90.0, 45.0}, {90.0, 70.0}, {60.0, 0.0}, {60.0, 60.0}}) {
    GBuffer g = wall_picture(elevation, tilt, false);
    for (const char* name : {"direct.r", "direct.g", "direct.b"}) {
      Plane light(kWallSide, kWallSide, name == std::string("direct.g") ? 2.0f : 0.5f);
      g.layers[0].add(name) = std::move(light);
    }
    const auto light = mean_values_at_middle(g, joined(kExactSettings, {{"bleeding", "1"}}),
                                             {"indirect.r", "indirect.g", "indirect.b", "ao"});
    const double fraction = (1.0 - std::cos(elevation * kRadian)) / 2.0;
    EXPECT_NEAR(light[0] / (0.5 * fraction), 1.0, 0.01) << elevation << ' ' << tilt;
    EXPECT_NEAR(light[1] / (2.0 * fraction), 1.0, 0.01) << elevation << ' ' << tilt;
    EXPECT_NEAR(light[2] / (0.5 * fraction), 1.0, 0.01) << elevation << ' ' << tilt;
    EXPECT_NEAR(light[3], 1.0 - fraction, 2e-3) << elevation << ' ' << tilt;
  }
}

/// Returns the mean of a function of (x, z), in the frame of a floor, over the cosine-weighted open directions beside a
/// wall towards +x, as a part of that of all directions. By quadrature.
double mean_beside_wall(double elevation_deg, const std::function<double(double, double)>& function) {
  constexpr int kSteps = 1000;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i)
    for (int k = 0; k < kSteps; ++k) {
      const double azimuth = 2.0 * kPi * (k + 0.5) / kSteps, sine2 = (i + 0.5) / kSteps;
      const double x = std::sqrt(sine2) * std::cos(azimuth), z = std::sqrt(1.0 - sine2);
      const bool is_open = std::atan2(z, x) > elevation_deg * kRadian;
      if (is_open) sum += function(x, z);
    }
  return sum / (kSteps * kSteps);
}

TEST(Bitmask, OpenDirectionsTakeTheirOwnAmbientLight) {
  // Radiance 0.5 + 0.5 x in red, 0.2 + 0.8 z in green, x z + x^2 in blue, in the frame of the floor.
  constexpr double kElevation = 60.0;
  const auto radiance = [](int channel, double x, double z) {
    return channel == 0 ? 0.5 + 0.5 * x : channel == 1 ? 0.2 + 0.8 * z : x * z + x * x;
  };
  EXPECT_NEAR(mean_beside_wall(kElevation, [&](double x, double z) { return radiance(0, x, z); }), 0.2954, 1e-3);
  EXPECT_NEAR(mean_beside_wall(kElevation, [&](double x, double z) { return radiance(1, x, z); }), 0.5791, 1e-3);
  for (const double tilt : {0.0, 45.0, 75.0}) {
    GBuffer g = wall_picture(kElevation, tilt, false);
    const double s = std::sin(tilt * kRadian), c = std::cos(tilt * kRadian);
    const glm::vec3 x(c, 0.0f, -s), z(s, 0.0f, c);  // axes of the floor in view space
    const auto symmetric = [](glm::vec3 a, glm::vec3 b) {
      return 0.5f * (glm::outerProduct(a, b) + glm::outerProduct(b, a));
    };
    // Irradiance has 2/3 of the first degree of radiance, and 1/4 of the second.
    const glm::vec3 first[] = {0.5f * x, 0.8f * z, glm::vec3(0.0f)};
    const glm::mat3 second[] = {glm::mat3(0.0f), glm::mat3(0.0f), symmetric(x, z) + symmetric(x, x)};
    for (int channel = 0; channel < 3; ++channel) {
      glm::mat4 m(0.25f * second[channel]);
      m[3][3] = 0.0f;
      for (int k = 0; k < 3; ++k) m[3][k] = m[k][3] = first[channel][k] / 3.0f;
      g.info.ambient_shape.by_color[std::size_t(channel)] = m;
    }
    const auto light = mean_values_at_middle(g, joined(kExactSettings, {{"directional", "1"}}),
                                             {"indirect.r", "indirect.g", "indirect.b", "ao"});
    EXPECT_NEAR(light[3], 0.75, 2e-3);
    for (int channel = 0; channel < 3; ++channel) {
      const auto of_channel = [&](double u, double w) { return radiance(channel, u, w); };
      // The light of all directions, times visibility, is what `composite` adds.
      const double expected = mean_beside_wall(kElevation, of_channel) - 0.75 * mean_beside_wall(0.0, of_channel);
      EXPECT_NEAR(light[std::size_t(channel)], expected, 3e-3) << tilt << ' ' << channel;
    }
  }
}

// ---- planes

TEST(Bitmask, PlanesAreUnoccludedAtEveryTilt) {
  for (const bool orthographic : {false, true})
    for (const double tilt_deg : {0.0, 35.0, 70.0, 84.0}) {
      const double tilt = tilt_deg * kRadian, azimuth = 0.6;
      const glm::dvec3 normal(std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth), std::cos(tilt));
      const Camera camera = camera_of(orthographic, 4.0, 157, 123);
      const GBuffer g = picture(157, 123, camera, {{{0.0, 0.0, -5.0}, normal}});
      for (const Settings& settings :
           {Settings{}, Settings{{"mode", "infinite"}}, Settings{{"measure", "uniform"}},
            Settings{{"noise", "hash"}, {"slices", "3"}}, Settings{{"mode", "layers"}}, Settings{{"bent", "on"}}})
        test::on_every_target("bitmask", g, joined(settings, {{"radius", "1.5"}}), [&](const Image& image) {
          const Plane& ao = image.plane("ao");
          long wrong = 0;
          for (int y = 0; y < ao.height; ++y)
            for (int x = 0; x < ao.width; ++x) wrong += std::fabs(ao.at(x, y) - 1.0f) > 1e-6f;
          EXPECT_EQ(wrong, 0) << "tilt " << tilt_deg << (orthographic ? ", no perspective, " : ", ")
                              << (settings.empty() ? "" : settings[0].second);
        });
    }
}

// ---- closed forms

TEST(Bitmask, FloorInFrontOfAStep) {
  // At the distance a from an infinitely long step of height h, the visibility is 1/2 (1 + a / sqrt(a^2 + h^2)). The
  // tolerance allows for pixels of 0.006 units and for the end of the picture at 2.5 units.
  for (const double high : {0.2, 0.5, 1.0}) {
    const double distance = 0.4;
    const GBuffer g = floor_from_above([&](double x, double) { return x > distance ? high : 0.0; });
    const double expected = 0.5 * (1.0 + distance / std::hypot(distance, high));
    for (const Settings& settings : {Settings{}, Settings{{"mode", "infinite"}}}) {
      const auto ao = mean_values_at_middle(
          g, joined(joined(kFineSettings, {{"radius", "9"}, {"border", "open"}}), settings), {"ao"});
      EXPECT_NEAR(ao[0], expected, 6e-3) << high << (settings.empty() ? "" : " infinite");
    }
  }
}

TEST(Bitmask, FloorUnderASlabOfKnownThickness) {
  // An infinitely long slab extends from x = a to b and from h to h + t above the floor. It covers the angles from its
  // far lower edge to its near upper edge, weighted by the cosine.
  const double a = 0.3, b = 0.7, h = 0.4, t = 0.25;
  const GBuffer g = floor_from_above([&](double x, double) { return x > a && x < b ? h + t : 0.0; });
  const double low = std::atan2(h, b), high = std::atan2(h + t, a);
  const double expected = 1.0 - (std::cos(low) - std::cos(high)) / 2.0;
  const auto ao = mean_values_at_middle(
      g, joined(kFineSettings, {{"radius", "5"}, {"thickness", std::to_string(t / 5.0)}, {"border", "open"}}), {"ao"});
  EXPECT_NEAR(ao[0], expected, 6e-3);
  const auto endless = mean_values_at_middle(g, joined(kFineSettings, {{"radius", "5"}, {"border", "open"}}), {"ao"});
  EXPECT_LT(endless[0], expected - 0.05) << "a slab of infinite thickness also occludes what is below it";
}

TEST(Bitmask, SphereOnAFloorInThreeLayers) {
  // A sphere of radius r that rests on the floor at a distance d from the middle occludes r^3 / (r^2 + d^2)^1.5. Its
  // lower half is the second layer, the floor below it the third; both are assumed to be thin.
  for (const double distance : {0.5, 0.8, 1.2}) {
    const double r = 0.4;
    const auto half = [&](double x, double y) { return r * r - (x - distance) * (x - distance) - y * y; };
    GBuffer g =
        floor_from_above([&](double x, double y) { return half(x, y) > 0.0 ? r + std::sqrt(half(x, y)) : 0.0; });
    for (int layer = 1; layer <= 2; ++layer) {
      Image image(kSide, kSide);
      Plane& depth = image.add("depth");
      for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
          const ViewRay ray = view_ray_of(g.info.camera, kSide, kSide, x, y);
          const double inside = half(ray.origin.x, ray.origin.y);
          const double height = layer == 1 ? r - std::sqrt(std::max(inside, 0.0)) : 0.0;
          depth.at(x, y) = inside > 0.0 ? float(5.0 - height) : kInfinity;
        }
      g.layers.push_back(std::move(image));
      g.info.more_layers.push_back({LayerKind::kBehind, layer - 1, {}});
    }
    const double expected = 1.0 - std::pow(r * r / (r * r + distance * distance), 1.5);
    const Settings settings =
        joined(kFineSettings, {{"radius", "2"}, {"mode", "layers"}, {"thickness", "0.0075"}, {"border", "open"}});
    GBuffer flat = g;
    flat.layers.resize(1);
    for (int layer = 1; layer <= 2; ++layer) {
      Plane depth = g.layers[std::size_t(layer)].planes[0];
      flat.layers[0].add(layer_plane(layer, "depth")) = std::move(depth);
    }
    const auto ao = mean_values_at_middle(flat, settings, {"ao"});
    EXPECT_NEAR(ao[0], expected, 6e-3) << distance;
  }
}

// ---- invariances

double mean_ao(const GBuffer& g, const Settings& settings) {
  const Image image = test::run_effect(*find_effect("bitmask"), g, settings, {});
  const Plane &ao = image.plane("ao"), &depth = g.layers[0].plane("depth");
  double sum = 0.0;
  long count = 0;
  for (int y = 0; y < ao.height; ++y)
    for (int x = 0; x < ao.width; ++x)
      if (std::isfinite(depth.at(x, y))) {
        sum += ao.at(x, y);
        ++count;
      }
  return sum / double(count);
}

/// Returns depth and normals of the device's scene as `camera` sees it.
GBuffer captured(Device& device, int width, int height, const Camera& camera) {
  const auto frame = device.capture(camera, {.width = width, .height = height, .shadows = 0});
  GBuffer g;
  g.info = frame->info;
  g.layers.push_back(*device.download(*frame, {"depth", "normal.x", "normal.y", "normal.z"}));
  return g;
}

TEST(Bitmask, ResolutionAndScaleDoNotMatter) {
  const auto device = make_cpu_device({});
  for (const char* name : {"solids", "room"}) {
    const auto scene = make_builtin_scene(fmt::format("scene:{}?detail=20000", name));
    ASSERT_TRUE(scene);
    ASSERT_TRUE(device->prepare(*scene));
    const Camera camera = frame_scene(*scene, {}, 512, 384);
    GBuffer whole = captured(*device, 512, 384, camera);
    const double mean = mean_ao(whole, {});
    EXPECT_LT(mean, 0.97) << name;
    EXPECT_NEAR(mean_ao(captured(*device, 256, 192, camera), {}), mean, 0.005) << name;
    for (const float scale : {0.01f, 100.0f}) {
      GBuffer scaled = whole;
      Plane& depth = scaled.layers[0].plane("depth");
      for (int y = 0; y < depth.height; ++y)
        for (int x = 0; x < depth.width; ++x) depth.at(x, y) *= scale;
      scaled.info.scene_radius *= scale;
      EXPECT_NEAR(mean_ao(scaled, {}), mean, 1e-4) << name << " times " << scale;
    }
  }
}

TEST(Bitmask, TiltOfTheCameraDoesNotMatter) {
  for (const double tilt : {-20.0, 0.0, 25.0, 50.0, 75.0}) {
    GBuffer g = wall_picture(40, tilt, false);
    EXPECT_NEAR(mean_values_at_middle(g, joined(kExactSettings, {{"mode", "infinite"}}), {"ao"})[0],
                (1.0 + std::cos(40 * kRadian)) / 2.0, 2e-3)
        << tilt;
  }
}

TEST(Bitmask, OrthographicMatchesADistantPerspective) {
  const double far = 2000.0;
  const std::vector<Wall> near_walls = {{{0, 0, -6}, {0, 0, 1}},
                                        {{0.3, 0, -5.4}, glm::normalize(glm::dvec3(-1, 0.2, 0.4))}};
  std::vector<Wall> far_walls = near_walls;
  for (Wall& wall : far_walls) wall.point.z -= far;
  const Camera parallel = camera_of(true, 2.0, 160, 120);
  Camera perspective = parallel;
  perspective.projection = Projection::kPerspective;
  for (float* side : {&perspective.left, &perspective.right, &perspective.bottom, &perspective.top})
    *side /= float(far + 6.0);
  const Settings settings = {{"radius", "0.5"}, {"slices", "8"}, {"steps", "32"}};
  GBuffer a = picture(160, 120, parallel, near_walls), b = picture(160, 120, perspective, far_walls);
  // Floats near 2000 have a spacing of 1e-4, so both pictures use the same rounded depths.
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 160; ++x) a.layers[0].planes[0].at(x, y) = b.layers[0].planes[0].at(x, y);
  EXPECT_LT(mean_ao(a, settings), 0.98);
  EXPECT_NEAR(mean_ao(a, settings), mean_ao(b, settings), 1e-3);
}

TEST(Bitmask, PixelsOutsideThePictureAreLeftOut) {
  // A valley seen from above. The picture is cut at the bottom of the valley, so that the missing half mirrors the
  // visible one.
  const GBuffer whole = floor_from_above([](double x, double) { return std::fabs(x); }, {0, 0, 1});
  GBuffer half;
  half.info = whole.info;
  const int cut = kSide / 2;
  half.info.width = kSide - cut;
  half.info.camera.left += (half.info.camera.right - half.info.camera.left) * float(cut) / kSide;
  half.layers.emplace_back(kSide - cut, kSide);
  for (std::size_t p = 0; p < whole.layers[0].planes.size(); ++p) {
    Plane& plane = half.layers[0].add(whole.layers[0].names[p]);
    for (int y = 0; y < plane.height; ++y)
      for (int x = 0; x < plane.width; ++x) plane.at(x, y) = whole.layers[0].planes[p].at(x + cut, y);
  }
  const auto at_valley = [](const GBuffer& g, int column, const char* border) {
    const Image image = test::run_effect(*find_effect("bitmask"), g,
                                         {{"radius", "0.5"}, {"slices", "8"}, {"steps", "16"}, {"border", border}}, {});
    double sum = 0.0;
    for (int y = 350; y < 450; ++y) sum += image.plane("ao").at(column, y) / 100.0;
    return sum;
  };
  const double expected = at_valley(whole, cut, "skip");
  EXPECT_LT(expected, 0.85);
  EXPECT_NEAR(at_valley(half, 0, "skip"), expected, 0.01);
  EXPECT_GT(at_valley(half, 0, "open"), expected + 0.08);
}

TEST(Bitmask, PixelsAtTheBorderGetNoMoreLightThanIsEmitted) {
  // On a surface seen edge-on, all directions of some slices are on one side, which is outside at the border.
  const int width = 96, height = 64;
  GBuffer g = picture(width, height, camera_of(false, 4.0, width, height), {});
  std::mt19937 random(1);
  std::uniform_real_distribution<float> fraction(0.0f, 1.0f);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      g.layers[0].planes[0].at(x, y) = 5.0f + fraction(random);
      const float azimuth = 2.0f * float(std::numbers::pi) * fraction(random), up = 0.2f * fraction(random);
      g.layers[0].planes[1].at(x, y) = std::sqrt(1.0f - up * up) * std::cos(azimuth);
      g.layers[0].planes[2].at(x, y) = std::sqrt(1.0f - up * up) * std::sin(azimuth);
      g.layers[0].planes[3].at(x, y) = up;
    }
  for (const char* name : {"direct.r", "direct.g", "direct.b"}) g.layers[0].add(name) = Plane(width, height, 1.0f);
  for (const char* slices : {"1", "2"})
    for (int sample = 0; sample < 16; ++sample) {
      const Image image = test::run_effect(*find_effect("bitmask"), g,
                                           {{"radius", "4"},
                                            {"slices", slices},
                                            {"steps", "12"},
                                            {"bleeding", "1"},
                                            {"sample_index", std::to_string(sample)}},
                                           {});
      const Plane& light = image.plane("indirect.g");
      // The factor 2: a bit may be counted on the other side.
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) ASSERT_LE(light.at(x, y), 2.0f) << x << ' ' << y << ' ' << sample;
    }
}

TEST(Bitmask, AmbientLightOfAllDirectionsAlikeStaysAsItIs) {
  GBuffer g = test::bumpy_gbuffer(96, 64, 3);
  for (glm::mat4& shape : g.info.ambient_shape.by_color) {
    shape = glm::mat4(0.25f);  // of a unit vector: a constant
    shape[3][3] = 0.0f;
  }
  for (const char* border : {"skip", "open"})
    for (const char* measure : {"exact", "uniform", "sectors"}) {
      const Settings settings = {
          {"directional", "1"}, {"border", border}, {"measure", measure}, {"radius", "4"}, {"thickness", "1"}};
      const Image image = test::run_effect(*find_effect("bitmask"), g, settings, {});
      const Plane &light = image.plane("indirect.g"), &ao = image.plane("ao");
      double min_ao = 1.0;
      for (int y = 0; y < light.height; ++y)
        for (int x = 0; x < light.width; ++x) {
          ASSERT_NEAR(light.at(x, y), 0.0f, 1e-4f) << x << ' ' << y << ' ' << border << ' ' << measure;
          min_ao = std::min(min_ao, double(ao.at(x, y)));
        }
      EXPECT_LT(min_ao, 0.5) << "nothing is occluded";
    }
}

TEST(Bitmask, SampleIndicesAverageToLessNoise) {
  const GBuffer g = floor_from_above([](double x, double y) { return 0.1 * std::sin(9.0 * x) * std::cos(7.0 * y); });
  const auto ao = [&](const Settings& settings) {
    return test::run_effect(*find_effect("bitmask"), g, joined({{"radius", "0.3"}}, settings), {}).plane("ao");
  };
  const Plane fine = ao({{"slices", "32"}, {"steps", "8"}});
  Plane mean(kSide, kSide, 0.0f);
  double first_error = 0.0;
  constexpr int kSamples = 8;
  for (int sample = 0; sample < kSamples; ++sample) {
    const Plane plane = ao({{"sample_index", std::to_string(sample)}});
    if (sample == 0) first_error = test::difference(plane, fine, 1.0).mean;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) mean.at(x, y) += plane.at(x, y) / kSamples;
  }
  EXPECT_LT(test::difference(mean, fine, 1.0).mean, 0.45 * first_error);
}

}  // namespace
}  // namespace umbrage
