// Compares `toon` with listing 2 of [Lajzer and Nottingham] in double, and tests spheres and faces with known tone
// steps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "run_effect.h"
#include "support.h"
#include "tilted_plane.h"

namespace umbrage {
namespace {

using namespace test;

const Settings kNoAmbient = {{"ambient", "0"}, {"extra", "0"}};

// ---- pictures
// --------------------------------------------------------------------------------------------------------

void set_normal(GBuffer& g, int x, int y, glm::dvec3 normal) {
  for (int c = 0; c < 3; ++c) g.layers[0].plane(kNormal[c]).at(x, y) = float(normal[c]);
}

/// Returns a white face in an orthographic view; all pixels are identical.
GBuffer face(int width, int height, glm::vec3 normal, float depth = 5.0f) {
  GBuffer g = test::empty_gbuffer(width, height);
  g.info.camera = orthographic_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 3.0f, float(width) / float(height));
  g.info.lights = {{.direction = {0, 0, 1}, .color = glm::vec3(0.7f)}};
  Image& image = g.layers[0];
  image.add("depth") = Plane(width, height, depth);
  for (int c = 0; c < 3; ++c) image.add(kNormal[c]) = Plane(width, height, normal[c]);
  for (const char* name : {"albedo.r", "albedo.g", "albedo.b", "shadow", "ao"})
    image.add(name) = Plane(width, height, 1.0f);
  return g;
}

constexpr int kSphereSize = 256;
constexpr double kSphereRadius = 110.0;  // pixels
const glm::dvec3 kSphereLight = glm::normalize(glm::dvec3(0.5, 0.4, 0.6));

/// Returns the normal of the sphere at a position in the picture, in pixels; zero outside.
glm::dvec3 sphere_normal(double x, double y) {
  const double u = (x - 0.5 * kSphereSize) / kSphereRadius, v = (0.5 * kSphereSize - y) / kSphereRadius;
  const double squared = u * u + v * v;
  return squared < 1.0 ? glm::dvec3(u, v, std::sqrt(1.0 - squared)) : glm::dvec3(0.0);
}

/// Returns a white sphere in an orthographic view, lit from the upper right.
GBuffer sphere() {
  GBuffer g = face(kSphereSize, kSphereSize, {0, 0, 1});
  g.info.lights[0].direction = glm::vec3(kSphereLight);
  const double radius = kSphereRadius * 3.0 / kSphereSize;  // the view is 3 high
  for (int y = 0; y < kSphereSize; ++y)
    for (int x = 0; x < kSphereSize; ++x) {
      const glm::dvec3 n = sphere_normal(x + 0.5, y + 0.5);
      set_normal(g, x, y, n);
      g.layers[0].plane("depth").at(x, y) =
          n.z > 0.0 ? float(5.0 - radius * n.z) : std::numeric_limits<float>::infinity();
    }
  return g;
}

glm::dvec3 position_of(const PictureInfo& info, int x, int y, double depth) {
  const Camera& c = info.camera;
  const double u = c.left + (x + 0.5) / info.width * (double(c.right) - c.left);
  const double v = c.top - (y + 0.5) / info.height * (double(c.top) - c.bottom);
  const double spread = c.projection == Projection::kPerspective ? depth : 1.0;
  return {u * spread, v * spread, -depth};
}

glm::dvec3 to_light(const PictureInfo& info, const Light& light, const glm::dvec3& position) {
  const bool perspective = info.camera.projection == Projection::kPerspective;
  if (light.kind == LightKind::kPoint) return glm::normalize(glm::dvec3(light.position) - position);
  if (light.kind == LightKind::kHead) return perspective ? -glm::normalize(position) : glm::dvec3(0, 0, 1);
  return light.direction;
}

/// Returns bumps with random occlusion and without shadow.
GBuffer bumps(bool perspective, unsigned seed) {
  GBuffer g = test::bumpy_gbuffer(131, 97, seed);
  if (!perspective) g.info.camera = orthographic_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 3.0f, 131.0f / 97.0f);
  Image& image = g.layers[0];
  image.plane("shadow") = Plane(131, 97, 1.0f);
  image.add("ao");
  for (int y = 0; y < 97; ++y)
    for (int x = 0; x < 131; ++x) image.plane("ao").at(x, y) = float(test::hash(seed + 131u * y + x) >> 8) * 0x1p-24f;
  return g;
}

/// Returns the intensity at a pixel, with this strength of the shadow.
float intensity_at(const Image& out, int x, int y, float shadow = 1.0f) {
  const float visible = 1.0f + shadow * (out.plane("toon_visible").at(x, y) - 1.0f);
  return out.plane("toon_key").at(x, y) * visible + out.plane("toon_rest").at(x, y);
}

// ---- listing 2
// -----------------------------------------------------------------------------------------------

struct Listing {
  double intensity;  // before quantization
  double cut;        // floor(4 i) / 4
};

/// Returns the result of listing 2, ported literally, in double.
Listing listing_2(glm::dvec3 n, glm::dvec3 l, double ao, double specular_exp) {
  const glm::dvec3 nn = glm::normalize(n), nl = glm::normalize(l);
  const glm::dvec3 nh = glm::normalize(nl + glm::dvec3(0.0, 0.0, 1.0));
  double intensity = (std::max(0.0, glm::dot(nn, nl)) + 0.1) * ao + 0.2;
  if (intensity >= 0.0 && specular_exp > 1.0) intensity += std::pow(std::max(0.0, glm::dot(nn, nh)), specular_exp);
  return {intensity, std::floor(intensity * 4.0) / 4.0};
}

