// Polygons are split into triangles of their orientation that cover them once.
#include "scene/readers/polygon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <random>

namespace umbrage {
namespace {

using Polygon = std::vector<glm::vec3>;

glm::dvec3 area(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  return 0.5 * glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a));
}

/// Expects triangles without overlaps: their areas add up to the polygon's, and none is turned over.
void expect_split(const Polygon& polygon, const char* what) {
  SCOPED_TRACE(what);
  std::vector<std::uint32_t> triangles;
  split_polygon(polygon, triangles);
  ASSERT_EQ(triangles.size(), 3 * (polygon.size() - 2));
  glm::dvec3 whole(0.0);
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) whole += area(polygon[0], polygon[i], polygon[i + 1]);
  const glm::dvec3 normal = glm::normalize(whole);
  double covered = 0.0;
  std::size_t turned = 0;
  for (std::size_t i = 0; i < triangles.size(); i += 3) {
    ASSERT_LT(std::max({triangles[i], triangles[i + 1], triangles[i + 2]}), polygon.size());
    const glm::dvec3 part = area(polygon[triangles[i]], polygon[triangles[i + 1]], polygon[triangles[i + 2]]);
    covered += glm::length(part);
    turned += glm::dot(part, normal) < -1e-6 * glm::length(whole);
  }
  EXPECT_EQ(turned, 0u);
  EXPECT_NEAR(covered, glm::length(whole), 1e-5 * glm::length(whole));
}

TEST(Polygon, SplitsConvexOnesIntoFans) {
  std::vector<std::uint32_t> triangles{7};  // appended to
  split_polygon(Polygon{{0, 0, 0}, {2, 0, 0}, {3, 1, 0}, {2, 2, 0}, {0, 2, 0}}, triangles);
  EXPECT_EQ(triangles, (std::vector<std::uint32_t>{7, 0, 1, 2, 0, 2, 3, 0, 3, 4}));
  triangles.clear();
  split_polygon(Polygon{{0, 0, 0}, {2, 0, 0}}, triangles);
  EXPECT_TRUE(triangles.empty());
}

TEST(Polygon, SplitsConcaveOnes) {
  expect_split({{0, 0, 0}, {2, 1, 0}, {0, 2, 0}, {1, 1, 0}}, "arrow");
  expect_split({{1, 1, 0}, {0, 0, 0}, {2, 1, 0}, {0, 2, 0}}, "arrow from its notch");
  expect_split({{0, 2, 0}, {2, 1, 0}, {0, 0, 0}, {1, 1, 0}}, "arrow, clockwise");
  expect_split({{0, 0, 0}, {0, 3, 0}, {0, 3, 1}, {0, 1, 1}, {0, 1, 3}, {0, 0, 3}}, "L in the plane x = 0");
  expect_split({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}}, "square with collinear corners");
  expect_split({{0, 0, 0}, {0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {1, 1, 0}, {1, 1, 0}}, "repeated corners");
  expect_split(
      {{0, 0, 0}, {9, 0, 0}, {9, 9, 0}, {0, 9, 0}, {0, 0, 0}, {3, 3, 0}, {3, 6, 0}, {6, 6, 0}, {6, 3, 0}, {3, 3, 0}},
      "square with a hole");
  Polygon comb, star;
  for (int i = 0; i < 500; ++i) {
    comb.push_back({float(i), float(i % 2 * 40), 0.3f * float(i)});
    const float angle = float(i) * 2.0f * std::numbers::pi_v<float> / 500.0f, radius = i % 2 == 0 ? 1.0f : 0.1f;
    star.push_back({radius * std::cos(angle), 5.0f, radius * std::sin(angle)});
  }
  comb.push_back({499.0f, -9.0f, 0.3f * 499.0f});
  comb.push_back({0.0f, -9.0f, 0.0f});
  expect_split(comb, "comb");
  expect_split(star, "star");
}

