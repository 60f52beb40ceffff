// Captures on the CPU against geometry in double: depth, normals and textures.
#include "capture_support.h"

namespace umbrage {
namespace {

using namespace test;

// ---- depth and normals ----

TEST(Capture, PlaneFacingTheCameraHasOneDepth) {
  const Scene scene = scene_of({square(50.0f)});
  const Camera perspective = perspective_camera({0.5f, -1.0f, 7.0f}, {0.5f, -1.0f, 0}, {0, 1, 0}, 60.0f, 1.5f);
  const Camera orthographic = orthographic_camera({0.5f, -1.0f, 7.0f}, {0.5f, -1.0f, 0}, {0, 1, 0}, 9.0f, 1.5f);
  for (const Camera& camera : {perspective, orthographic}) {
    const Picture picture = capture(scene, camera, 90, 60);
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 90; ++x) {
        ASSERT_NEAR(picture.depth(x, y), 7.0, 7e-6) << x << ',' << y;
        ASSERT_EQ(picture.normal(x, y), glm::dvec3(0, 0, 1)) << x << ',' << y;
        ASSERT_EQ(picture["object_id"].at(x, y), 0.0f);
      }
  }
}

TEST(Capture, TiltedPlaneFollowsItsEquation) {
  const glm::vec3 point(1, 2, 3), u(90, 15, -27), v(-12, 84, 33);
  const Scene scene = scene_of({parallelogram(point - 0.5f * (u + v), u, v)});
  const glm::dvec3 normal = glm::normalize(glm::cross(glm::dvec3(u), glm::dvec3(v)));
  const glm::vec3 front(normal), side = glm::normalize(u + 0.3f * v);
  for (const float tilt_deg : {5.0f, 50.0f, 74.0f})  // angle between the view axis and the normal
    for (const bool orthographic : {false, true}) {
      const float tilt = glm::radians(tilt_deg);
      const glm::vec3 eye = point + 12.0f * (std::cos(tilt) * front + std::sin(tilt) * side);
      const Camera camera = orthographic ? orthographic_camera(eye, point, {0, 0, 1}, 4.0f, 0.8f)
                                         : perspective_camera(eye, point, {0, 0, 1}, 15.0f, 0.8f);
      const Picture picture = capture(scene, camera, 64, 80);
      const glm::dvec3 expected = glm::dmat3(glm::mat3(camera.view_from_world)) * normal;
      for (int y = 0; y < 80; ++y)
        for (int x = 0; x < 64; ++x) {
          const PixelRay ray = ray_of(picture.info, x, y);
          const double slope = glm::dot(normal, ray.direction);
          const double depth = glm::dot(normal, glm::dvec3(point) - ray.origin) / slope;
          // The more grazing the angle, the more a rounded position moves the hit.
          ASSERT_NEAR(picture.depth(x, y), depth, 3e-6 * depth / std::fabs(slope)) << x << ',' << y;
          ASSERT_LT(degrees_between(picture.normal(x, y), expected), 0.001);
        }
    }
}

TEST(Capture, SphereHasTheNormalsOfASphere) {
  // One sphere with its own normals, one with normals from finish_scene.
  Mesh made = shapes::cube_sphere(64, [](glm::vec3) { return 2.0f; });
  made.normals.clear();
  for (const Mesh& mesh : {shapes::sphere(2.0f, 192, 96), made})
    for (const bool orthographic : {false, true}) {
      const Scene scene = scene_of({mesh});
      const glm::vec3 eye(4, 5, 6);
      const Camera camera = orthographic ? orthographic_camera(eye, {0, 0, 0}, {0, 1, 0}, 4.4f, 1.0f)
                                         : perspective_camera(eye, {0, 0, 0}, {0, 1, 0}, 30.0f, 1.0f);
      const Picture picture = capture(scene, camera, 150, 150);
      const glm::dmat3 view(glm::mat3(camera.view_from_world));
      long compared = 0, background = 0;
      for (int y = 0; y < 150; ++y)
        for (int x = 0; x < 150; ++x) {
          const PixelRay ray = ray_of(picture.info, x, y);
          const double a = glm::dot(ray.direction, ray.direction), b = glm::dot(ray.direction, ray.origin);
          const double root = b * b - a * (glm::dot(ray.origin, ray.origin) - 4.0);
          if (root < 0.0) {
            ASSERT_EQ(picture.depth(x, y), kInfinity);  // the mesh lies inside the sphere
            ++background;
            continue;
          }
          const double depth = (-b - std::sqrt(root)) / a;
          const glm::dvec3 normal = ray.at(depth) / 2.0;
          const double facing = -glm::dot(normal, ray.direction) / std::sqrt(a);
          if (facing < 0.15) continue;  // the mesh's silhouette is a polygon
          ++compared;
          ASSERT_NEAR(picture.depth(x, y), depth, 2e-3 / facing);
          ASSERT_LT(degrees_between(picture.normal(x, y), view * normal), 0.5) << x << ',' << y;
          ASSERT_NEAR(glm::length(picture.normal(x, y)), 1.0, 1e-6);
        }
      EXPECT_GT(compared, 10000);
      EXPECT_GT(background, 2000);
    }
}

/// Returns a scene of points with this diameter: discs if there are normals, otherwise spheres.
Scene points_of(std::vector<glm::vec3> positions, std::vector<glm::vec3> normals, float across,
                std::vector<glm::vec3> colors = {}) {
  Mesh mesh;
  mesh.points = true;
  mesh.positions = std::move(positions);
  mesh.normals = std::move(normals);
  mesh.colors = std::move(colors);
  Scene scene;
  scene.meshes = {mesh};
  scene.materials.emplace_back().albedo = glm::vec3(0.5f);
  EXPECT_EQ(finish_scene(scene, 80.0f, {mesh.normals.empty() ? PointShape::kSpheres : PointShape::kDiscs, {across, 0}}),
            0u);
  return scene;
}

TEST(Capture, PointsAreSpheres) {
  const Scene scene = points_of({{0, 0, 0}}, {}, 4.0f);
  const glm::vec3 eye(4, 5, 6);
  for (const Camera& camera : {perspective_camera(eye, {0, 0, 0}, {0, 1, 0}, 30.0f, 1.0f),
                               orthographic_camera(eye, {0, 0, 0}, {0, 1, 0}, 4.4f, 1.0f)}) {
    const Picture picture = capture_with({97, 97, false, 3}, scene, camera);
    const glm::dmat3 view(glm::mat3(camera.view_from_world));
    long compared = 0;
    for (int y = 0; y < 97; ++y)
      for (int x = 0; x < 97; ++x) {
        const PixelRay ray = ray_of(picture.info, x, y);
        const double a = glm::dot(ray.direction, ray.direction), b = glm::dot(ray.direction, ray.origin);
        const double root = b * b - a * (glm::dot(ray.origin, ray.origin) - 4.0);
        if (std::abs(root) < 1e-3 * a) continue;  // the silhouette
        if (root < 0.0) {
          ASSERT_EQ(picture.depth(x, y), kInfinity);
          continue;
        }
        ++compared;
        const double depth = (-b - std::sqrt(root)) / a;
        ASSERT_NEAR(picture.depth(x, y), depth, 2e-5) << x << ',' << y;
        ASSERT_LT(degrees_between(picture.normal(x, y), view * (ray.at(depth) / 2.0)), 0.05) << x << ',' << y;
        const double chord = 2.0 * std::sqrt(root) / a;
        ASSERT_NEAR(picture["layer1.depth"].at(x, y) - picture.depth(x, y), chord, 1e-4) << x << ',' << y;
        ASSERT_EQ(picture["layer2.depth"].at(x, y), kInfinity);
      }
    EXPECT_GT(compared, 4000);
  }
}

TEST(Capture, PointsWithNormalsAreDiscs) {
  const glm::vec3 normal = glm::normalize(glm::vec3(1, 2, 3));
  // The second one shows its back.
  const Scene scene = points_of({{-1, 0, 0}, {1, 0, 1}}, {normal, -normal}, 1.6f, {{1, 0, 0}, {0, 0.5f, 1}});
  const Camera camera = from_above(4.0f);
  const Picture picture = capture(scene, camera, 120, 120);
  long seen[2] = {0, 0};
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 120; ++x) {
      const PixelRay ray = ray_of(picture.info, x, y);
      const int k = ray.origin.x > 0.0;
      const glm::dvec3 center = k ? glm::dvec3(1, 0, 1) : glm::dvec3(-1, 0, 0);
      const double depth =
          glm::dot(center - ray.origin, glm::dvec3(normal)) / glm::dot(ray.direction, glm::dvec3(normal));
      const double away = glm::distance(ray.at(depth), center);
      if (std::abs(away - 0.8) < 1e-3) continue;
      if (away > 0.8) {
        ASSERT_EQ(picture.depth(x, y), kInfinity) << x << ',' << y;
        continue;
      }
      ++seen[k];
      ASSERT_NEAR(picture.depth(x, y), depth, 2e-5);
      ASSERT_LT(degrees_between(picture.normal(x, y), glm::dvec3(normal)), 0.01);
      const glm::vec3 color = k ? glm::vec3(0, 0.25f, 0.5f) : glm::vec3(0.5f, 0, 0);
      ASSERT_EQ(glm::vec3(picture["albedo.r"].at(x, y), picture["albedo.g"].at(x, y), picture["albedo.b"].at(x, y)),
                color);
    }
  EXPECT_GT(seen[0], 1200);
  EXPECT_GT(seen[1], 1200);
}