TEST(Toon, PaperModeIsListing2) {
  const Light lights[] = {{.direction = glm::normalize(glm::vec3(-1.0f, 2.0f, 1.5f)), .color = glm::vec3(0.7f)},
                          {.kind = LightKind::kPoint, .position = {0.5f, 1.5f, -0.5f}, .reach = 3.0f},
                          {.kind = LightKind::kHead}};
  unsigned seed = 0;
  for (const Light& light : lights)
    for (const bool perspective : {true, false}) {
      GBuffer g = bumps(perspective, ++seed);
      g.info.lights = {light, {.direction = {0, 0, 1}}};  // the paper has one light: the second is ignored
      Image& image = g.layers[0];
      image.plane("specular") = Plane(131, 97, 0.3f);
      for (int y = 0; y < 97; ++y)
        for (int x = 0; x < 131; x += 3) image.plane("shininess").at(x, y) = 1.0f;  // no highlight
      test::on_every_target("toon", g, {{"mode", "paper"}}, [&](const Image& out) {
        long compared = 0, flips = 0, wrong = 0;
        std::map<double, long> steps;
        for (int y = 0; y < 97; ++y)
          for (int x = 0; x < 131; ++x) {
            const double depth = image.plane("depth").at(x, y);
            if (!std::isfinite(depth)) continue;
            glm::dvec3 n;
            for (int c = 0; c < 3; ++c) n[c] = image.plane(kNormal[c]).at(x, y);
            const Listing expected = listing_2(n, to_light(g.info, light, position_of(g.info, x, y, depth)),
                                               image.plane("ao").at(x, y), image.plane("shininess").at(x, y));
            const double to_edge = std::fabs(expected.intensity * 4.0 - std::round(expected.intensity * 4.0));
            const double allowed = to_edge < 4e-4 ? 0.25 + 1e-6 : 1e-6;
            flips += to_edge < 4e-4;
            ++compared;
            ++steps[expected.cut];
            for (int c = 0; c < 3; ++c)
              wrong += !(std::fabs(out.plane(kLit[c]).at(x, y) - expected.cut * image.plane(kAlbedo[c]).at(x, y)) <=
                         allowed);
          }
        EXPECT_EQ(wrong, 0);
        EXPECT_GT(compared, 5000);
        EXPECT_LE(flips, compared / 200);
        EXPECT_GE(steps.size(), 6u);
      });
    }
}

TEST(Toon, IntensityAddsLightsRelativeToTheKeyLight) {
  GBuffer g = bumps(true, 9);
  g.info.lights = {
      {.direction = glm::normalize(glm::vec3(-1.0f, 2.0f, 3.0f)), .color = glm::vec3(0.8f)},
      {.kind = LightKind::kPoint, .position = {0.5f, 1.5f, -0.5f}, .color = glm::vec3(0.4f), .reach = 3.0f},
      {.kind = LightKind::kHead, .color = glm::vec3(0.2f)}};
  const double fraction[] = {1.0, 0.5, 0.25};
  test::on_every_target("toon", g, {{"ambient", "0.3"}, {"extra", "0.05"}, {"smoothness", "0"}}, [&](const Image& out) {
    double worst = 0.0;
    for (int y = 0; y < 97; ++y)
      for (int x = 0; x < 131; ++x) {
        const double depth = g.layers[0].plane("depth").at(x, y);
        if (!std::isfinite(depth)) continue;
        const glm::dvec3 position = position_of(g.info, x, y, depth);
        glm::dvec3 n;
        for (int c = 0; c < 3; ++c) n[c] = g.layers[0].plane(kNormal[c]).at(x, y);
        double sum = 0.3;
        for (int k = 0; k < 3; ++k) {
          const double reach = g.info.lights[k].reach;
          const double falloff =
              reach > 0.0 ? std::pow(reach / glm::distance(glm::dvec3(g.info.lights[k].position), position), 2.0) : 1.0;
          sum += fraction[k] * falloff * std::max(0.0, glm::dot(n, to_light(g.info, g.info.lights[k], position)));
        }
        const double expected = sum * g.layers[0].plane("ao").at(x, y) + 0.05;
        worst = std::max(worst, std::fabs(intensity_at(out, x, y) - expected) / (1.0 + expected));
      }
    EXPECT_LE(worst, 3e-6);
  });
}

// ---- tone steps
// ---------------------------------------------------------------------------------------------------

TEST(Toon, SphereHasTheRequestedSteps) {
  const GBuffer g = sphere();
  for (const char* mode : {"ramp", "paper"})
    for (const int steps : {2, 3, 4, 8}) {
      const Settings settings = joined(kNoAmbient, {{"mode", mode}, {"steps", fmt::format("{}", steps)}});
      test::on_every_target("toon", g, settings, [&](const Image& out) {
        // The histogram is fine enough to separate the values at edges from those of tone steps.
        std::map<long, long> histogram;
        long pixels = 0;
        for (int y = 0; y < kSphereSize; ++y)
          for (int x = 0; x < kSphereSize; ++x)
            if (std::isfinite(g.layers[0].plane("depth").at(x, y)))
              ++histogram[std::lround(out.plane("lit.g").at(x, y) * 1e5)], ++pixels;
        int peaks = 0;
        for (const auto& [value, count] : histogram) peaks += count > pixels / 100;
        EXPECT_EQ(peaks, steps) << mode;
      });
    }
}

