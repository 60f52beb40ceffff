// Compares `hemisphere` with a literal port of the paper's description in double, and with quadrature in scenes of
// rectangles.
#include "effects/hemisphere/hemisphere.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "run_effect.h"
#include "support.h"

namespace umbrage {
namespace {

using namespace test;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr double kPi = 3.14159265358979323846;

Image run(const GBuffer& g, const Settings& settings) {
  return test::run_effect(*find_effect("hemisphere"), g, settings, {});
}

HemisphereConstants constants(const GBuffer& g, const Settings& settings) {
  return test::constants_of<HemisphereConstants>("hemisphere", g.info, settings);
}

// ---- scenes of rectangles
// ------------------------------------------------------------------------------------------

/// The points corner + s u + t v with s and t in [0, 1]. The front is the side to which cross(u, v) points.
struct Rectangle {
  glm::dvec3 corner, u, v;
  glm::dvec3 front{0.0}, back{0.0};  ///< emitted light of each side
  glm::dvec3 ambient{0.0};           ///< ambient light that each side reflects if unoccluded
  double albedo = 0.8;
  glm::dvec3 normal() const { return glm::normalize(glm::cross(u, v)); }
};
using Rectangles = std::vector<Rectangle>;

struct Intersection {
  double t = 0.0;
  const Rectangle* on = nullptr;
};

/// Returns all intersections of a ray, nearest first.
std::vector<Intersection> intersections(const Rectangles& scene, glm::dvec3 from, glm::dvec3 direction) {
  std::vector<Intersection> all;
  for (const Rectangle& r : scene) {
    const glm::dvec3 n = r.normal();
    const double t = glm::dot(r.corner - from, n) / glm::dot(direction, n);
    if (!(t > 1e-9) || !std::isfinite(t)) continue;
    const glm::dvec3 at = from + t * direction - r.corner;
    const double s = glm::dot(at, r.u) / glm::dot(r.u, r.u), q = glm::dot(at, r.v) / glm::dot(r.v, r.v);
    if (s >= 0.0 && s <= 1.0 && q >= 0.0 && q <= 1.0) all.push_back({t, &r});
  }
  std::sort(all.begin(), all.end(), [](const Intersection& a, const Intersection& b) { return a.t < b.t; });
  return all;
}

/// Ray of a pixel's centre in world space; its parameter is the view depth.
struct Ray {
  glm::dvec3 from, direction;
};
Ray ray_of(const Camera& camera, int width, int height, int x, int y) {
  const double u = camera.left + (camera.right - camera.left) * (x + 0.5) / width;
  const double v = camera.top - (camera.top - camera.bottom) * (y + 0.5) / height;
  const glm::dmat4 world = glm::inverse(glm::dmat4(camera.view_from_world));
  const auto point = [&](double px, double py, double pz) { return glm::dvec3(world * glm::dvec4(px, py, pz, 1.0)); };
  if (camera.projection == Projection::kOrthographic) return {point(u, v, 0.0), point(u, v, -1.0) - point(u, v, 0.0)};
  return {point(0, 0, 0), point(u, v, -1.0) - point(0, 0, 0)};
}

/// Returns a layer of the `nth` surface along each ray, from 0; `back`: its back side.
Image layer_of(const Rectangles& scene, const Camera& camera, int width, int height, int nth, bool back) {
  Image image(width, height);
  image.add("depth");
  for (const auto* names : {kNormal, kDirect, kAmbient, kAlbedo})
    for (int c = 0; c < 3; ++c) image.add(names[c]);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Ray ray = ray_of(camera, width, height, x, y);
      const auto all = intersections(scene, ray.from, ray.direction);
      const bool has_surface = nth < int(all.size());
      const Rectangle none{};
      const Rectangle& r = has_surface ? *all[nth].on : none;
      image.plane("depth").at(x, y) = has_surface ? float(all[nth].t) : kInfinity;
      const bool faces_front = has_surface && glm::dot(r.normal(), ray.direction) < 0.0;
      const glm::dvec3 side = has_surface ? (faces_front != back ? r.normal() : -r.normal()) : glm::dvec3(0.0);
      const glm::dvec3 n = glm::dmat3(glm::dmat4(camera.view_from_world)) * side;
      for (int c = 0; c < 3; ++c) {
        image.plane(kNormal[c]).at(x, y) = float(n[c]);
        image.plane(kDirect[c]).at(x, y) = float(has_surface ? (faces_front != back ? r.front[c] : r.back[c]) : 0.0);
        image.plane(kAmbient[c]).at(x, y) = float(r.ambient[c]);
        image.plane(kAlbedo[c]).at(x, y) = float(r.albedo);
      }
    }
  return image;
}

/// Returns a G-buffer of a scene, with layers of the first `surfaces` surfaces along each ray and, if `backs`, of their
/// back sides.
GBuffer picture(const Rectangles& scene, const Camera& camera, int width, int height, int surfaces = 1,
                bool backs = false) {
  GBuffer g;
  g.info.width = width;
  g.info.height = height;
  g.info.camera = camera;
  g.info.depth_min = 0.5f;
  g.info.depth_max = 20.0f;
  g.info.scene_radius = 5.0f;
  int before = 0;
  for (int nth = 0; nth < surfaces; ++nth) {
    const int own = int(g.layers.size());
    g.layers.push_back(layer_of(scene, camera, width, height, nth, false));
    if (nth > 0) g.info.more_layers.push_back({.kind = LayerKind::kBehind, .of = before, .camera = {}});
    before = own;
    if (!backs) continue;
    g.layers.push_back(layer_of(scene, camera, width, height, nth, true));
    g.info.more_layers.push_back({.kind = LayerKind::kBack, .of = own, .camera = {}});
  }
  return g;
}

/// Returns the light, divided by pi, that arrives at a point from all rectangles within a radius, without occlusion, by
/// quadrature.
glm::dvec3 light_by_quadrature(const Rectangles& scene, glm::dvec3 at, glm::dvec3 normal, double radius) {
  constexpr int kSteps = 300;
  glm::dvec3 sum(0.0);
  for (const Rectangle& r : scene) {
    const glm::dvec3 n = r.normal();
    const double area = glm::length(glm::cross(r.u, r.v)) / (kSteps * kSteps);
    for (int j = 0; j < kSteps; ++j)
      for (int i = 0; i < kSteps; ++i) {
        const glm::dvec3 to_patch = r.corner + r.u * ((i + 0.5) / kSteps) + r.v * ((j + 0.5) / kSteps) - at;
        const double d2 = glm::dot(to_patch, to_patch), receiver = glm::dot(to_patch, normal),
                     emitter = -glm::dot(to_patch, n);
        if (d2 > radius * radius || d2 < 1e-12 || receiver <= 0.0 || emitter == 0.0) continue;
        sum += (emitter > 0.0 ? r.front : r.back) * (receiver * std::fabs(emitter) * area / (kPi * d2 * d2));
      }
  }
  return sum;
}

glm::dvec3 world_position(const GBuffer& g, int x, int y) {
  const Ray ray = ray_of(g.info.camera, g.info.width, g.info.height, x, y);
  return ray.from + ray.direction * double(g.layers[0].plane("depth").at(x, y));
}

const glm::dvec3 kRed(1.0, 0.0, 0.0);

/// Returns an unlit floor, and on it a bright red wall that faces +x.
Rectangles floor_and_wall() {
  return {{.corner = {-3, 0, 3}, .u = {6, 0, 0}, .v = {0, 0, -6}},
          {.corner = {0, 0, 1}, .u = {0, 0, -2}, .v = {0, 1, 0}, .front = kRed}};
}

const Camera kFloorCamera = perspective_camera({3.5f, 3, 3}, {0.3f, 0.2f, 0}, {0, 1, 0}, 40, 1.0f);

/// Means of a plane and of the expected values.
struct Means {
  double mean = 0.0, expected_mean = 0.0;
  int count = 0;
};

/// Returns the means over the pixels whose surface position `selects` accepts. `expected` takes this position.
Means means(const GBuffer& g, const Plane& plane, const std::function<bool(glm::dvec3)>& selects,
            const std::function<double(glm::dvec3)>& expected) {
  Means m;
  for (int y = 0; y < g.info.height; ++y)
    for (int x = 0; x < g.info.width; ++x) {
      if (!std::isfinite(g.layers[0].plane("depth").at(x, y))) continue;
      const glm::dvec3 at = world_position(g, x, y);
      if (!selects(at)) continue;
      m.mean += plane.at(x, y);
      m.expected_mean += expected(at);
      ++m.count;
    }
  m.mean /= std::max(1, m.count);
  m.expected_mean /= std::max(1, m.count);
  return m;
}

bool on_floor(glm::dvec3 at) { return std::fabs(at.y) < 1e-4; }

// ---- the paper, in double
// ------------------------------------------------------------------------------------------

const Settings kPaper = {{"distribution", "paper"}, {"range", "quadratic"}, {"range_depth", "window"},
                         {"bias_of", "depth"},      {"bias", "0"},          {"border", "clamp"},
                         {"bleeding", "1"},         {"area", "paper"},      {"floor", "0"},
                         {"weight", "1"},           {"ambient_bounce", "0"}};

unsigned scrambled(unsigned v) {
  v = (v ^ (v >> 16)) * 0x7feb352du;
  v = (v ^ (v >> 15)) * 0x846ca68bu;
  return v ^ (v >> 16);
}

/// Returns the noise texture for seed 0: x and y uniform in [-1, 1], z = 0, scaled to length 1.
glm::dvec3 noise_texture(int x, int y) {
  const unsigned first = scrambled(unsigned(x) ^ scrambled(unsigned(y) + scrambled(0x9e3779b9u)));
  const auto real = [](unsigned v) { return double(v >> 8) * 0x1p-23 - 1.0; };
  return glm::normalize(glm::dvec3(real(first) + 0x1p-24, real(scrambled(first + 1)), 0.0));
}

struct ReferencePixel {
  double ao;
  glm::dvec3 bleed;
};

/// Computes one pixel by a literal port of "SSAO Pass" and "Calculating Colour Bleed".
ReferencePixel reference_pixel(const GBuffer& g, const HemisphereConstants& c, int x, int y) {
  const Image& image = g.layers[0];
  const double far_plane = g.info.depth_max, near_plane = g.info.depth_min, span = far_plane - near_plane;
  const auto vector = [&](const char* const* names, int i, int j) {
    return glm::dvec3(image.plane(names[0]).at(i, j), image.plane(names[1]).at(i, j), image.plane(names[2]).at(i, j));
  };
  const auto position = [&](int i, int j) {
    const Camera& camera = g.info.camera;
    const double d = image.plane("depth").at(i, j);
    return d * glm::dvec3(camera.left + (camera.right - camera.left) * (i + 0.5) / g.info.width,
                          camera.top - (camera.top - camera.bottom) * (j + 0.5) / g.info.height, -1.0);
  };
  const auto window = [&](double z) {
    return far_plane * (std::clamp(z, near_plane, far_plane) - near_plane) /
           (std::clamp(z, near_plane, far_plane) * span);
  };
  const glm::dvec3 fragment = position(x, y), normal = glm::normalize(vector(kNormal, x, y));
  // The tangent space is that of an arbitrary vector, or of another one if the first is parallel to the normal; then
  // Gram-Schmidt with the noise.
  const glm::dvec3 arbitrary = std::fabs(normal.y) > 0.99 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 first = glm::normalize(glm::cross(arbitrary, normal)), second = glm::cross(normal, first);
  const glm::dvec3 noise = noise_texture(x % 4, y % 4);
  const glm::dvec3 random = first * noise.x + second * noise.y;
  const glm::dvec3 tangent = glm::normalize(random - normal * glm::dot(random, normal));
  const glm::dvec3 bitangent = glm::cross(normal, tangent);
  double factor = 0.0;
  glm::dvec3 bleed(0.0);
  for (int k = 0; k < c.samples; ++k) {
    const float* p = c.points + 5 * k;
    const glm::dvec3 sample =
        fragment + double(c.radius) * (double(p[0]) * tangent + double(p[1]) * bitangent + double(p[2]) * normal);
    const Camera& camera = g.info.camera;
    const double u = (sample.x / -sample.z - camera.left) / (camera.right - camera.left) * g.info.width;
    const double v = (camera.top - sample.y / -sample.z) / (camera.top - camera.bottom) * g.info.height;
    const int i = std::clamp(int(std::floor(u)), 0, g.info.width - 1);
    const int j = std::clamp(int(std::floor(v)), 0, g.info.height - 1);
    const double tap = image.plane("depth").at(i, j);
    if (!(window(tap) < window(-sample.z)) || !(tap < -sample.z)) continue;
    // The limit of the difference falls with the square of the depth. At the geometric mean of the planes it is the
    // radius divided by the depth span.
    const double limit = c.radius / span * near_plane * far_plane / (fragment.z * fragment.z);
    if (!(std::fabs(window(-fragment.z) - window(tap)) < limit)) continue;
    factor += 1.0;
    const glm::dvec3 from_occluder = fragment - position(i, j);
    const glm::dvec3 transmittance = glm::normalize(from_occluder);
    const double cos_oc = glm::dot(vector(kNormal, i, j), transmittance), cos_or = -glm::dot(normal, transmittance);
    if (cos_oc > 0.0 && cos_or > 0.0)
      bleed += vector(kDirect, i, j) *
               (0.05 * c.radius * c.radius * cos_oc * cos_or / glm::dot(from_occluder, from_occluder));
  }
  return {1.0 - factor / c.samples, bleed};
}

TEST(Hemisphere, PaperSettingsMatchThePaper) {
  Rectangles scene = floor_and_wall();
  scene[0].front = {0.2, 0.5, 0.3};
  scene.push_back({.corner = {1, 0.4, 0.5}, .u = {0.8, 0, 0}, .v = {0, 0, -0.8}, .front = {0.1, 0.2, 0.9}});
  const GBuffer g = picture(scene, kFloorCamera, 96, 96);
  for (const char* samples : {"16", "64"}) {
    const Settings settings = joined(kPaper, {{"samples", samples}, {"radius", "0.7"}});
    const HemisphereConstants c = constants(g, settings);
    test::on_every_target("hemisphere", g, settings, [&](const Image& image) {
      int differing = 0, compared = 0, dark = 0, coloured = 0;
      for (int y = 0; y < 96; ++y)
        for (int x = 0; x < 96; ++x) {
          if (!std::isfinite(g.layers[0].plane("depth").at(x, y))) continue;
          const ReferencePixel reference = reference_pixel(g, c, x, y);
          bool same = std::fabs(image.plane("ao").at(x, y) - reference.ao) < 1e-5;
          for (int k = 0; k < 3; ++k)
            same &=
                std::fabs(image.plane(kIndirect[k]).at(x, y) - reference.bleed[k]) < 1e-4 * (1.0 + reference.bleed[k]);
          differing += !same;
          dark += reference.ao < 0.9;
          coloured += reference.bleed.x > 0.05;
          ++compared;
        }
      // Samples on a pixel's border or at the range's limit may round either way.
      EXPECT_LE(differing, compared / 100);
      EXPECT_GT(dark, 200);
      EXPECT_GT(coloured, 200);
    });
  }
}

TEST(Hemisphere, LightOfANearFragmentIsBoundedByItsSize) {
  const GBuffer g = picture(floor_and_wall(), kFloorCamera, 96, 96);
  const auto max_light = [&](const char* floor) {
    const Image image =
        run(g, joined(kPaper, {{"samples", "1"}, {"radius", "0.7"}, {"fragment_area", "0.08"}, {"floor", floor}}));
    float max = 0.0f;
    for (int y = 0; y < 96; ++y)
      for (int x = 0; x < 96; ++x) max = std::max(max, image.plane("indirect.r").at(x, y));
    return max;
  };
  // A disc of 0.08 squared radii has a radius of 0.16. From nearer it sends what it sends from there: at most pi times
  // its light.
  const float most = 0.08f / (0.16f * 0.16f);
  EXPECT_LE(max_light("0.16"), most);
  EXPECT_GT(max_light("0"), most);
}

TEST(Hemisphere, PaperPointsAreTheKernelTexture) {
  const GBuffer g = test::empty_gbuffer(8, 8);
  for (const int n : {1, 16, 256}) {
    const HemisphereConstants c = constants(g, joined(kPaper, {{"samples", std::to_string(n)}}));
    for (int i = 0; i < n; ++i) {
      const glm::dvec3 p(c.points[5 * i], c.points[5 * i + 1], c.points[5 * i + 2]);
      EXPECT_NEAR(glm::length(p), 0.1 + 0.9 * i * i / (double(n) * n), 1e-6);
      // The lowest point of the random table has z = 0.05 and x = y = 1.
      EXPECT_GE(p.z / glm::length(p), 0.05 / std::sqrt(2.0 + 0.05 * 0.05) - 1e-6);
    }
  }
}

// ---- planes and corners
// ------------------------------------------------------------------------------------------

/// Returns a tilted, emitting plane through the centre of the view.
GBuffer plane(double tilt_deg, bool orthographic) {
  const double tilt = tilt_deg * kPi / 180.0;
  const glm::dvec3 up(0, std::cos(tilt), -std::sin(tilt));
  const Rectangles scene = {
      {.corner = glm::dvec3(-40, 0, 0) - 4.0 * up, .u = {80, 0, 0}, .v = 8.0 * up, .front = kRed}};
  return picture(scene,
                 orthographic ? orthographic_camera({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 2, 1.25f)
                              : perspective_camera({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 30, 1.25f),
                 100, 80);
}

TEST(Hemisphere, PlanesStayUnoccludedAndDark) {
  for (const double tilt : {0.0, 30.0, 60.0, 80.0})
    for (const bool orthographic : {false, true}) {
      const GBuffer g = plane(tilt, orthographic);
      for (const char* bias : {"0.02", "0"})
        test::on_every_target(
            "hemisphere", g, {{"bleeding", "1"}, {"radius", "0.5"}, {"bias", bias}}, [&](const Image& image) {
              EXPECT_EQ(test::difference(image.plane("ao"), Plane(100, 80, 1.0f), 0.0).max, 0.0)
                  << tilt << orthographic;
              EXPECT_LT(test::difference(image.plane("indirect.r"), Plane(100, 80, 0.0f), 0.0).max, 1e-4)
                  << tilt << orthographic;
            });
    }
}

TEST(Hemisphere, WholeSphereOccludesHalfOfAPlane) {
  for (const char* distribution : {"even", "paper"}) {
    const GBuffer g = plane(30.0, false);
    const Settings settings = {{"shape", "sphere"}, {"distribution", distribution},
                               {"samples", "64"},   {"radius", "0.2"},
                               {"weight", "1"},     {"bias", "0"}};
    const Plane ao = run(g, settings).plane("ao");
    // The samples in front of the surface are those on the normal's side; rotation about the normal leaves them there.
    const HemisphereConstants c = constants(g, settings);
    double in_front = 0.0, mean = 0.0;
    for (int i = 0; i < 64; ++i) in_front += (c.points[5 * i + 2] > 0.0f) / 64.0;
    const bool is_even = distribution == std::string("even");
    EXPECT_NEAR(in_front, 0.5, is_even ? 0.0 : 0.1) << "the paper's points are random";
    for (int y = 20; y < 60; ++y)
      for (int x = 20; x < 80; ++x) mean += ao.at(x, y) / (40.0 * 60.0);
    EXPECT_NEAR(mean, in_front, is_even ? 0.005 : 0.01) << distribution;
  }
}

TEST(Hemisphere, ConvexCornersAreLighterInTheWholeSphereOnly) {
  // Two faces that meet at 90 degrees, in a ridge that points at the camera.
  const Rectangles ridge = {{.corner = {-2, -2, -2}, .u = {2, 0, 2}, .v = {0, 4, 0}},
                            {.corner = {0, -2, 0}, .u = {2, 0, -2}, .v = {0, 4, 0}}};
  const GBuffer g = picture(ridge, perspective_camera({0, 0, 6}, {0, 0, 0}, {0, 1, 0}, 30, 1.0f), 128, 128);
  constexpr double kRadius = 0.4, kInner = 0.02;  // kInner: shortest length, fraction of the radius
  // Of the directions into a face, a fraction 1/2 (1 - d/r) leaves the other face again if the sample has the length r
  // and the edge the distance d, so samples are in front of the surface with a probability of 1/2 + 1/4 (1 - d/r). Half
  // of the lengths are in equal steps, half in equal steps of their logarithm.
  const auto probability = [&](glm::dvec3 at) {
    constexpr int kSteps = 1000;
    const double distance = std::fabs(at.x) * std::sqrt(2.0);
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i)
      for (const double length : {(i + 0.5) / kSteps, std::pow(kInner, (i + 0.5) / kSteps)})
        sum += 0.5 + 0.25 * std::max(0.0, 1.0 - distance / (kRadius * length));
    return sum / (2 * kSteps);
  };
  const auto band = [&](const char* shape, double min, double max) {
    const Image image = run(g, {{"shape", shape},
                                {"samples", "64"},
                                {"radius", "0.4"},
                                {"weight", "1"},
                                {"bias", shape == std::string("sphere") ? "0" : "0.02"}});
    return means(
        g, image.plane("ao"),
        [&](glm::dvec3 at) { return std::fabs(at.y) < 0.8 && std::fabs(at.x) >= min && std::fabs(at.x) < max; },
        probability);
  };
  const Means corner = band("sphere", 0.0, 0.05), face = band("sphere", 0.5, 0.8);
  EXPECT_NEAR(corner.mean, corner.expected_mean, 0.005);
  EXPECT_NEAR(face.mean, 0.5, 0.0025);
  EXPECT_GT(corner.mean, face.mean + 0.12);
  EXPECT_EQ(band("hemisphere", 0.0, 0.05).mean, 1.0);
  EXPECT_EQ(band("hemisphere", 0.5, 0.8).mean, 1.0);
}

// ---- reflected light against quadrature
// ------------------------------------------------------------------------------------------

TEST(Hemisphere, LightOfAWallMatchesItsFormFactor) {
  const Rectangles scene = floor_and_wall();
  const GBuffer g = picture(scene, kFloorCamera, 192, 192);
  // A pixel at the foot of the wall is about 0.02 wide.
  const double edges[] = {0.02, 0.06, 0.15, 0.3, 0.5, 0.8, 1.2};
  for (const char* samples : {"16", "64", "256"})
    test::on_every_target(
        "hemisphere", g, {{"bleeding", "1"}, {"radius", "2.4"}, {"samples", samples}, {"noise", "0"}},
        [&](const Image& image) {
          for (int k = 0; k + 1 < int(std::size(edges)); ++k) {
            const auto selects = [&](glm::dvec3 at) {
              return on_floor(at) && at.x >= edges[k] && at.x < edges[k + 1] && std::fabs(at.z) < 0.6;
            };
            // The exact value hardly changes along the wall, so that one line is enough.
            const double exact = light_by_quadrature(scene, {0.5 * (edges[k] + edges[k + 1]), 0, 0}, {0, 1, 0}, 2.4).x;
            const Means m = means(g, image.plane("indirect.r"), selects, [&](glm::dvec3) { return exact; });
            EXPECT_GT(m.count, 50);
            EXPECT_NEAR(m.mean, m.expected_mean, 0.25 * m.expected_mean) << samples << " at " << edges[k];
          }
          const Means green = means(g, image.plane("indirect.g"), on_floor, [](glm::dvec3) { return 0.0; });
          EXPECT_EQ(green.mean, 0.0);
        });
}

TEST(Hemisphere, UnlitSideOfAWallEmitsNothing) {
  const Rectangles scene = floor_and_wall();
  const GBuffer g = picture(scene, kFloorCamera, 160, 160);
  const Image image = run(g, {{"bleeding", "1"}, {"radius", "2.4"}, {"samples", "64"}});
  int count = 0;
  for (int y = 0; y < 160; ++y)
    for (int x = 0; x < 160; ++x) {
      if (!std::isfinite(g.layers[0].plane("depth").at(x, y))) continue;
      const glm::dvec3 at = world_position(g, x, y);
      if (!on_floor(at) || at.x > -0.01) continue;
      ++count;
      EXPECT_EQ(image.plane("indirect.r").at(x, y), 0.0f);
    }
  EXPECT_GT(count, 500);
}

TEST(Hemisphere, LightHardlyDependsOnTheNumberOfSamples) {
  const Rectangles scene = floor_and_wall();
  const GBuffer g = picture(scene, kFloorCamera, 192, 192);
  const auto light = [&](const char* samples, const char* area) {
    const Image image =
        run(g, {{"bleeding", "1"}, {"radius", "2.4"}, {"samples", samples}, {"noise", "0"}, {"area", area}});
    return means(
               g, image.plane("indirect.r"),
               [](glm::dvec3 at) { return on_floor(at) && at.x > 0.1 && at.x < 1.0 && std::fabs(at.z) < 1.0; },
               [](glm::dvec3) { return 0.0; })
        .mean;
  };
  EXPECT_NEAR(light("8", "measured") / light("256", "measured"), 1.0, 0.02);
  EXPECT_NEAR(light("8", "equal") / light("256", "equal"), 1.0, 0.08);
  // The paper's sum grows with the number of samples.
  EXPECT_NEAR(light("256", "paper") / light("8", "paper"), 256.0 / 8.0, 2.5);
}

// ---- ambient light and further bounces
// ------------------------------------------------------------------------------------------

constexpr double kBoxAlbedo = 0.7, kBoxAmbient = 0.5;

/// Returns the inside of a white box, open at the top, in ambient light only.
Rectangles open_box() {
  const auto face = [](glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v) {
    return Rectangle{
        .corner = corner, .u = u, .v = v, .ambient = glm::dvec3(kBoxAlbedo * kBoxAmbient), .albedo = kBoxAlbedo};
  };
  return {face({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}), face({-1, 0, -1}, {2, 0, 0}, {0, 1, 0}),
          face({1, 0, 1}, {-2, 0, 0}, {0, 1, 0}), face({-1, 0, 1}, {0, 0, -2}, {0, 1, 0}),
          face({1, 0, -1}, {0, 0, 2}, {0, 1, 0})};
}

TEST(Hemisphere, AmbientBouncesMatchTheSeries) {
  const Rectangles box = open_box();
  const Camera camera = perspective_camera({0, 4, 0.001f}, {0, 0, 0}, {0, 1, 0}, 42, 1.0f);
  const GBuffer g = picture(box, camera, 160, 160);
  const Settings settings = {{"bleeding", "1"}, {"radius", "4"}, {"samples", "64"}, {"range", "none"}, {"noise", "0"}};
  const Image first = run(g, settings);

  // The series of bounces in double: the light between patches of the box, with the visibility that the effect
  // computed.
  constexpr int kPatches = 12;
  struct Patch {
    glm::dvec3 at, normal;
    double area, ao = 0.0, emitted = 0.0, arrives = 0.0;
    int pixels = 0;
  };
  std::vector<Patch> patches;
  for (const Rectangle& r : box)
    for (int j = 0; j < kPatches; ++j)
      for (int i = 0; i < kPatches; ++i)
        patches.push_back({.at = r.corner + r.u * ((i + 0.5) / kPatches) + r.v * ((j + 0.5) / kPatches),
                           .normal = r.normal(),
                           .area = glm::length(glm::cross(r.u, r.v)) / (kPatches * kPatches)});
  const auto nearest = [&](glm::dvec3 at) {
    return std::min_element(patches.begin(), patches.end(), [&](const Patch& a, const Patch& b) {
      return glm::length(a.at - at) < glm::length(b.at - at);
    });
  };
  for (int y = 0; y < 160; ++y)
    for (int x = 0; x < 160; ++x) {
      if (!std::isfinite(g.layers[0].plane("depth").at(x, y))) continue;
      const auto patch = nearest(world_position(g, x, y));
      patch->ao += first.plane("ao").at(x, y);
      ++patch->pixels;
    }
  for (Patch& patch : patches) {
    ASSERT_GT(patch.pixels, 0);
    patch.ao /= patch.pixels;
  }
  const double own = kBoxAlbedo * kBoxAmbient;
  const auto bounce = [&] {
    for (Patch& to : patches) {
      to.arrives = 0.0;
      for (const Patch& from : patches) {
        const glm::dvec3 to_patch = from.at - to.at;
        const double d2 = glm::dot(to_patch, to_patch), a = glm::dot(to_patch, to.normal),
                     b = -glm::dot(to_patch, from.normal);
        if (a > 1e-9 && b > 1e-9) to.arrives += from.emitted * a * b * from.area / (kPi * d2 * d2);
      }
    }
  };
  const auto on_the_floor_inside = [](glm::dvec3 at) {
    return on_floor(at) && std::fabs(at.x) < 0.7 && std::fabs(at.z) < 0.7;
  };
  for (const int bounces : {1, 2, 4}) {
    for (Patch& patch : patches) patch.emitted = own * 0.7;  // the assumed visibility
    for (int k = 0; k < bounces; ++k) {
      if (k > 0)
        for (Patch& patch : patches) patch.emitted = own * patch.ao + kBoxAlbedo * patch.arrives;
      bounce();
    }
    const Image image = run(g, joined(settings, {{"bounces", std::to_string(bounces)}}));
    const Means m =
        means(g, image.plane("indirect.g"), on_the_floor_inside, [&](glm::dvec3 at) { return nearest(at)->arrives; });
    EXPECT_GT(m.expected_mean, 0.02);
    EXPECT_NEAR(m.mean, m.expected_mean, 0.1 * m.expected_mean) << bounces;
  }
  const Image none = run(g, joined(settings, {{"ambient_bounce", "0"}}));
  EXPECT_EQ(test::difference(none.plane("indirect.g"), Plane(160, 160, 0.0f), 0.0).max, 0.0);
}

TEST(Hemisphere, AmbientBouncesInAClosedRoomMatchQuadrature) {
  // A closed white room, seen from inside. Ambient light arrives equally from everything beyond the radius; nearer
  // surfaces occlude it, and reflect the light that they receive.
  constexpr double kRadius = 0.8;
  const auto face = [](glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v) {
    return Rectangle{
        .corner = corner, .u = u, .v = v, .ambient = glm::dvec3(kBoxAlbedo * kBoxAmbient), .albedo = kBoxAlbedo};
  };
  const Rectangles room = {face({-1, 0, 2}, {2, 0, 0}, {0, 0, -4}), face({-1, 2, -2}, {2, 0, 0}, {0, 0, 4}),
                           face({-1, 0, -2}, {2, 0, 0}, {0, 2, 0}), face({1, 0, 2}, {-2, 0, 0}, {0, 2, 0}),
                           face({-1, 0, 2}, {0, 0, -4}, {0, 2, 0}), face({1, 0, -2}, {0, 0, 4}, {0, 2, 0})};
  const GBuffer g = picture(room, perspective_camera({0, 1.2f, 1.9f}, {0, 0.8f, -2}, {0, 1, 0}, 62, 1.0f), 160, 160);

  // Returns the cosine-weighted mean, over directions about a normal, of `emitted` at surfaces within the radius, and
  // of 0 beyond it.
  const auto gathered = [&](glm::dvec3 at, glm::dvec3 normal, int steps, const auto& emitted) {
    const glm::dvec3 across =
        glm::normalize(glm::cross(normal, std::fabs(normal.y) > 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
    const glm::dvec3 along = glm::cross(normal, across);
    double sum = 0.0;
    for (int j = 0; j < steps; ++j)
      for (int i = 0; i < 2 * steps; ++i) {
        const double sine2 = (j + 0.5) / steps, turn = kPi * (i + 0.5) / steps;
        const glm::dvec3 direction =
            std::sqrt(sine2) * (std::cos(turn) * across + std::sin(turn) * along) + std::sqrt(1.0 - sine2) * normal;
        const auto met = intersections(room, at + 1e-6 * normal, direction);
        if (!met.empty() && met[0].t < kRadius) sum += emitted(at + met[0].t * direction, *met[0].on);
      }
    return sum / (2 * steps * steps);
  };
  const double own = kBoxAlbedo * kBoxAmbient;
  const auto occluded_fraction = [&](glm::dvec3 at, const Rectangle& on) {
    return gathered(at, on.normal(), 16, [](glm::dvec3, const Rectangle&) { return 1.0; });
  };
  constexpr double kAssumedVisibility = 0.7;  // of ambient light, in the first round
  const auto emitted_first = [&](glm::dvec3, const Rectangle&) { return own * kAssumedVisibility; };
  const auto emitted_second = [&](glm::dvec3 at, const Rectangle& on) {
    const double fraction = occluded_fraction(at, on);
    return own * (1.0 - fraction) + kBoxAlbedo * own * kAssumedVisibility * fraction;
  };
  // The second bounce depends on the visibility that the effect computes, here with the weight of the look `bleeding`.
  const Settings settings = {{"bleeding", "1"}, {"radius", "0.8"}, {"samples", "64"},
                             {"range", "none"}, {"noise", "0"},    {"weight", "2"}};
  for (const int bounces : {1, 2}) {
    const Image image = run(g, joined(settings, {{"bounces", std::to_string(bounces)}}));
    double mean = 0.0, expected_mean = 0.0;
    int count = 0;
    for (int y = 0; y < 160; ++y)
      for (int x = 0; x < 160; ++x) {
        const glm::dvec3 at = world_position(g, x, y);
        // In this part of the floor, all surfaces within the radius are visible.
        if (!on_floor(at) || std::fabs(at.x) > 0.9 || at.z < -1.9 || at.z > -0.9) continue;
        mean += image.plane("indirect.g").at(x, y);
        if (count++ % 23 == 0)
          expected_mean += 23.0 * (bounces == 1 ? gathered(at, {0, 1, 0}, 16, emitted_first)
                                                : gathered(at, {0, 1, 0}, 16, emitted_second));
      }
    EXPECT_GT(count, 500);
    EXPECT_GT(expected_mean / count, 0.02);
    EXPECT_NEAR(mean / expected_mean, 1.0, 0.1) << bounces;
  }
}

// ---- layers
// ------------------------------------------------------------------------------------------

/// Returns a drape whose far side is lit red, and behind it the face of a box, of which a part is visible beside the
/// drape.
Rectangles drape_and_box() {
  return {{.corner = {-1.2, 0, 0}, .u = {1.4, 0, 0}, .v = {0, 2, 0}, .front = {0, 0, 0}, .back = kRed},
          {.corner = {-0.5, 0, -0.7}, .u = {3, 0, 0}, .v = {0, 2, 0}}};
}
const Camera kDrapeCamera = perspective_camera({0, 1, 6}, {0.4f, 1, 0}, {0, 1, 0}, 25, 1.0f);
const Settings kDrapeSettings = {{"bleeding", "1"}, {"radius", "1.8"}, {"samples", "64"}, {"noise", "0"}};

Means behind_drape(const GBuffer& g, const Settings& settings) {
  const Rectangles scene = drape_and_box();
  const Image image = run(g, settings);
  return means(
      g, image.plane("indirect.r"),
      [](glm::dvec3 at) { return at.z < -0.69 && at.x < 0.8 && std::fabs(at.y - 1.0) < 0.4; },
      [&](glm::dvec3 at) {
        return light_by_quadrature(scene, at, {0, 0, 1}, 1.8).x;
      });
}

TEST(Hemisphere, LayersColourTheBoxBehindADrape) {
  const GBuffer one = picture(drape_and_box(), kDrapeCamera, 64, 64);
  const GBuffer layers = picture(drape_and_box(), kDrapeCamera, 64, 64, 2, true);
  const Means without = behind_drape(one, kDrapeSettings), with = behind_drape(layers, kDrapeSettings);
  ASSERT_GT(with.count, 50);
  EXPECT_GT(with.expected_mean, 0.05);
  EXPECT_LT(without.mean, 0.1 * without.expected_mean);
  EXPECT_GT(with.mean, 0.5 * with.expected_mean);
  EXPECT_LT(with.mean, 1.3 * with.expected_mean);
}

TEST(Hemisphere, AnotherCameraSeesTheDrapesOtherSide) {
  GBuffer g = picture(drape_and_box(), kDrapeCamera, 64, 64);
  // The other camera is behind the drape and to the left, and sees its far side.
  for (const bool orthographic : {false, true}) {
    const Camera other = orthographic ? orthographic_camera({-3, 1.5f, -3}, {-0.5f, 1, 0}, {0, 1, 0}, 3, 1.0f)
                                      : perspective_camera({-3, 1.5f, -3}, {-0.5f, 1, 0}, {0, 1, 0}, 45, 1.0f);
    GBuffer more = g;
    more.layers.push_back(layer_of(drape_and_box(), other, 64, 64, 0, false));
    more.info.more_layers.push_back({.kind = LayerKind::kOther, .of = 0, .camera = other});
    const Means with = behind_drape(more, kDrapeSettings);
    EXPECT_GT(with.mean, 0.5 * with.expected_mean) << orthographic;
    EXPECT_LT(with.mean, 1.3 * with.expected_mean) << orthographic;
  }
}

TEST(Hemisphere, OccluderBehindAnOccluderOutOfRangeCounts) {
  // In the first layer, a rail far in front of the wall covers some of the surroundings of the wall's foot.
  Rectangles scene = floor_and_wall();
  scene.push_back({.corner = {1.85, 1.55, 2}, .u = {0, 0, -1}, .v = {0, 0.04, 0}});
  const Settings settings = {{"radius", "0.4"}, {"range", "constant"}, {"samples", "64"}};
  const Image one = run(picture(scene, kFloorCamera, 128, 128), settings);
  const Image two = run(picture(scene, kFloorCamera, 128, 128, 2), settings);
  int darker = 0, lighter = 0;
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 128; ++x) {
      darker += two.plane("ao").at(x, y) < one.plane("ao").at(x, y) - 1e-3;
      lighter += two.plane("ao").at(x, y) > one.plane("ao").at(x, y) + 1e-3;
    }
  EXPECT_GT(darker, 50);
  EXPECT_EQ(lighter, 0);
}

TEST(Hemisphere, UsesTheRequestedNumberOfLayers) {
  const GBuffer one = picture(drape_and_box(), kDrapeCamera, 48, 48);
  const GBuffer layers = picture(drape_and_box(), kDrapeCamera, 48, 48, 2, true);
  const Image expected = run(one, kDrapeSettings);
  const Image first = run(layers, joined(kDrapeSettings, {{"layers", "1"}}));
  const Image all = run(layers, kDrapeSettings), four = run(layers, joined(kDrapeSettings, {{"layers", "4"}}));
  for (const char* name : {"ao", "indirect.r"}) {
    EXPECT_EQ(test::difference(first.plane(name), expected.plane(name), 0.0).max, 0.0) << name;
    EXPECT_EQ(test::difference(four.plane(name), all.plane(name), 0.0).max, 0.0) << name;
  }
  EXPECT_GT(test::difference(all.plane("indirect.r"), expected.plane("indirect.r"), 0.0).max, 0.01);
}

TEST(Hemisphere, LanesAgreeWithScalarInLayersAndOtherViews) {
  GBuffer g = picture(drape_and_box(), kDrapeCamera, 61, 47, 2, true);
  const Camera other = perspective_camera({-3, 1.5f, -3}, {-0.5f, 1, 0}, {0, 1, 0}, 45, 1.0f);
  g.layers.push_back(layer_of(drape_and_box(), other, 61, 47, 0, false));
  g.info.more_layers.push_back({.kind = LayerKind::kOther, .of = 0, .camera = other});
  g.layers.push_back(layer_of(drape_and_box(), other, 61, 47, 0, true));
  g.info.more_layers.push_back({.kind = LayerKind::kBack, .of = 4, .camera = {}});
  const Image expected = test::run_effect(*find_effect("hemisphere"), g, kDrapeSettings, {.scalar = true});
  test::on_every_target("hemisphere", g, kDrapeSettings, [&](const Image& image) {
    for (const char* name : {"ao", "indirect.r"}) {
      const auto d = test::difference(image.plane(name), expected.plane(name), 1e-4);
      EXPECT_LE(d.fraction_over, 2e-3) << name;  // one sample of 64 that falls on a pixel's border
      EXPECT_LE(d.mean, 1e-4) << name;
    }
  });
}

// ---- range and switches
// ------------------------------------------------------------------------------------------

/// Returns two planes side by side that face the camera, at depths 4 and 5.
GBuffer two_depths() {
  const Rectangles scene = {{.corner = {-9, -9, -4}, .u = {9, 0, 0}, .v = {0, 18, 0}, .front = kRed},
                            {.corner = {-9, -9, -5}, .u = {18, 0, 0}, .v = {0, 18, 0}}};
  return picture(scene, orthographic_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 4, 1.0f), 64, 64);
}

TEST(Hemisphere, RangeLimitsMatchTheirFormulas) {
  const GBuffer g = two_depths();
  // Returns the occlusion of pixels at depth 5, beside a surface that is nearer by 1. The radius is 1.
  const auto fraction = [&](const Settings& settings) {
    const Image image =
        run(g, joined({{"radius", "1"}, {"samples", "64"}, {"weight", "0.5"}, {"bias_of", "depth"}}, settings));
    double sum = 0.0;
    for (int y = 20; y < 44; ++y)
      for (int x = 32; x < 42; ++x) sum += (1.0 - image.plane("ao").at(x, y)) / 240.0;
    return sum;
  };
  const double all = fraction({{"range", "none"}});
  EXPECT_GT(all, 0.05);
  const auto edge = [&](const char* range, const char* depth, double factor) {
    const Settings settings = {{"range", range}, {"range_depth", depth}, {"near", "2"}, {"far", "10"}};
    EXPECT_NEAR(fraction(joined(settings, {{"range_factor", fmt::format("{}", 1.03 * factor)}})), all, 1e-6)
        << range << depth;
    EXPECT_EQ(fraction(joined(settings, {{"range_factor", fmt::format("{}", 0.97 * factor)}})), 0.0) << range << depth;
  };
  // All limits are equal at the depth sqrt(2 10); beyond it, `linear` and `quadratic` fall. The window depth at z is
  // 10/8 (1 - 2/z), so that the two surfaces differ by 1/8, which is the radius divided by the span.
  const double depth_ratio = std::sqrt(20.0) / 5.0;
  edge("constant", "view", 1.0);
  edge("linear", "view", 1.0 / depth_ratio);
  edge("quadratic", "view", 1.0 / (depth_ratio * depth_ratio));
  edge("constant", "window", 1.0);
  edge("linear", "window", 1.0 / depth_ratio);
  edge("quadratic", "window", 1.0 / (depth_ratio * depth_ratio));
  const double t = 0.6;
  for (const char* depth : {"view", "window"})
    EXPECT_NEAR(
        fraction(
            {{"range", "smoothstep"}, {"range_depth", depth}, {"range_factor", "0.6"}, {"near", "2"}, {"far", "10"}}),
        all * t * t * (3.0 - 2.0 * t), 1e-5);
}

TEST(Hemisphere, EachPartCanBeSwitchedOff) {
  const GBuffer g = picture(floor_and_wall(), kFloorCamera, 96, 96);
  const Settings both = {{"bleeding", "1"}, {"radius", "1"}};
  const Image all = run(g, both);
  const Image bleeding = run(g, joined(both, {{"occlusion", "off"}}));
  EXPECT_EQ(test::difference(bleeding.plane("ao"), Plane(96, 96, 1.0f), 0.0).max, 0.0);
  EXPECT_EQ(test::difference(bleeding.plane("indirect.r"), all.plane("indirect.r"), 0.0).max, 0.0);
  const Image occlusion = run(g, joined(both, {{"bleeding", "0"}}));
  EXPECT_EQ(occlusion.find("indirect.r"), nullptr);
  EXPECT_EQ(test::difference(occlusion.plane("ao"), all.plane("ao"), 0.0).max, 0.0);
  const Image doubled = run(g, joined(both, {{"bleeding", "2"}}));
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x)
      ASSERT_NEAR(doubled.plane("indirect.r").at(x, y), 2.0f * all.plane("indirect.r").at(x, y), 1e-6);
}

TEST(Hemisphere, ScaleOfTheSceneDoesNotMatter) {
  const auto scaled = [](double scale) {
    Rectangles scene = floor_and_wall();
    for (Rectangle& r : scene) {
      r.corner *= scale;
      r.u *= scale;
      r.v *= scale;
    }
    const float s = float(scale);
    GBuffer g = picture(
        scene, perspective_camera({3.5f * s, 3 * s, 3 * s}, {0.3f * s, 0.2f * s, 0}, {0, 1, 0}, 40, 1.0f), 96, 96);
    g.info.scene_radius *= s;
    g.info.depth_min *= s;
    g.info.depth_max *= s;
    return run(g, {{"bleeding", "1"}, {"radius", "20%"}, {"samples", "32"}});
  };
  const Image one = scaled(1.0);
  EXPECT_GT(test::difference(one.plane("indirect.r"), Plane(96, 96, 0.0f), 0.0).mean, 0.01);
  for (const double scale : {1e-3, 1e3}) {
    const Image other = scaled(scale);
    for (const char* name : {"ao", "indirect.r"})
      EXPECT_LT(test::difference(one.plane(name), other.plane(name), 1e-2).fraction_over, 0.01) << scale << name;
  }
}

TEST(Hemisphere, RadiusIsSetInSceneUnits) {
  const GBuffer g = two_depths();
  const Effect& effect = *find_effect("hemisphere");
  ParameterBytes bytes = test::parameters_of(effect, {});
  EXPECT_FLOAT_EQ(constants(g, {}).radius, 0.5f);  // 10% of the scene's radius, 5
  effect.set_radius(0.8f, g.info, bytes);
  EXPECT_EQ(as<HemisphereParams>(bytes).radius.value, 0.8f);
  EXPECT_EQ(as<HemisphereParams>(bytes).radius.relative, 0);
}

TEST(Hemisphere, NoiseIsTiledAndSeeded) {
  const GBuffer g = two_depths();
  const auto column = [&](const char* noise, const char* seed, const char* distribution, int from) {
    const Image image = run(g, {{"radius", "1"},
                                {"noise", noise},
                                {"seed", seed},
                                {"distribution", distribution},
                                {"range", "none"},
                                {"bias_of", "depth"}});
    std::vector<float> values;
    for (int y = from; y < from + 8; ++y) values.push_back(image.plane("ao").at(33, y));
    return values;
  };
  for (const char* distribution : {"even", "paper"}) {
    EXPECT_EQ(column("4", "0", distribution, 20), column("4", "0", distribution, 24));
    EXPECT_NE(column("4", "0", distribution, 20), column("4", "0", distribution, 22));
    EXPECT_EQ(column("1", "0", distribution, 20), column("1", "0", distribution, 21));
    EXPECT_NE(column("0", "0", distribution, 20), column("0", "0", distribution, 24));
    EXPECT_NE(column("4", "0", distribution, 20), column("4", "7", distribution, 20));
  }
}

// ---- odd input
// ------------------------------------------------------------------------------------------

TEST(Hemisphere, TangentsAreTheBasisRotatedByTheTile) {
  const GBuffer g = test::bumpy_gbuffer(83, 61, 5);
  const Image& layer = g.layers[0];
  for (const char* distribution : {"even", "paper"})
    test::on_every_target(
        "hemisphere", g, {{"tangents", "on"}, {"distribution", distribution}}, [&](const Image& image) {
          const auto vector = [](const Image& of, const char* name, int x, int y) {
            const auto axis = [&](const char* a) { return double(of.plane(std::string(name) + a).at(x, y)); };
            return glm::dvec3(axis(".x"), axis(".y"), axis(".z"));
          };
          // Cosine and sine of the rotation at each pixel of the tile. They do not depend on the normal.
          std::vector<glm::dvec2> turns(16, glm::dvec2(0.0));
          int compared = 0;
          for (int y = 0; y < 61; ++y)
            for (int x = 0; x < 83; ++x) {
              const glm::dvec3 tangent = vector(image, "tangent", x, y);
              if (!std::isfinite(layer.plane("depth").at(x, y))) {
                EXPECT_EQ(glm::length(tangent), 0.0);
                continue;
              }
              const glm::dvec3 normal = glm::normalize(vector(layer, "normal", x, y));
              const glm::dvec3 fixed = std::fabs(normal.y) > 0.99 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
              const glm::dvec3 first = glm::normalize(glm::cross(fixed, normal)), second = glm::cross(normal, first);
              const glm::dvec2 turn(glm::dot(tangent, first), glm::dot(tangent, second));
              EXPECT_NEAR(glm::length(turn), 1.0, 1e-5);
              EXPECT_NEAR(glm::dot(tangent, normal), 0.0, 1e-5);
              glm::dvec2& known = turns[std::size_t(y % 4 * 4 + x % 4)];
              if (known == glm::dvec2(0.0)) known = turn;
              EXPECT_LT(glm::length(turn - known), 1e-4) << x << ' ' << y;
              ++compared;
            }
          EXPECT_GT(compared, 2000);
          for (std::size_t a = 0; a < 16; ++a)
            for (std::size_t b = 0; b < a; ++b) EXPECT_GT(glm::length(turns[a] - turns[b]), 1e-3) << a << ' ' << b;
        });
  const Image plain = run(g, {});
  EXPECT_EQ(plain.find("tangent.x"), nullptr);
}

TEST(Hemisphere, ZeroSamplesAndZeroRadiusAreErrors) {
  const Effect& effect = *find_effect("hemisphere");
  ParameterBytes bytes = test::parameters_of(effect, {});
  for (const auto& [name, value] : Settings{{"samples", "0"}, {"samples", "257"}, {"radius", "0"}, {"radius", "0%"}}) {
    const auto status = set_parameter("hemisphere", *find_parameter(effect, name), value, bytes);
    ASSERT_FALSE(status) << name << value;
    EXPECT_NE(status.error().message.find(name), std::string::npos);
  }
}

TEST(Hemisphere, MissingPlanesAreDarkOrErrors) {
  GBuffer g = picture(floor_and_wall(), kFloorCamera, 48, 48);
  GBuffer unlit = g;
  Image& image = unlit.layers[0];
  image = Image(48, 48);
  for (const char* name : {"depth", "normal.x", "normal.y", "normal.z"}) image.add(name) = g.layers[0].plane(name);
  const Image dark = run(unlit, {{"bleeding", "1"}, {"bounces", "3"}});
  EXPECT_EQ(test::difference(dark.plane("indirect.r"), Plane(48, 48, 0.0f), 0.0).max, 0.0);

  const Effect& effect = *find_effect("hemisphere");
  const auto device = make_cpu_device({});
  auto frame = device->upload({.info = g.info, .layers = {Image(48, 48)}});
  const auto status = device->run(effect, test::parameters_of(effect, {}), *frame);
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().message.find("depth"), std::string::npos);
}