TEST(Capture, DiscsOfARoundSurfaceDoNotShadowEachOther) {
  // Points on a sphere, lit from the camera: none of the discs, which overlap and tilt, may shadow another.
  std::vector<glm::vec3> positions, normals;
  constexpr int kCount = 4000;
  for (int k = 0; k < kCount; ++k) {
    const double z = 1.0 - (2.0 * k + 1.0) / kCount, turn = k * std::numbers::pi * (3.0 - std::sqrt(5.0));
    normals.emplace_back(std::sqrt(1.0 - z * z) * std::cos(turn), std::sqrt(1.0 - z * z) * std::sin(turn), z);
    positions.push_back(normals.back());
  }
  Scene scene = points_of(positions, normals, 0.12f);
  scene.lights = {key_light({0.5f, 0.3f, 1})};
  const Picture picture = capture(scene, from_above(2.4f), 130, 130);
  long lit = 0, dark = 0;
  for (int y = 0; y < 130; ++y)
    for (int x = 0; x < 130; ++x) {
      if (!std::isfinite(picture.depth(x, y))) continue;
      const glm::dvec3 n = picture.normal(x, y);
      // The discs are flat, within 3.5 degrees of the sphere; their normals are those of the sphere.
      const glm::dvec3 place = ray_of(picture.info, x, y).at(picture.depth(x, y));
      if (place.z > 0.3) {
        ASSERT_LT(degrees_between(n, glm::normalize(place)), 0.7) << x << ',' << y;
      }
      if (glm::dot(n, glm::normalize(glm::dvec3(0.5, 0.3, 1))) < 0.3) continue;
      (picture["shadow"].at(x, y) > 0.5f ? lit : dark) += 1;
    }
  EXPECT_GT(lit, 5000);
  EXPECT_EQ(dark, 0);
}

