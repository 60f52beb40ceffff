// The reference on scenes whose occlusion and light are known in closed form or by quadrature in double. Random results
// may deviate by three standard errors. The standard error is measured over pixels, whose noise is independent.
#include "reference/reference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <memory>
#include <set>
#include <sstream>
#include <thread>

#include "build_paths.h"
#include "devices/cpu/capture.h"
#include "devices/cpu/cpu_device.h"
#include "effects/effects.h"
#include "generators/builtin.h"
#include "generators/shapes.h"
#include "reference/sampler.h"
#include "scene/finish.h"
#include "support.h"

namespace umbrage {
namespace {

using test::PixelRay;
using test::ray_of;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
// Size of walls that stand for infinite walls. At a distance of 1 the missing part contributes less than 1e-5.
constexpr float kFar = 1e5f;

// ---- statistics ----

/// Mean and standard error of independent samples.
struct Tally {
  double sum = 0.0, squares = 0.0;
  long count = 0;

  void add(double value) {
    sum += value;
    squares += value * value;
    ++count;
  }
  double mean() const { return sum / double(count); }
  double variance() const { return std::max(squares - sum * mean(), 0.0) / double(count - 1); }
  double standard_error() const { return std::sqrt(variance() / double(count)); }
};

/// Expects that the mean is `expected`, within three standard errors and rounding. The standard error must be below
/// `max_error`; otherwise the test would prove nothing.
void expect_mean(const Tally& tally, double expected, double max_error, std::string_view what) {
  constexpr double kFloats = 1e-6;
  ASSERT_GE(tally.count, 30) << what;
  EXPECT_LT(tally.standard_error(), max_error) << what;
  EXPECT_NEAR(tally.mean(), expected, 3.0 * tally.standard_error() + kFloats)
      << what << ": " << (tally.mean() - expected) / tally.standard_error() << " standard errors";
}

// ---- scenes: z is up, the floor is at z = 0 ----

/// Makes the parallelogram origin + s u + t v for s, t in [0, 1], with texture coordinates (s, t).
Mesh parallelogram(glm::vec3 origin, glm::vec3 u, glm::vec3 v) {
  Mesh mesh;
  mesh.positions = {origin, origin + u, origin + u + v, origin + v};
  mesh.normals.assign(4, glm::normalize(glm::cross(u, v)));
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

/// Makes a horizontal square of side 2 half.
Mesh level_square(float half, float height = 0.0f) {
  return parallelogram({-half, -half, height}, {2 * half, 0, 0}, {0, 2 * half, 0});
}

/// Makes a wall in the plane x = `where`, from -height to height. It extends below the floor so that the scene's
/// centre, where floats are most precise, is on the floor.
Mesh wall_x(float where, float height = kFar, float half_length = kFar) {
  return parallelogram({where, -half_length, -height}, {0, 2 * half_length, 0}, {0, 0, 2 * height});
}

Mesh wall_y(float where) { return parallelogram({-kFar, where, -kFar}, {2 * kFar, 0, 0}, {0, 0, 2 * kFar}); }

/// A scene and its traced scene, which points to it; therefore the scene is on the heap.
struct PreparedScene {
  std::unique_ptr<Scene> scene;
  TracedScenePtr traced;

  const TracedScene& operator*() const { return *traced; }
  PictureInfo info(const Camera& camera, int width, int height, int guard = 0) const {
    return picture_info(*scene, camera, {.width = width, .height = height, .guard = guard});
  }
};

PreparedScene make_prepared_scene(Scene scene) {
  PreparedScene prepared{std::make_unique<Scene>(std::move(scene)), {}};
  auto traced = build_traced_scene(*prepared.scene);
  EXPECT_TRUE(traced);
  prepared.traced = std::move(*traced);
  return prepared;
}

/// Makes a finished scene. Mesh k is object k and has material k, or the last material.
Scene scene_of(std::vector<Mesh> meshes, std::vector<Material> materials = {Material{}}, std::vector<Light> lights = {},
               std::vector<Texture> textures = {}) {
  Scene scene;
  scene.name = "test";
  scene.meshes = std::move(meshes);
  scene.materials = std::move(materials);
  scene.textures = std::move(textures);
  scene.lights = std::move(lights);
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    scene.meshes[m].object = int(m);
    scene.meshes[m].material = int(std::min(m, scene.materials.size() - 1));
  }
  EXPECT_EQ(finish_scene(scene), 0u);
  return scene;
}

/// Returns a camera above (x, y) that looks straight down on the floor.
Camera from_above(float width, float height, glm::vec2 at = {0, 0}, float from = 10.0f) {
  return orthographic_camera({at.x, at.y, from}, {at.x, at.y, 0}, {0, 1, 0}, height, width / height);
}

/// Returns the intersection of a pixel's ray with the floor, z = 0.
glm::dvec3 on_floor(const PixelRay& ray) { return ray.origin - ray.direction * (ray.origin.z / ray.direction.z); }

glm::dvec3 vector_at(const Image& image, std::string_view name, std::array<const char*, 3> parts, int x, int y) {
  glm::dvec3 v;
  for (int c = 0; c < 3; ++c) v[c] = image.plane(fmt::format("{}.{}", name, parts[c])).at(x, y);
  return v;
}

glm::dvec3 color_at(const Image& image, std::string_view name, int x, int y) {
  return vector_at(image, name, {"r", "g", "b"}, x, y);
}

/// Returns the bent normal in world space.
glm::dvec3 bent_at(const Image& image, const PictureInfo& info, int x, int y) {
  return glm::transpose(glm::dmat3(glm::mat3(info.camera.view_from_world))) *
         vector_at(image, "bent_normal", {"x", "y", "z"}, x, y);
}

Image occlusion(const PreparedScene& prepared, const PictureInfo& info, const OcclusionSettings& settings) {
  auto image = trace_occlusion(*prepared, info, settings);
  EXPECT_TRUE(image);
  return std::move(*image);
}

Image light(const PreparedScene& prepared, const PictureInfo& info, const LightSettings& settings) {
  auto image = trace_light(*prepared, info, settings);
  EXPECT_TRUE(image);
  return std::move(*image);
}

void for_each_pixel(const PictureInfo& info, const std::function<void(int x, int y)>& visit) {
  for (int y = 0; y < info.height; ++y)
    for (int x = 0; x < info.width; ++x) visit(x, y);
}

/// Returns how many pixels differ by more than `bound`.
long differing_pixels(const Plane& a, const Plane& b, double bound = 0.0) {
  return std::lround(test::difference(a, b, bound).fraction_over * a.width * a.height);
}

void expect_equal(const Image& a, const Image& b, std::string_view what) {
  ASSERT_EQ(a.names, b.names) << what;
  for (std::size_t p = 0; p < a.planes.size(); ++p)
    EXPECT_EQ(test::difference(a.planes[p], b.planes[p], 0.0).max, 0.0) << what << ": " << a.names[p];
}

/// Traces occlusion and compares it with `truth` at the floor point of each pixel. `sees_floor` excludes pixels in
/// which something else covers the floor.
void expect_occlusion(
    const PreparedScene& prepared, const PictureInfo& info, const OcclusionSettings& settings,
    const std::function<double(glm::dvec3)>& truth, std::string_view what, double max_error = 1e-3,
    const std::function<bool(const PixelRay&)>& sees_floor = [](const PixelRay&) { return true; }) {
  const Image image = occlusion(prepared, info, settings);
  Tally error;
  for_each_pixel(info, [&](int x, int y) {
    const PixelRay ray = ray_of(info, x, y);
    if (sees_floor(ray)) error.add(image.plane("ao").at(x, y) - truth(on_floor(ray)));
  });
  expect_mean(error, 0.0, max_error, what);
}

// ---- ground truth ---- The cosine-weighted fraction of the hemisphere that a set of directions fills is the area of
// the set's projection on the floor's unit disc, divided by pi.

/// Returns the fraction of a disc beyond a chord at distance k from its centre.
double segment(double k) {
  if (k >= 1.0) return 0.0;
  return (std::acos(k) - k * std::sqrt(1.0 - k * k)) / M_PI;
}

/// An infinite vertical wall: its direction from the floor point, and its distance.
struct Wall {
  double azimuth, distance;
};

/// Visibility at a point of the floor: the fraction of open directions, and the cosine-weighted mean of the open
/// directions as a vector.
struct Visibility {
  double fraction = 0.0;
  glm::dvec3 moment{0.0};
};

/// Computes the visibility between walls and below a ceiling, within a radius, by quadrature.
Visibility assumed_visibility(const std::vector<Wall>& walls, double ceiling, double radius) {
  constexpr int kAzimuths = 4000;
  Visibility open;
  // A direction that projects to r at this azimuth meets the ceiling at ceiling / sqrt(1 - r^2).
  const double ceiling_fraction = std::min(ceiling / radius, 1.0);
  const double low = std::sqrt(1.0 - ceiling_fraction * ceiling_fraction);
  const double from = radius > ceiling ? low : 0.0;
  for (int k = 0; k < kAzimuths; ++k) {
    const double azimuth = (k + 0.5) * 2.0 * M_PI / kAzimuths;
    double to = 1.0;
    for (const Wall& wall : walls)
      if (const double cosine = std::cos(azimuth - wall.azimuth); cosine > 0.0)
        to = std::min(to, wall.distance / radius / cosine);
    if (to <= from) continue;
    const double cubes = (to * to * to - from * from * from) / 3.0;
    const double heights = (std::pow(1.0 - from * from, 1.5) - std::pow(1.0 - to * to, 1.5)) / 3.0;
    open.fraction += (to * to - from * from) / kAzimuths;
    open.moment += glm::dvec3(std::cos(azimuth) * cubes, std::sin(azimuth) * cubes, heights) * (2.0 / kAzimuths);
  }
  return open;
}

double weight_of(Falloff falloff, double fraction) {
  if (fraction >= 1.0) return 0.0;
  if (falloff == Falloff::kNone) return 1.0;
  if (falloff == Falloff::kLinear) return 1.0 - fraction;
  return 1.0 - fraction * fraction * (3.0 - 2.0 * fraction);
}

// ---- occlusion ----

TEST(Reference, QuadratureAgreesWithTheClosedForms) {
  EXPECT_NEAR(assumed_visibility({{0.0, 0.4}}, 9.0, 1.0).fraction, 1.0 - segment(0.4), 1e-6);
  EXPECT_NEAR(assumed_visibility({}, 0.6, 1.0).fraction, 0.36, 1e-12);
  EXPECT_NEAR(assumed_visibility({}, 9.0, 1.0).moment.z, 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(assumed_visibility({{0.0, 0.0}, {M_PI / 2, 0.0}}, 9.0, 1.0).fraction, 0.25, 1e-12);
}

TEST(Reference, PlaneIsExactlyUnoccluded) {
  for (const float tilt_deg : {0.0f, 37.0f, 80.0f})
    for (const glm::vec3 middle : {glm::vec3(0.0f), glm::vec3(300.0f, -200.0f, 500.0f)}) {
      const glm::vec3 u = glm::normalize(glm::vec3(0.8f, 0.3f, -0.2f)), v = glm::normalize(glm::cross({0.1f, 2, 1}, u));
      const glm::vec3 front = glm::cross(u, v), a = middle - u - v;
      const PreparedScene prepared =
          make_prepared_scene(scene_of({shapes::quad(a, a + 2.0f * u, a + 2.0f * (u + v), a + 2.0f * v, 30, 30)}));
      const glm::vec3 eye =
          middle + 6.0f * (std::cos(glm::radians(tilt_deg)) * front + std::sin(glm::radians(tilt_deg)) * u);
      for (const Camera& camera :
           {perspective_camera(eye, middle, v, 12.0f, 1.0f), orthographic_camera(eye, middle, v, 1.2f, 1.0f)})
        for (const float radius : {kInfinity, 0.3f}) {
          const PictureInfo info = prepared.info(camera, 24, 24);
          const Image image = occlusion(prepared, info, {.samples = 100, .radius = radius});
          long surfaces = 0;
          Tally across;
          for_each_pixel(info, [&](int x, int y) {
            EXPECT_EQ(image.plane("ao").at(x, y), 1.0f) << tilt_deg << " deg, " << x << ',' << y;
            const glm::dvec3 bent = bent_at(image, info, x, y);
            if (glm::length(bent) == 0.0) return;
            ++surfaces;
            EXPECT_NEAR(glm::length(bent), 1.0, 1e-6);
            EXPECT_GT(glm::dot(bent, glm::dvec3(front)), 0.99);
            across.add(glm::dot(bent, glm::dvec3(u)));
          });
          EXPECT_GT(surfaces, 100);
          expect_mean(across, 0.0, 2e-3, "bent normal across the plane");
        }
    }
}

TEST(Reference, BackgroundIsOpenAndHasNoNormal) {
  const PreparedScene prepared = make_prepared_scene(scene_of({level_square(0.5f)}));
  const PictureInfo info = prepared.info(from_above(2, 2), 8, 8);
  const Image image = occlusion(prepared, info, {.samples = 4});
  const Image lit = light(prepared, info, {.samples = 4});
  EXPECT_EQ(image.plane("ao").at(0, 0), 1.0f);
  EXPECT_EQ(bent_at(image, info, 0, 0), glm::dvec3(0.0));
  EXPECT_GT(bent_at(image, info, 4, 4).z, 0.5);
  EXPECT_EQ(lit.plane("shadow").at(0, 0), 1.0f);
  EXPECT_EQ(color_at(lit, "direct", 0, 0), glm::dvec3(0.0));
  EXPECT_EQ(color_at(lit, "indirect", 0, 0), glm::dvec3(0.0));
}

TEST(Reference, WallOfFiniteHeight) {
  // Beside a wall whose top is at elevation E, the visibility is (1 + cos E) / 2.
  constexpr double kDistance = 2.0, kHeight = 1.0;
  const PreparedScene prepared = make_prepared_scene(scene_of({level_square(4.0f), wall_x(kDistance, kHeight)}));
  const auto truth = [&](glm::dvec3 p) {
    const double away = kDistance - p.x;
    return 0.5 + 0.5 * away / std::hypot(away, kHeight);
  };
  expect_occlusion(prepared, prepared.info(from_above(3, 3, {0.4f, 0}), 32, 32), {.samples = 256}, truth,
                   "orthographic");
  const Camera camera = perspective_camera({-3, -2, 3}, {0.6f, 0, 0}, {0, 0, 1}, 11.0f, 1.0f);
  expect_occlusion(prepared, prepared.info(camera, 32, 32), {.samples = 256}, truth, "perspective");
}

TEST(Reference, WallWithinARadius) {
  // The projections of hits within the radius R are beyond a chord at distance / R.
  constexpr double kRadius = 1.3;
  const PreparedScene prepared = make_prepared_scene(scene_of({level_square(4.0f), wall_x(1.5f, 3.0f, 6.0f)}));
  const auto truth = [&](glm::dvec3 p) { return 1.0 - segment((1.5 - p.x) / kRadius); };
  const OcclusionSettings settings{.samples = 256, .radius = kRadius};
  expect_occlusion(prepared, prepared.info(from_above(1.6f, 1, {0.65f, 0}), 40, 25), settings, truth, "orthographic");
  const Camera camera = perspective_camera({-3, -2, 3}, {0.8f, 0, 0}, {0, 0, 1}, 7.0f, 1.0f);
  expect_occlusion(prepared, prepared.info(camera, 32, 32), settings, truth, "perspective");
}

TEST(Reference, CornersOfInfiniteWalls) {
  // One infinite wall blocks half of the disc, two walls at a corner block three quarters, three walls all of it.
  const Mesh floor = level_square(4.0f);
  const PictureInfo info = make_prepared_scene(scene_of({floor})).info(from_above(1, 1), 24, 24);
  const auto expect_fraction = [&](std::vector<Mesh> walls, double fraction) {
    walls.push_back(floor);
    const PreparedScene prepared = make_prepared_scene(scene_of(walls));
    expect_occlusion(
        prepared, info, {.samples = 256}, [&](glm::dvec3) { return fraction; }, "infinite walls");
  };
  expect_fraction({wall_x(1)}, 0.5);
  expect_fraction({wall_x(1), wall_y(1)}, 0.25);
  expect_fraction({wall_x(1), wall_y(1), wall_y(-2)}, 0.0);
}

TEST(Reference, CornersWithinARadius) {
  constexpr double kRadius = 1.5;
  for (const int walls : {1, 2, 3}) {
    std::vector<Mesh> meshes = {level_square(4.0f), wall_x(1.0f), wall_y(0.8f), wall_x(-1.2f)};
    meshes.resize(std::size_t(walls) + 1);
    const auto truth = [&](glm::dvec3 p) {
      std::vector<Wall> all = {{0.0, 1.0 - p.x}, {M_PI / 2, 0.8 - p.y}, {M_PI, p.x + 1.2}};
      all.resize(std::size_t(walls));
      return assumed_visibility(all, 100.0, kRadius).fraction;
    };
    const PreparedScene prepared = make_prepared_scene(scene_of(meshes));
    expect_occlusion(prepared, prepared.info(from_above(1.8f, 1.2f), 30, 20), {.samples = 256, .radius = kRadius},
                     truth, fmt::format("{} walls", walls));
  }
}

/// Makes a sphere of radius 1 that touches the floor. Its 384 facets around the axis reduce its size by less than 1e-4.
PreparedScene sphere_on_floor() {
  return make_prepared_scene(scene_of({level_square(20.0f), shapes::moved(shapes::sphere(1.0f, 384, 192), {0, 0, 1})}));
}

bool misses_sphere(const PixelRay& ray) {
  const glm::dvec3 direction = glm::normalize(ray.direction), away = glm::dvec3(0, 0, 1) - ray.origin;
  return glm::length(away - direction * glm::dot(away, direction)) > 1.01;
}

TEST(Reference, SphereOnAPlane) {
  // The sphere fills a cone whose half angle has the sine r / d. The cosine-weighted fraction of the cone is
  // sine^2 cos(theta). Hits within R fill the inner part of the cone, because the distance to the sphere increases with
  // the angle to the axis.
  const PreparedScene prepared = sphere_on_floor();
  for (const float radius : {kInfinity, 1.5f}) {
    const auto truth = [&](glm::dvec3 p) {
      const double squared = p.x * p.x + p.y * p.y + 1.0, distance = std::sqrt(squared);
      double sine_squared = 1.0 / squared;
      if (radius * radius < squared - 1.0) {
        const double cosine = std::min((radius * radius + squared - 1.0) / (2.0 * radius * distance), 1.0);
        sine_squared = 1.0 - cosine * cosine;
      }
      return 1.0 - sine_squared / distance;
    };
    const OcclusionSettings settings{.samples = 256, .radius = radius};
    const std::string what = fmt::format("radius {}", radius);
    expect_occlusion(prepared, prepared.info(from_above(6, 6), 40, 40), settings, truth, what + ", orthographic", 1e-3,
                     misses_sphere);
    const Camera camera = perspective_camera({7, 1, 0.8f}, {0.3f, 0, 0}, {0, 0, 1}, 10.0f, 1.0f);
    expect_occlusion(prepared, prepared.info(camera, 40, 40), settings, truth, what + ", perspective", 1e-3,
                     misses_sphere);
  }
}

TEST(Reference, FloatingSlab) {
  // A slab has a round underside of radius r at height h; the point is at distance a from its axis.
  constexpr double kDisc = 1.0, kHeight = 0.7;
  const Mesh slab = shapes::moved(shapes::turned_x(shapes::cylinder(kDisc, 0.4f, 512), 90.0f), {0, 0, kHeight});
  const PreparedScene prepared = make_prepared_scene(scene_of({level_square(5.0f), slab}));
  const auto truth = [&](glm::dvec3 p) {
    const double a = p.x * p.x + p.y * p.y, h = kHeight * kHeight, r = kDisc * kDisc;
    return 1.0 - 0.5 * (1.0 - (a + h - r) / std::sqrt((a + h + r) * (a + h + r) - 4.0 * a * r));
  };
  EXPECT_NEAR(truth({0, 0, 0}), 1.0 - kDisc * kDisc / (kDisc * kDisc + kHeight * kHeight), 1e-12);
  // Both cameras are below the slab; the sides of the slab occlude nothing that they see.
  expect_occlusion(prepared, prepared.info(from_above(1.4f, 1.4f, {0.2f, 0}, 0.5f), 32, 32), {.samples = 256}, truth,
                   "below");
  const Camera camera = perspective_camera({0.1f, -0.2f, 0.4f}, {0.1f, -0.2f, 0}, {0, 1, 0}, 70.0f, 1.0f);
  expect_occlusion(prepared, prepared.info(camera, 32, 32), {.samples = 256}, truth, "perspective");
  // On the axis, rays of length R reach the plane of the underside if their cosine is above h / R. Here they reach it
  // inside the disc.
  const double radius = 0.9;
  expect_occlusion(
      prepared, prepared.info(from_above(1e-3f, 1e-3f, {0, 0}, 0.5f), 24, 24), {.samples = 256, .radius = 0.9f},
      [&](glm::dvec3) { return kHeight * kHeight / (radius * radius); }, "within a radius");
}

TEST(Reference, FalloffBelowACeiling) {
  // With k = h / R, occlusion is the mean of w(k / c) over the cosines c, which have the density 2 c.
  const PreparedScene prepared = make_prepared_scene(scene_of({level_square(3.0f), level_square(3.0f, 0.4f)}));
  const PictureInfo info = prepared.info(from_above(0.5f, 0.5f, {0, 0}, 0.3f), 24, 24);
  for (const float radius : {0.5f, 1.0f, 2.5f}) {
    const double k = 0.4 / radius;
    const double linear = (1 - k) * (1 - k), smooth = 1 + 3 * k * k - 4 * k * k * k + 6 * k * k * std::log(k);
    const auto expect_closed = [&](Falloff falloff, double closed) {
      expect_occlusion(
          prepared, info, {.samples = 256, .radius = radius, .falloff = falloff},
          [&](glm::dvec3) { return 1.0 - closed; }, fmt::format("{}, radius {}", int(falloff), radius));
    };
    expect_closed(Falloff::kNone, 1 - k * k);
    expect_closed(Falloff::kLinear, linear);
    expect_closed(Falloff::kSmooth, smooth);
  }
}

TEST(Reference, FalloffBesideAWall) {
  constexpr double kRadius = 2.0;
  const PreparedScene prepared = make_prepared_scene(scene_of({level_square(4.0f), wall_x(1.5f, 3.0f, 6.0f)}));
  const PictureInfo info = prepared.info(from_above(1.6f, 1.6f, {0.65f, 0}), 24, 24);
  for (const Falloff falloff : {Falloff::kLinear, Falloff::kSmooth}) {
    std::vector<double> columns;  // the truth depends only on x
    for (int x = 0; x < info.width; ++x) {
      constexpr int kSteps = 400;
      const double k = (1.5 - on_floor(ray_of(info, x, 0)).x) / kRadius;
      double closed = 0.0;
      // Integrate over chords of the disc at distance s. In all directions that project to a chord, the wall is k / s
      // radii away.
      for (int i = 0; i < kSteps; ++i) {
        const double s = k + (1.0 - k) * (i + 0.5) / kSteps;
        closed += weight_of(falloff, k / s) * 2.0 * std::sqrt(1.0 - s * s) / M_PI * (1.0 - k) / kSteps;
      }
      columns.push_back(1.0 - closed);
    }
    const auto truth = [&](glm::dvec3 p) { return columns[std::size_t((p.x + 0.15) / 1.6 * info.width)]; };
    expect_occlusion(prepared, info, {.samples = 256, .radius = kRadius, .falloff = falloff}, truth, "beside a wall");
  }
}

TEST(Reference, BentNormalBesideAWall) {
  const PreparedScene prepared = make_prepared_scene(scene_of({level_square(4.0f), wall_x(1.0f)}));
  const Camera tilted = perspective_camera({-4, -3, 5}, {0.2f, 0, 0}, {0, 0, 1}, 6.0f, 1.0f);
  for (const float radius : {1.0f, 20.0f})
    for (const Camera& camera : {from_above(1.5f, 1.5f), tilted}) {
      const PictureInfo info = prepared.info(camera, 24, 24);
      const Image image = occlusion(prepared, info, {.samples = 256, .radius = radius});
      Tally towards, along;
      for_each_pixel(info, [&](int x, int y) {
        const glm::dvec3 bent = bent_at(image, info, x, y);
        const double distance = 1.0 - on_floor(ray_of(info, x, y)).x;
        const glm::dvec3 expected = glm::normalize(assumed_visibility({{0.0, distance}}, 1e9, radius).moment);
        ASSERT_NEAR(glm::length(bent), 1.0, 1e-6);
        ASSERT_GT(glm::dot(bent, expected), 0.99);
        towards.add(glm::dot(bent, glm::dvec3(expected.z, 0.0, -expected.x)));
        along.add(bent.y);
      });
      expect_mean(towards, 0.0, 1e-3, fmt::format("towards the wall, radius {}", radius));
      expect_mean(along, 0.0, 1e-3, fmt::format("along the wall, radius {}", radius));
    }
}

TEST(Reference, BentNormalOfSymmetricScenesIsSymmetric) {
  const PreparedScene prepared =
      make_prepared_scene(scene_of({level_square(4.0f), wall_x(1.0f), wall_x(-1.0f), wall_y(0.5f)}));
  const PictureInfo info = prepared.info(from_above(1e-4f, 1e-4f), 32, 32);
  const Image image = occlusion(prepared, info, {.samples = 100, .radius = 3.0f});
  Tally side;
  for_each_pixel(info, [&](int x, int y) {
    const glm::dvec3 bent = bent_at(image, info, x, y);
    side.add(bent.x);
    EXPECT_LT(bent.y, -0.2) << "it points away from the wall";
  });
  expect_mean(side, 0.0, 2e-3, "x");
}

TEST(Reference, WhereNothingIsOpenTheBentNormalIsTheNormal) {
  const PreparedScene prepared = make_prepared_scene(scene_of({shapes::box({-1, -1, 0}, {1, 1, 1})}));
  const PictureInfo info = prepared.info(from_above(1.8f, 1.8f, {0, 0}, 0.5f), 16, 16);
  const Image image = occlusion(prepared, info, {.samples = 256});
  for_each_pixel(info, [&](int x, int y) {
    EXPECT_EQ(image.plane("ao").at(x, y), 0.0f) << "no ray leaves a closed box";
    EXPECT_EQ(bent_at(image, info, x, y), glm::dvec3(0, 0, 1));
  });
}

TEST(Reference, ConvexMeshesAreOpenAroundTheirTriangles) {
  const PreparedScene prepared = make_prepared_scene(scene_of({shapes::sphere(1.0f, 12, 6)}));
  const PictureInfo info = prepared.info(perspective_camera({2, 3, 4}, {0, 0, 0}, {0, 1, 0}, 28.0f, 1.0f), 48, 48);
  const Image flat = occlusion(prepared, info, {.samples = 64});
  const Image smooth = occlusion(prepared, info, {.samples = 64, .normal = HemisphereNormal::kShading});
  long closed = 0, surfaces = 0;
  for_each_pixel(info, [&](int x, int y) {
    EXPECT_EQ(flat.plane("ao").at(x, y), 1.0f) << x << ',' << y;
    surfaces += glm::length(bent_at(flat, info, x, y)) > 0.0;
    closed += smooth.plane("ao").at(x, y) < 1.0f;
    EXPECT_GT(smooth.plane("ao").at(x, y), 0.9f) << x << ',' << y;
  });
  EXPECT_GT(surfaces, 900);
  EXPECT_GT(closed, surfaces / 4) << "facets show around interpolated normals";
}

TEST(Reference, DirectionsBelowTheTriangleAreBlocked) {
  // The shading normals of a plane are tilted by an angle: (1 + cos angle) / 2 of their hemisphere is above the plane.
  for (const double lean : {0.3, 0.8}) {
    Mesh floor = level_square(2.0f);
    floor.normals.assign(4, glm::vec3(std::sin(lean), 0.0, std::cos(lean)));
    const PreparedScene prepared = make_prepared_scene(scene_of({floor}));
    const PictureInfo info = prepared.info(from_above(2, 2), 32, 32);
    expect_occlusion(
        prepared, info, {.samples = 128, .normal = HemisphereNormal::kShading},
        [&](glm::dvec3) { return 0.5 + 0.5 * std::cos(lean); }, fmt::format("leaning by {}", lean));
    expect_occlusion(
        prepared, info, {.samples = 128}, [](glm::dvec3) { return 1.0; }, "around the triangle's normal");
  }
}

TEST(Reference, CutAwayTexelsLetRaysThrough) {
  // The left half of the ceiling is cut away. Below its centre, half of its occlusion remains.
  Texture halves;
  halves.name = "halves";
  halves.width = 64;
  halves.height = 1;
  for (int x = 0; x < 64; ++x)
    for (const int value : {255, 255, 255, x < 32 ? 0 : 255}) halves.rgba.push_back(std::uint8_t(value));
  Material leaf;
  leaf.texture = 0;
  for (const bool masked : {true, false}) {
    leaf.alpha_mask = masked;
    Mesh ceiling = level_square(4.0f, 1.0f), leaf_below = level_square(0.3f, 0.5f);
    for (glm::vec2& uv : leaf_below.uvs) uv = glm::vec2(0.25f);  // all of it is cut away
    const PreparedScene prepared = make_prepared_scene(
        scene_of({ceiling, leaf_below, level_square(4.0f)}, {leaf, leaf, Material{}}, {}, {halves}));
    // The camera above the lower leaf sees the floor through the leaf, and rays pass through it, too. If the leaf is
    // not cut away, it is the visible surface, 0.5 below the ceiling.
    const double truth = masked ? 1.0 - 0.5 * (1.0 - 1.0 / 4.0) : 1.0 / 16.0;
    expect_occlusion(
        prepared, prepared.info(from_above(1e-3f, 1e-3f, {0, 0}, 0.8f), 24, 24), {.samples = 256, .radius = 2.0f},
        [&](glm::dvec3) { return truth; }, masked ? "cut" : "whole");
  }
}

// ---- direct light ----

Light sun(glm::vec3 towards, glm::vec3 color = glm::vec3(1.0f), float angle_deg = 0.0f) {
  return {.direction = glm::normalize(towards), .color = color, .angle_deg = angle_deg, .casts_shadow = true};
}

Light lamp(glm::vec3 where, float reach = 0.0f, glm::vec3 color = glm::vec3(1.0f), float radius = 0.0f) {
  return {.kind = LightKind::kPoint,
          .position = where,
          .color = color,
          .reach = reach,
          .radius = radius,
          .casts_shadow = true};
}

Material matt(glm::vec3 albedo, glm::vec3 emission = glm::vec3(0.0f)) {
  Material material;
  material.albedo = albedo;
  material.emission = emission;
  return material;
}

TEST(Reference, HardShadowsMatchTheCapture) {
  for (const Light& key : {sun({0.9f, 0.5f, 1.0f}), lamp({1.5f, -0.5f, 4.0f})}) {
    const PreparedScene prepared =
        make_prepared_scene(scene_of({level_square(8.0f), level_square(1.0f, 2.0f),
                                      shapes::moved(shapes::sphere(1.0f, 48, 24), {-2.0f, 1.0f, 1.0f})},
                                     {Material{}}, {key}));
    const PictureInfo info =
        prepared.info(perspective_camera({-5, -6, 9}, {-1, -1, 0}, {0, 0, 1}, 40.0f, 1.0f), 100, 100);
    const Image drawn = *capture_planes(*prepared, info, {.width = 100, .height = 100});
    const Image traced = light(prepared, info, {.samples = 4, .bounce = false});
    long dark = 0;
    for_each_pixel(info, [&](int x, int y) { dark += drawn.plane("shadow").at(x, y) == 0.0f; });
    EXPECT_GT(dark, 300);
    EXPECT_LT(dark, 5000);
    EXPECT_LE(differing_pixels(drawn.plane("shadow"), traced.plane("shadow")), 5) << "only rays along edges may differ";
    EXPECT_EQ(traced.find("indirect.r"), nullptr);
  }
}

TEST(Reference, DirectLightIsLambertTimesColour) {
  const glm::vec3 albedo(0.2f, 0.5f, 0.9f), color(3.0f, 1.0f, 0.5f);
  const glm::vec3 towards = glm::normalize(glm::vec3(0.3f, -0.2f, 0.7f));
  const PreparedScene prepared =
      make_prepared_scene(scene_of({level_square(3.0f)}, {matt(albedo)}, {sun(towards, color)}));
  const PictureInfo info = prepared.info(perspective_camera({2, 1, 4}, {0, 0, 0}, {0, 0, 1}, 30.0f, 1.0f), 16, 16);
  const Image image = light(prepared, info, {.samples = 7});
  for_each_pixel(info, [&](int x, int y) {
    const glm::dvec3 direct = color_at(image, "direct", x, y);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(direct[c], albedo[c] * color[c] * towards.z, 1e-6);
    EXPECT_EQ(image.plane("shadow").at(x, y), 1.0f);
    EXPECT_EQ(color_at(image, "indirect", x, y), glm::dvec3(0.0));
  });
}

TEST(Reference, LampsFallOffWithTheSquare) {
  const glm::dvec3 where(0.5, 0.2, 1.5);
  for (const float reach : {0.0f, 2.0f}) {
    const PreparedScene prepared =
        make_prepared_scene(scene_of({level_square(5.0f)}, {matt(glm::vec3(0.5f))}, {lamp(where, reach, {2, 1, 1})}));
    const PictureInfo info = prepared.info(from_above(8, 8), 32, 32);
    const Image image = light(prepared, info, {.samples = 2, .bounce = false});
    for_each_pixel(info, [&](int x, int y) {
      const glm::dvec3 away = where - on_floor(ray_of(info, x, y));
      const double squared = glm::dot(away, away), distance_factor = reach > 0.0f ? reach * reach / squared : 1.0;
      const double expected = 0.5 * 2.0 * distance_factor * away.z / std::sqrt(squared);
      EXPECT_NEAR(image.plane("direct.r").at(x, y), expected, 1e-5 * expected);
    });
  }
}

/// Makes a flat floor with wavy normals: nothing blocks light, but the normals of all pixels differ.
Mesh wavy_floor() {
  Mesh mesh = shapes::quad({-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}, 40, 40);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const glm::vec3 p = mesh.positions[v];
    mesh.normals[v] = glm::normalize(glm::vec3(0.5f * std::sin(3.0f * p.x), 0.5f * std::cos(4.0f * p.y), 1.0f));
  }
  return mesh;
}

TEST(Reference, WithoutShadowsDirectLightMatchesEffectLighting) {
  Material shiny = matt({0.6f, 0.3f, 0.2f});
  shiny.specular_strength = 0.7f;
  shiny.specular_exponent = 20.0f;
  const std::vector<Light> lights = {sun({0.5f, 0.3f, 0.6f}, {1.0f, 0.8f, 0.6f}),
                                     lamp({-1, 1, 2}, 1.5f, {0.3f, 0.6f, 1.0f}),
                                     {.kind = LightKind::kHead, .color = glm::vec3(0.4f)}};
  const Scene scene = scene_of({wavy_floor()}, {shiny}, lights);
  const auto device = make_cpu_device();
  ASSERT_TRUE(device->prepare(scene));
  const auto traced = build_traced_scene(scene);
  const Effect& effect = *find_effect("lighting");
  for (const Camera& camera : {perspective_camera({1, -3, 3}, {0, 0, 0}, {0, 0, 1}, 40.0f, 1.0f),
                               orthographic_camera({1, -3, 3}, {0, 0, 0}, {0, 0, 1}, 3.0f, 1.0f)}) {
    auto frame = device->capture(camera, {.width = 60, .height = 60});
    ASSERT_TRUE(frame);
    ASSERT_TRUE(device->run(effect, initial_parameters(effect.parameters, effect.params_size), *frame));
    const Image expected = *device->download(*frame, {"direct.r", "direct.g", "direct.b"});
    const auto image = trace_light(**traced, frame->info, {.samples = 1, .bounce = false});
    ASSERT_TRUE(image);
    for (const char* name : {"direct.r", "direct.g", "direct.b"}) {
      EXPECT_LT(test::difference(image->plane(name), expected.plane(name), 0.0).max, 1e-4) << name;
      EXPECT_GT(expected.plane(name).at(30, 30), 0.1f);
    }
  }
}

TEST(Reference, HeadLightCastsNoVisibleShadow) {
  // An orthographic camera in the middle of a room: geometry behind it casts no shadow forward.
  const PreparedScene prepared = make_prepared_scene(
      scene_of({shapes::box({-1, -1, 0}, {1, 1, 1})}, {matt(glm::vec3(0.5f))}, {{.kind = LightKind::kHead}}));
  for (const Camera& camera :
       {from_above(1.8f, 1.8f, {0, 0}, 0.5f), perspective_camera({0, 0, 0.5f}, {0, 0, 0}, {0, 1, 0}, 60.0f, 1.0f)}) {
    const PictureInfo info = prepared.info(camera, 16, 16);
    const Image image = light(prepared, info, {.samples = 16});
    for_each_pixel(info, [&](int x, int y) {
      EXPECT_EQ(image.plane("shadow").at(x, y), 1.0f);
      EXPECT_GT(image.plane("direct.g").at(x, y), 0.3f);
    });
  }
}

TEST(Reference, LargeLightsShineAsBrightlyAsPoints) {
  // An unoccluded disc or sphere of constant radiance above the horizon illuminates as if it were a point at its
  // centre.
  const glm::dvec3 where(0.4, 0.3, 1.5);
  const glm::vec3 towards = glm::normalize(glm::vec3(0.5f, -0.2f, 0.8f));
  const Mesh floor = level_square(3.0f);
  const PictureInfo info = make_prepared_scene(scene_of({floor})).info(from_above(2, 2), 32, 32);
  for (const float angle_deg : {0.5f, 20.0f, 80.0f}) {
    const PreparedScene prepared =
        make_prepared_scene(scene_of({floor}, {matt(glm::vec3(1.0f))}, {sun(towards, glm::vec3(1.0f), angle_deg)}));
    PictureInfo here = info;
    here.lights = prepared.info(info.camera, 32, 32).lights;
    const Image image = light(prepared, here, {.samples = 64, .bounce = false});
    Tally error;
    for_each_pixel(info, [&](int x, int y) { error.add(image.plane("direct.g").at(x, y) - towards.z); });
    expect_mean(error, 0.0, 1e-3, fmt::format("sun of {} degrees", angle_deg));
  }
  for (const float radius : {0.1f, 1.2f})
    for (const float reach : {0.0f, 1.0f}) {
      const PreparedScene prepared = make_prepared_scene(
          scene_of({floor}, {matt(glm::vec3(1.0f))}, {lamp(where, reach, glm::vec3(1.0f), radius)}));
      PictureInfo here = info;
      here.lights = prepared.info(info.camera, 32, 32).lights;
      const Image image = light(prepared, here, {.samples = 64, .bounce = false});
      Tally error;
      for_each_pixel(info, [&](int x, int y) {
        const glm::dvec3 away = where - on_floor(ray_of(info, x, y));
        const double squared = glm::dot(away, away);
        const double expected = (reach > 0.0f ? reach * reach / squared : 1.0) * away.z / std::sqrt(squared);
        error.add(image.plane("direct.g").at(x, y) - expected);
      });
      expect_mean(error, 0.0, 1e-3, fmt::format("ball of radius {}, reach {}", radius, reach));
    }
}

TEST(Reference, PenumbraOfAnEdge) {
  // A half plane at height h is below a sun in the zenith. From x = -h tan(angle / 2) to h tan(angle / 2) a growing
  // part of the sun's disc is visible.
  constexpr double kHeight = 1.0;
  for (const float angle_deg : {0.05f, 0.53f, 30.0f}) {
    const double half = glm::radians(0.5 * angle_deg), width = kHeight * std::tan(half);
    // The half plane is no larger than necessary: the rounding error of its edge grows with its size.
    const float reach = float(4.0 * width);
    const Mesh edge = parallelogram({-reach, -reach, kHeight}, {reach, 0, 0}, {0, 2 * reach, 0});
    const PreparedScene prepared = make_prepared_scene(
        scene_of({level_square(reach), edge}, {matt(glm::vec3(1.0f))}, {sun({0, 0, 1}, glm::vec3(1.0f), angle_deg)}));
    const PictureInfo info = prepared.info(from_above(float(2.6 * width), float(1.3 * width), {0, 0}, 0.5f), 40, 20);
    const Image image = light(prepared, info, {.samples = 144, .bounce = false});
    std::array<Tally, 4> errors;  // by position on the ramp
    for_each_pixel(info, [&](int x, int y) {
      constexpr int kSteps = 200;
      const double at = on_floor(ray_of(info, x, y)).x / kHeight;
      const float shadow = image.plane("shadow").at(x, y);
      if (at < -1.01 * std::tan(half)) {
        EXPECT_EQ(shadow, 0.0f) << at;
      } else if (at > 1.01 * std::tan(half)) {
        EXPECT_EQ(shadow, 1.0f) << at;
      } else {
        // Sum over rings of the disc of equal solid angle. The edge cuts each ring along a chord.
        double visible = 0.0;
        for (int k = 0; k < kSteps; ++k) {
          const double sine = std::sin(0.5 * half);
          const double below = 2.0 * sine * sine * (k + 0.5) / kSteps, z = 1.0 - below;
          const double ring = std::sqrt(below * (2.0 - below)) / z;
          visible += std::acos(std::clamp(-at / ring, -1.0, 1.0)) / M_PI / kSteps;
        }
        const int zone = std::clamp(int((at / std::tan(half) + 1.0) * 2.0), 0, 3);
        errors[std::size_t(zone)].add(shadow - visible);
      }
    });
    for (int zone = 0; zone < 4; ++zone)
      expect_mean(errors[std::size_t(zone)], 0.0, 3e-3, fmt::format("sun of {} degrees, zone {}", angle_deg, zone));
  }
}

TEST(Reference, TheSunsAngleCanBeSet) {
  const Mesh edge = parallelogram({-50, -50, 1}, {50, 0, 0}, {0, 100, 0});
  const auto traced_with = [&](float lights_own, float setting) {
    const PreparedScene prepared = make_prepared_scene(
        scene_of({level_square(50.0f), edge}, {matt(glm::vec3(1.0f))}, {sun({0, 0, 1}, glm::vec3(1.0f), lights_own)}));
    return light(prepared, prepared.info(from_above(1, 0.5f, {0, 0}, 0.5f), 32, 16),
                 {.samples = 9, .sun_angle_deg = setting});
  };
  const Image ten = traced_with(10.0f, 0.0f);
  expect_equal(ten, traced_with(0.0f, 10.0f), "set in place of 0");
  expect_equal(ten, traced_with(3.0f, 10.0f), "set in place of 3");
  EXPECT_GT(differing_pixels(ten.plane("shadow"), traced_with(3.0f, 0.0f).plane("shadow")), 20);
}

TEST(Reference, SphericalLightsCastSoftShadows) {
  // At a point from which the edge of a half plane covers half of the sphere, visibility is 0.5. Geometry behind the
  // light casts no shadow.
  const Mesh edge = parallelogram({-50, -50, 1}, {50, 0, 0}, {0, 100, 0});
  const PreparedScene prepared =
      make_prepared_scene(scene_of({level_square(50.0f), edge, level_square(20.0f, 5.0f)}, {matt(glm::vec3(1.0f))},
                                   {lamp({0, 0, 3}, 0.0f, glm::vec3(1.0f), 0.8f)}));
  const PictureInfo info = prepared.info(from_above(1e-3f, 1e-3f, {0, 0}, 0.5f), 24, 24);
  const Image image = light(prepared, info, {.samples = 100, .bounce = false});
  Tally half;
  for_each_pixel(info, [&](int x, int y) { half.add(image.plane("shadow").at(x, y)); });
  expect_mean(half, 0.5, 1e-3, "half a ball");
  const PictureInfo lit = prepared.info(from_above(1, 1, {3, 0}, 0.5f), 8, 8);
  const Image whole = light(prepared, lit, {.samples = 50, .bounce = false});
  for_each_pixel(lit, [&](int x, int y) { EXPECT_EQ(whole.plane("shadow").at(x, y), 1.0f); });
}

// ---- the bounce ----

TEST(Reference, WallOfConstantRadiance) {
  // The wall contributes its radiance times (1 - cos E) / 2, the fraction of the hemisphere that it fills.
  const glm::dvec3 radiance(2.0, 1.0, 0.25);
  for (const double height : {1.0, 20.0}) {
    const PreparedScene prepared = make_prepared_scene(
        scene_of({level_square(4.0f), wall_x(2.0f, float(height))}, {Material{}, matt(glm::vec3(0.8f), radiance)}));
    const PictureInfo info = prepared.info(from_above(3, 3, {0.4f, 0}), 32, 32);
    const Image image = light(prepared, info, {.samples = 128});
    std::array<Tally, 3> errors;
    for_each_pixel(info, [&](int x, int y) {
      const double away = 2.0 - on_floor(ray_of(info, x, y)).x;
      const double fraction = 0.5 - 0.5 * away / std::hypot(away, height);
      const glm::dvec3 indirect = color_at(image, "indirect", x, y);
      for (int c = 0; c < 3; ++c) errors[std::size_t(c)].add(indirect[c] - radiance[c] * fraction);
    });
    for (int c = 0; c < 3; ++c)
      expect_mean(errors[std::size_t(c)], 0.0, 2e-3, fmt::format("height {}, channel {}", height, c));
  }
}

TEST(Reference, FurnaceGivesItsRadianceEverywhere) {
  const PreparedScene prepared = make_prepared_scene(scene_of(
      {shapes::box({-1, -1, -1}, {1, 1, 1}), shapes::sphere(0.4f, 24, 12)}, {matt(glm::vec3(0.9f), glm::vec3(0.7f))}));
  const PictureInfo info =
      prepared.info(perspective_camera({0.9f, 0.8f, 0.7f}, {0, 0, 0}, {0, 0, 1}, 100.0f, 1.0f), 32, 32);
  for (const int samples : {1, 7, 64}) {
    const Image image = light(prepared, info, {.samples = samples});
    long off = 0;  // interpolated normals of the sphere: directions below its triangles contribute nothing
    for_each_pixel(info, [&](int x, int y) { off += std::fabs(image.plane("indirect.g").at(x, y) - 0.7f) > 1e-6f; });
    const Image ball = *capture_planes(*prepared, info, {.width = 32, .height = 32});
    long on_sphere = 0;
    for_each_pixel(info, [&](int x, int y) { on_sphere += ball.plane("object_id").at(x, y) == 1.0f; });
    EXPECT_GT(on_sphere, 30);
    EXPECT_LE(off, on_sphere) << samples << " samples";
  }
}

TEST(Reference, SunlitFloorLightsAWall) {
  // The floor fills half of the wall's hemisphere, so indirect light is albedo x colour x cosine / 2, whether the sun
  // is a point or a disc. The sun is in front of the wall, so that the wall hides no part of the sun.
  const glm::vec3 albedo(0.9f, 0.5f, 0.1f), towards = glm::normalize(glm::vec3(0.6f, 0.2f, 1.0f));
  const Mesh floor = parallelogram({0, -kFar, 0}, {kFar, 0, 0}, {0, 2 * kFar, 0});
  const Mesh wall = parallelogram({0, -3, 0}, {0, 6, 0}, {0, 0, 3});
  // The camera is in front of the wall and looks along -x.
  const Camera camera = orthographic_camera({1, 0, 0.5f}, {0, 0, 0.5f}, {0, 0, 1}, 0.6f, 1.0f);
  for (const float angle_deg : {0.0f, 20.0f}) {
    const PreparedScene prepared = make_prepared_scene(
        scene_of({wall, floor}, {matt(glm::vec3(0.8f)), matt(albedo)}, {sun(towards, glm::vec3(2.0f), angle_deg)}));
    const PictureInfo info = prepared.info(camera, 32, 32);
    const Image image = light(prepared, info, {.samples = 128});
    std::array<Tally, 3> errors;
    for_each_pixel(info, [&](int x, int y) {
      const glm::dvec3 indirect = color_at(image, "indirect", x, y);
      for (int c = 0; c < 3; ++c) errors[std::size_t(c)].add(indirect[c] - albedo[c] * 2.0 * towards.z * 0.5);
    });
    for (int c = 0; c < 3; ++c)
      expect_mean(errors[std::size_t(c)], 0.0, 2e-3, fmt::format("sun of {} degrees, channel {}", angle_deg, c));
  }
}

TEST(Reference, UnlitFloorsGiveNoLight) {
  const Mesh wall = parallelogram({0, -3, 0}, {0, 6, 0}, {0, 0, 3});
  const PreparedScene prepared = make_prepared_scene(scene_of(
      {wall, level_square(8.0f), level_square(20.0f, 3.0f)}, {Material{}}, {sun({0.1f, 0.2f, 1.0f}), lamp({1, 0, 9})}));
  const Camera camera = orthographic_camera({1, 0, 0.5f}, {0, 0, 0.5f}, {0, 0, 1}, 0.6f, 1.0f);
  const PictureInfo info = prepared.info(camera, 16, 16);
  const Image image = light(prepared, info, {.samples = 64});
  for_each_pixel(info, [&](int x, int y) {
    EXPECT_EQ(color_at(image, "indirect", x, y), glm::dvec3(0.0));
    EXPECT_EQ(color_at(image, "direct", x, y), glm::dvec3(0.0));
    EXPECT_EQ(image.plane("shadow").at(x, y), 0.0f);
  });
}

TEST(Reference, TexturesColourTheBounce) {
  Texture grey;
  grey.name = "grey";
  grey.width = grey.height = 1;
  grey.rgba = {188, 255, 0, 255};
  Material textured = matt({1.0f, 0.5f, 1.0f});
  textured.texture = 0;
  const Mesh wall = parallelogram({0, -3, 0}, {0, 6, 0}, {0, 0, 3});
  const Mesh floor = parallelogram({0, -kFar, 0}, {kFar, 0, 0}, {0, 2 * kFar, 0});
  const PreparedScene prepared =
      make_prepared_scene(scene_of({wall, floor}, {Material{}, textured}, {sun({1, 0, 1})}, {grey}));
  const Camera camera = orthographic_camera({1, 0, 0.5f}, {0, 0, 0.5f}, {0, 0, 1}, 0.6f, 1.0f);
  const PictureInfo info = prepared.info(camera, 24, 24);
  const Image image = light(prepared, info, {.samples = 64});
  const double red = std::pow((188.0 / 255.0 + 0.055) / 1.055, 2.4);
  Tally fraction;
  for_each_pixel(info, [&](int x, int y) {
    const glm::dvec3 indirect = color_at(image, "indirect", x, y);
    fraction.add(indirect.r);
    EXPECT_NEAR(indirect.r / red, indirect.g / 0.5, 1e-5);
    EXPECT_EQ(indirect.b, 0.0);
  });
  expect_mean(fraction, red * std::sqrt(0.5) / 2.0, 1e-3, "red");
}

TEST(Reference, BounceEndsAtItsReach) {
  // For an emissive ceiling at height 1, the part within R of a point on the floor fills 1 - 1 / R^2 of the hemisphere,
  // cosine-weighted.
  const PreparedScene prepared = make_prepared_scene(
      scene_of({level_square(4.0f), level_square(200.0f, 1.0f)}, {Material{}, matt(glm::vec3(0.8f), glm::vec3(3.0f))}));
  const PictureInfo info = prepared.info(from_above(2, 2, {0, 0}, 0.5f), 24, 24);
  for (const auto& [reach, fraction] : {std::pair(0.9f, 0.0), {1.25f, 1.0 - 1.0 / 1.5625}, {2.0f, 0.75}}) {
    const Image image = light(prepared, info, {.samples = 128, .reach = reach});
    Tally error;
    for_each_pixel(info, [&](int x, int y) { error.add(color_at(image, "indirect", x, y).g - 3.0 * fraction); });
    expect_mean(error, 0.0, 3e-3, fmt::format("reach {}", reach));
  }
}

TEST(Reference, BounceAloneMatchesBounceWithDirectLight) {
  const PreparedScene prepared = make_prepared_scene(
      scene_of({level_square(4.0f), wall_x(1.0f, 1.0f)}, {Material{}}, {sun({-1, 0, 1}), lamp({0, 0, 3})}));
  const PictureInfo info = prepared.info(from_above(3, 3), 16, 16);
  const Image both = light(prepared, info, {.samples = 16}),
              alone = light(prepared, info, {.samples = 16, .direct = false});
  EXPECT_EQ(alone.names, (std::vector<std::string>{"indirect.r", "indirect.g", "indirect.b"}));
  double max = 0.0;
  for (const std::string& name : alone.names)
    EXPECT_EQ(test::difference(alone.plane(name), both.plane(name), 0.0).max, 0.0) << name;
  for_each_pixel(info, [&](int x, int y) { max = std::max(max, color_at(alone, "indirect", x, y).g); });
  EXPECT_GT(max, 0.1);
}

TEST(Reference, CapturedShadowsMatchTheCapture) {
  // The lamp has a radius, but its captured shadow is hard. The sun casts no shadow.
  Light fill = sun({0.2f, 0.1f, 1.0f}, glm::vec3(0.5f), 30.0f);
  fill.casts_shadow = false;
  const PreparedScene prepared =
      make_prepared_scene(scene_of({level_square(8.0f), level_square(1.0f, 2.0f)}, {matt(glm::vec3(0.8f))},
                                   {lamp({0.5f, -0.5f, 4.0f}, 0.0f, glm::vec3(1.0f), 0.5f), fill}));
  const PictureInfo info = prepared.info(from_above(6, 6, {-1, 1}, 1.5f), 60, 60);  // below the plate
  const Image drawn = *capture_planes(*prepared, info, {.width = 60, .height = 60});
  const Image traced = light(prepared, info, {.samples = 16, .bounce = false, .captured_shadows = true});
  const Image soft = light(prepared, info, {.samples = 16, .bounce = false});
  long dark = 0, dimmer = 0;
  const double filled = 0.8 * 0.5 * glm::normalize(glm::dvec3(0.2, 0.1, 1.0)).z;
  for_each_pixel(info, [&](int x, int y) {
    const double direct = color_at(traced, "direct", x, y).g;
    dimmer += color_at(soft, "direct", x, y).g < 0.9 * filled;
    if (traced.plane("shadow").at(x, y) == 0.0f) {
      ++dark;
      EXPECT_NEAR(direct, filled, 1e-5);
    } else {
      EXPECT_GT(direct, filled + 0.1);
    }
  });
  EXPECT_GT(dark, 100);
  EXPECT_GT(dimmer, 100) << "where all lights cast shadows, two shadows meet";
  EXPECT_LE(differing_pixels(drawn.plane("shadow"), traced.plane("shadow")), 5) << "only rays along edges may differ";
}

// ---- samples ----

TEST(Sampler, EveryElementaryBoxHoldsOnePoint) {
  for (int power = 0; power <= 12; ++power) {
    const int count = 1 << power;
    const SampleTable table = sample_table(count);
    for (const unsigned seed : {0u, 1u, 77u, 0xdeadbeefu})
      for (int across = 0; across <= power; ++across) {
        std::vector<int> boxes(std::size_t(count), 0);
        for (int i = 0; i < count; ++i) {
          const glm::vec2 p = sample_point(table, i, seed);
          ++boxes[(std::size_t(p.x * float(1 << across)) << (power - across)) +
                  std::size_t(p.y * float(1 << (power - across)))];
        }
        EXPECT_EQ(std::count(boxes.begin(), boxes.end(), 1), count) << count << " points, 2^" << across << " columns";
      }
  }
}

TEST(Sampler, PointsLieInsideTheSquare) {
  // A point on the square's edge would be a direction along the surface, which is neither open nor blocked.
  const SampleTable table = sample_table(kMaxSamples);
  float low = 1.0f, high = 0.0f;
  for (unsigned seed = 0; seed < 4000; ++seed)
    for (int i = 0; i < kMaxSamples; i += 2) {
      const glm::vec2 p = sample_point(table, i, seed);
      low = std::min({low, p.x, p.y});
      high = std::max({high, p.x, p.y});
    }
  EXPECT_GT(low, 0.0f);
  EXPECT_LT(low, 1e-6f);
  EXPECT_LT(high, 1.0f);
  EXPECT_GT(high, 1.0f - 1e-6f);
}

TEST(Sampler, EachPointIsUniformlyDistributed) {
  const SampleTable table = sample_table(16);
  for (const int i : {0, 5, 15}) {
    Tally x, y, product;
    for (unsigned seed = 0; seed < 20000; ++seed) {
      const glm::vec2 p = sample_point(table, i, hash(seed, 9u));
      x.add(p.x);
      y.add(p.y);
      product.add((p.x - 0.5) * (p.y - 0.5));
    }
    expect_mean(x, 0.5, 3e-3, "x");
    expect_mean(y, 0.5, 3e-3, "y");
    expect_mean(product, 0.0, 1e-3, "x y");
    EXPECT_NEAR(x.variance(), 1.0 / 12.0, 2e-3);
  }
}

TEST(Sampler, ShufflingMakesTwoSetsIndependent) {
  const int count = 256;
  const SampleTable table = sample_table(count);
  for (const unsigned seed : {3u, 4u, 5u, 6u}) {
    std::set<int> numbers, boxes, unshuffled;
    for (int i = 0; i < count; ++i) {
      const int other = shuffled(table, i, seed);
      ASSERT_GE(other, 0);
      ASSERT_LT(other, count);
      numbers.insert(other);
      const auto box = [&](int j) {
        return int(sample_point(table, i, 100u + seed).x * 8.0f) * 8 +
               int(sample_point(table, j, 200u + seed).x * 8.0f);
      };
      boxes.insert(box(other));
      unshuffled.insert(box(i));
    }
    EXPECT_EQ(int(numbers.size()), count) << "a permutation";
    EXPECT_GE(boxes.size(), 56u) << "of 64 boxes over the first coordinates of both sets";
    EXPECT_EQ(unshuffled.size(), 8u) << "most boxes are empty with scrambling alone";
  }
}

/// Statistics of a plane over seeds: the variance of a pixel, the mean over all pixels, and the standard error of this
/// mean. Pixels and seeds are independent.
struct Spread {
  double variance = 0.0, mean = 0.0, standard_error = 0.0;
};

Spread spread_of(int seeds, const std::function<Plane(std::uint32_t seed)>& trace) {
  std::vector<Tally> pixels;
  for (int seed = 0; seed < seeds; ++seed) {
    const Plane plane = trace(std::uint32_t(seed));
    pixels.resize(std::size_t(plane.width * plane.height));
    for (int y = 0; y < plane.height; ++y)
      for (int x = 0; x < plane.width; ++x) pixels[std::size_t(y * plane.width + x)].add(plane.at(x, y));
  }
  Spread spread;
  for (const Tally& pixel : pixels) {
    spread.variance += pixel.variance() / double(pixels.size());
    spread.mean += pixel.mean() / double(pixels.size());
  }
  spread.standard_error = std::sqrt(spread.variance / double(seeds) / double(pixels.size()));
  return spread;
}

void expect_same_mean(const Spread& a, const Spread& b, std::string_view what) {
  EXPECT_LE(std::fabs(a.mean - b.mean), 3.0 * std::hypot(a.standard_error, b.standard_error) + 1e-6)
      << what << ": " << a.mean << " and " << b.mean;
}

Scene small_solids() {
  auto scene = make_builtin_scene("scene:solids?detail=7000");
  EXPECT_TRUE(scene);
  return std::move(*scene);
}

Camera solids_camera(const Scene& scene, float scale = 1.0f) {
  const View& view = scene.views[0];
  return perspective_camera(view.eye * scale, view.target * scale, {0, 1, 0}, view.angle_deg, 1.0f);
}

/// Max ratio of the variances when the number of samples doubles: a half, plus the error of measuring it.
constexpr double kMaxVarianceRatio = 0.55;

TEST(Reference, DoublingSamplesHalvesTheVarianceOfOcclusion) {
  const PreparedScene prepared = make_prepared_scene(small_solids());
  const PictureInfo info = prepared.info(solids_camera(*prepared.scene), 64, 64);
  const float radius = 0.2f * info.scene_radius;
  const auto spread = [&](int samples, int seeds) {
    return spread_of(seeds, [&](std::uint32_t seed) {
      return occlusion(prepared, info, {.samples = samples, .radius = radius, .seed = seed}).plane("ao");
    });
  };
  const Spread first = spread(16, 8);
  EXPECT_GT(first.variance, 1e-4);
  EXPECT_LT(first.mean, 0.95);
  EXPECT_LT(first.standard_error, 1e-3);
  Spread last = first;
  for (const int samples : {32, 64, 128}) {
    const Spread next = spread(samples, 8);
    EXPECT_LE(next.variance / last.variance, kMaxVarianceRatio) << samples << " samples";
    expect_same_mean(next, first, fmt::format("{} samples", samples));
    last = next;
  }
  // Counts that are not powers of two, including a single ray, are unbiased, too.
  for (const int samples : {1, 3, 7, 100})
    expect_same_mean(spread(samples, 6), last, fmt::format("{} samples", samples));
  EXPECT_GT(spread(1, 6).variance, 8.0 * first.variance);
}

void expect_light_converges(const PreparedScene& prepared, const PictureInfo& info, const char* name, bool bounce) {
  const auto spread = [&](int samples) {
    return spread_of(8, [&](std::uint32_t seed) {
      return light(prepared, info, {.samples = samples, .bounce = bounce, .seed = seed}).plane(name);
    });
  };
  const Spread first = spread(16);
  EXPECT_GT(first.variance, 1e-5) << name;
  Spread last = first;
  for (const int samples : {32, 64, 128, 256}) {
    const Spread next = spread(samples);
    EXPECT_LE(next.variance / last.variance, kMaxVarianceRatio) << name << ", " << samples << " samples";
    expect_same_mean(next, first, fmt::format("{}, {} samples", name, samples));
    last = next;
  }
  expect_same_mean(spread(7), last, name);
}

TEST(Reference, DoublingSamplesHalvesTheVarianceOfLight) {
  // The scene is a slatted roof below a sun with a large disc.
  std::vector<Mesh> meshes = {parallelogram({0, -4, 0}, {8, 0, 0}, {0, 8, 0}),
                              parallelogram({0, -3, 0}, {0, 6, 0}, {0, 0, 2})};
  for (int k = 0; k < 8; ++k) meshes.push_back(parallelogram({0.6f * k, -4, 2}, {0.3f, 0, 0}, {0, 8, 0}));
  const PreparedScene prepared =
      make_prepared_scene(scene_of(meshes, {Material{}}, {sun({0.3f, 0, 1}, glm::vec3(1.0f), 40.0f)}));
  // In front of the wall, below the roof, above the floor: wall and floor are both visible.
  const PictureInfo info =
      prepared.info(perspective_camera({3, 0, 1.2f}, {0, 0, 0.4f}, {0, 0, 1}, 50.0f, 1.0f), 24, 24);
  expect_light_converges(prepared, info, "direct.g", false);
  expect_light_converges(prepared, info, "shadow", false);
  expect_light_converges(prepared, info, "indirect.g", true);
}

TEST(Reference, BounceSamplesItsTwoChoicesIndependently) {
  // Because of the fin above the floor, only the left half of the sun lights the left half of the floor. So light on
  // the wall depends on both random choices of a sample together: the direction of the ray and the point on the sun.
  const Mesh wall = parallelogram({0, -3, 0}, {0, 6, 0}, {0, 0, 0.9f}), floor = level_square(8.0f);
  const Mesh fin = parallelogram({-8, 0, 1}, {16, 0, 0}, {0, 0, 40});
  const PreparedScene prepared =
      make_prepared_scene(scene_of({wall, floor, fin}, {Material{}}, {sun({0, 0, 1}, glm::vec3(1.0f), 80.0f)}));
  const PictureInfo info =
      prepared.info(orthographic_camera({1, 0, 0.5f}, {0, 0, 0.5f}, {0, 0, 1}, 0.4f, 1.0f), 20, 20);
  expect_light_converges(prepared, info, "indirect.g", true);
}

TEST(Reference, MoreSamplesAreCloserToTheGroundTruth) {
  const PreparedScene prepared = make_prepared_scene(scene_of({level_square(4.0f), wall_x(1.5f, 3.0f, 6.0f)}));
  const PictureInfo info = prepared.info(from_above(0.8f, 0.8f, {0.9f, 0}), 8, 8);
  for (const auto& [samples, max] : {std::pair{64, 0.06}, {kMaxSamples, 3e-3}}) {
    const Image image = occlusion(prepared, info, {.samples = samples, .radius = 1.3f});
    for_each_pixel(info, [&](int x, int y) {
      EXPECT_NEAR(image.plane("ao").at(x, y), 1.0 - segment((1.5 - on_floor(ray_of(info, x, y)).x) / 1.3), max);
    });
  }
}

// ---- invariance ----

TEST(Reference, ThreadsAndRunsDoNotMatter) {
  Scene scene = small_solids();
  scene.lights = {sun({0.4f, 1, 0.3f}, glm::vec3(1.0f), 10.0f), lamp({1, 3, 2}, 2.0f, glm::vec3(1.0f), 0.3f)};
  const PreparedScene prepared = make_prepared_scene(std::move(scene));
  const PictureInfo info = prepared.info(solids_camera(*prepared.scene), 72, 50);
  ParameterBytes bytes = initial_parameters(reference_effect().parameters, reference_effect().params_size);
  auto& params = as<ReferenceParams>(bytes);
  params.samples = 10;
  params.light = 2;
  const auto trace = [&](int threads) { return *trace_reference(*prepared, info, bytes, {.threads = threads}); };
  const Image one = trace(1);
  EXPECT_EQ(one.planes.size(), 11u);
  for (const int threads : {1, 2, 0, 64}) expect_equal(one, trace(threads), fmt::format("{} threads", threads));
  params.seed = 1;
  const Image other = trace(0);
  for (const char* name : {"ao", "bent_normal.x", "direct.g", "indirect.g"})
    EXPECT_GT(differing_pixels(one.plane(name), other.plane(name)), 300) << name;
}

Scene scaled_scene(Scene scene, float scale) {
  for (Mesh& mesh : scene.meshes)
    for (glm::vec3& p : mesh.positions) p *= scale;
  finish_scene(scene);
  return scene;
}

TEST(Reference, ScaleDoesNotMatter) {
  const Scene solids = small_solids();
  const auto trace = [&](float scale) {
    const PreparedScene prepared = make_prepared_scene(scaled_scene(solids, scale));
    const PictureInfo info = prepared.info(solids_camera(solids, scale), 48, 48);
    return occlusion(prepared, info, {.samples = 16, .radius = 0.25f * info.scene_radius});
  };
  const Image one = trace(1.0f);
  for (const float power : {0x1p-10f, 0x1p10f}) expect_equal(one, trace(power), "a power of two");
  for (const float scale : {1e-3f, 1e3f}) {
    const Image image = trace(scale);
    Tally change;
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 48; ++x) change.add(image.plane("ao").at(x, y) - one.plane("ao").at(x, y));
    expect_mean(change, 0.0, 1e-3, "scaled");
    EXPECT_LT(differing_pixels(one.plane("ao"), image.plane("ao")), 48 * 48 / 20);
  }
}

TEST(Reference, FarPerspectiveIsOrthographic) {
  const PreparedScene prepared = sphere_on_floor();
  constexpr float kDistance = 100.0f;
  const float angle_deg = float(2.0 * std::atan(3.0 / kDistance) * 180.0 / M_PI);
  const PictureInfo near = prepared.info(from_above(6, 6), 40, 40);
  const PictureInfo far =
      prepared.info(perspective_camera({0, 0, kDistance}, {0, 0, 0}, {0, 1, 0}, angle_deg, 1.0f), 40, 40);
  const Image a = occlusion(prepared, near, {.samples = 256, .radius = 2.0f});
  const Image b = occlusion(prepared, far, {.samples = 256, .radius = 2.0f, .seed = 1});
  Tally change;
  for_each_pixel(near, [&](int x, int y) {
    if (misses_sphere(ray_of(near, x, y)) && misses_sphere(ray_of(far, x, y)))
      change.add(b.plane("ao").at(x, y) - a.plane("ao").at(x, y));
  });
  expect_mean(change, 0.0, 1e-3, "perspective less orthographic");
}

TEST(Reference, GuardBandIsNotTraced) {
  constexpr int kGuard = 9;
  Scene scene = small_solids();
  scene.lights = {sun({0.4f, 1, 0.3f}, glm::vec3(1.0f), 10.0f)};
  const PreparedScene prepared = make_prepared_scene(std::move(scene));
  const Camera camera = solids_camera(*prepared.scene);
  const PictureInfo without_guard = prepared.info(camera, 50, 40), wide = prepared.info(camera, 50, 40, kGuard);
  const Image occluded = occlusion(prepared, wide, {.samples = 16, .radius = 1.0f});
  const Image lit = light(prepared, wide, {.samples = 4});
  ASSERT_EQ(occluded.width, 50 + 2 * kGuard);
  ASSERT_EQ(occluded.plane("ao").height, 40 + 2 * kGuard);
  for_each_pixel(wide, [&](int x, int y) {
    if (x >= kGuard && y >= kGuard && x < 50 + kGuard && y < 40 + kGuard) return;
    EXPECT_EQ(occluded.plane("ao").at(x, y), 1.0f);
    EXPECT_EQ(bent_at(occluded, wide, x, y), glm::dvec3(0.0));
    EXPECT_EQ(color_at(lit, "direct", x, y), glm::dvec3(0.0));
    EXPECT_EQ(color_at(lit, "indirect", x, y), glm::dvec3(0.0));
    EXPECT_EQ(lit.plane("shadow").at(x, y), 1.0f);
  });
  // Inside, the guard band changes the last bits of positions, and through them a few rays.
  const Plane inside = cropped(occluded.plane("ao"), kGuard);
  EXPECT_LT(differing_pixels(occlusion(prepared, without_guard, {.samples = 16, .radius = 1.0f}).plane("ao"), inside),
            40);
  EXPECT_LT(differing_pixels(light(prepared, without_guard, {.samples = 4}).plane("shadow"),
                             cropped(lit.plane("shadow"), kGuard)),
            40);
}

TEST(Reference, SmallAndOddSizes) {
  const PreparedScene prepared = make_prepared_scene(small_solids());
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 2}, {17, 33}}) {
    const PictureInfo info = prepared.info(solids_camera(*prepared.scene), width, height, 1);
    const Image image = occlusion(prepared, info, {.samples = 5, .radius = 1.0f});
    EXPECT_EQ(image.width, width + 2);
    for_each_pixel(info, [&](int x, int y) {
      EXPECT_GE(image.plane("ao").at(x, y), 0.0f);
      EXPECT_LE(image.plane("ao").at(x, y), 1.0f);
    });
  }
}