/// Returns the outline of Koch's snowflake, of 3 * 4^levels corners.
Polygon snowflake(int levels) {
  std::vector<glm::dvec2> outline{{0.0, 0.0}, {0.5, std::sqrt(0.75)}, {1.0, 0.0}};
  for (; levels > 0; --levels) {
    std::vector<glm::dvec2> finer;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const glm::dvec2 a = outline[i], b = outline[(i + 1) % outline.size()], third = (b - a) / 3.0;
      const glm::dvec2 outward(-third.y, third.x);
      finer.insert(finer.end(), {a, a + third, 0.5 * (a + b) + std::sqrt(0.75) * outward, b - third});
    }
    outline = finer;
  }
  Polygon polygon;
  for (const glm::dvec2& p : outline) polygon.push_back({float(p.x), float(p.y), 0.0f});
  return polygon;
}

TEST(Polygon, SplitsThoseOfManyCorners) {
  expect_split(snowflake(3), "snowflake of 192 corners");
  expect_split(snowflake(6), "snowflake of 12288 corners");
  Polygon comb, rays;
  constexpr int kCorners = 20000;
  for (int i = 0; i < kCorners; ++i) {
    comb.push_back({float(i), i % 2 == 0 ? 0.0f : 20.0f + float(i % 17), 0.0f});
    const float angle = float(i) * 2.0f * std::numbers::pi_v<float> / float(kCorners),
                radius = i % 2 == 0 ? 1.0f : 0.5f;
    rays.push_back({radius * std::cos(angle), radius * std::sin(angle), 0.0f});
  }
  Polygon spiral;
  for (int i = 0; i < 5 * kCorners; ++i) {
    const int along = std::min(i, 5 * kCorners - 1 - i);  // out on one side and back on the other
    const float angle = 0.00628f * float(along), radius = 1.0f + angle + (along == i ? 0.0f : 3.0f);
    spiral.push_back({radius * std::cos(angle), radius * std::sin(angle), 0.0f});
  }
  expect_split(spiral, "spiral");
  comb.push_back({float(kCorners) - 1.0f, -9.0f, 0.0f});
  comb.push_back({0.0f, -9.0f, 0.0f});
  expect_split(comb, "comb");
  expect_split(rays, "rays");
}

TEST(Polygon, SplitsRandomOnes) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  for (int round = 0; round < 300; ++round) {
    // Star-shaped around a point: random radii at ascending angles, in a tilted plane.
    const int count = 4 + int(unit(random) * 60.0f);
    const glm::vec3 u = glm::normalize(glm::vec3(unit(random), unit(random) - 0.5f, 1.0f)),
                    v = glm::normalize(glm::cross(u, glm::vec3(unit(random), 1.0f, 0.2f)));
    Polygon polygon;
    for (int i = 0; i < count; ++i) {
      const float angle = float(i) * 2.0f * std::numbers::pi_v<float> / float(count), radius = 0.05f + unit(random);
      polygon.push_back(radius * (std::cos(angle) * u + std::sin(angle) * v));
    }
    expect_split(polygon, "random");
  }
}

TEST(Polygon, SplitsAnythingInLimitedTime) {
  std::mt19937 random(6);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  Polygon scribble, spiral, line, holes(5, glm::vec3(0.0f));
  for (int i = 0; i < 10000; ++i) {
    scribble.push_back({unit(random), unit(random), unit(random)});
    const float angle = 0.02f * float(i < 5000 ? i : 9999 - i), radius = 0.1f + angle + (i < 5000 ? 0.0f : 3.0f);
    spiral.push_back({radius * std::cos(angle), radius * std::sin(angle), 0.0f});
    line.push_back({float(i % 7), 0.0f, 0.0f});
  }
  holes[2].x = std::numeric_limits<float>::quiet_NaN();
  for (const Polygon& polygon : {scribble, spiral, line, holes}) {
    std::vector<std::uint32_t> triangles;
    split_polygon(polygon, triangles);
    EXPECT_EQ(triangles.size(), 3 * (polygon.size() - 2));
  }
  expect_split(spiral, "spiral");
}

TEST(Polygon, StopsOnceThePollEnds) {
  const Polygon polygon = snowflake(8);
  const ProgressMonitor monitor = [](double) { return false; };
  Poll poll(monitor);
  poll.ask(0.0);
  std::vector<std::uint32_t> stopped, whole;
  split_polygon(polygon, stopped, &poll);
  split_polygon(polygon, whole);
  EXPECT_EQ(stopped.size(), whole.size());
  EXPECT_NE(stopped, whole);
}

}  // namespace
}  // namespace umbrage