TEST(Toon, EdgesOfStepsAreAntialiasedWhereTheyBelong) {
  const GBuffer g = sphere();
  for (const int steps : {2, 4}) {
    const Settings settings =
        joined(kNoAmbient, {{"steps", fmt::format("{}", steps)}, {"shadow_g", "0"}, {"smoothness", "0"}});
    test::on_every_target("toon", g, settings, [&](const Image& out) {
      double sum = 0.0, max_away = 0.0, max_error = 0.0;
      long between = 0;
      for (int y = 0; y < kSphereSize; ++y)
        for (int x = 0; x < kSphereSize; ++x) {
          const double r = std::hypot(x + 0.5 - 0.5 * kSphereSize, y + 0.5 - 0.5 * kSphereSize);
          if (r > 0.95 * kSphereRadius) continue;  // near the silhouette a tone step is narrower than a pixel
          const auto scaled = [&](double px, double py) {
            return steps * std::max(0.0, glm::dot(sphere_normal(px, py), kSphereLight));
          };
          const double t = scaled(x + 0.5, y + 0.5);
          const double edge = std::min(std::max(std::round(t), 1.0), steps - 1.0);
          const double slope =
              std::hypot(scaled(x + 1.0, y + 0.5) - scaled(x, y + 0.5), scaled(x + 0.5, y + 1.0) - scaled(x + 0.5, y));
          const double away = slope > 0.0 ? (t - edge) / slope : 1e9;  // distance from the edge, pixels
          const double step = out.plane("lit.g").at(x, y) * (steps - 1.0);
          const double fraction = step - (edge - 1.0);  // fraction of the pixel beyond the edge
          if (std::fabs(away) > 1.0) {
            max_error = std::max(max_error, std::fabs(step - std::min(std::floor(t), steps - 1.0)));
          } else if (fraction > 1e-4 && fraction < 1.0 - 1e-4) {
            sum += fraction - 0.5 - away;
            max_away = std::max(max_away, std::fabs(away));
            ++between;
          }
        }
      EXPECT_LE(max_error, 1e-5) << steps;  // pixels farther than a pixel from an edge have one tone step
      EXPECT_GT(between, 150 * (steps - 1));
      EXPECT_LE(std::fabs(sum) / double(between), 0.1);
      EXPECT_GT(max_away, 0.3);
    });
  }
}

// Smoothing moves the edges on a sphere, which is curved, by a fraction of a pixel.
TEST(Toon, SmoothingLeavesEdgesInPlace) {
  const GBuffer g = sphere();
  for (const int steps : {2, 4}) {
    const Settings settings = joined(kNoAmbient, {{"steps", fmt::format("{}", steps)}, {"shadow_g", "0"}});
    const Image rough = run_effect(*find_effect("toon"), g, joined(settings, {{"smoothness", "0"}}), {});
    test::on_every_target("toon", g, settings, [&](const Image& out) {
      double sum = 0.0, edges = 0.0;
      for (int y = 1; y < kSphereSize; ++y)
        for (int x = 0; x < kSphereSize; ++x) {
          if (std::hypot(x + 0.5 - 0.5 * kSphereSize, y + 0.5 - 0.5 * kSphereSize) > 0.95 * kSphereRadius) continue;
          const Plane& exact = rough.plane("lit.g");
          sum += std::fabs(out.plane("lit.g").at(x, y) - exact.at(x, y));
          edges += std::fabs(exact.at(x, y) - exact.at(x, y - 1));
        }
      EXPECT_LT(sum, 0.4 * edges) << steps;
    });
  }
}

/// Returns the number of connected areas of one tone step with fewer than `max` pixels. Pixels at edges of steps belong
/// to none.
int islands(const Plane& lit, double steps, int max) {
  std::map<std::pair<int, int>, int> open;
  for (int y = 0; y < lit.height; ++y)
    for (int x = 0; x < lit.width; ++x) {
      const double step = lit.at(x, y) * (steps - 1.0);
      if (std::fabs(step - std::round(step)) < 0.02) open[{x, y}] = int(std::lround(step));
    }
  int count = 0;
  while (!open.empty()) {
    const int step = open.begin()->second;
    std::vector<std::pair<int, int>> next = {open.begin()->first};
    open.erase(open.begin());
    int size = 0;
    for (; !next.empty(); ++size) {
      const auto [x, y] = next.back();
      next.pop_back();
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i)
          if (const auto found = open.find({x + i, y + j}); found != open.end() && found->second == step) {
            next.push_back(found->first);
            open.erase(found);
          }
    }
    count += size < max;
  }
  return count;
}

