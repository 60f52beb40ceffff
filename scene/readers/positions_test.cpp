// The origin of files with coordinates too large for floats, with strays far from the model.
#include "scene/readers/positions.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

namespace umbrage {
namespace {

glm::dvec3 origin_of(const std::vector<glm::dvec3>& positions) {
  OriginFinder finder;
  for (const glm::dvec3& p : positions) finder.add(p);
  return finder.origin();
}

/// Positions along a line of this length, with the strays after every 100th.
std::vector<glm::dvec3> line_at(const glm::dvec3& start, std::size_t count, const glm::dvec3& stray) {
  std::vector<glm::dvec3> positions;
  for (std::size_t i = 0; i < count; ++i) {
    positions.push_back(start + glm::dvec3(double(i) / double(count), 0.0, 0.0));
    if (i % 100 == 0) positions.push_back(stray);
  }
  return positions;
}

TEST(OriginFinder, IsNotMovedByStrays) {
  const glm::dvec3 far(512345.0, 4212345.0, 101.0), infinite(HUGE_VAL, 0.0, 0.0);
  for (const std::size_t count : {4u, 100u, 100000u})
    for (const glm::dvec3& stray : {glm::dvec3(0.0), -far, infinite}) {
      EXPECT_LT(glm::length(origin_of(line_at(far, count, stray)) - far), 2.0) << count;
      EXPECT_EQ(origin_of(line_at({0.0, 0.0, 0.0}, count, stray)), glm::dvec3(0.0)) << count;
    }
}

TEST(OriginFinder, IsZeroWithoutFinitePositions) {
  EXPECT_EQ(origin_of({}), glm::dvec3(0.0));
  EXPECT_EQ(origin_of({glm::dvec3(NAN)}), glm::dvec3(0.0));
  EXPECT_EQ(origin_of({glm::dvec3(1e9), glm::dvec3(1e9)}), glm::dvec3(0.0));
}

}  // namespace
}  // namespace umbrage
