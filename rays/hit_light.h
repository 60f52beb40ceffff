// Traced lights: the lights of a picture in unit space (rays/traced_scene.h), and the samples of a light that rays
// test. Hit light: the light that the surfaces which rays hit send back along the rays.
#pragma once
#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "core/light.h"
#include "rays/camera_rays.h"
#include "rays/ray_packet.h"
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

/// Return albedo and emission of a surface that is not directly visible, from its finest texels.
glm::vec3 unfiltered_albedo(const TracedScene& traced, const Surface& surface);
glm::vec3 unfiltered_emission(const TracedScene& traced, const Surface& surface);

/// What lights the surfaces that rays hit: the lights as points, with the shadows that a capture contains, and ambient
/// light.
struct HitLighting {
  CameraRays rays;
  std::vector<TracedLight> lights;
  glm::mat3 view_from_world{1.0f};
  glm::vec3 ambient{0.0f};     ///< mean over all normals
  AmbientShape ambient_shape;  ///< in view space; not read if `even_ambient`
  bool even_ambient = true;
  float reach = 0.0f;         ///< distance within which surfaces block ambient light, unit space
  float max_emission = 0.0f;  ///< max channel of emission; more is scaled down: few rays find a small emitter
};

/// Returns the lighting of a picture, with its ambient light times `ambient`.
HitLighting hit_lighting(const TracedScene& traced, const PictureInfo& info, float ambient, float reach);

using PacketLight = std::array<glm::vec3, kPacket>;

/// Returns the radiance along each ray of a packet after find_hits: emission, and diffuse reflection of lights and of
/// ambient light. 0 for a ray without a hit. Of the lights that cast shadows and the ambient light, one is chosen at
/// random for each hit, by its brightness without shadow, and one ray tests whether it arrives; for ambient light the
/// ray has a cosine-weighted direction. `seeds` selects choices and directions. The mean over all seeds is the light of
/// all of them, and no value exceeds the light without any shadow by more than the sum of its channels.
PacketLight light_of_hits(const TracedScene& traced, const HitLighting& lighting, const RayPacket& hits,
                          const std::array<std::uint32_t, kPacket>& seeds);

}  // namespace umbrage