TEST(Capture, ColorsRunFromVertexToVertex) {
  Mesh mesh = square(1.0f);
  mesh.uvs.clear();
  mesh.colors = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};  // red along x, green along y
  Material grey;
  grey.albedo = glm::vec3(0.5f);
  Mesh plain = square(1.0f, 0.0f, {3.0f, 0.0f});
  // The coloured mesh is not the first one: its colours must still be found.
  const Scene scene = scene_of({plain, mesh}, {grey});
  const Picture picture = capture(scene, from_above(2.0f), 100, 100);
  for (int y = 2; y < 98; ++y)
    for (int x = 2; x < 98; ++x) {
      ASSERT_NEAR(picture["albedo.r"].at(x, y), 0.5f * (float(x) + 0.5f) / 100.0f, 1e-4f);
      ASSERT_NEAR(picture["albedo.g"].at(x, y), 0.5f * (1.0f - (float(y) + 0.5f) / 100.0f), 1e-4f);
      ASSERT_EQ(picture["albedo.b"].at(x, y), 0.0f);
    }
}

TEST(Capture, OffCentreWindowIsAPartOfTheWhole) {
  const Scene scene = scene_of({shapes::sphere(2.0f, 48, 24), square(9.0f, -1.0f)});
  for (const bool orthographic : {false, true}) {
    const Camera whole = orthographic ? orthographic_camera({4, 5, 6}, {0, 0, 0}, {0, 1, 0}, 8.0f, 1.0f)
                                      : perspective_camera({4, 5, 6}, {0, 0, 0}, {0, 1, 0}, 50.0f, 1.0f);
    // Columns 16 to 47 and rows 32 to 55 of 64 x 64.
    Camera part = whole;
    part.left = whole.left + (whole.right - whole.left) * 0.25f;
    part.right = whole.left + (whole.right - whole.left) * 0.75f;
    part.top = whole.top + (whole.bottom - whole.top) * 0.5f;
    part.bottom = whole.top + (whole.bottom - whole.top) * 0.875f;
    const Picture all = capture(scene, whole, 64, 64), cut = capture(scene, part, 32, 24);
    long different = 0;  // at silhouettes rounding decides which surface is hit
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 32; ++x) {
        const float a = all.depth(x + 16, y + 32), b = cut.depth(x, y);
        different += !(a == b || std::fabs(a - b) < 2e-5f);
        different += glm::distance(all.normal(x + 16, y + 32), cut.normal(x, y)) > 1e-4;
      }
    EXPECT_LE(different, 4) << orthographic;
  }
}