// The bumps of a scan make islands of other tone steps beside the edges of steps, unless light is smoothed.
TEST(Toon, BumpsMakeNoIslands) {
  GBuffer g = sphere();
  for (int y = 0; y < kSphereSize; ++y)
    for (int x = 0; x < kSphereSize; ++x)
      if (const glm::dvec3 n = sphere_normal(x + 0.5, y + 0.5); n.z > 0.0)
        set_normal(g, x, y,
                   glm::normalize(n + 0.09 * glm::dvec3(std::sin(0.9 * x + 2.0 * std::sin(0.31 * y)),
                                                        std::sin(0.8 * y + 2.0 * std::sin(0.27 * x)), 0.0)));
  const Settings settings = joined(kNoAmbient, {{"shadow_g", "0"}, {"steps", "5"}});
  test::on_every_target("toon", g, settings, [&](const Image& out) {
    // The background is an island of its own step, but a large one.
    EXPECT_LE(islands(out.plane("lit.g"), 5.0, 30), 4);
  });
  const Image rough = run_effect(*find_effect("toon"), g, joined(settings, {{"smoothness", "0"}}), {});
  EXPECT_GT(islands(rough.plane("lit.g"), 5.0, 30), 60);
}

// The edge of a shadow is antialiased where it is, and neither wide nor rounded by the smoothing of light.
TEST(Toon, ShadowsHaveEdgesOfAPixel) {
  GBuffer g = face(200, 200, {0, 0, 1});
  const auto edge = [](double y) { return 80.3 + 0.37 * y; };
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) g.layers[0].plane("shadow").at(x, y) = x + 0.5 < edge(y + 0.5) ? 1.0f : 0.0f;
  test::on_every_target("toon", g, joined(kNoAmbient, {{"steps", "2"}, {"shadow_g", "0"}}), [&](const Image& out) {
    for (int y = 8; y < 192; ++y) {
      double lit = 0.0;
      int between = 0;
      for (int x = 0; x < 200; ++x) {
        const double v = out.plane("lit.g").at(x, y);
        lit += v;
        between += v > 0.01 && v < 0.99;
      }
      EXPECT_LE(between, 3) << y;
      EXPECT_NEAR(lit, edge(y + 0.5), 0.6) << y;
    }
  });
}

/// Returns a plane at a grazing angle in ambient light only, so that the intensity depends on `ao`, not on normals.
GBuffer lit_by_ambient(const test::TiltedPlane& plane) {
  GBuffer g = test::seen(plane);
  g.info.lights.clear();
  g.layers[0].add("ao") = Plane(plane.width, plane.height, 1.0f);
  return g;
}

// Settings for four tone steps, from black to white, of an intensity that equals `ao` and is not smoothed.
const Settings kStepsOfAo = {{"steps", "4"},   {"ambient", "1"},   {"extra", "0"},     {"shadow_g", "0"},
                             {"light_g", "1"}, {"albedo", "clay"}, {"smoothness", "0"}};
/// Returns the `ao` at the intensity `step`, in tone steps.
float ao_of_step(double step) { return float(0.5 * step); }

TEST(Toon, StepsOfGrazingPlanesAreAntialiased) {
  // The picture has few rows, so that depth changes by more than a tenth from one to the next.
  const test::TiltedPlane few_rows{.width = 32, .height = 8, .error_deg = 2.0, .roll_rad = 0.0, .depth_ratio = 0.6};
  test::at_grazing_angles(few_rows, [](const test::TiltedPlane& plane) {
    GBuffer g = lit_by_ambient(plane);
    // The intensity rises by a tenth of a step per row; the edge is a fifth of a row above the centre of the fourth
    // row.
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 32; ++x) g.layers[0].plane("ao").at(x, y) = ao_of_step(1.02 + 0.1 * (y - 3));
    test::on_every_target("toon", g, kStepsOfAo, [&](const Image& out) {
      for (int x = 0; x < 32; ++x) EXPECT_NEAR(out.plane("lit.g").at(x, 3) * 3.0, 0.7, 0.01) << x;
    });
  });
}

TEST(Toon, StepsOfGrazingPlanesEndAtEdges) {
  // Up to the depth step, the intensity rises by 1/50 of a tone step per column; at the depth step it jumps. The edge
  // in the last column before that must be as narrow as if there were no jump.
  const test::TiltedPlane step{.width = 256, .height = 256, .step_px = 20.0};
  test::at_grazing_angles(step, [](const test::TiltedPlane& plane) {
    GBuffer g = lit_by_ambient(plane);
    for (int y = 0; y < 256; ++y)
      for (int x = 0; x < 256; ++x)
        g.layers[0].plane("ao").at(x, y) = x < 128 ? ao_of_step(1.004 + 0.02 * (x - 127)) : ao_of_step(1.5);
    test::on_every_target("toon", g, kStepsOfAo, [&](const Image& out) {
      for (int y = 0; y < 256; ++y) ASSERT_NEAR(out.plane("lit.g").at(127, y) * 3.0, 0.7, 0.01) << y;
    });
  });
}