// ---- progress ----

TEST(Reference, ProgressNeverFallsAndEndsAtOne) {
  const PreparedScene prepared = make_prepared_scene(small_solids());
  const PictureInfo info = prepared.info(solids_camera(*prepared.scene), 100, 70);
  ParameterBytes bytes = initial_parameters(reference_effect().parameters, reference_effect().params_size);
  as<ReferenceParams>(bytes).samples = 2;
  for (const int light : {0, 1, 2})
    for (const int threads : {1, 0}) {
      as<ReferenceParams>(bytes).light = light;
      std::vector<double> reported;
      std::atomic<int> inside = 0;
      const auto progress = [&](double done) {
        EXPECT_EQ(++inside, 1) << "two threads at once";
        reported.push_back(done);
        // Wait so long that other threads, including the thread with the last tile, arrive.
        if (threads == 0) std::this_thread::sleep_for(std::chrono::microseconds(200));
        --inside;
        return true;
      };
      ASSERT_TRUE(trace_reference(*prepared, info, bytes, {threads, progress}));
      // The number of calls depends on scheduling: one thread may finish all its tiles while another reports.
      ASSERT_FALSE(reported.empty());
      EXPECT_TRUE(std::is_sorted(reported.begin(), reported.end())) << threads << " threads, light " << light;
      EXPECT_GT(reported.front(), 0.0);
      EXPECT_EQ(reported.back(), 1.0);
      if (threads == 1) {
        const std::size_t tiles = 7 * 5;
        EXPECT_EQ(reported.size(), light == 0 ? tiles : 2 * tiles);
        EXPECT_EQ(std::adjacent_find(reported.begin(), reported.end()), reported.end()) << "each tile adds";
      }
    }
}

