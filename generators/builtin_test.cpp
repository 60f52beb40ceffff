// Built-in scenes satisfy their contract (counts, valid meshes, reproducible results), and the kit's shapes are closed,
// face outwards and have the expected volume.
#include "generators/builtin.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <numbers>

#include "generators/shapes.h"
#include "support.h"

namespace umbrage {
namespace {

using test::volume;

constexpr double kPi = std::numbers::pi;

Scene make(std::string_view uri) {
  Result<Scene> scene = make_builtin_scene(uri);
  if (!scene) {
    ADD_FAILURE() << scene.error().message;
    return {};
  }
  return std::move(*scene);
}

std::string message_of(std::string_view uri) {
  const Result<Scene> scene = make_builtin_scene(uri);
  if (scene) return "no error";
  EXPECT_EQ(scene.error().kind, ErrorKind::kUsage) << uri;
  return scene.error().message;
}

bool contains(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

/// Checks the properties that devices rely on without checking.
void expect_sound(const Scene& scene) {
  ASSERT_FALSE(scene.meshes.empty());
  for (const Texture& texture : scene.textures) {
    EXPECT_GT(texture.width, 0) << texture.name;
    EXPECT_EQ(texture.rgba.size(), std::size_t(texture.width) * std::size_t(texture.height) * 4) << texture.name;
  }
  for (const Material& material : scene.materials) {
    EXPECT_GE(material.texture, kNoTexture) << material.name;
    EXPECT_LT(material.texture, int(scene.textures.size())) << material.name;
    EXPECT_GE(glm::length(material.albedo), 0.0f) << material.name;
    for (int i = 0; i < 3; ++i) EXPECT_LE(material.albedo[i], 1.0f) << material.name;
  }
  for (const Mesh& mesh : scene.meshes) {
    SCOPED_TRACE(mesh.name);
    ASSERT_GE(mesh.material, 0);
    ASSERT_LT(mesh.material, int(scene.materials.size()));
    EXPECT_GE(mesh.object, 0);
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    ASSERT_EQ(mesh.indices.size() % 3, 0u);
    if (scene.materials[std::size_t(mesh.material)].texture != kNoTexture) {
      ASSERT_EQ(mesh.uvs.size(), mesh.positions.size());
    }
    std::size_t out_of_range = 0, outside = 0, not_finite = 0, not_unit = 0;
    for (const std::uint32_t index : mesh.indices) out_of_range += index >= mesh.positions.size();
    for (const glm::vec3& p : mesh.positions) {
      not_finite += !std::isfinite(p.x + p.y + p.z);
      for (int i = 0; i < 3; ++i) outside += p[i] < scene.bounds_min[i] || p[i] > scene.bounds_max[i];
    }
    for (const glm::vec3& n : mesh.normals) not_unit += !(std::abs(glm::length(n) - 1.0f) < 1e-4f);
    for (const glm::vec2& uv : mesh.uvs) not_finite += !std::isfinite(uv.x + uv.y);
    EXPECT_EQ(out_of_range, 0u);
    EXPECT_EQ(not_finite, 0u);
    EXPECT_EQ(not_unit, 0u);
    EXPECT_EQ(outside, 0u);
  }
}

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

class BuiltinScenes : public testing::TestWithParam<BuiltinScene> {};

INSTANTIATE_TEST_SUITE_P(All, BuiltinScenes, testing::ValuesIn(builtin_scenes().begin(), builtin_scenes().end()),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_P(BuiltinScenes, IsSoundAtItsDefault) {
  const Scene scene = make("scene:" + std::string(GetParam().name));
  EXPECT_EQ(scene.name, GetParam().name);
  EXPECT_FALSE(GetParam().summary.empty());
  expect_sound(scene);
  const double triangles = GetParam().default_triangles;
  EXPECT_GE(double(scene.triangle_count()), 0.5 * triangles);
  EXPECT_LE(double(scene.triangle_count()), 2.0 * triangles);
}

TEST_P(BuiltinScenes, HasALightAndAViewOfSomething) {
  const Scene scene = make("scene:" + std::string(GetParam().name) + "?detail=1000");
  EXPECT_GT(scene.radius(), 0.0f);
  EXPECT_LT(scene.radius(), 1e4f);
  for (const View& view : scene.views) {
    EXPECT_GT(glm::length(view.target - view.eye), 0.0f);
    EXPECT_GT(view.angle_deg, 5.0f);
    EXPECT_LT(view.angle_deg, 100.0f);
  }
  for (const Light& light : scene.lights)
    if (light.kind == LightKind::kDirectional) {
      EXPECT_NEAR(glm::length(light.direction), 1.0f, 1e-4f);
      EXPECT_GT(light.angle_deg, 0.0f) << "a light without size has shadows that no light has";
      EXPECT_LT(light.angle_deg, 90.0f);
    } else if (light.kind == LightKind::kPoint) {
      EXPECT_GT(light.radius, 0.0f);
      EXPECT_LT(light.radius, 0.5f * light.reach);
    }
}

TEST_P(BuiltinScenes, FollowsDetail) {
  const std::string uri = "scene:" + std::string(GetParam().name) + "?detail=";
  const Scene coarse = make(uri + "1000");
  expect_sound(coarse);
  // A scene has a min count, which exceeds a thousand for all but the simplest scenes.
  const double min = double(coarse.triangle_count());
  EXPECT_GE(min, 500.0);
  for (const double triangles : {3e4, 1e6}) {
    const Scene scene = make(uri + std::to_string(int(triangles)));
    const double count = double(scene.triangle_count());
    EXPECT_GE(count, 0.5 * triangles);
    EXPECT_LE(count, std::max(2.0 * triangles, min));
    if (triangles > 5e5) expect_sound(scene);
  }
}

TEST_P(BuiltinScenes, IsTheSameTwice) {
  const std::string uri = "scene:" + std::string(GetParam().name) + "?detail=5000";
  const Scene a = make(uri), b = make(uri);
  ASSERT_EQ(a.meshes.size(), b.meshes.size());
  for (std::size_t i = 0; i < a.meshes.size(); ++i) {
    SCOPED_TRACE(a.meshes[i].name);
    EXPECT_TRUE(same_bytes(a.meshes[i].positions, b.meshes[i].positions));
    EXPECT_TRUE(same_bytes(a.meshes[i].normals, b.meshes[i].normals));
    EXPECT_TRUE(same_bytes(a.meshes[i].uvs, b.meshes[i].uvs));
    EXPECT_TRUE(same_bytes(a.meshes[i].indices, b.meshes[i].indices));
    EXPECT_EQ(a.meshes[i].object, b.meshes[i].object);
  }
  ASSERT_EQ(a.textures.size(), b.textures.size());
  for (std::size_t i = 0; i < a.textures.size(); ++i)
    EXPECT_TRUE(same_bytes(a.textures[i].rgba, b.textures[i].rgba)) << a.textures[i].name;
}

TEST(BuiltinNames, AreListedInOrder) {
  const auto scenes = builtin_scenes();
  ASSERT_EQ(scenes.size(), 7u);
  for (std::size_t i = 1; i < scenes.size(); ++i) EXPECT_LT(scenes[i - 1].name, scenes[i].name);
}

TEST(BuiltinNames, AreSuggested) {
  EXPECT_TRUE(contains(message_of("scene:atriun"), "did you mean 'atrium'"));
  const std::string far = message_of("scene:xyzzyplugh");
  EXPECT_TRUE(contains(far, "room") && contains(far, "terrain")) << far;
  EXPECT_TRUE(contains(message_of("scene:"), "atrium"));
  EXPECT_TRUE(contains(message_of("atrium.obj"), "scene:NAME"));
}

TEST(BuiltinDetail, IsCheckedBeforeWork) {
  for (const std::string_view bad :
       {"abc", "", "0", "999", "-5", "1e12", "10000001", "nan", "inf", "5e4x", " 5000", "0x5000"}) {
    const std::string message = message_of("scene:room?detail=" + std::string(bad));
    EXPECT_TRUE(contains(message, "detail cannot be '" + std::string(bad) + "'")) << message;
    EXPECT_TRUE(contains(message, "1000 to 10000000")) << message;
  }
  for (const std::string_view bad : {"foo=1", "detail", "", "Detail=5000", "detail=5000&foo=1"}) {
    const std::string message = message_of("scene:room?" + std::string(bad));
    EXPECT_TRUE(contains(message, "detail")) << message;
  }
  EXPECT_TRUE(contains(message_of("scene:room?foo=1"), "foo=1"));
}

TEST(BuiltinDetail, ReadsScientificNumbers) {
  EXPECT_EQ(make("scene:solids?detail=2e4").triangle_count(), make("scene:solids?detail=20000").triangle_count());
}

// ------------------------------------------------------------------------------------------------------------ the kit

using namespace shapes;

/// Returns the length of the sum of a surface's area vectors over its total area; 0 for a closed surface.
double unclosed_fraction(const Mesh& mesh) {
  glm::dvec3 sum(0.0);
  double total = 0.0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const glm::dvec3 a = mesh.positions[mesh.indices[i]], b = mesh.positions[mesh.indices[i + 1]],
                     c = mesh.positions[mesh.indices[i + 2]];
    sum += glm::cross(b - a, c - a);
    total += glm::length(glm::cross(b - a, c - a));
  }
  return glm::length(sum) / total;
}

/// Expects that normals are unit vectors and on the front side of every face around them.
void expect_outward(const Mesh& mesh) {
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const glm::vec3 a = mesh.positions[mesh.indices[i]], b = mesh.positions[mesh.indices[i + 1]],
                    c = mesh.positions[mesh.indices[i + 2]];
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec3 n = mesh.normals[mesh.indices[i + k]];
      wrong += !(std::abs(glm::length(n) - 1.0f) < 1e-4f) || glm::dot(n, glm::cross(b - a, c - a)) <= 0.0f;
    }
  }
  EXPECT_EQ(wrong, 0u);
}

struct Solid {
  const char* name;
  Mesh mesh;
  double volume;
  double tolerance;  ///< relative, for round shapes made of flat faces
};

TEST(Shapes, SolidsAreClosedAndHaveTheirVolume) {
  const Points2 ell = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  const Points3 straight = {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}};
  Points3 ring;
  for (const glm::vec2 p : circle(1.0f, 96)) ring.emplace_back(p.x, 0.0f, p.y);
  const Solid solids[] = {
      {"box", box({0, 0, 0}, {1, 2, 3}), 6.0, 1e-6},
      {"rounded box", box({-1, -1, -1}, {1, 1, 1}, 1.0f, 16), 4.0 / 3.0 * kPi, 5e-3},
      {"sphere", sphere(1.0f, 96, 48), 4.0 / 3.0 * kPi, 5e-3},
      {"cube sphere", cube_sphere(24, [](glm::vec3) { return 2.0f; }), 32.0 / 3.0 * kPi, 5e-3},
      {"ellipsoid", superellipsoid({1, 2, 3}, 2.0f, 24), 8.0 * kPi, 5e-3},
      {"torus", torus(1.0f, 0.25f, 96, 48), 2.0 * kPi * kPi * 0.0625, 5e-3},
      {"cylinder", cylinder(1.0f, 2.0f, 96), 2.0 * kPi, 5e-3},
      {"cone", cone(1.0f, 0.0f, 3.0f, 96, 4), kPi, 5e-3},
      {"prism", extrusion(sharp(ell), 0.5f), 1.5, 1e-5},
      {"bar", sweep(straight, rectangle({0.5f, 0.25f}), {1, 0, 0}), 0.25, 1e-5},
      {"hoop", tube(ring, 0.1f, 48, true), 2.0 * kPi * kPi * 0.01, 1e-2},
      {"arch", arch(2.0f, 2.5f, 1.5f, 0.4f, 96, true), 0.4 * (3.75 - 0.5 * kPi), 5e-3},
      {"mirrored box", scaled(box({0, 0, 0}, {1, 1, 1}), {-1, 2, 1}), 2.0, 1e-6},
  };
  for (const Solid& solid : solids) {
    SCOPED_TRACE(solid.name);
    EXPECT_NEAR(volume(solid.mesh), solid.volume, solid.tolerance * solid.volume);
    EXPECT_LT(unclosed_fraction(solid.mesh), 1e-5);
    expect_outward(solid.mesh);
    EXPECT_EQ(solid.mesh.uvs.size(), solid.mesh.positions.size());
  }
}

