// The figures among the built-in scenes, and their two meshers: closed surfaces at the right place, and parts at the
// positions that the papers' figures need.
#include <gtest/gtest.h>

#include <array>
#include <glm/geometric.hpp>
#include <map>

#include "generators/builtin.h"
#include "generators/makers.h"
#include "generators/sdf_mesh.h"
#include "generators/shapes.h"
#include "support.h"

namespace umbrage {
namespace {

using test::volume;

using glm::vec3;

using EdgeEnd = std::array<float, 3>;

/// Returns the number of directed edges, by position, without a partner in the opposite direction.
int open_edges(const Mesh& mesh) {
  std::map<std::pair<EdgeEnd, EdgeEnd>, int> balance;
  const auto end = [&](std::size_t i) {
    const vec3 p = mesh.positions[mesh.indices[i]];
    return EdgeEnd{p.x, p.y, p.z};
  };
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3)
    for (std::size_t e = 0; e < 3; ++e) {
      const EdgeEnd a = end(t + e), b = end(t + (e + 1) % 3);
      ++balance[{a, b}];
      --balance[{b, a}];
    }
  int open = 0;
  for (const auto& [edge, count] : balance) open += count != 0;
  return open;
}

struct Box {
  vec3 low{1e30f}, high{-1e30f};
};

/// Returns the bounds of all meshes with a name.
Box bounds(const Scene& scene, std::string_view name) {
  Box box;
  for (const Mesh& mesh : scene.meshes)
    if (mesh.name == name)
      for (const vec3& p : mesh.positions) {
        box.low = glm::min(box.low, p);
        box.high = glm::max(box.high, p);
      }
  return box;
}

Scene made(const char* uri) {
  Result<Scene> scene = make_builtin_scene(uri);
  EXPECT_TRUE(scene) << uri;
  return scene ? std::move(*scene) : Scene{};
}

class ImplicitBall : public testing::TestWithParam<float> {};

// The mesh of a sphere away from the origin has every vertex on the sphere, radial normals, no hole, and the documented
// number of triangles. The finest cell needs more than the grid's 96 cells per side, so that triangles are split.
TEST_P(ImplicitBall, IsRoundAndClosed) {
  const float cell = GetParam();
  constexpr float kRadius = 0.8f;
  const vec3 centre(0.31f, -0.2f, 0.07f);
  const Mesh mesh =
      sdf::mesh([=](vec3 p) { return sdf::ball(p, centre, kRadius); }, centre - kRadius, centre + kRadius, cell);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const vec3 out = mesh.positions[i] - centre;
    ASSERT_NEAR(glm::length(out), kRadius, 1e-4f * kRadius);
    ASSERT_GT(glm::dot(glm::normalize(out), mesh.normals[i]), 0.999f);
  }
  EXPECT_EQ(open_edges(mesh), 0);
  const double expected = 3.0 * 4.0 * 3.14159265 * kRadius * kRadius / (cell * cell);
  EXPECT_NEAR(double(mesh.indices.size()) / 3.0, expected, 0.1 * expected);
  EXPECT_NEAR(volume(mesh), 4.0 / 3.0 * 3.14159265 * kRadius * kRadius * kRadius, 0.02);
}
INSTANTIATE_TEST_SUITE_P(Cells, ImplicitBall, testing::Values(0.1f, 0.03f, 0.009f));

TEST(ImplicitBlends, JoinContainsBothAndCutRemovesTheTool) {
  for (float a = -1.0f; a <= 1.0f; a += 0.125f)
    for (float b = -1.0f; b <= 1.0f; b += 0.125f) {
      EXPECT_LE(sdf::join(a, b, 0.3f), std::min(a, b));
      EXPECT_GE(sdf::join(a, b, 0.3f), std::min(a, b) - 0.25f * 0.3f);
      EXPECT_GE(sdf::overlap(a, b, 0.3f), std::max(a, b));
      EXPECT_GE(sdf::cut(a, b, 0.3f), -b);
    }
}

// The volume of a box with rounded edges is that of the inner box, slabs, quarter cylinders and one sphere.
TEST(RoundedHull, BoxHasTheVolumeOfARoundedBox) {
  constexpr double kX = 1.0, kY = 2.0, kZ = 3.0, kR = 0.2;
  std::vector<vec3> points;
  for (const float x : {0.0f, float(kX)})
    for (const float y : {0.0f, float(kY)})
      for (const float z : {0.0f, float(kZ)}) points.push_back({x + 5.0f, y, z - 4.0f});
  const Mesh mesh = rounded_hull(points, float(kR), 24);
  EXPECT_EQ(open_edges(mesh), 0);
  const double x = kX - 2 * kR, y = kY - 2 * kR, z = kZ - 2 * kR, pi = 3.14159265;
  const double expected =
      x * y * z + 2 * kR * (x * y + y * z + z * x) + pi * kR * kR * (x + y + z) + 4.0 / 3.0 * pi * kR * kR * kR;
  EXPECT_NEAR(volume(mesh), expected, 1e-3);
  EXPECT_NEAR(volume(rounded_hull(points, float(kR), 0)), kX * kY * kZ, 1e-5) << "without segments edges are sharp";
  for (const vec3& normal : mesh.normals) EXPECT_NEAR(glm::length(normal), 1.0f, 1e-5f);
}

