// Captured depth layers.
#include <algorithm>

#include "capture_support.h"

namespace umbrage {
namespace {

using namespace test;

// ---- depth layers ----

/// Returns the number of surfaces at a pixel; they must be in its first layers.
int surfaces_at(const Picture& picture, int layers, int x, int y) {
  int count = 0;
  for (int layer = 0; layer < layers; ++layer)
    if (std::isfinite(picture[layer_plane(layer, "depth")].at(x, y))) {
      EXPECT_EQ(count, layer) << "a surface behind an empty layer at " << x << ',' << y;
      ++count;
    }
  return count;
}

void expect_empty(const Picture& picture, int layer, int x, int y) {
  SCOPED_TRACE(fmt::format("layer {} at {},{}", layer, x, y));
  const auto value = [&](const char* name) { return picture[layer_plane(layer, name)].at(x, y); };
  EXPECT_EQ(value("depth"), kInfinity);
  for (const char* name :
       {"normal.x", "normal.y", "normal.z", "albedo.r", "albedo.g", "albedo.b", "specular", "shininess"})
    EXPECT_EQ(value(name), 0.0f) << name;
  for (const char* name : {"object_id", "material_id"}) EXPECT_EQ(value(name), -1.0f) << name;
  EXPECT_EQ(value("shadow"), 1.0f);
}

TEST(CaptureLayers, ParallelSheetsComeInOrder) {
  const float heights[] = {0.5f, 2.0f, -1.0f, 1.0f};
  std::vector<Mesh> sheets;
  for (const float height : heights) sheets.push_back(square(8.0f, height));
  const Scene scene = scene_of(sheets, {Material{}, Material{}});
  const int order[] = {1, 3, 0, 2};
  for (const Camera& camera : {perspective_camera({0.3f, -0.2f, 7.0f}, {0.3f, -0.2f, 0}, {0, 1, 0}, 40.0f, 1.0f),
                               orthographic_camera({0.3f, -0.2f, 7.0f}, {0, 0, 0}, {0, 1, 0}, 6.0f, 1.0f)}) {
    const Picture picture = capture_with({33, 33, false, 6}, scene, camera);
    ASSERT_EQ(picture.planes.planes.size(), 6u * 12u);
    for (int y = 0; y < 33; ++y)
      for (int x = 0; x < 33; ++x) {
        const PixelRay ray = ray_of(picture.info, x, y);
        for (int layer = 0; layer < 4; ++layer) {
          const int sheet = order[layer];
          const double depth = (heights[sheet] - ray.origin.z) / ray.direction.z;
          ASSERT_NEAR(picture[layer_plane(layer, "depth")].at(x, y), depth, 2e-6 * depth) << layer;
          ASSERT_EQ(picture[layer_plane(layer, "object_id")].at(x, y), float(sheet));
          ASSERT_EQ(picture[layer_plane(layer, "material_id")].at(x, y), float(sheet % 2));
        }
        expect_empty(picture, 4, x, y);
        expect_empty(picture, 5, x, y);
      }
  }
}

TEST(CaptureLayers, TheBackOfABoxIsBehindItsFront) {
  const Scene scene = scene_of({shapes::box({-1, -1, -1}, {1, 1, 1})});
  const Picture picture =
      capture_with({64, 64, true, 3}, scene, perspective_camera({0, 0, 6}, {0, 0, 0}, {0, 1, 0}, 25.0f, 1.0f));
  long seen = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const glm::dvec3 at_back = ray_of(picture.info, x, y).at(7.0);
      if (std::max(std::fabs(at_back.x), std::fabs(at_back.y)) > 0.99) continue;  // leaves through a side
      ++seen;
      ASSERT_NEAR(picture.depth(x, y), 5.0f, 1e-5);
      ASSERT_NEAR(picture["layer1.depth"].at(x, y), 7.0f, 1e-5);
      ASSERT_EQ(layer_normal(picture, 0, x, y), glm::dvec3(0, 0, 1));
      ASSERT_EQ(layer_normal(picture, 1, x, y), glm::dvec3(0, 0, 1)) << "the inside of the back faces the camera";
      expect_empty(picture, 2, x, y);
    }
  EXPECT_GT(seen, 500);
}

TEST(CaptureLayers, ASphereIsAsThickAsItsChord) {
  constexpr double kRadius = 2.0;
  const Scene scene = scene_of({shapes::sphere(float(kRadius), 192, 96)});
  const glm::vec3 eye(4, 5, 6);
  for (const Camera& camera : {perspective_camera(eye, {0, 0, 0}, {0, 1, 0}, 30.0f, 1.0f),
                               orthographic_camera(eye, {0, 0, 0}, {0, 1, 0}, 4.4f, 1.0f)}) {
    const Picture picture = capture_with({97, 97, false, 3}, scene, camera);
    long compared = 0;
    for (int y = 0; y < 97; ++y)
      for (int x = 0; x < 97; ++x) {
        const PixelRay ray = ray_of(picture.info, x, y);
        const double a = glm::dot(ray.direction, ray.direction), b = glm::dot(ray.direction, ray.origin);
        const double root = b * b - a * (glm::dot(ray.origin, ray.origin) - kRadius * kRadius);
        if (root < 0.0) {
          expect_empty(picture, 0, x, y);
          continue;
        }
        const double facing = std::sqrt(root / a) / kRadius;
        if (facing < 0.15) continue;  // the mesh's silhouette is a polygon
        ++compared;
        const double chord = 2.0 * std::sqrt(root) / a;
        ASSERT_NEAR(picture["layer1.depth"].at(x, y) - picture.depth(x, y), chord, 2e-3 / facing) << x << ',' << y;
        for (const int layer : {0, 1})
          ASSERT_LT(glm::dot(layer_normal(picture, layer, x, y),
                             glm::dmat3(glm::mat3(camera.view_from_world)) * ray.direction),
                    0.0)
              << "layer " << layer;
        expect_empty(picture, 2, x, y);
      }
    EXPECT_GT(compared, 4000);
  }
}

TEST(CaptureLayers, RaysEnterAndLeaveClosedSolids) {
  // Rays through edges and vertices meet several triangles in one place, which count as one surface.
  struct Solid {
    const char* name;
    Mesh mesh;
    bool convex;
  };
  const auto round = [](glm::vec3) { return 1.0f; };
  Mesh cone = shapes::cone(0.9f, 0.3f, 0.8f, 24, 3);
  for (glm::vec3& p : cone.positions) p.y -= 0.41f;  // no ray lies in the plane of its base
  const Solid solids[] = {{"coarse sphere", shapes::sphere(1.0f, 16, 8), true},
                          {"fine sphere", shapes::sphere(1.0f, 90, 60), true},
                          {"box", shapes::box({-0.7f, -0.8f, -0.9f}, {0.9f, 0.8f, 0.7f}), true},
                          {"cone", cone, true},
                          {"sphere of quads that are not flat", shapes::cube_sphere(8, round), false},
                          {"torus", shapes::torus(0.7f, 0.3f, 48, 24), false}};
  for (const Solid& solid : solids) {
    const Scene scene = scene_of({solid.mesh});
    for (const glm::vec3 eye : {glm::vec3(0, 0, 5), glm::vec3(5, 0, 0), glm::vec3(3.0f, 3.1f, 2.9f)})
      for (const Camera& camera : {perspective_camera(eye, {0, 0, 0}, {0.1f, 1, 0}, 40.0f, 1.0f),
                                   orthographic_camera(eye, {0, 0, 0}, {0, 1, 0.1f}, 3.0f, 1.0f)}) {
        constexpr int kLayers = 6;
        const Picture picture = capture_with({65, 65, false, kLayers}, scene, camera);
        long hit = 0, wrong = 0;
        for (int y = 0; y < 65; ++y)
          for (int x = 0; x < 65; ++x) {
            const int count = surfaces_at(picture, kLayers, x, y);
            hit += count > 0;
            wrong += solid.convex ? count != 0 && count != 2 : count % 2 != 0;
          }
        EXPECT_EQ(wrong, 0) << solid.name << ", of " << hit;
        EXPECT_GT(hit, 300) << solid.name;
      }
  }
}

TEST(CaptureLayers, VerticesAndDiagonalsOfAGridAreOneSurface) {
  // Pixel centres fall on the vertices of 17 x 17, and on the diagonals of 16 x 16.
  const auto grid = [](float half, int cells) {
    return scene_of(
        {shapes::quad({-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}, cells, cells)});
  };
  for (const auto& [pixels, height] : {std::pair{17, 4.25f}, {16, 4.0f}}) {
    const Picture picture = capture_with({pixels, pixels, false, 3}, grid(2.25f, 18), from_above(height));
    for (int y = 0; y < pixels; ++y)
      for (int x = 0; x < pixels; ++x) ASSERT_EQ(surfaces_at(picture, 3, x, y), 1) << x << ',' << y;
  }
  // Rounding decides whether a border that falls on pixel centres belongs to the surface: for Embree's rays all of it
  // does with fused multiply-adds, and half of it without (SSE4.2), as in rasterisation. So the border is cropped.
  const auto without_border = [](Image image) {
    Image out(image.width - 2, image.height - 2);
    for (std::size_t p = 0; p < image.planes.size(); ++p) out.add(image.names[p]) = cropped(image.planes[p], 1);
    return out;
  };
  if (Device* const gpu = test::capturing_device(VulkanCapture::kRays)) {
    const Scene scene = grid(2.0f, 16);
    const CaptureSettings settings{.width = 17, .height = 17, .layers = 3};
    const test::Deviation d =
        test::deviation({without_border(test::captured(*gpu, scene, from_above(4.25f), settings)),
                         without_border(test::captured(*make_cpu_device(), scene, from_above(4.25f), settings))},
                        settings.layers);
    EXPECT_LE(d.anywhere, d.pixels / 200);
    for (const auto& [plane, count] : d.inside) EXPECT_LE(count, d.pixels / 500) << plane;
  }
}

TEST(CaptureLayers, CloseSheetsAreOneSurfaceFromAfarAndTwoFromNear) {
  for (const float scale : {1.0f, 0x1p-20f, 0x1p30f}) {
    const float distance = 8.0f * scale;
    for (const auto& [fraction, surfaces] : {std::pair{0.8e-5f, 1}, {1e-4f, 2}}) {
      const Scene scene = scene_of({square(scale), square(scale, -fraction * distance)});
      const glm::vec3 eye(0, 0, distance), middle(0, 0, 0), up(0, 1, 0);
      for (const Camera& camera : {perspective_camera(eye, middle, up, 10.0f, 1.0f),
                                   orthographic_camera(eye, middle, up, 1.5f * scale, 1.0f)}) {
        const Picture picture = capture_with({16, 16, false, 3}, scene, camera);
        for (int y = 0; y < 16; ++y)
          for (int x = 0; x < 16; ++x)
            ASSERT_EQ(surfaces_at(picture, 3, x, y), surfaces) << fraction << " at scale " << scale;
      }
    }
  }
}

TEST(CaptureLayers, MasksCutHolesInEveryLayer) {
  const Scene scene = holed_square_over_ground();
  const glm::vec3 above(0, 0, 10), below(0, 0, -10), origin(0, 0, 0);
  for (const glm::vec3 eye : {above, below}) {
    const Picture picture =
        capture_with({96, 96, false, 3}, scene, orthographic_camera(eye, origin, {0, 1, 0}, 4.0f, 1.0f));
    long holes = 0, solids = 0;
    for (int y = 0; y < 96; ++y)
      for (int x = 0; x < 96; ++x) {
        const double square = inside_square(ray_of(picture.info, x, y).origin), hole = square - 0.5;
        if (std::fabs(square) < 0.02 || std::fabs(hole) < 0.04) continue;  // a texel is 1/32 wide
        const bool solid = square > 0.0 && hole < 0.0;
        (solid ? solids : holes) += 1;
        ASSERT_EQ(surfaces_at(picture, 3, x, y), solid ? 2 : 1) << x << ',' << y;
        const int ground = solid && eye == above ? 1 : 0;
        ASSERT_EQ(picture[layer_plane(ground, "object_id")].at(x, y), 0.0f);
        if (solid) {
          ASSERT_EQ(picture[layer_plane(1 - ground, "object_id")].at(x, y), 1.0f);
        }
      }
    EXPECT_GT(holes, 1000);
    EXPECT_GT(solids, 500);
  }
}

TEST(CaptureLayers, EveryLayerHasItsShadow) {
  Scene scene = square_over_ground();
  scene.lights = {key_light({0, 0, 1})};
  const Picture picture = capture_with({64, 64, true, 2}, scene, from_above(4.0f));
  long under = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const double inside = inside_square(ray_of(picture.info, x, y).origin);
      if (std::fabs(inside) < 2e-3) continue;
      ASSERT_EQ(picture["shadow"].at(x, y), 1.0f);
      ASSERT_EQ(picture["layer1.shadow"].at(x, y), inside > 0.0 ? 0.0f : 1.0f);
      under += inside > 0.0;
    }
  EXPECT_GT(under, 900);
}

