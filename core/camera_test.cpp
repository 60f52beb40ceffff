// Views of cameras whose up vector is nearly parallel to the view direction.
#include "core/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

namespace umbrage {
namespace {

/// Returns the direction that points up in the picture of a camera at the origin, in world space. `tolerance`: of the
/// axes of its view, which rounding affects the more, the closer `up` is to the view direction.
glm::vec3 up_in_picture(const glm::vec3& forward, const glm::vec3& up, float tolerance) {
  const glm::mat3 view(perspective_camera(glm::vec3(0.0f), forward, up, 40.0f, 1.5f).view_from_world);
  const glm::mat3 unit = view * glm::transpose(view);
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(unit[i][k], i == k ? 1.0f : 0.0f, tolerance);
  EXPECT_NEAR(glm::determinant(view), 1.0f, tolerance) << "mirrored";
  const glm::vec3 to_front = glm::transpose(view) * glm::vec3(0, 0, -1);
  EXPECT_LT(glm::distance(to_front, glm::normalize(forward)), tolerance);
  return glm::transpose(view) * glm::vec3(0, 1, 0);
}

const glm::vec3 kForward[] = {{0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {1, 0, 0}, {0.36f, 0.48f, 0.8f}};

TEST(Camera, UpVectorsCountUntilTheyAreParallelToTheView) {
  for (const glm::vec3& forward : kForward) {
    const glm::vec3 beside = glm::normalize(glm::cross(forward, glm::vec3(0.3f, 0.2f, 0.5f)));
    for (const float length : {1e-3f, 1.0f, 1e3f})
      for (const float along : {-1.0f, 1.0f})
        for (const float sine : {1.0f, 0.1f, 1e-2f, 1e-3f, 2e-4f}) {
          const glm::vec3 up = length * (std::sqrt(1.0f - sine * sine) * along * forward + sine * beside);
          const float tolerance = 1e-5f + 1e-6f / sine;
          EXPECT_LT(glm::distance(up_in_picture(forward, up, tolerance), beside), tolerance) << sine << ' ' << length;
        }
  }
}

TEST(Camera, ParallelUpVectorsAreReplacedByAnAxis) {
  for (const glm::vec3& forward : kForward) {
    // The z axis, or y for views along z.
    const glm::vec3 axis = std::abs(forward.z) < 0.9f ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0);
    const glm::vec3 expected = glm::normalize(axis - glm::dot(axis, forward) * forward);
    const glm::vec3 beside = glm::normalize(glm::cross(forward, glm::vec3(0.3f, 0.2f, 0.5f)));
    for (const float length : {1e-3f, 1.0f, 1e3f})
      for (const float along : {-1.0f, 0.0f, 1.0f})
        for (const float sine : {0.0f, 3e-5f}) {
          if (along == 0.0f && sine > 0.0f) continue;  // not parallel
          const glm::vec3 up = length * (along * forward + sine * beside);
          EXPECT_LT(glm::distance(up_in_picture(forward, up, 1e-5f), expected), 1e-5f) << along << ' ' << sine;
        }
  }
}

}  // namespace
}  // namespace umbrage