TEST(Reference, ProgressCanEndTheWork) {
  const PreparedScene prepared = make_prepared_scene(small_solids());
  const PictureInfo info = prepared.info(solids_camera(*prepared.scene), 100, 100);
  ParameterBytes bytes = initial_parameters(reference_effect().parameters, reference_effect().params_size);
  as<ReferenceParams>(bytes).samples = 1;
  as<ReferenceParams>(bytes).light = 2;
  for (const double end_at : {0.0, 0.1, 0.6})
    for (const int threads : {1, 0}) {
      int calls_after_end = 0;
      bool ended = false;
      const auto progress = [&](double done) {
        calls_after_end += ended;
        ended = ended || done >= end_at;
        return !ended;
      };
      const auto image = trace_reference(*prepared, info, bytes, {threads, progress});
      ASSERT_FALSE(image) << end_at;
      EXPECT_EQ(image.error().kind, ErrorKind::kInterrupted);
      EXPECT_EQ(calls_after_end, 0) << "no further report";
    }
}

// ---- parameters ----

TEST(Reference, PlanesFollowTheLightParameter) {
  const PreparedScene prepared = make_prepared_scene(scene_of({level_square(1.0f)}));
  const PictureInfo info = prepared.info(from_above(1, 1), 4, 4);
  ParameterBytes bytes = initial_parameters(reference_effect().parameters, reference_effect().params_size);
  const auto& outputs = reference_effect().dispatches[0].outputs;
  const std::vector<std::string> all(outputs.begin(), outputs.end());
  for (const auto& [light, planes] : {std::pair{0, 4}, {1, 8}, {2, 11}}) {
    as<ReferenceParams>(bytes).light = light;
    const auto image = trace_reference(*prepared, info, bytes);
    ASSERT_TRUE(image);
    EXPECT_EQ(image->names, std::vector<std::string>(all.begin(), all.begin() + planes));
  }
  EXPECT_EQ(all.size(), 11u);
}

