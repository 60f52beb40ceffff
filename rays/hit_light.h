// Hit light: the light that the surfaces which rays hit send back along the rays.
#pragma once
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "core/light.h"
#include "rays/ray_packet.h"
#include "rays/traced_lights.h"

namespace umbrage {

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