TEST(Toon, ShadowsOnGrazingPlanesHaveSmoothEdgesExceptAtDepthSteps) {
  for (const bool whole : {true, false}) {
    const test::TiltedPlane base{
        .width = 32, .height = 32, .step_px = whole ? 0.0 : 20.0, .error_deg = whole ? 2.0 : 0.0, .roll_rad = 0.0};
    test::at_grazing_angles(base, [&](const test::TiltedPlane& plane) {
      GBuffer g = lit_by_ambient(plane);
      // The light comes from the direction that the plane faces.
      const double angle = plane.angle_deg * std::numbers::pi / 180.0;
      g.info.lights = {{.direction = glm::vec3(0.0, std::sin(angle), std::cos(angle)), .color = glm::vec3(0.7f)}};
      Plane& shadow = g.layers[0].add("shadow") = Plane(32, 32, 0.0f);
      for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) shadow.at(x, y) = (whole ? y < 16 : x < 16) ? 1.0f : 0.0f;
      test::on_every_target("toon", g, kNoAmbient, [&](const Image& out) {
        const Plane& visible = out.plane("toon_visible");
        for (int k = 0; k < 32; ++k) {
          EXPECT_NEAR(whole ? visible.at(k, 15) : visible.at(15, k), whole ? 0.6875 : 1.0, 1e-3) << k;
          EXPECT_NEAR(whole ? visible.at(k, 16) : visible.at(16, k), whole ? 0.3125 : 0.0, 1e-3) << k;
        }
      });
    });
  }
}

TEST(Toon, SoftnessWidensEdges) {
  // Intensity rises by 1/8 of a tone step per pixel; with edges as wide as steps the ramp is straight.
  constexpr int kWidth = 40;
  GBuffer g = face(kWidth, 3, {0, 0, 1});
  for (int x = 0; x < kWidth; ++x)
    for (int y = 0; y < 3; ++y) g.layers[0].plane("ao").at(x, y) = float(x + 0.37) / 32.0f;
  for (const double softness : {0.0, 0.5, 1.0}) {
    const Settings settings =
        joined(kNoAmbient,
               {{"steps", "4"}, {"shadow_r", "0"}, {"smoothness", "0"}, {"softness", fmt::format("{}", softness)}});
    test::on_every_target("toon", g, settings, [&](const Image& out) {
      for (int x = 1; x < kWidth - 1; ++x) {
        const double t = (x + 0.37) / 8.0, width = std::max(0.125, softness);
        double mean = 0.0;
        constexpr int kSteps = 4096;
        for (int k = 0; k < kSteps; ++k)
          mean += std::min(3.0, std::max(0.0, std::floor(t + width * ((k + 0.5) / kSteps - 0.5)))) / kSteps;
        EXPECT_NEAR(out.plane("lit.r").at(x, 1) * 3.0, mean, 1e-3) << x << ' ' << softness;
      }
    });
  }
}

TEST(Toon, NothingSmearsOverSilhouettesAndCreases) {
  // Kinds: 0 a surface in front of another, 1 two faces that meet, 2 a wire one pixel wide in front of a wall.
  constexpr int kWidth = 24;
  const glm::vec3 lit(0, 0, 1), dim = glm::normalize(glm::vec3(1.0f, 0.0f, 0.4f));
  for (const int kind : {0, 1, 2}) {
    GBuffer g = face(kWidth, 5, lit);
    for (int y = 0; y < 5; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const bool second = kind == 2 ? x == 12 : x >= 12;
        if (!second) continue;
        set_normal(g, x, y, dim);
        if (kind != 1) g.layers[0].plane("depth").at(x, y) = 2.0f;
        g.layers[0].plane("shadow").at(x, y) = kind == 2 ? 1.0f : 0.0f;
        for (int c = 0; c < 3; ++c) g.layers[0].plane(kAlbedo[c]).at(x, y) = 0.5f;
      }
    // The first surface is white in the brightest step. The second is grey in the darkest or, for the wire, at 2.07 of
    // four steps.
    const double other = kind == 2 ? 0.5 * 2.0 / 3.0 : 0.0;
    test::on_every_target("toon", g, {{"shadow_r", "0"}}, [&](const Image& out) {
      for (int x = 0; x < kWidth; ++x) {
        const bool second = kind == 2 ? x == 12 : x >= 12;
        EXPECT_NEAR(out.plane("lit.r").at(x, 2), second ? other : 1.0, 1e-6) << kind << " column " << x;
      }
    });
  }
}

TEST(Toon, FacesAreNotSpeckled) {
  // The last bits of the normals vary, as those of interpolated normals do.
  const auto spread = [](glm::dvec3 normal, const Settings& settings) {
    GBuffer g = face(64, 64, {0, 0, 1});
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x)
        set_normal(g, x, y,
                   normal + 1e-7 * glm::dvec3(test::hash(x + 64 * y) % 5 - 2.0, 0, test::hash(y + 64 * x) % 5 - 2.0));
    double max = 0.0;
    test::on_every_target("toon", g, settings, [&](const Image& out) {
      float low = 1e9f, high = -1e9f;
      for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
          low = std::min(low, out.plane("lit.r").at(x, y));
          high = std::max(high, out.plane("lit.r").at(x, y));
        }
      max = std::max(max, double(high - low));
    });
    return max;
  };
  for (const char* steps : {"2", "3", "4", "5", "8", "16"}) {
    EXPECT_EQ(spread({0, 0, 1}, {{"steps", steps}}), 0.0) << steps;   // turned to the light
    EXPECT_EQ(spread({0, 0, -1}, {{"steps", steps}}), 0.0) << steps;  // turned away
  }
  // If the intensity is exactly at an edge, the face has one colour, between those of the two steps.
  const Settings on_edge = joined(kNoAmbient, {{"steps", "2"}, {"shadow_r", "0"}});
  EXPECT_LE(spread({std::sqrt(0.75), 0, 0.5}, on_edge), 0.03);
}

