// Created normals: the crease angle that is chosen for a mesh, smoothing groups and winding.
#include "scene/vertex_normals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <map>
#include <numbers>
#include <random>

namespace umbrage {
namespace {

using Profile = std::vector<glm::vec2>;  // radius and height

std::uint32_t add(Mesh& mesh, const glm::vec3& p) {
  mesh.positions.push_back(p);
  return std::uint32_t(mesh.positions.size() - 1);
}

void add_polygon(Mesh& mesh, const std::vector<glm::vec3>& corners) {
  const std::uint32_t first = add(mesh, corners[0]);
  for (std::size_t i = 1; i < corners.size(); ++i) add(mesh, corners[i]);
  for (std::uint32_t i = 1; i + 1 < corners.size(); ++i)
    mesh.indices.insert(mesh.indices.end(), {first, first + i, first + i + 1});
}

/// Returns a solid with `sides` equal sides around the z axis, with flat ends.
Mesh turned(const Profile& profile, int sides) {
  Mesh mesh;
  const auto ring = [&](const glm::vec2& p) {
    std::vector<glm::vec3> points;
    for (int k = 0; k < sides; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / sides;
      points.emplace_back(p.x * std::cos(angle), p.x * std::sin(angle), p.y);
    }
    return points;
  };
  for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
    const std::vector<glm::vec3> low = ring(profile[i]), high = ring(profile[i + 1]);
    for (int k = 0; k < sides; ++k) {
      const int next = (k + 1) % sides;
      if (profile[i].x == 0.0f)
        add_polygon(mesh, {low[0], high[next], high[k]});
      else if (profile[i + 1].x == 0.0f)
        add_polygon(mesh, {low[k], low[next], high[0]});
      else
        add_polygon(mesh, {low[k], low[next], high[next], high[k]});
    }
  }
  std::vector<glm::vec3> bottom = ring(profile.front());
  std::reverse(bottom.begin(), bottom.end());
  if (profile.front().x > 0.0f) add_polygon(mesh, bottom);
  if (profile.back().x > 0.0f) add_polygon(mesh, ring(profile.back()));
  return mesh;
}

Mesh cylinder(int sides) { return turned({{1.0f, 0.0f}, {1.0f, 2.0f}}, sides); }

/// Returns a sphere of 20 * 4^levels triangles, whose vertices are moved in and out by up to `noise` radii.
Mesh icosphere(int levels, float noise) {
  Mesh mesh;
  const float t = (1.0f + std::sqrt(5.0f)) / 2.0f;
  for (const glm::vec3& p : {glm::vec3(-1, t, 0), glm::vec3(1, t, 0), glm::vec3(-1, -t, 0), glm::vec3(1, -t, 0),
                             glm::vec3(0, -1, t), glm::vec3(0, 1, t), glm::vec3(0, -1, -t), glm::vec3(0, 1, -t),
                             glm::vec3(t, 0, -1), glm::vec3(t, 0, 1), glm::vec3(-t, 0, -1), glm::vec3(-t, 0, 1)})
    add(mesh, glm::normalize(p));
  mesh.indices = {0, 11, 5, 0, 5, 1, 0, 1, 7, 0, 7, 10, 0, 10, 11, 1, 5, 9, 5, 11, 4,  11, 10, 2,  10, 7, 6, 7, 1, 8,
                  3, 9,  4, 3, 4, 2, 3, 2, 6, 3, 6, 8,  3, 8,  9,  4, 9, 5, 2, 4,  11, 6,  2,  10, 8,  6, 7, 9, 8, 1};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [found, is_new] = middles.try_emplace(std::minmax(a, b), 0u);
      if (is_new) found->second = add(mesh, glm::normalize(mesh.positions[a] + mesh.positions[b]));
      return found->second;
    };
    const std::vector<std::uint32_t> old = std::move(mesh.indices);
    mesh.indices.clear();
    for (std::size_t i = 0; i < old.size(); i += 3) {
      const std::uint32_t a = old[i], b = old[i + 1], c = old[i + 2];
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      mesh.indices.insert(mesh.indices.end(), {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca});
    }
  }
  std::mt19937 random(1);
  for (glm::vec3& p : mesh.positions) p *= 1.0f + noise * (float(random() % 2001) / 1000.0f - 1.0f);
  return mesh;
}