TEST(Reference, ParametersReachTheTrace) {
  // Below a ceiling at 0.4 each value of a parameter gives another result: see FalloffBelowACeiling.
  Mesh floor = level_square(1.0f);
  floor.normals.assign(4, glm::normalize(glm::vec3(0.5f, 0, 1)));
  const PreparedScene prepared = make_prepared_scene(scene_of({floor, level_square(1.0f, 0.4f)}));
  const PictureInfo info = prepared.info(from_above(1, 1, {0, 0}, 0.3f), 8, 8);
  const auto mean = [&](const std::vector<std::pair<std::string_view, std::string_view>>& settings) {
    ParameterBytes bytes = initial_parameters(reference_effect().parameters, reference_effect().params_size);
    for (const auto& [name, value] : settings)
      EXPECT_TRUE(set_parameter("reference", *find_parameter(reference_effect(), name), value, bytes));
    const auto image = trace_reference(*prepared, info, bytes);
    EXPECT_TRUE(image);
    double sum = 0.0;
    for_each_pixel(info, [&](int x, int y) { sum += image->plane("ao").at(x, y) / 64.0; });
    return sum;
  };
  EXPECT_EQ(mean({}), 1.0) << "10 % do not reach the ceiling";
  EXPECT_NEAR(mean({{"radius", "0.8"}}), 0.25, 0.01);
  EXPECT_NEAR(mean({{"radius", "0.8"}, {"falloff", "linear"}}), 0.75, 0.01);
  EXPECT_NEAR(mean({{"radius", "0.8"}, {"falloff", "smooth"}}), 1.0 - (1.25 + 1.5 * std::log(0.5)), 0.01);
  EXPECT_NEAR(mean({{"radius", "0.1"}, {"normal", "shading"}}), 0.5 + 0.5 * std::sqrt(0.8), 0.01);
  const std::string fraction = fmt::format("{}%", 0.8 / info.scene_radius * 100.0);
  EXPECT_NEAR(mean({{"radius", fraction}}), mean({{"radius", "0.8"}}), 1e-3);
}