TEST(Capture, PixelsAreCountedFromTheTopLeft) {
  // One small square, above and to the right of the centre.
  const Scene scene = scene_of({square(0.5f, 0.0f, {1.5f, 0.5f})});
  const Picture picture = capture(scene, from_above(4.0f), 4, 4);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) EXPECT_EQ(std::isfinite(picture.depth(x, y)), x == 3 && y == 1) << x << ',' << y;
}

TEST(Capture, BackgroundIsMarkedInEveryPlane) {
  Material material;
  material.albedo = {0.1f, 0.2f, 0.3f};
  material.specular_strength = 0.4f;
  material.specular_exponent = 50.0f;
  Scene scene = scene_of({square(0.5f)}, {material});
  scene.lights = {key_light({0, 0, 1})};
  const Picture picture = capture(scene, from_above(4.0f), 4, 4);
  EXPECT_EQ(picture.depth(0, 0), kInfinity);
  for (const char* name :
       {"normal.x", "normal.y", "normal.z", "albedo.r", "albedo.g", "albedo.b", "specular", "shininess"})
    EXPECT_EQ(picture[name].at(0, 0), 0.0f) << name;
  EXPECT_EQ(picture["object_id"].at(0, 0), -1.0f);
  EXPECT_EQ(picture["material_id"].at(0, 0), -1.0f);
  EXPECT_EQ(picture["shadow"].at(0, 0), 1.0f);
  EXPECT_EQ(picture["albedo.g"].at(2, 2), 0.2f);
  EXPECT_EQ(picture["specular"].at(2, 2), 0.4f);
  EXPECT_EQ(picture["shininess"].at(2, 2), 50.0f);
}

TEST(Capture, ObjectsAndMaterialsAreNumbered) {
  // Four squares in a row, of two materials; the last two are one object.
  std::vector<Mesh> meshes;
  for (int k = 0; k < 4; ++k) meshes.push_back(square(0.5f, 0.1f * k, {k - 1.5f, 0.0f}));
  Scene scene = scene_of(meshes, {Material{}, Material{}});
  scene.meshes[3].object = 2;
  const Picture picture = capture(scene, from_above(1.0f, 4.0f), 4, 1);
  const float objects[] = {0, 1, 2, 2}, materials[] = {0, 1, 0, 1};
  for (int x = 0; x < 4; ++x) {
    EXPECT_EQ(picture["object_id"].at(x, 0), objects[x]);
    EXPECT_EQ(picture["material_id"].at(x, 0), materials[x]);
    EXPECT_NEAR(picture.depth(x, 0), 10.0f - 0.1f * x, 1e-5);
  }
}

TEST(Capture, TheNearestSurfaceIsSeen) {
  const Scene scene = scene_of({square(3.0f, 0.0f), square(1.0f, 2.0f), square(2.0f, 1.0f)});
  const Picture picture = capture(scene, from_above(8.0f), 8, 8);
  const float row[] = {-1, 0, 2, 1, 1, 2, 0, -1};
  for (int x = 0; x < 8; ++x) EXPECT_EQ(picture["object_id"].at(x, 4), row[x]) << x;
}

TEST(Capture, BothSidesShowNormalsTowardsTheCamera) {
  const Scene scene = scene_of({square(2.0f)});
  for (const float side : {1.0f, -1.0f}) {
    const glm::vec3 eye(1.0f, 2.0f, side * 5.0f);
    const Picture picture = capture(scene, perspective_camera(eye, {0, 0, 0}, {0, 1, 0}, 20.0f, 1.0f), 16, 16);
    const glm::dvec3 expected = glm::dmat3(glm::mat3(picture.info.camera.view_from_world)) * glm::dvec3(0, 0, side);
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 16; ++x) {
        ASSERT_TRUE(std::isfinite(picture.depth(x, y)));
        ASSERT_LT(degrees_between(picture.normal(x, y), expected), 0.001) << side;
      }
  }
}