glm::vec3 face_normal(const Mesh& mesh, std::size_t face) {
  const std::uint32_t* corner = &mesh.indices[3 * face];
  const glm::vec3 a = mesh.positions[corner[0]];
  return glm::normalize(glm::cross(mesh.positions[corner[1]] - a, mesh.positions[corner[2]] - a));
}

/// Returns the max angle between the normals of a face and of its corners, degrees.
float max_turn_deg(const Mesh& mesh, std::size_t face) {
  float min = 1.0f;
  for (int k = 0; k < 3; ++k)
    min = std::min(min, glm::dot(face_normal(mesh, face), mesh.normals[mesh.indices[3 * face + k]]));
  return glm::degrees(std::acos(std::min(min, 1.0f)));
}

float max_turn_deg(const Mesh& mesh) {
  float max = 0.0f;
  for (std::size_t face = 0; face < mesh.indices.size() / 3; ++face) max = std::max(max, max_turn_deg(mesh, face));
  return max;
}

std::size_t distinct_vertices(const Mesh& mesh) { return mesh.positions.size(); }

TEST(ChosenCreaseAngle, KeepsEdgesOfParts) {
  constexpr float kFlatDeg = 0.1f;
  for (const int sides : {3, 4, 6, 8, 9}) {
    Mesh prism = cylinder(sides);
    make_normals(prism);
    EXPECT_LT(max_turn_deg(prism), kFlatDeg) << sides << " sides";
  }
  // A chamfer of 30, 45 and 60 degrees around a round part: its faces turn only with the part's sides.
  for (const float chamfer_deg : {30.0f, 45.0f, 60.0f}) {
    const float fall = 0.2f * std::tan(glm::radians(chamfer_deg));
    Mesh part = turned({{1.0f, 0.0f}, {1.0f, 2.0f}, {0.8f, 2.0f + fall}}, 64);
    make_normals(part);
    EXPECT_LT(max_turn_deg(part), 360.0f / 64.0f) << chamfer_deg;
    // At both edges of the chamfer and both ends, vertices are double.
    EXPECT_EQ(distinct_vertices(part), 6u * 64u) << chamfer_deg;
  }
}

TEST(ChosenCreaseAngle, MakesCylindersRoundWithSharpEnds) {
  for (const int sides : {11, 12, 13, 16, 18, 24, 32, 64}) {
    Mesh part = cylinder(sides);
    make_normals(part);
    EXPECT_EQ(distinct_vertices(part), 4u * std::size_t(sides)) << sides;
    for (std::size_t v = 0; v < part.positions.size(); ++v) {
      const glm::vec3 p = part.positions[v], n = part.normals[v];
      const float radial = glm::dot(n, glm::vec3(p.x, p.y, 0.0f)), axial = std::abs(n.z);
      EXPECT_NEAR(std::max(radial, axial), 1.0f, 1e-4f) << sides << " sides: " << n.x << " " << n.y << " " << n.z;
    }
  }
}

TEST(ChosenCreaseAngle, LeavesRoundAndRoughSurfacesSmooth) {
  for (const float noise : {0.0f, 0.01f, 0.05f, 0.1f})
    for (const int levels : {1, 2, 3}) {
      const Mesh source = icosphere(levels, noise);
      Mesh mesh = source, smooth = source;
      make_normals(mesh);
      make_normals(smooth, 80.0f);
      EXPECT_EQ(mesh.positions, smooth.positions) << noise << " " << levels;
      EXPECT_EQ(mesh.normals, smooth.normals) << noise << " " << levels;
    }
  for (const int sides : {12, 16, 32}) {  // by longitude and latitude
    Profile half;
    for (int i = 0; i <= sides / 2; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / sides;
      half.emplace_back(i % (sides / 2) == 0 ? 0.0 : std::sin(angle), -std::cos(angle));
    }
    Mesh sphere = turned(half, sides);
    make_normals(sphere);
    EXPECT_EQ(distinct_vertices(sphere), std::size_t(sides * (sides / 2 - 1) + 2)) << sides;
  }
}