// ---- shadow, highlight, colour
// ---------------------------------------------------------------------------------------

TEST(Toon, ShadowFallsIntoTheDarkStep) {
  GBuffer g = face(32, 8, {0, 0, 1});
  for (int y = 0; y < 8; ++y)
    for (int x = 16; x < 32; ++x) g.layers[0].plane("shadow").at(x, y) = 0.0f;
  for (const char* steps : {"2", "3", "4"})
    test::on_every_target("toon", g, {{"steps", steps}, {"shadow_r", "0.25"}, {"light_r", "0.75"}},
                          [&](const Image& out) {
                            for (int x = 0; x < 32; ++x) {
                              const float r = out.plane("lit.r").at(x, 4);
                              if (x < 15) {
                                EXPECT_EQ(r, 0.75f) << x;
                              }
                              if (x > 16) {
                                EXPECT_EQ(r, 0.25f) << x;
                              }
                              if (x > 0) {
                                EXPECT_LE(r, out.plane("lit.r").at(x - 1, 4)) << x;
                              }
                            }
                          });
  // Also without shadow, with half of it, and in mode paper, where edges are hard.
  test::on_every_target("toon", g, {{"shadow", "0"}},
                        [](const Image& out) { EXPECT_EQ(out.plane("lit.r").at(24, 4), 1.0f); });
  test::on_every_target("toon", g, {{"shadow", "0.5"}},
                        [](const Image& out) { EXPECT_NEAR(intensity_at(out, 24, 4, 0.5f), 0.8f, 1e-6); });
  test::on_every_target("toon", g, {{"mode", "paper"}}, [](const Image& out) {
    EXPECT_EQ(out.plane("lit.r").at(15, 4), 1.25f);
    EXPECT_EQ(out.plane("lit.r").at(16, 4), 0.25f);
  });
}

TEST(Toon, HighlightsAreRoundAndNotDarkened) {
  GBuffer g = sphere();
  Image& image = g.layers[0];
  for (int c = 0; c < 3; ++c) image.plane(kAlbedo[c]) = Plane(kSphereSize, kSphereSize, 0.25f);
  image.add("specular") = Plane(kSphereSize, kSphereSize, 1.0f);
  image.add("shininess") = Plane(kSphereSize, kSphereSize, 40.0f);
  const glm::dvec3 halfway = glm::normalize(kSphereLight + glm::dvec3(0, 0, 1));
  for (const double ao : {1.0, 0.0})
    for (const double size : {1.0, 2.0}) {
      image.plane("ao") = Plane(kSphereSize, kSphereSize, float(ao));
      test::on_every_target("toon", g, {{"highlight_size", fmt::format("{}", size)}}, [&](const Image& out) {
        double area = 0.0, expected = 0.0;
        for (int y = 0; y < kSphereSize; ++y)
          for (int x = 0; x < kSphereSize; ++x) {
            const double cosine = glm::dot(sphere_normal(x + 0.5, y + 0.5), halfway);
            // The highlight ends at half of its strength: e (1 - cos) = ln 2, with e divided by the square of the size.
            const double inside = 1.0 - 40.0 / (size * size) * (1.0 - cosine) / std::log(2.0);
            const double lit = out.plane("lit.r").at(x, y);
            if (inside > 0.15) {
              EXPECT_EQ(lit, 1.0) << x << ',' << y;
            }
            if (inside < -0.15) {
              EXPECT_LE(lit, 0.25) << x << ',' << y;
            }
            area += lit > 0.5;
            expected += inside > 0.0;
          }
        EXPECT_NEAR(area, expected, 0.03 * expected);
      });
    }
  image.plane("shadow") = Plane(kSphereSize, kSphereSize, 0.0f);
  test::on_every_target("toon", g, {}, [](const Image& out) {
    for (int y = 0; y < kSphereSize; ++y)
      for (int x = 0; x < kSphereSize; ++x) ASSERT_LE(out.plane("lit.r").at(x, y), 0.25f) << x << ',' << y;
  });
}

TEST(Toon, HighlightsThinnerThanAPixelAreFainter) {
  // The normals of a bevel turn by turn_deg per row. Each column is shifted up a little from the previous one.
  constexpr int kWidth = 64, kHeight = 24;
  for (const double turn_deg : {12.0, 20.0, 30.0})
    for (const double shininess : {40.0, 200.0}) {
      GBuffer g = face(kWidth, kHeight, {0, 0, 1});
      for (int c = 0; c < 3; ++c) g.layers[0].plane(kAlbedo[c]) = Plane(kWidth, kHeight, 0.0f);
      g.layers[0].add("specular") = Plane(kWidth, kHeight, 1.0f);
      g.layers[0].add("shininess") = Plane(kWidth, kHeight, float(shininess));
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
          const double rows = y + 0.5 - 0.5 * kHeight + 0.07 * (x - 0.5 * kWidth);
          const double angle = std::clamp(rows * turn_deg, -60.0, 60.0) * std::numbers::pi / 180.0;
          set_normal(g, x, y, {0.0, std::sin(angle), std::cos(angle)});
        }
      const double wide = 2.0 * std::acos(1.0 - std::log(2.0) / shininess) / (turn_deg * std::numbers::pi / 180.0);
      test::on_every_target("toon", g, {}, [&](const Image& out) {
        const std::string what = fmt::format("{} degrees, shininess {}, {:.2f} pixels", turn_deg, shininess, wide);
        double max = 0.0;
        for (int y = 1; y < kHeight - 1; ++y)
          for (int x = 1; x < kWidth - 1; ++x) max = std::max(max, double(out.plane("lit.r").at(x, y)));
        EXPECT_LT(max, std::min(wide, 1.0) + 0.05) << what;
        EXPECT_GT(max, 0.2 * wide) << what;
      });
    }
}

