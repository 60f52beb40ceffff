// The camera in OpenEXR's header: the attributes worldToCamera and worldToNDC.
#pragma once
#include <glm/mat4x4.hpp>
#include <optional>

#include "core/camera.h"

namespace umbrage {

/// The matrices of a camera in OpenEXR's header. They transform columns (m * p), as in glm. Imath transforms rows and
/// stores rows, which gives the same 16 numbers.
struct ExrCamera {
  /// World to OpenEXR's camera space: left-handed, +x right, +y up, +z forward.
  glm::dmat4 camera_from_world{1.0};
  /// World to normalized device coordinates. After division by w, (0, 0) is the upper left corner of the display window
  /// and (1, 1) the lower right one. OpenEXR does not define z: here it is 1 - 1 / depth for perspective and depth for
  /// parallel cameras, so that the matrix is invertible.
  glm::dmat4 ndc_from_world{1.0};
};

/// Returns the matrices of a camera whose view matrix is `view_from_world`.
ExrCamera exr_camera(const Camera& camera, const glm::dmat4& view_from_world);
inline ExrCamera exr_camera(const Camera& camera) { return exr_camera(camera, glm::dmat4(camera.view_from_world)); }

/// Returns the camera that the two matrices describe, or nothing if they describe no pinhole or parallel camera that
/// Camera can represent.
std::optional<Camera> camera_from(const ExrCamera& matrices);

}  // namespace umbrage
