// Camera: view matrix and projection.
#pragma once
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace umbrage {

enum class Projection { kPerspective, kOrthographic };

/// A pinhole or parallel camera. View space is right-handed: +x right, +y up, the camera looks down -z; depth is the
/// positive distance along the view axis.
struct Camera {
  glm::mat4 view_from_world{1.0f};
  Projection projection = Projection::kPerspective;
  /// The window that the image fills: at depth 1 for a perspective camera, in scene units for an orthographic one.
  /// Off-centre windows are allowed; top > bottom.
  float left = -1.0f, right = 1.0f, bottom = -1.0f, top = 1.0f;

  /// Returns the position of the camera in world space.
  glm::vec3 eye() const;

  bool operator==(const Camera&) const = default;
};

/// Returns a camera at `eye` that looks at `target`. If `up` is parallel to the view direction, another axis is used.
/// `angle_deg` is the vertical field of view; `aspect` is width / height.
Camera perspective_camera(glm::vec3 eye, glm::vec3 target, glm::vec3 up, float angle_deg, float aspect);

/// Returns an orthographic camera with the same conventions; the image is `height` scene units high.
Camera orthographic_camera(glm::vec3 eye, glm::vec3 target, glm::vec3 up, float height, float aspect);

}  // namespace umbrage