TEST(CaptureLayers, TriangleSoupMatchesABruteForceSearch) {
  Mesh soup;
  constexpr unsigned kTriangles = 120;
  const auto random = [](unsigned i) { return 2.0f * (float(test::hash(i) >> 8) * 0x1p-24f) - 1.0f; };
  for (unsigned i = 0; i < 3 * kTriangles; ++i) {
    soup.positions.emplace_back(random(3 * i), random(3 * i + 1), random(3 * i + 2));
    soup.indices.push_back(i);
  }
  const Scene scene = scene_of({soup});
  for (const Camera& camera : {perspective_camera({2, 3, 4}, {0, 0, 0}, {0, 1, 0}, 30.0f, 1.0f),
                               orthographic_camera({2, 3, 4}, {0, 0, 0}, {0, 1, 0}, 3.0f, 1.0f),
                               perspective_camera({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 80.0f, 1.0f)}) {  // inside
    const Picture picture = capture_with({60, 60, false, kMaxLayers}, scene, camera);
    long compared = 0, max = 0;
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 60; ++x) {
        const PixelRay ray = ray_of(picture.info, x, y);
        std::vector<double> depths;
        bool clear = true;  // no edge or second surface is so close that rounding decides
        for (unsigned i = 0; i < kTriangles; ++i) {
          const glm::dvec3 a(soup.positions[3 * i]), b(soup.positions[3 * i + 1]), c(soup.positions[3 * i + 2]);
          // [Moeller and Trumbore 1997]
          const glm::dvec3 p = glm::cross(ray.direction, c - a), q = glm::cross(ray.origin - a, b - a);
          const double whole = glm::dot(b - a, p);
          const double u = glm::dot(ray.origin - a, p) / whole, v = glm::dot(ray.direction, q) / whole;
          const double depth = glm::dot(c - a, q) / whole, margin = std::min({u, v, 1.0 - u - v});
          constexpr double kMargin = 1e-4;
          clear = clear && std::fabs(margin) > kMargin && std::fabs(depth) > kMargin;
          if (margin > 0.0 && depth > 0.0) depths.push_back(depth);
        }
        std::sort(depths.begin(), depths.end());
        constexpr double kMinGap = 5e-4;
        for (std::size_t k = 1; k < depths.size(); ++k) clear = clear && depths[k] - depths[k - 1] > kMinGap;
        if (!clear) continue;
        ++compared;
        max = std::max(max, long(depths.size()));
        ASSERT_EQ(surfaces_at(picture, kMaxLayers, x, y), int(std::min(depths.size(), std::size_t(kMaxLayers))))
            << x << ',' << y;
        for (std::size_t k = 0; k < depths.size() && k < std::size_t(kMaxLayers); ++k)
          ASSERT_NEAR(picture[layer_plane(int(k), "depth")].at(x, y), depths[k], 1e-4);
      }
    EXPECT_GT(compared, 2000);
    EXPECT_GT(max, 8);
  }
}