TEST(Reference, RefusesValuesThatItCannotUse) {
  ParameterBytes bytes = initial_parameters(reference_effect().parameters, reference_effect().params_size);
  const auto expect_refused = [&](std::string_view name, std::string_view value, std::string_view range) {
    const auto status = set_parameter("reference", *find_parameter(reference_effect(), name), value, bytes);
    ASSERT_FALSE(status) << name << '=' << value;
    EXPECT_EQ(status.error().kind, ErrorKind::kUsage);
    for (const std::string& part : {fmt::format("reference.{}", name), fmt::format("'{}'", value), std::string(range)})
      EXPECT_NE(status.error().message.find(part), std::string::npos) << status.error().message;
  };
  for (const char* value : {"0", "4097", "-1", "1.5", "many", "nan"}) expect_refused("samples", value, "1 to 4096");
  for (const char* value : {"0", "0%", "-1", "-5%", "1001%", "nan", "inf", "wide"})
    expect_refused("radius", value, "a number above 0 in scene units or a percentage up to 1000%");
  for (const char* value : {"-1", "91"}) expect_refused("sun_angle", value, "0 to 90 deg");
  expect_refused("falloff", "smoth", "did you mean 'smooth'");
  for (const char* value : {"1", "4096"})
    EXPECT_TRUE(set_parameter("reference", *find_parameter(reference_effect(), "samples"), value, bytes)) << value;
}