TEST(Shapes, CushionIsClosed) {
  const Mesh mesh = cushion({1.0f, 0.3f, 1.0f}, 24);
  EXPECT_LT(unclosed_fraction(mesh), 1e-4);
  EXPECT_GT(volume(mesh), 0.0);
  expect_outward(mesh);
}

TEST(Shapes, FlippedTurnsInsideOut) {
  const Mesh mesh = flipped(box({0, 0, 0}, {1, 1, 1}));
  EXPECT_NEAR(volume(mesh), -1.0, 1e-6);
  expect_outward(mesh);
}

TEST(Shapes, WallWithHoleIsMissingTheHole) {
  // Sums the area of the front only; the reveals face along x and y.
  const Mesh mesh = wall_with_hole({4, 3}, {1, 1}, {3, 2}, 0.5f);
  double front = 0.0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const glm::vec3 a = mesh.positions[mesh.indices[i]], b = mesh.positions[mesh.indices[i + 1]],
                    c = mesh.positions[mesh.indices[i + 2]];
    front += 0.5 * std::max(glm::cross(b - a, c - a).z, 0.0f);
  }
  EXPECT_NEAR(front, 4.0 * 3.0 - 2.0 * 1.0, 1e-5);
  expect_outward(mesh);
}

TEST(Shapes, MouldingMitresItsCorners) {
  // Around a square of side 2, a section that extends 0.1 outwards fills the frame between sides 2 and 2.2 exactly.
  const Points3 square = {{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}};
  const Points2 section = {{0.0f, 0.0f}, {0.1f, 0.0f}, {0.1f, 0.2f}, {0.0f, 0.2f}, {0.0f, 0.0f}};
  EXPECT_NEAR(volume(moulding(square, sharp(section), true)), 0.2 * (2.2 * 2.2 - 2.0 * 2.0), 1e-5);
}