TEST(ChosenCreaseAngle, DoesNotDependOnSizeOrPlace) {
  for (const float size : {1e-6f, 1.0f, 1e6f}) {
    Mesh part = cylinder(6);
    for (glm::vec3& p : part.positions) p = size * (p + glm::vec3(100.0f, 0.0f, 0.0f));
    make_normals(part);
    EXPECT_LT(max_turn_deg(part), 0.1f) << size;
  }
}

TEST(SmoothingGroups, BoundWhatIsSmooth) {
  const auto sides_of = [](const Mesh& mesh) { return mesh.indices.size() / 3; };
  Mesh flat = cylinder(32);
  flat.smoothing.assign(sides_of(flat), 0);
  make_normals(flat);
  EXPECT_LT(max_turn_deg(flat), 0.1f) << "group 0 is flat";

  Mesh one = cylinder(6);
  one.smoothing.assign(sides_of(one), 7);
  make_normals(one);
  EXPECT_GT(max_turn_deg(one), 25.0f) << "within a group, edges of a nut are smooth: the file asks for it";

  Mesh two = cylinder(32);  // the halves of the side are in groups 1 and 2, the ends in group 3
  for (std::size_t face = 0; face < sides_of(two); ++face) two.smoothing.push_back(face < 32 ? 1 : face < 64 ? 2 : 3);
  make_normals(two);
  // Of the 32 positions at each end, two are where the halves meet.
  EXPECT_EQ(distinct_vertices(two), 2u * (32u + 32u + 2u));

  Mesh given = cylinder(6);
  given.smoothing.assign(sides_of(given), 7);
  make_normals(given, 30.0f);
  EXPECT_LT(max_turn_deg(given), 0.1f) << "a crease angle that is given applies within groups";
}

TEST(Winding, OfNeighboursIsUnified) {
  std::mt19937 random(3);
  for (const Mesh& source : {icosphere(3, 0.0f), cylinder(32)}) {
    Mesh mixed = source, even = source;
    for (std::size_t face = 0; face < mixed.indices.size() / 3; ++face)
      if (random() % 3 == 0) std::swap(mixed.indices[3 * face + 1], mixed.indices[3 * face + 2]);
    make_normals(mixed);
    make_normals(even);
    EXPECT_EQ(mixed.positions.size(), even.positions.size());
    EXPECT_NEAR(max_turn_deg(mixed), max_turn_deg(even), 1e-3f);
    glm::vec3 low = mixed.positions[0], high = low;
    for (const glm::vec3& p : mixed.positions) low = glm::min(low, p), high = glm::max(high, p);
    for (std::size_t v = 0; v < mixed.positions.size(); ++v)
      EXPECT_GT(glm::dot(mixed.normals[v], mixed.positions[v] - 0.5f * (low + high)), 0.0f)
          << "most faces are outward, so all become so";
  }
}

TEST(Winding, OfATwistedBandIsLeftAsItIs) {
  Mesh band;  // a Moebius strip has no consistent winding
  constexpr int kSteps = 48;
  for (int i = 0; i < kSteps; ++i) {
    const double around = 2.0 * std::numbers::pi * i / kSteps, twist = around / 2.0;
    for (const double side : {-0.3, 0.3}) {
      const double radius = 1.0 + side * std::cos(twist);
      add(band, {float(radius * std::cos(around)), float(radius * std::sin(around)), float(side * std::sin(twist))});
    }
  }
  for (std::uint32_t i = 0; i < kSteps; ++i) {
    const bool last = i + 1 == kSteps;
    const std::uint32_t a = 2 * i, b = a + 1, c = last ? 1 : a + 2, d = last ? 0 : a + 3;
    band.indices.insert(band.indices.end(), {a, b, d, a, d, c});
  }
  make_normals(band);
  ASSERT_EQ(band.normals.size(), band.positions.size());
  EXPECT_EQ(band.positions.size(), 2u * kSteps + 2u) << "one seam, where the normal changes sides";
}

}  // namespace
}  // namespace umbrage
