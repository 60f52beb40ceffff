// Tests hidden lines on layers that are ray traced in double from solids with known edges.
#include "effects/hidden/hidden_lines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "chains/trace.h"
#include "effects/outline/outline_test_scenes.h"

namespace umbrage::test {
namespace {

constexpr int kSize = 384;

/// Returns the layers of a picture. Each scene contributes at most one surface to a ray.
GBuffer layers_of(const std::vector<RayScene>& scenes, int layers, const Lens& lens) {
  std::vector<GBuffer> all;
  for (int layer = 0; layer < layers; ++layer)
    all.push_back(seen(lens, [&](const dvec3& origin, const dvec3& direction) {
      std::vector<Hit> hits;
      for (const RayScene& scene : scenes)
        if (const Hit hit = scene(origin, direction); hit.distance < kInfinity) hits.push_back(hit);
      std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) { return a.distance < b.distance; });
      if (layer >= int(hits.size())) return Hit{};
      Hit hit = hits[std::size_t(layer)];
      if (glm::dot(hit.normal, direction) > 0.0) hit.normal = -hit.normal;
      return hit;
    }));
  GBuffer g = all[0];
  g.layers[0].add("outline") = Plane(lens.width, lens.height, 0.0f);
  for (int layer = 1; layer < layers; ++layer) {
    g.layers.push_back(all[std::size_t(layer)].layers[0]);
    g.info.more_layers.push_back({.kind = LayerKind::kBehind, .of = layer - 1});
  }
  return g;
}

Plane hidden_plane(const GBuffer& g, Settings settings) {
  return run_effect(*find_effect("hidden"), g, joined({{"draw", "on"}, {"width", "1"}}, settings), {}).plane("outline");
}

double total(const Plane& plane) {
  double sum = 0.0;
  for (int y = 0; y < plane.height; ++y)
    for (int x = 0; x < plane.width; ++x) sum += plane.at(x, y);
  return sum;
}

/// A cube, seen from outside and through its near faces.
struct Cube {
  dvec3 center{0.2, -0.1, -kFocus};
  dmat3 turn = rotation(32, 24, 7);
  double half = 1.0;

  dvec3 corner(int k) const { return center + turn * (half * dvec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1)); }
  std::vector<RayScene> walls(int object) const {
    std::vector<HalfSpace> sides;
    for (int axis = 0; axis < 3; ++axis)
      for (int sign : {-1, 1}) {
        dvec3 n(0.0);
        n[axis] = sign;
        sides.push_back({turn * n, half + glm::dot(turn * n, center)});
      }
    return {convex_solid(sides, object), [inside = convex_solid(sides, object, true), outside = convex_solid(sides)](
                                             const dvec3& origin, const dvec3& direction) {
              return outside(origin, direction).distance < kInfinity ? inside(origin, direction) : Hit{};
            }};
  }
};

std::array<double, 2> pixel_of(const dvec3& p, const Lens& lens) {
  const double depth = lens.orthographic ? 1.0 : -p.z;
  return {(p.x / depth - lens.left()) / lens.pixel(), (lens.top() - p.y / depth) / lens.pixel()};
}

/// Returns the three hidden edges of a cube in pixels: those of its farthest corner.
std::vector<std::array<std::array<double, 2>, 2>> hidden_edges_of(const Cube& cube, const Lens& lens) {
  int far = 0;
  for (int k = 1; k < 8; ++k)
    if (cube.corner(k).z < cube.corner(far).z) far = k;
  std::vector<std::array<std::array<double, 2>, 2>> edges;
  for (int bit : {1, 2, 4}) edges.push_back({pixel_of(cube.corner(far), lens), pixel_of(cube.corner(far ^ bit), lens)});
  return edges;
}

