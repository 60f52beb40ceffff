// The camera as OpenEXR's header says it: the attributes worldToCamera and worldToNDC.
#pragma once
#include <glm/mat4x4.hpp>
#include <optional>

#include "core/camera.h"

namespace umbrage {

/// Columns are transformed (m * p), as glm does. Imath transforms rows and stores rows: the same 16 numbers.
struct ExrCamera {
  /// To OpenEXR's camera space: left-handed, +x right, +y up, +z forward.
  glm::dmat4 camera_from_world{1.0};
  /// After division by w, (0, 0) is the upper left corner of the display window and (1, 1) the lower right one. OpenEXR
  /// leaves z open: it is 1 - 1 / depth for perspective and depth for parallel cameras, so that the matrix has an
  /// inverse.
  glm::dmat4 ndc_from_world{1.0};
};

ExrCamera exr_camera(const Camera& camera);

/// The camera that two such matrices mean, or nothing where they are no pinhole or parallel camera of ours.
std::optional<Camera> camera_from(const ExrCamera& matrices);

}  // namespace umbrage