TEST(Toon, HighlightsReachUpToCreases) {
  // Two faces: one is entirely in the highlight, the other faces away from it.
  GBuffer g = face(32, 8, {0, 0, 1});
  for (int c = 0; c < 3; ++c) g.layers[0].plane(kAlbedo[c]) = Plane(32, 8, 0.0f);
  g.layers[0].add("specular") = Plane(32, 8, 1.0f);
  g.layers[0].add("shininess") = Plane(32, 8, 60.0f);
  for (int y = 0; y < 8; ++y)
    for (int x = 16; x < 32; ++x) set_normal(g, x, y, glm::normalize(glm::dvec3(0.9, 0.0, 0.4)));
  test::on_every_target("toon", g, {}, [&](const Image& out) {
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 32; ++x) EXPECT_EQ(out.plane("lit.r").at(x, y), x < 16 ? 1.0f : 0.0f) << x << ", " << y;
  });
}

TEST(Toon, HighlightFollowsTheMaterial) {
  GBuffer g = face(1, 1, {0, 0, 1});
  for (int c = 0; c < 3; ++c) g.layers[0].plane(kAlbedo[c]) = Plane(1, 1, 0.0f);
  g.layers[0].add("specular") = Plane(1, 1, 0.25f);
  g.layers[0].add("shininess") = Plane(1, 1, 30.0f);
  const auto lit = [&](const Settings& settings, double expected) {
    test::on_every_target("toon", g, settings,
                          [&](const Image& out) { EXPECT_NEAR(out.plane("lit.g").at(0, 0), expected, 1e-6); });
  };
  lit({}, 0.5);
  lit({{"specular", "0.5"}}, 0.25);
  lit({{"specular", "0"}}, 0.0);
  lit({{"specular", "100"}, {"light_g", "0.75"}}, 0.75);
  for (int c = 0; c < 3; ++c) g.layers[0].plane(kAlbedo[c]) = Plane(1, 1, 1.0f);
  lit({{"mode", "paper"}}, 2.25);
  lit({{"mode", "paper"}, {"specular", "0.5"}}, 1.75);
  lit({{"mode", "paper"}, {"specular", "0"}}, 1.25);
  g.layers[0].plane("specular") = Plane(1, 1, 0.0f);
  lit({{"mode", "paper"}}, 1.25);
}

TEST(Toon, RampEndsInItsColours) {
  const Settings colors = {{"shadow_r", "0.1"}, {"shadow_g", "0.2"}, {"shadow_b", "0.5"},
                           {"light_r", "0.9"},  {"light_g", "0.8"},  {"light_b", "0.7"}};
  const double dark[] = {0.1, 0.2, 0.5}, bright[] = {0.9, 0.8, 0.7};
  for (const int steps : {1, 2, 3, 4, 256}) {
    const Settings settings = joined(joined(colors, {{"steps", fmt::format("{}", steps)}}), kNoAmbient);
    for (const bool towards : {true, false})
      test::on_every_target("toon", face(3, 2, {0, 0, towards ? 1.0f : -1.0f}), settings, [&](const Image& out) {
        for (int c = 0; c < 3; ++c)
          EXPECT_NEAR(out.plane(kLit[c]).at(1, 1), towards || steps == 1 ? bright[c] : dark[c], 1e-6) << steps;
      });
  }
  // The middle one of three steps has the mean colour.
  test::on_every_target("toon", face(3, 2, {float(std::sqrt(0.75)), 0, 0.5f}), joined(colors, {{"steps", "3"}}),
                        [&](const Image& out) {
                          for (int c = 0; c < 3; ++c)
                            EXPECT_NEAR(out.plane(kLit[c]).at(1, 1), 0.5 * (dark[c] + bright[c]), 1e-6);
                        });
}

TEST(Toon, AlbedoScalesSteps) {
  GBuffer g = face(16, 4, {0, 0, 1});
  for (int x = 0; x < 16; ++x)
    for (int y = 0; y < 4; ++y)
      for (int c = 0; c < 3; ++c) g.layers[0].plane(kAlbedo[c]).at(x, y) = float(x + c) / 20.0f;
  const auto check = [&](const Settings& settings, const std::function<double(double)>& expected) {
    test::on_every_target("toon", g, settings, [&](const Image& out) {
      for (int x = 0; x < 16; ++x)
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(out.plane(kLit[c]).at(x, 2), expected((x + c) / 20.0), 2e-6);
    });
  };
  check({}, [](double albedo) { return albedo; });
  check({{"mode", "paper"}}, [](double albedo) { return 1.25 * albedo; });
  check({{"albedo", "clay"}}, [](double) { return 1.0; });
  check({{"albedo", "display"}}, [](double albedo) {
    return albedo > 0.0031308 ? 1.055 * std::pow(albedo, 1.0 / 2.4) - 0.055 : 12.92 * albedo;
  });
}

