// Framing: the default camera and the options that change it; the default lights, which depend on the camera.
#pragma once
#include <optional>
#include <vector>

#include "core/camera.h"
#include "scene/scene.h"

namespace umbrage {

/// A user's request for the camera; members that are not set are chosen automatically. Angles in degrees.
struct Framing {
  std::optional<glm::dvec3> position, focal_point;  ///< in the coordinates of the file: see Scene::origin
  std::optional<glm::vec3> view_up, direction;
  std::optional<float> view_angle_deg;  ///< vertical field of view
  float usual_view_angle_deg = 30.0f;   ///< that of a fitted camera without view_angle_deg
  /// A fitted camera without a direction looks down less, so that the horizon is in the upper part of the picture.
  bool shows_horizon = false;
  float margin = 0.06f;  ///< fraction of the picture left free on each side of a fitted model
  /// A fitted camera centres the model together with its shadow on Scene::ground_object, if the key light, the scene's
  /// or else that of studio_lighting, is parallel, and as far as the model keeps a margin of 0.06. The picture's window
  /// is shifted, not the camera.
  bool centers_shadow = false;
  /// Azimuth and elevation of the key light, see light_direction; empty: chosen by the scene or the look.
  std::optional<glm::vec2> light_deg;
  float azimuth_deg = 0.0f, elevation_deg = 0.0f;
  float zoom = 1.0f;  ///< above 1: the model fills more of the picture
  bool orthographic = false;
  /// Fractions of the picture's width at the right and of its height at the bottom that a fitted model leaves free.
  glm::vec2 free_space{0.0f};
  /// A fitted camera is fitted without the azimuth and elevation and then moved by them around turn_center, as a
  /// turntable moves it: all directions have one distance.
  bool orbits = false;
};

/// Returns a point on the axis of an orbit, whose direction is Scene::up: the point the camera looks at, or the scene's
/// center if the camera was fitted without a focal point.
glm::vec3 turn_center(const Scene& scene, const Framing& framing);

/// Returns the camera for a picture of width x height pixels. By default: the scene's first suggested view, or else the
/// whole scene from slightly above and to the side, fitted to the picture with a small margin.
Camera frame_scene(const Scene& scene, const Framing& framing, int width, int height);

/// Of the points that are added, those that are farthest in each of 98 directions: any direction has one of these
/// within 20 degrees.
class FarthestPoints {
 public:
  FarthestPoints();
  /// Adds a point. Those that are not finite, or farther away than kMaxCoordinate, do not count.
  void add(const glm::dvec3& p);
  /// Returns the points; none if none was added.
  std::vector<glm::dvec3> points() const;

 private:
  struct Direction {
    glm::dvec3 direction, farthest{0.0};
    double distance = 0.0;
  };
  std::vector<Direction> directions_;
  bool is_empty_ = true;
};

/// Returns what frame_scene would fit the camera to, as points for Scene::motion.
std::vector<glm::vec3> points_around(const Scene& scene);

/// Returns whether frame_scene fits the camera to the scene: it has no position, neither of the request nor of a view.
bool is_fitted(const Scene& scene, const Framing& framing);

/// Rotates a camera about the axis through `center` in the direction `up`, counterclockwise as seen from above.
Camera turned_around(Camera camera, const glm::vec3& center, const glm::vec3& up, float angle_deg);

/// Returns the direction towards a light, in world space, from its azimuth and elevation in degrees as seen from the
/// camera: 0, 0 is the direction towards the camera; positive azimuths are to the right.
glm::vec3 light_direction(const Camera& camera, const glm::vec2& light_deg);

/// Returns the lighting of a scene without lights: one white key light from above and to the left of the camera, with a
/// shadow, and ambient light of a sky in the direction `up` and of the ground. The disc of the key light spans 4
/// degrees, so that ray-traced shadows are slightly soft.
Lighting default_lighting(const Camera& camera, const glm::vec3& up);

/// Returns studio lighting, relative to the camera: a large warm key light from above and to the left; a larger, cool
/// fill light from the other side; a rim light from behind and above; all with soft shadows. Ambient light is cool from
/// above, in the direction `up`, and weaker and warm from below.
Lighting studio_lighting(const Camera& camera, const glm::vec3& up);

}  // namespace umbrage