TEST(Capture, NormalsFaceTheCameraOnCoarseMeshesToo) {
  // A sphere of 16 x 8 quads with smooth normals: at the silhouette interpolated normals point away.
  const Scene scene = scene_of({shapes::sphere(1.0f, 16, 8)});
  for (const glm::vec3 eye : {glm::vec3(0, 0, 3), glm::vec3(0.2f, 0.1f, -0.3f)}) {  // outside, and inside
    const Picture picture = capture(scene, perspective_camera(eye, {0, 0, 0}, {0, 1, 0}, 50.0f, 1.0f), 90, 90);
    long hits = 0;
    for (int y = 0; y < 90; ++y)
      for (int x = 0; x < 90; ++x) {
        if (!std::isfinite(picture.depth(x, y))) continue;
        ++hits;
        const glm::dmat3 world = glm::transpose(glm::dmat3(glm::mat3(picture.info.camera.view_from_world)));
        const glm::dvec3 direction = ray_of(picture.info, x, y).direction;
        ASSERT_LE(glm::dot(world * picture.normal(x, y), glm::normalize(direction)), 1e-6) << x << ',' << y;
        ASSERT_NEAR(glm::length(picture.normal(x, y)), 1.0, 1e-5);
      }
    EXPECT_GT(hits, 3000);
  }
}

TEST(Capture, NormalsThatContradictTheWindingStillFaceTheCamera) {
  // Files with clockwise triangles and correct normals are common.
  Mesh mesh = square(2.0f);
  std::swap(mesh.indices[1], mesh.indices[2]);
  std::swap(mesh.indices[4], mesh.indices[5]);
  const Scene scene = scene_of({mesh});
  for (const float side : {1.0f, -1.0f}) {
    const Camera camera = perspective_camera({3.0f, 2.0f, side * 4.0f}, {0, 0, 0}, {0, 1, 0}, 20.0f, 1.0f);
    const glm::dvec3 expected = glm::dmat3(glm::mat3(camera.view_from_world)) * glm::dvec3(0, 0, side);
    const Picture picture = capture(scene, camera, 8, 8);
    for (int x = 0; x < 8; ++x) EXPECT_LT(degrees_between(picture.normal(x, 3), expected), 0.001) << side;
  }
}

// ---- textures ----

Scene textured(Mesh mesh, Texture texture, glm::vec3 albedo = glm::vec3(1.0f)) {
  Material material;
  material.albedo = albedo;
  material.texture = 0;
  Scene scene;
  scene.meshes = {std::move(mesh)};
  scene.materials = {material};
  scene.textures = {std::move(texture)};
  finish_scene(scene);
  return scene;
}

TEST(Capture, TexelsLandOnTheirPixels) {
  // Texels and pixels coincide: row 0 of the texture is at the top, u runs to the right. Colours are sRGB.
  const auto texel = [](int x, int y) { return glm::ivec4(20 * x, 255 - 30 * y, 10 * x * y, 255); };
  const Scene scene = textured(square(2.0f), texture_of(8, 4, texel), {1.0f, 0.5f, 1.0f});
  const Picture picture = capture(scene, from_above(4.0f), 8, 4);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 8; ++x) {
      EXPECT_NEAR(picture["albedo.r"].at(x, y), linear(20 * x), 2e-5) << x << ',' << y;
      EXPECT_NEAR(picture["albedo.g"].at(x, y), 0.5f * linear(255 - 30 * y), 2e-5) << x << ',' << y;
      EXPECT_NEAR(picture["albedo.b"].at(x, y), linear(10 * x * y), 2e-5) << x << ',' << y;
    }
}

TEST(Capture, TexturesRepeat) {
  const auto texel = [](int x, int y) { return glm::ivec4(60 * x, 60 * y, 0, 255); };
  // Texture coordinates from -3 to 5, and once so large that a float has eleven bits of fraction left.
  for (const float shift : {-3.0f, 4096.0f}) {
    Mesh mesh = square(2.0f);
    for (glm::vec2& uv : mesh.uvs) uv = uv * 8.0f + shift;
    const Picture picture = capture(textured(mesh, texture_of(4, 4, texel)), from_above(4.0f), 32, 32);
    const double close = shift < 1000.0f ? 1e-4 : 0.01;
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x) {
        ASSERT_NEAR(picture["albedo.r"].at(x, y), linear(60 * (x % 4)), close) << x << ',' << y;
        ASSERT_NEAR(picture["albedo.g"].at(x, y), linear(60 * (y % 4)), close) << x << ',' << y;
      }
  }
}