TEST(Toon, RigsReplaceLightsAndShadow) {
  GBuffer g = face(4, 4, {0, 0, 1});
  g.info.lights[0].direction = {0, 0, -1};
  g.layers[0].plane("shadow") = Plane(4, 4, 0.0f);
  const double above_left = 0.62 / std::sqrt(0.45 * 0.45 + 0.65 * 0.65 + 0.62 * 0.62);
  for (const auto& [rig, diffuse] : {std::pair{"scene", 0.0}, {"head", 1.0}, {"key", above_left}})
    test::on_every_target("toon", g, {{"rig", rig}}, [&, diffuse = diffuse](const Image& out) {
      EXPECT_NEAR(intensity_at(out, 2, 2, rig == std::string_view("scene") ? 1.0f : 0.0f), diffuse + 0.3, 1e-6);
    });
}

// ---- missing or invalid planes
// ----------------------------------------------------------------------------------------

TEST(Toon, WithoutLightsOnlyAmbientIsLeft) {
  GBuffer g = face(3, 3, {0, 0, 1});
  g.info.lights.clear();
  test::on_every_target("toon", g, {{"shadow_r", "0.125"}},
                        [](const Image& out) { EXPECT_EQ(out.plane("lit.r").at(1, 1), 0.125f); });
  test::on_every_target("toon", g, {{"mode", "paper"}},
                        [](const Image& out) { EXPECT_EQ(out.plane("lit.r").at(1, 1), 0.25f); });
  g.info.lights = {{.direction = {0, 0, 1}, .color = glm::vec3(0.0f)}, {.direction = {0, 0, 1}}};
  test::on_every_target("toon", g, {}, [](const Image& out) {
    EXPECT_NEAR(intensity_at(out, 1, 1), 1.3f, 1e-6);  // a black key light is still the key light
  });
}

TEST(Toon, DepthAndNormalAreEnough) {
  GBuffer g = face(3, 3, {0, 0, 1});
  for (const char* name : {"albedo.r", "albedo.g", "albedo.b", "shadow", "ao"}) {
    const std::size_t at =
        std::find(g.layers[0].names.begin(), g.layers[0].names.end(), name) - g.layers[0].names.begin();
    g.layers[0].names.erase(g.layers[0].names.begin() + long(at));
    g.layers[0].planes.erase(g.layers[0].planes.begin() + long(at));
  }
  test::on_every_target("toon", g, {}, [](const Image& out) { EXPECT_FLOAT_EQ(out.plane("lit.b").at(1, 1), 0.8f); });
}

TEST(Toon, BackgroundAndNonFiniteInputsAreDefined) {
  const float nan = std::nanf(""), infinity = std::numeric_limits<float>::infinity();
  GBuffer g = face(16, 1, {0, 0, 1});
  Image& image = g.layers[0];
  image.plane("depth").at(0, 0) = infinity;
  image.plane("depth").at(2, 0) = nan;
  image.plane("normal.x").at(4, 0) = nan;
  image.plane("ao").at(6, 0) = nan;
  image.plane("shadow").at(8, 0) = nan;
  image.plane("albedo.r").at(10, 0) = infinity;
  set_normal(g, 12, 0, {0, 0, 0});
  for (const char* mode : {"ramp", "paper"})
    test::on_every_target("toon", g, joined(kNoAmbient, {{"mode", mode}, {"shadow_r", "0.125"}, {"smoothness", "0"}}),
                          [&](const Image& out) {
                            const float dark = mode == std::string_view("ramp") ? 0.125f : 0.0f;
                            for (const int x : {0, 2, 10}) EXPECT_EQ(out.plane("lit.r").at(x, 0), 0.0f) << x;
                            for (const int x : {4, 6, 12}) EXPECT_EQ(out.plane("lit.r").at(x, 0), dark) << x;
                            for (int x = 0; x < 16; ++x) EXPECT_TRUE(std::isfinite(out.plane("lit.g").at(x, 0))) << x;
                            for (const int x : {14, 15}) EXPECT_EQ(out.plane("lit.r").at(x, 0), 1.0f) << x;
                          });
  test::on_every_target("toon", g, kNoAmbient, [&](const Image& out) {
    for (int x = 0; x < 16; ++x) EXPECT_TRUE(std::isfinite(out.plane("lit.g").at(x, 0))) << x;
  });
}

TEST(Toon, NumbersOfStepsOutsideTheRangeAreRefused) {
  const Effect& effect = *find_effect("toon");
  ParameterBytes bytes = initial_parameters(effect.parameters, effect.params_size);
  for (const char* text : {"0", "1000", "-4", "2.5"}) {
    const auto status = set_parameter("toon", *find_parameter(effect, "steps"), text, bytes);
    ASSERT_FALSE(status) << text;
    EXPECT_NE(status.error().message.find("1 to 256"), std::string::npos) << status.error().message;
    EXPECT_NE(status.error().message.find(text), std::string::npos) << status.error().message;
  }
}

}  // namespace
}  // namespace umbrage