TEST(CaptureLayers, LayersDoNotDependOnTheirNumber) {
  const Scene scene = mixed_scene();
  const Camera camera = perspective_camera({-5, -6, 9}, {-1, -1, 0}, {0, 0, 1}, 40.0f, 0.6f);
  const Picture four = capture_with({61, 103, true, 4}, scene, camera);
  for (const int layers : {1, 2, 3}) {
    const Picture fewer = capture_with({61, 103, true, layers}, scene, camera);
    ASSERT_EQ(fewer.planes.planes.size(), std::size_t(layers) * 12u);
    for (std::size_t p = 0; p < fewer.planes.planes.size(); ++p) {
      ASSERT_EQ(fewer.planes.names[p], four.planes.names[p]);
      EXPECT_EQ(test::difference(fewer.planes.planes[p], four.planes.planes[p], 0.0).max, 0.0)
          << layers << ": " << fewer.planes.names[p];
    }
  }
}

TEST(CaptureLayers, DoNotDependOnThreads) {
  const Scene scene = mixed_scene();
  const Camera camera = perspective_camera({-5, -6, 9}, {-1, -1, 0}, {0, 0, 1}, 40.0f, 0.6f);
  const CaptureSettings settings{.width = 90, .height = 150, .layers = 3};
  const Picture one = capture_with(settings, scene, camera, {.threads = 1});
  for (const int threads : {2, 7})
    expect_equal(one.planes, capture_with(settings, scene, camera, {.threads = threads}).planes,
                 fmt::format("{} threads", threads));
}

