#include "rays/hit_light.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <limits>

#include "core/hash.h"
#include "core/light_rig.h"
#include "rays/directions.h"

namespace umbrage {
namespace {

/// Returns the finest texels of a texture at a surface; white if there is no texture.
glm::vec3 unfiltered_texel(const TracedScene& traced, const Surface& surface, int texture) {
  if (texture == kNoTexture || surface.mesh->uvs.empty()) return glm::vec3(1.0f);
  const glm::vec2 uv = uv_at(*surface.mesh, surface.triangle, surface.u, surface.v);
  return glm::vec3(sample_filtered(traced.textures[texture], uv, glm::vec2(0.0f), glm::vec2(0.0f)));
}

/// Light that a ray must test.
struct Candidate {
  int light = 0;  ///< index into HitLighting::lights, or kAmbient
  LightSample sample{};
  glm::vec3 reflected{0.0f};  ///< by the surface, without a shadow
};

constexpr int kAmbient = -1;

float brightness(glm::vec3 color) { return color.r + color.g + color.b; }

/// Returns the ambient light that a white surface with this normal reflects.
glm::vec3 ambient_at(const HitLighting& lighting, glm::vec3 normal) {
  if (lighting.even_ambient) return lighting.ambient;
  return glm::max(lighting.ambient + lighting.ambient_shape.at(lighting.view_from_world * normal), glm::vec3(0.0f));
}

/// The light of one hit: that which needs no test, and one candidate, with its brightness raised to that of all.
struct ChosenLight {
  glm::vec3 certain{0.0f};
  Candidate candidate;
};

/// Chooses a candidate for a surface with the random number `choice`, in (0, 1).
ChosenLight choose_light(const TracedScene& traced, const HitLighting& lighting, const Surface& surface, float choice) {
  const glm::vec3 emission = unfiltered_emission(traced, surface);
  const float peak = std::max({emission.r, emission.g, emission.b, lighting.max_emission});
  ChosenLight chosen{.certain = emission * (lighting.max_emission / peak), .candidate = {}};
  const glm::vec3 albedo = unfiltered_albedo(traced, surface);
  std::array<Candidate, kMaxShadows + 1> candidates;
  int count = 0;
  for (std::size_t l = 0; l < lighting.lights.size(); ++l) {
    const LightSample sample = sample_light(lighting.lights[l], lighting.rays, surface.position, glm::vec2(0.5f));
    const float lambert = glm::dot(surface.normal, sample.direction);
    if (!(lambert > 0.0f)) continue;
    const glm::vec3 reflected = albedo * sample.color * lambert;
    if (!lighting.lights[l].casts_shadow)
      chosen.certain += reflected;
    else
      candidates[count++] = {int(l), sample, reflected};
  }
  candidates[count++] = {kAmbient, {}, albedo * ambient_at(lighting, surface.normal)};
  float sum = 0.0f;
  for (int k = 0; k < count; ++k) sum += brightness(candidates[k].reflected);
  float rest = choice * sum;
  for (int k = 0; k < count && rest >= 0.0f; ++k) {
    const float of_light = brightness(candidates[k].reflected);
    if (!(of_light > 0.0f)) continue;
    // Rounding may leave a rest behind the last one, which is then chosen.
    chosen.candidate = candidates[k];
    chosen.candidate.reflected *= sum / of_light;
    rest -= of_light;
  }
  return chosen;
}

}  // namespace

glm::vec3 unfiltered_albedo(const TracedScene& traced, const Surface& surface) {
  return surface.material->albedo * mesh_color(surface) * unfiltered_texel(traced, surface, surface.material->texture);
}

glm::vec3 unfiltered_emission(const TracedScene& traced, const Surface& surface) {
  return surface.material->emission * unfiltered_texel(traced, surface, surface.material->emission_texture);
}

HitLighting hit_lighting(const TracedScene& traced, const PictureInfo& info, float ambient, float reach) {
  HitLighting lighting{.rays = camera_rays(traced, info), .reach = reach};
  lighting.lights = traced_lights(traced, lighting.rays, info, {.captured_shadows = true});
  if (lighting.lights.size() > std::size_t(kMaxRigLights)) lighting.lights.resize(kMaxRigLights);
  constexpr float kMaxEmission = 4.0f;  // relative to a white surface in the brightest light
  float white = info.lit_white_luminance;
  for (const TracedLight& light : lighting.lights)
    white = std::max({white, light.color.r, light.color.g, light.color.b});
  lighting.max_emission = kMaxEmission * white;
  lighting.view_from_world = glm::transpose(lighting.rays.world_from_view);
  lighting.ambient = info.ambient * ambient;
  lighting.even_ambient = info.ambient_shape.even();
  lighting.ambient_shape = info.ambient_shape;
  for (glm::mat4& of_color : lighting.ambient_shape.by_color) of_color *= ambient;
  return lighting;
}

PacketLight light_of_hits(const TracedScene& traced, const HitLighting& lighting, const RayPacket& hits,
                          const std::array<std::uint32_t, kPacket>& seeds) {
  PacketLight light{};
  PacketLight reflected{};
  RayPacket to_light;
  for (int k = 0; k < kPacket; ++k) {
    if (!hits.hit(k)) continue;
    const Surface surface = hits.surface(traced, k);
    const ChosenLight chosen = choose_light(traced, lighting, surface, unit_real(hash(seeds[k], 1u)));
    light[k] = chosen.certain;
    reflected[k] = chosen.candidate.reflected;
    if (!(brightness(reflected[k]) > 0.0f)) continue;
    if (chosen.candidate.light == kAmbient) {
      const glm::vec2 sample(unit_real(hash(seeds[k], 2u)), unit_real(hash(seeds[k], 3u)));
      const glm::vec3 direction = basis_around(surface.normal) * cosine_direction(sample);
      if (glm::dot(direction, surface.geometric) > 0.0f)
        to_light.set(k, ray_origin_above(traced, surface, hits.origin(k)), direction, 0.0f, lighting.reach);
    } else {
      to_light.set(k, ray_origin_to_light(traced, surface, hits.origin(k)), chosen.candidate.sample.direction, 0.0f,
                   chosen.candidate.sample.distance);
    }
  }
  to_light.find_blocked(traced, Coherence::kIncoherent);
  for (int k = 0; k < kPacket; ++k)
    if (to_light.arrives(k)) light[k] += reflected[k];
  return light;
}

std::vector<TracedLight> traced_lights(const TracedScene& traced, const CameraRays& rays, const PictureInfo& info,
                                       const TracedLightSettings& settings) {
  std::vector<TracedLight> lights;
  for (const Light& light : info.lights) {
    TracedLight out{.color = light.color};
    const bool head = light.kind == LightKind::kHead, points = settings.captured_shadows;
    if (points) out.casts_shadow = light.casts_shadow && !head && int(lights.size()) < kMaxShadows;
    out.point = light.kind == LightKind::kPoint || (head && info.camera.projection == Projection::kPerspective);
    if (head) {
      out.where = out.point ? rays.eye : rays.world_from_view[2];
      out.from_camera = !out.point;
    } else if (out.point) {
      out.where = rays.eye + rays.world_from_view * (light.position * traced.scale);
      out.reach_squared = light.reach * light.reach * traced.scale * traced.scale;
      out.min_squared = light.radius * light.radius * traced.scale * traced.scale;
      out.radius = points ? 0.0f : light.radius * traced.scale;
    } else {
      out.where = glm::normalize(rays.world_from_view * light.direction);
      const float light_deg = settings.sun_angle_deg > 0.0f ? settings.sun_angle_deg : light.angle_deg;
      const float angle_deg = points ? 0.0f : light_deg;
      const float sine = std::sin(glm::radians(0.25f * angle_deg));
      out.cone_height = 2.0f * sine * sine;
    }
    lights.push_back(out);
  }
  return lights;
}

namespace {

/// Returns the factor that makes a white surface that faces the cone's axis as bright as under a point light of the
/// same colour: 1 over the mean cosine of the cone's directions to its axis.
float cone_gain(float cone_height) { return 1.0f / (1.0f - 0.5f * cone_height); }

}  // namespace

LightSample sample_light(const TracedLight& light, const CameraRays& rays, glm::vec3 from, glm::vec2 sample) {
  if (!light.point) {
    const glm::vec3 direction = basis_around(light.where) * cone_direction(sample, light.cone_height);
    const float distance =
        light.from_camera ? glm::dot(rays.eye - from, light.where) : std::numeric_limits<float>::infinity();
    return {direction, distance, light.color * cone_gain(light.cone_height)};
  }
  const glm::vec3 to_center = light.where - from;
  const float squared = std::max(glm::dot(to_center, to_center), 1e-20f), distance = std::sqrt(squared);
  const glm::vec3 toward = to_center / distance;
  // The falloff is clamped at the sphere's surface: points inside a light would be fireflies.
  const float falloff_squared = std::max(squared, light.min_squared);
  const glm::vec3 color =
      light.reach_squared > 0.0f ? light.color * (light.reach_squared / falloff_squared) : light.color;
  if (!(light.radius > 0.0f)) return {toward, distance, color};
  // Seen from outside, the sphere fills a cone; from inside, a hemisphere is used.
  const float sine_squared = std::min(1.0f, light.radius * light.radius / squared);
  const float cone_height = sine_squared / (1.0f + std::sqrt(1.0f - sine_squared));
  const glm::vec3 local = cone_direction(sample, cone_height);
  const float to_sphere = distance * local.z -
                          std::sqrt(std::max(0.0f, light.radius * light.radius - squared * (1.0f - local.z * local.z)));
  return {basis_around(toward) * local, std::max(to_sphere, 0.0f), color * cone_gain(cone_height)};
}

}  // namespace umbrage