TEST(Hemisphere, RadiusBeyondTheSceneAndBlackSurfacesAreDefined) {
  Rectangles scene = open_box();
  for (Rectangle& r : scene) {
    r.albedo = 0.0;
    r.ambient = glm::dvec3(0.0);
  }
  const GBuffer g = picture(scene, kFloorCamera, 48, 48);
  const Image image = run(g, {{"bleeding", "1"}, {"bounces", "3"}, {"radius", "1e6"}});
  EXPECT_EQ(test::difference(image.plane("indirect.r"), Plane(48, 48, 0.0f), 0.0).max, 0.0);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 48; ++x) {
      EXPECT_GE(image.plane("ao").at(x, y), 0.0f);
      EXPECT_LE(image.plane("ao").at(x, y), 1.0f);
    }
}

TEST(Hemisphere, InvalidDepthAndLightHaveNoEffect) {
  GBuffer g = two_depths();
  const float invalid_values[] = {std::nanf(""), -kInfinity, 0.0f, -1.0f};
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 32; ++x) g.layers[0].plane("depth").at(x, y) = invalid_values[(x + y) % 4];
  const Settings settings = {{"bleeding", "1"}, {"radius", "1"}, {"range", "none"}};
  test::on_every_target("hemisphere", g, settings, [&](const Image& image) {
    EXPECT_EQ(test::difference(image.plane("ao"), Plane(64, 64, 1.0f), 0.0).max, 0.0);
    EXPECT_EQ(test::difference(image.plane("indirect.r"), Plane(64, 64, 0.0f), 0.0).max, 0.0);
  });
  GBuffer bad_light = picture(floor_and_wall(), kFloorCamera, 64, 64);
  for (const float value : {std::nanf(""), kInfinity, -5.0f}) {
    bad_light.layers[0].plane("direct.r") = Plane(64, 64, value);
    test::on_every_target("hemisphere", bad_light, settings, [&](const Image& image) {
      EXPECT_EQ(test::difference(image.plane("indirect.r"), Plane(64, 64, 0.0f), 0.0).max, 0.0) << value;
    });
  }
}

TEST(Hemisphere, InvalidNormalFacesTheCamera) {
  const GBuffer g = two_depths();
  for (const float value : {0.0f, std::nanf(""), kInfinity}) {
    GBuffer without = g;
    for (const char* name : kNormal) without.layers[0].plane(name) = Plane(64, 64, value);
    const Settings settings = {{"radius", "1"}};
    const Plane expected = run(g, settings).plane("ao");
    test::on_every_target("hemisphere", without, settings, [&](const Image& image) {
      EXPECT_LT(test::difference(image.plane("ao"), expected, 1e-5).fraction_over, 1e-2) << value;
    });
  }
}

}  // namespace
}  // namespace umbrage