TEST(CaptureLayers, SmallAndOddSizes) {
  const Scene scene = scene_of({square(8.0f, 1.0f), square(8.0f)});
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 2}, {2, 3}, {17, 5}, {5, 67}}) {
    const Picture picture =
        capture_with({width, height, true, 3}, scene, from_above(4.0f, float(width) / float(height)));
    ASSERT_EQ(picture["layer2.depth"].width, width);
    ASSERT_EQ(picture["layer2.depth"].height, height);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) ASSERT_EQ(surfaces_at(picture, 3, x, y), 2) << x << ',' << y;
  }
}

TEST(CaptureLayers, ScalingByPowersOfTwoChangesOnlyDepths) {
  const auto picture_at = [](float scale) {
    Scene scene = mixed_scene();
    for (Mesh& mesh : scene.meshes)
      for (glm::vec3& p : mesh.positions) p *= scale;
    finish_scene(scene);
    const glm::vec3 eye(-5, -6, 9), target(-1, -1, 0);
    return capture_with({70, 70, true, 3}, scene,
                        perspective_camera(eye * scale, target * scale, {0, 0, 1}, 40.0f, 1.0f));
  };
  const Picture plain = picture_at(1.0f);
  for (const float scale : {0x1p-30f, 0x1p20f}) {
    Picture scaled = picture_at(scale);
    for (std::size_t p = 0; p < scaled.planes.planes.size(); ++p) {
      const std::string& name = scaled.planes.names[p];
      Plane& plane = scaled.planes.planes[p];
      if (name.ends_with("depth"))
        for (int y = 0; y < 70; ++y)
          for (int x = 0; x < 70; ++x) plane.at(x, y) /= scale;
      EXPECT_EQ(test::difference(plane, plain.planes.planes[p], 0.0).max, 0.0) << name << " at " << scale;
    }
  }
}

TEST(CaptureLayers, BeyondTheRayLimitEveryLayerIsEmpty) {
  const Scene scene = scene_of({square(1.0f)});
  const Picture picture =
      capture_with({5, 3, true, 3}, scene, orthographic_camera({0, 0, 1e19f}, {0, 0, 0}, {0, 1, 0}, 4.0f, 1.0f));
  for (int layer = 0; layer < 3; ++layer) expect_empty(picture, layer, 2, 1);
}

}  // namespace
}  // namespace umbrage