// Quads that are not quite flat, and corners where more than three faces meet, occur in hand-written plates.
TEST(RoundedHull, SurvivesFacesThatAreNearlyFlat) {
  const std::vector<vec3> half = {{0.60f, 1.80f, 1.38f},  {1.20f, 1.80f, 0.62f},  {1.30f, 1.92f, 0.50f},
                                  {0.62f, 1.96f, 1.42f},  {1.22f, 1.80f, -1.00f}, {1.32f, 1.94f, -1.05f},
                                  {0.85f, 1.84f, -1.72f}, {0.92f, 1.98f, -1.80f}, {0.42f, 2.42f, 0.62f},
                                  {0.92f, 2.42f, 0.20f},  {0.98f, 2.42f, -0.95f}, {0.78f, 2.39f, -1.62f}};
  std::vector<vec3> points = half;
  for (const vec3& p : half) points.push_back(p * vec3(-1, 1, 1));
  for (const float offset : {0.0f, 1e-7f, 1e-5f, 1e-3f}) {
    points[3].y = 1.96f + offset;
    for (const int segments : {0, 1, 2, 5}) {
      const Mesh mesh = rounded_hull(points, 0.035f, segments);
      EXPECT_EQ(open_edges(mesh), 0) << offset << " " << segments;
      EXPECT_GT(volume(mesh), 1.0);
    }
  }
}

TEST(RoundedHull, WithoutPointsIsEmpty) { EXPECT_TRUE(rounded_hull(std::span<const vec3>(), 0.1f, 2).indices.empty()); }

class Figures : public testing::TestWithParam<const char*> {};

// Making a scene twice gives bitwise identical results; triangles face in the direction of their normals.
TEST_P(Figures, AreRepeatableAndRightSideOut) {
  const Scene one = made(GetParam()), two = made(GetParam());
  ASSERT_EQ(one.meshes.size(), two.meshes.size());
  std::size_t reversed = 0;
  for (std::size_t m = 0; m < one.meshes.size(); ++m) {
    const Mesh& mesh = one.meshes[m];
    ASSERT_EQ(mesh.indices, two.meshes[m].indices) << mesh.name;
    ASSERT_EQ(mesh.positions, two.meshes[m].positions) << mesh.name;
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
      const std::uint32_t a = mesh.indices[t], b = mesh.indices[t + 1], c = mesh.indices[t + 2];
      const vec3 face = glm::cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
      reversed += glm::dot(face, mesh.normals[a] + mesh.normals[b] + mesh.normals[c]) < 0.0f;
    }
  }
  // Where a coarse triangle bridges a sharp crease, its face may be opposite to the crease's own normals.
  EXPECT_LT(double(reversed), 0.003 * double(one.triangle_count()));
  EXPECT_GE(one.views.size(), 2u);
}
INSTANTIATE_TEST_SUITE_P(Scenes, Figures,
                         testing::Values("scene:solids?detail=120000", "scene:pink?detail=120000",
                                         "scene:tank?detail=120000", "scene:claw?detail=120000"));

TEST(FigureLayout, ClawIsWellBeforeTheBody) {
  const Scene scene = made("scene:claw?detail=60000");
  const View view = scene.views.at(0);
  const vec3 ahead = glm::normalize(view.target - view.eye);
  const auto depth = [&](const Box& box) { return glm::dot(0.5f * (box.low + box.high) - view.eye, ahead); };
  Box claw;  // the claw that reaches forwards
  for (const Mesh& mesh : scene.meshes)
    if (mesh.name == "claw") {
      Box box;
      for (const vec3& p : mesh.positions) {
        box.low = glm::min(box.low, p);
        box.high = glm::max(box.high, p);
      }
      if (box.high.z > claw.high.z) claw = box;
    }
  const float fraction = depth(claw) / depth(bounds(scene, "trunk"));
  EXPECT_GT(fraction, 0.55f);
  EXPECT_LT(fraction, 0.75f);
}

TEST(FigureLayout, TankIsSeenFromBehindFirst) {
  const Scene scene = made("scene:tank?detail=60000");
  const View view = scene.views.at(0);
  const float muzzle = bounds(scene, "muzzle brake").high.z, rear = bounds(scene, "rear grille").low.z;
  EXPECT_GT(muzzle, 0.0f);
  EXPECT_LT(view.eye.z, rear);
}

TEST(FigureLayout, TankStandsOnItsPad) {
  const Scene scene = made("scene:tank?detail=150000");
  for (const char* part : {"left track", "right track", "foot"})
    EXPECT_NEAR(bounds(scene, part).low.y, 0.0f, 1e-3f) << part;
  EXPECT_NEAR(bounds(scene, "pad").high.y, 0.0f, 1e-6f);
}

TEST(FigureLayout, SolidsStandOnTheTable) {
  const Scene scene = made("scene:solids?detail=60000");
  EXPECT_NEAR(bounds(scene, "table").high.y, 0.0f, 1e-5f);
  for (const char* part : {"sphere", "cube", "cone", "cylinder", "torus knot", "standing ring", "lying ring",
                           "leaning torus", "dodecahedron", "capsule", "pyramid", "spring", "bowl", "stairs"})
    EXPECT_NEAR(bounds(scene, part).low.y, 0.0f, 4e-3f) << part;
}

TEST(FigureLayout, SpriteStandsInTheGrass) {
  const Scene scene = made("scene:pink?detail=60000");
  const Box grass = bounds(scene, "grass");
  for (const char* part : {"left foot", "right foot"}) {
    EXPECT_LT(bounds(scene, part).low.y, grass.high.y + 0.03f) << part;
    EXPECT_GT(bounds(scene, part).high.y, bounds(scene, "body").low.y) << part << " reaches into the body";
  }
}

}  // namespace
}  // namespace umbrage