TEST(Shapes, LatheSeamIsSmooth) {
  const Points2 side = {{1.0f, 0.0f}, {1.2f, 0.5f}, {1.0f, 1.0f}};
  const Mesh mesh = lathe(side, 16);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    for (std::size_t k = i + 1; k < mesh.positions.size(); ++k)
      if (mesh.positions[i] == mesh.positions[k]) {
        EXPECT_GT(glm::dot(mesh.normals[i], mesh.normals[k]), 0.9999f);
      }
}

TEST(Shapes, DetailScalesCounts) {
  const Detail half{0.5f};
  EXPECT_EQ(half(32), 16);
  EXPECT_EQ(half(4, 3), 3);
  EXPECT_EQ(half(0.1f, 0), 0);
}

TEST(Shapes, BuildToCountMeetsTheCountOrTheMin) {
  const auto make_plane = [](const Detail& d) {
    Scene scene;
    add_mesh(scene, "plane", plane({0, 0}, {1, 1}, 0.0f, d(10, 4), d(10, 4)), 0);
    return scene;
  };
  for (const int triangles : {1000, 50'000, 1'000'000})
    EXPECT_NEAR(double(build_to_count(triangles, make_plane).triangle_count()), triangles, 0.25 * triangles);
  EXPECT_EQ(build_to_count(3, make_plane).triangle_count(), 32u);
}

}  // namespace
}  // namespace umbrage