TEST(Reference, RadiusFitsTheScene) {
  PictureInfo info;
  info.scene_radius = 4.0f;
  EXPECT_EQ(*radius_in_scene("x", {0.5f, 0}, info), 0.5f);
  EXPECT_EQ(*radius_in_scene("x", {25.0f, 1}, info), 1.0f);
  EXPECT_EQ(*radius_in_scene("x", {200.0f, 1}, info), 8.0f) << "the whole scene";
  EXPECT_EQ(*radius_in_scene("x", {8.0f, 0}, info), 8.0f);
  const auto expect_refused = [&](Length radius, std::string_view value, std::string_view reason) {
    const auto length = radius_in_scene("--ao-radius", radius, info);
    ASSERT_FALSE(length) << value;
    EXPECT_EQ(length.error().kind, ErrorKind::kUsage);
    for (const std::string_view part : {std::string_view("--ao-radius"), value, reason})
      EXPECT_NE(length.error().message.find(part), std::string::npos) << length.error().message;
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  expect_refused({0.0f, 0}, "'0'", "above 0");
  expect_refused({0.0f, 1}, "'0%'", "above 0");
  expect_refused({-1.0f, 0}, "'-1'", "above 0");
  expect_refused({nan, 0}, "nan", "above 0");
  expect_refused({8.1f, 0}, "'8.1'", "8 across (200%)");
  expect_refused({201.0f, 1}, "'201%'", "larger than the scene");
  expect_refused({kInfinity, 0}, "'inf'", "larger than the scene");

  const PreparedScene prepared = make_prepared_scene(scene_of({level_square(1.0f)}));
  ParameterBytes bytes = initial_parameters(reference_effect().parameters, reference_effect().params_size);
  as<ReferenceParams>(bytes).radius = {300.0f, 1};
  const auto image = trace_reference(*prepared, prepared.info(from_above(1, 1), 4, 4), bytes);
  ASSERT_FALSE(image);
  EXPECT_EQ(image.error().kind, ErrorKind::kUsage);
  EXPECT_NE(image.error().message.find("reference.radius"), std::string::npos) << image.error().message;
  reference_effect().set_radius(0.7f, info, bytes);
  EXPECT_EQ(*radius_in_scene("x", as<ReferenceParams>(bytes).radius, info), 0.7f);
}

TEST(Reference, TableCoversEveryFieldAndIsExplained) {
  const Effect& effect = reference_effect();
  EXPECT_EQ(effect.kind, EffectKind::kOcclusion);
  std::set<std::size_t> bytes;
  for (const Parameter& row : effect.parameters) {
    for (std::size_t k = 0; k < parameter_size(row.type); ++k)
      EXPECT_TRUE(bytes.insert(row.offset + k).second) << row.name << " overlaps another row";
    ParameterBytes values = initial_parameters(effect.parameters, effect.params_size);
    EXPECT_TRUE(set_parameter(effect.name, row, parameter_text(row, values), values)) << row.name;
    EXPECT_FALSE(row.help.empty()) << row.name;
  }
  EXPECT_EQ(bytes.size(), sizeof(ReferenceParams)) << "there are fields without a row";
  EXPECT_EQ(effect.params_size, sizeof(ReferenceParams));

  const std::filesystem::path folder = std::filesystem::path(test::kSourceFolder) / "reference";
  std::stringstream readme;
  readme << std::ifstream(folder / "README.md").rdbuf();
  const auto expect_named = [&](std::string_view name) {
    EXPECT_NE(readme.str().find(fmt::format("`{}`", name)), std::string::npos) << "README.md does not explain " << name;
  };
  for (const Parameter& row : effect.parameters) expect_named(row.name);
  for (const std::string_view output : effect.dispatches[0].outputs) expect_named(output.substr(0, output.find('.')));
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if ((!name.ends_with(".h") && !name.ends_with(".cpp")) || name.ends_with("_test.cpp")) continue;
    EXPECT_NE(readme.str().find(fmt::format("`{}.", entry.path().stem().string())), std::string::npos)
        << "README.md does not name " << name;
  }
}

}  // namespace
}  // namespace umbrage