double distance_to(const std::array<std::array<double, 2>, 2>& edge, double x, double y) {
  const auto& [a, b] = edge;
  const double dx = b[0] - a[0], dy = b[1] - a[1];
  const double f = std::clamp(((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
  return std::hypot(x - a[0] - f * dx, y - a[1] - f * dy);
}

TEST(Hidden, TheFarEdgesOfACubeAreDrawnAndNothingElse) {
  for (const bool orthographic : {false, true}) {
    const Lens lens{.width = kSize, .height = kSize, .orthographic = orthographic};
    const Cube cube;
    const auto edges = hidden_edges_of(cube, lens);
    const Plane drawn = hidden_plane(layers_of(cube.walls(0), 4, lens), {{"gap", "0"}});
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        double nearest = 1e9;
        for (const auto& edge : edges) nearest = std::min(nearest, distance_to(edge, x + 0.5, y + 0.5));
        if (drawn.at(x, y) > 0.3f) {
          ASSERT_LT(nearest, 1.5) << x << ", " << y << ", orthographic " << orthographic;
        }
      }
    for (const auto& [a, b] : edges)
      for (double f = 0.08; f < 0.92; f += 0.01) {
        const double x = a[0] + f * (b[0] - a[0]), y = a[1] + f * (b[1] - a[1]);
        float max = 0.0f;
        for (int j = -1; j <= 1; ++j)
          for (int i = -1; i <= 1; ++i) max = std::max(max, drawn.at(int(x) + i, int(y) + j));
        EXPECT_GT(max, 0.5f) << f << ", orthographic " << orthographic;
      }
  }
}

TEST(Hidden, DashesCoverAFractionOfALine) {
  const Lens lens{.width = kSize, .height = kSize};
  const GBuffer g = layers_of(Cube().walls(0), 4, lens);
  const double whole = total(hidden_plane(g, {{"gap", "0"}}));
  // Round ends add a pixel to each dash of 12 and 6 pixels: they are as wide as the line.
  EXPECT_NEAR(total(hidden_plane(g, {{"dash", "12"}, {"gap", "6"}})) / whole, 13.0 / 18.0, 0.06);
  EXPECT_NEAR(total(hidden_plane(g, {{"dash", "6"}, {"gap", "12"}})) / whole, 7.0 / 18.0, 0.06);
}

/// Returns the lengths of the dashes that one sees within a pixel of an edge, in pixels, without the first and the
/// last.
std::vector<double> dashes_along(const Plane& drawn, const std::array<std::array<double, 2>, 2>& edge) {
  constexpr double kStep = 0.1;  // pixels
  const auto& [a, b] = edge;
  const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
  std::vector<double> dashes = {0.0};
  for (double at = 0.0; at < length; at += kStep) {
    const int x = int(a[0] + at / length * (b[0] - a[0])), y = int(a[1] + at / length * (b[1] - a[1]));
    float max = 0.0f;
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i) max = std::max(max, drawn.at(x + i, y + j));
    if (max > 0.5f) dashes.back() += kStep;
    if (max <= 0.5f && dashes.back() > 0.0) dashes.push_back(0.0);
  }
  return {dashes.begin() + 1, dashes.end() - 1};
}

/// Returns the walls of a cube, and of another one in it whose edges are nearly the same.
std::vector<RayScene> nested_cubes(double half) {
  auto scenes = Cube().walls(0);
  for (const RayScene& wall : Cube{.half = half}.walls(1)) scenes.push_back(wall);
  return scenes;
}

TEST(Hidden, DashesHaveOneLengthAtAnySize) {
  const Settings settings = {{"width", "0.3%"}, {"dash", "2%"}, {"gap", "1.5%"}};
  std::vector<double> medians;
  for (const int size : {kSize, 2 * kSize}) {
    const Lens lens{.width = size, .height = size};
    const Plane drawn = hidden_plane(layers_of(nested_cubes(0.997), 6, lens), settings);
    for (const auto& edge : hidden_edges_of(Cube(), lens)) {
      std::vector<double> dashes = dashes_along(drawn, edge);
      ASSERT_GE(dashes.size(), 5u);
      std::sort(dashes.begin(), dashes.end());
      medians.push_back((dashes[dashes.size() / 2] - 2.0) / size);  // less the pixel at either end
      EXPECT_LT(dashes.back() - dashes.front(), 2.0 + 0.1 * dashes.front()) << "pixels, of " << size;
    }
  }
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(medians[k + 3], medians[k], 0.1 * medians[k]);
}

TEST(Hidden, LinesThatCoincideAreDrawnOnce) {
  const Lens lens{.width = 2 * kSize, .height = 2 * kSize};
  const Settings settings = {{"width", "3"}, {"dash", "24"}, {"gap", "18"}};
  const double one = total(hidden_plane(layers_of(Cube().walls(0), 4, lens), settings));
  for (const double half : {0.997, 0.99})
    EXPECT_NEAR(total(hidden_plane(layers_of(nested_cubes(half), 6, lens), settings)), one, 0.05 * one) << half;
}

TEST(Hidden, ASphereBehindACubeHasItsSilhouetteThere) {
  const Lens lens{.width = kSize, .height = kSize, .orthographic = true};
  const Cube cube{.center = {0, 0, -5}, .turn = dmat3(1.0), .half = 1.2};
  auto scenes = cube.walls(0);
  const dvec3 center(0.1, -0.2, -9.0);
  scenes.push_back(sphere(center, 0.8, 1));
  const RayScene front = scenes.back();
  scenes.push_back([=](const dvec3& origin, const dvec3& direction) {
    Hit hit = front(origin, direction);
    if (hit.distance == kInfinity) return hit;
    hit.distance += 2.0 * (center.z - (origin + direction * hit.distance).z) / direction.z;
    hit.normal.z = -hit.normal.z;
    return hit;
  });
  const GBuffer g = layers_of(scenes, 6, lens);
  const Plane drawn = hidden_plane(g, {{"gap", "0"}});
  const auto at = pixel_of(center, lens);
  const double radius = 0.8 / lens.pixel();
  for (double angle = 0.0; angle < 6.28; angle += 0.02) {
    const double x = at[0] + radius * std::cos(angle), y = at[1] + radius * std::sin(angle);
    float max = 0.0f;
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i) max = std::max(max, drawn.at(int(x) + i, int(y) + j));
    EXPECT_GT(max, 0.5f) << angle;
  }
  // The circle, and the cube's back: its edges coincide with visible ones, which need no second line.
  EXPECT_NEAR(total(drawn), 2.0 * 3.14159265 * radius, 0.08 * 2.0 * 3.14159265 * radius);
  EXPECT_EQ(total(hidden_plane(g, {{"layers", "1"}})), 0.0) << "the sphere is the third surface";
}

