// Traced lights: the lights of a picture in unit space (rays/traced_scene.h), and the samples of a light that rays
// test.
#pragma once
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "rays/camera_rays.h"
#include "rays/traced_scene.h"

namespace umbrage {

/// A light in unit space.
struct TracedLight {
  bool point = false;
  bool from_camera = false;  ///< directional light that starts at the plane of the camera
  glm::vec3 where{0.0f};     ///< unit direction to the light, or position of its centre
  glm::vec3 color{0.0f};
  float reach_squared = 0.0f;  ///< 0: no distance falloff
  float min_squared = 0.0f;    ///< squared distance below which the falloff ends: at the sphere's surface
  float radius = 0.0f;         ///< radius of a spherical light; 0: it is traced as a point
  float cone_height = 0.0f;    ///< 1 minus the cosine of the half angle of a directional light
  bool casts_shadow = true;
};

/// How the lights of a picture are traced.
struct TracedLightSettings {
  /// Lights have no size, and a light casts a shadow only if a capture contains a `shadow` plane for it.
  bool captured_shadows = false;
  float sun_angle_deg = 0.0f;  ///< angular diameter of directional lights; 0: each light's own
};

/// Returns the lights of a picture, in their order.
std::vector<TracedLight> traced_lights(const TracedScene& traced, const CameraRays& rays, const PictureInfo& info,
                                       const TracedLightSettings& settings);

/// One sample of a light, for one surface point: unit direction and distance to the light, and the radiance of a white
/// surface that faces this direction.
struct LightSample {
  glm::vec3 direction;
  float distance;
  glm::vec3 color;
};

/// Returns the sample of a light, seen from the point `from`, for a point of the unit square. A light without a size
/// has one sample.
LightSample sample_light(const TracedLight& light, const CameraRays& rays, glm::vec3 from, glm::vec2 sample);

/// Returns the length of the shadow ray to a light. 0 for a light without shadows: a ray of length 0 hits nothing.
inline float ray_length(const TracedLight& light, float distance) { return light.casts_shadow ? distance : 0.0f; }

}  // namespace umbrage
