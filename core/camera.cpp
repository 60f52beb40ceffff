#include "core/camera.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>

namespace umbrage {
namespace {

glm::mat4 look_at(glm::vec3 eye, glm::vec3 target, glm::vec3 up) {
  glm::vec3 forward = target - eye;
  const float distance = glm::length(forward);
  forward = distance > 0.0f ? forward / distance : glm::vec3(0.0f, 0.0f, -1.0f);
  glm::vec3 right = glm::cross(forward, up);
  constexpr float kParallel = 1e-4f;  // sine of the angle below which `up` is unusable
  if (!(glm::length(right) > kParallel * glm::length(up))) {
    const glm::vec3 other = std::abs(forward.z) < 0.9f ? glm::vec3(0.0f, 0.0f, 1.0f) : glm::vec3(0.0f, 1.0f, 0.0f);
    right = glm::cross(forward, other);
  }
  right = glm::normalize(right);
  const glm::vec3 true_up = glm::cross(right, forward);
  const glm::mat4 rotation = glm::transpose(
      glm::mat4(glm::vec4(right, 0.0f), glm::vec4(true_up, 0.0f), glm::vec4(-forward, 0.0f), glm::vec4(0, 0, 0, 1)));
  glm::mat4 view = rotation;
  view[3] = glm::vec4(glm::vec3(rotation * glm::vec4(-eye, 0.0f)), 1.0f);
  return view;
}

Camera camera_of(glm::vec3 eye, glm::vec3 target, glm::vec3 up, Projection projection, float half_height,
                 float aspect) {
  Camera camera;
  camera.view_from_world = look_at(eye, target, up);
  camera.projection = projection;
  camera.top = half_height;
  camera.bottom = -half_height;
  camera.right = half_height * aspect;
  camera.left = -camera.right;
  return camera;
}

}  // namespace

glm::vec3 Camera::eye() const {
  const glm::mat3 rotation(view_from_world);
  return -(glm::transpose(rotation) * glm::vec3(view_from_world[3]));
}

Camera perspective_camera(glm::vec3 eye, glm::vec3 target, glm::vec3 up, float angle_deg, float aspect) {
  return camera_of(eye, target, up, Projection::kPerspective, std::tan(glm::radians(angle_deg) / 2.0f), aspect);
}

Camera orthographic_camera(glm::vec3 eye, glm::vec3 target, glm::vec3 up, float height, float aspect) {
  return camera_of(eye, target, up, Projection::kOrthographic, height / 2.0f, aspect);
}

}  // namespace umbrage