TEST(Hidden, ASurfaceThatContinuesBehindAnotherHasNoEdge) {
  const Lens lens{.width = kSize, .height = kSize};
  std::vector<RayScene> scenes = {ground(20, 2.0)};
  for (const RayScene& wall : Cube{.center = {0, 0.3, -4.5}, .turn = rotation(0, 0), .half = 0.5}.walls(1))
    scenes.push_back(wall);
  // All but the lines of the cube itself, which surround its far face.
  const Plane drawn = hidden_plane(layers_of(scenes, 4, lens), {{"gap", "0"}});
  const Plane alone = hidden_plane(layers_of({scenes[1], scenes[2]}, 4, lens), {{"gap", "0"}});
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x)
      if (alone.at(x, y) == 0.0f) {
        ASSERT_EQ(drawn.at(x, y), 0.0f) << x << ", " << y;
      }
  EXPECT_GT(total(alone), 100.0);
}

TEST(Hidden, WhatTheLastLayerHidesIsUnknown) {
  const Lens lens{.width = kSize, .height = kSize, .orthographic = true};
  std::vector<RayScene> scenes = Cube{.center = {0, 0, -4}, .turn = dmat3(1.0), .half = 0.5}.walls(0);
  const std::vector<RayScene> behind = {ground(90, 0.0, 9.0, 1)};
  scenes.insert(scenes.end(), behind.begin(), behind.end());
  // The wall is the second layer beside the cube and the third behind it: with two layers it would seem to end there.
  scenes.push_back(ground(90, 0.0, 8.0, 2));
  EXPECT_EQ(total(hidden_plane(layers_of(scenes, 2, lens), {})), 0.0);
}

TEST(Hidden, SmallShapesAreDrawnUnlessTheyAreASpeckle) {
  const Lens lens{.width = kSize / 2, .height = kSize / 2, .orthographic = true};
  constexpr int kSide = 5;
  std::vector<RayScene> one, all;
  for (int k = 0; k < 2 * kSide * kSide; ++k) {  // the second half is behind the first
    const int behind = k / (kSide * kSide);
    const dvec3 cell(k % kSide - 2 + 0.5 * behind, k / kSide % kSide - 2 + 0.5 * behind, -2 * behind);
    const auto walls =
        Cube{.center = 28.0 * lens.pixel() * cell - dvec3(0, 0, kFocus), .half = 8.0 * lens.pixel()}.walls(k);
    all.insert(all.end(), walls.begin(), walls.end());
    if (k == 0) one = walls;
  }
  const auto drawn = [&](const std::vector<RayScene>& scenes, const char* dash) {
    return total(hidden_plane(layers_of(scenes, 4, lens), {{"dash", dash}, {"gap", "0"}}));
  };
  EXPECT_GT(drawn(one, "20"), 9.0);
  EXPECT_EQ(drawn(one, "20"), drawn(one, "1"));
  EXPECT_LT(drawn(all, "20"), 0.7 * drawn(all, "1"));
}

TEST(Hidden, LinesOfTheInputRemain) {
  const Lens lens{.width = 64, .height = 48};
  GBuffer g = layers_of(Cube().walls(0), 1, lens);
  Plane& outline = g.layers[0].plane("outline");
  for (int x = 0; x < 64; ++x) outline.at(x, 7) = 0.01f * float(x);
  const Plane drawn = hidden_plane(g, {});
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) EXPECT_EQ(drawn.at(x, y), outline.at(x, y));
}

TEST(Hidden, OpenLinesBeginAndEndWithADash) {
  for (const float length : {3.0f, 12.0f, 20.0f, 47.0f, 400.0f}) {
    const Stroke line{StrokeKind::kHidden, 4, false, {{0, 1, 2}, {0.25f * length, 1, 2}, {length, 1, 2}}, 10.0f, 6.0f};
    const std::vector<Stroke> dashes = dashes_of(line);
    EXPECT_EQ(dashes.front().points.front().x, 0.0f) << length;
    EXPECT_NEAR(dashes.back().points.back().x, length, 1e-4 * length) << length;
    for (std::size_t k = 0; k < dashes.size(); ++k) {
      EXPECT_EQ(dashes[k].object, 4);
      const float from = dashes[k].points.front().x, to = dashes[k].points.back().x;
      if (length >= 20.0f) {
        EXPECT_NEAR(to - from, 10.0f, 2.6f) << length;
      }
      if (k > 0) {
        EXPECT_NEAR(from - dashes[k - 1].points.back().x, 6.0f, 1.6f) << length;
      }
    }
  }
  EXPECT_EQ(dashes_of({StrokeKind::kHidden, 0, true, {{0, 0, 1}, {30, 0, 1}, {0, 0, 1}}, 9.0f, 6.0f}).size(), 4u);
}

}  // namespace
}  // namespace umbrage::test