Texture checkers() {
  return texture_of(64, 64, [](int x, int y) { return glm::ivec4(glm::ivec3((x / 8 + y / 8) % 2 ? 255 : 0), 255); });
}

TEST(Capture, FarCheckersAverageToTheirMean) {
  // A ground of 4096 x 4096 checkers that extends to the horizon.
  Scene scene = textured(parallelogram({-256, -256, 0}, {512, 0, 0}, {0, 512, 0}, 512.0f), checkers());
  const Camera camera = perspective_camera({0, -256, 2.0f}, {0, 0, 0}, {0, 0, 1}, 40.0f, 1.0f);
  const Picture picture = capture(scene, camera, 200, 200);
  long compared = 0;
  double sum = 0.0;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) {
      if (!(picture.depth(x, y) > 150.0f && picture.depth(x, y) < 400.0f)) continue;
      ++compared;
      sum += picture["albedo.g"].at(x, y);
      // One pixel is at least 0.5 units wide: four checkers.
      EXPECT_NEAR(picture["albedo.g"].at(x, y), 0.5, 0.08) << x << ',' << y;
    }
  ASSERT_GT(compared, 400);
  EXPECT_NEAR(sum / compared, 0.5, 0.01);
}

/// Returns the number of pixels in rows [first, end) whose green satisfies the test.
template <class Test>
long count_green(const Picture& picture, int first, int end, const Test& test) {
  long count = 0;
  for (int y = first; y < end; ++y)
    for (int x = 0; x < picture.info.width; ++x) count += test(picture["albedo.g"].at(x, y));
  return count;
}

TEST(Capture, NearCheckersAreCrisp) {
  Scene scene = textured(parallelogram({-256, -256, 0}, {512, 0, 0}, {0, 512, 0}, 512.0f), checkers());
  const Camera camera = perspective_camera({0.3f, -0.2f, 2.0f}, {0.3f, 0, 0}, {0, 0, 1}, 20.0f, 1.0f);
  const Picture picture = capture(scene, camera, 200, 200);
  // A checker of 8 texels is 35 pixels wide: every pixel is the blend of the four texels around its point. The texture
  // repeats once per unit, and its first row is at the top.
  const auto texel = [](double column, double row) {
    return (long(std::floor(column / 8.0)) + long(std::floor(row / 8.0))) % 2 != 0 ? 1.0 : 0.0;
  };
  int different = 0;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) {
      const PixelRay ray = ray_of(picture.info, x, y);
      const glm::dvec3 point = ray.at(-ray.origin.z / ray.direction.z);
      const double u = 64.0 * point.x - 0.5, v = -64.0 * point.y - 0.5;  // texels
      const double i = std::floor(u), j = std::floor(v), s = u - i, t = v - j;
      const double g = (texel(i, j) * (1.0 - s) + texel(i + 1, j) * s) * (1.0 - t) +
                       (texel(i, j + 1) * (1.0 - s) + texel(i + 1, j + 1) * s) * t;
      different += !(std::fabs(picture["albedo.g"].at(x, y) - g) < 0.01);
    }
  EXPECT_EQ(different, 0);
}

TEST(Capture, CheckersAtAGrazingAngleStaySharpAcross) {
  // Stripes along the view: filtering along the view must not blur across it.
  const auto stripes = texture_of(64, 64, [](int x, int) { return glm::ivec4(glm::ivec3(x / 32 ? 255 : 0), 255); });
  const Scene scene = textured(parallelogram({-32, -32, 0}, {64, 0, 0}, {0, 64, 0}, 64.0f), stripes);
  const Camera camera = perspective_camera({0, -30, 1.5f}, {0, -22, 0}, {0, 0, 1}, 10.0f, 1.0f);
  const Picture picture = capture(scene, camera, 200, 200);
  const long pure = count_green(picture, 60, 140, [](float g) { return g < 0.05f || g > 0.95f; });
  EXPECT_GT(pure, 0.7 * 80 * 200);
}

}  // namespace
}  // namespace umbrage
