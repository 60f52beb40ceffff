// Framing: where the camera stands when nobody said, and the options that move it.
#pragma once
#include <optional>

#include "core/camera.h"
#include "scene/scene.h"

namespace umbrage {

/// What a person may say of the camera; what is not said is chosen. Positions in scene units, angles in degrees.
struct Framing {
  std::optional<glm::vec3> position, focal_point, view_up, direction;
  std::optional<float> view_angle_deg;  ///< vertical field of view
  float azimuth_deg = 0.0f, elevation_deg = 0.0f;
  float zoom = 1.0f;  ///< above 1: the model fills more of the picture
  bool orthographic = false;
  /// The camera that all this makes is turned as it is, not fitted anew, about the scene's up axis through what it
  /// looks at, or through the scene's middle where it was fitted. Counterclockwise as seen from above.
  float turn_deg = 0.0f;
};

/// The axis of Framing::turn_deg: a point on it; its direction is Scene::up.
glm::vec3 turn_center(const Scene& scene, const Framing& framing);

/// The camera for an image of width x height pixels. Without any wish: the scene's first suggested view, or else the
/// whole scene from slightly above and to the side, fitted to the picture with a small margin.
Camera frame_scene(const Scene& scene, const Framing& framing, int width, int height);

/// The lights of a scene that brings none: a white key light from above and to the left of the camera, with a shadow.
/// Its disc spans four degrees, so that ray-traced shadows are a little soft.
std::vector<Light> default_lights(const Scene& scene, const Camera& camera);

/// A photographer's: a large white key light from above and to the left, a weaker and larger fill light from the other
/// side, both with soft shadows.
std::vector<Light> studio_lights(const Camera& camera);

/// Ambient light that goes with studio_lights.
inline constexpr float kStudioAmbient = 0.42f;

}  // namespace umbrage
