#include "devices/vulkan/gpu_capture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "core/check.h"
#include "core/light_rig.h"
#include "rays/camera_rays.h"
#include "rays/hit_light.h"
#include "rays/shadow_lights.h"

namespace umbrage {
namespace {

void copy_to(const glm::vec3& v, float* to) {
  for (int c = 0; c < 3; ++c) to[c] = v[c];
}

/// Computes the projection of triangles. A point on a ray is origin + x origin_x + y origin_y + t (direction + x
/// direction_x + y direction_y). The projection yields x and y, in perspective multiplied by t, and t.
void set_projection(const TracedScene& unit, const CameraRays& rays, const PictureInfo& info, CaptureConstants& c) {
  constexpr float kNearest = 1e-6f;  // near clipping depth, relative to the farthest depth
  const bool parallel = info.camera.projection == Projection::kOrthographic;
  const glm::dmat3 rows = glm::transpose(
      glm::inverse(glm::dmat3(glm::dvec3(parallel ? rays.origin_x : rays.direction_x),
                              glm::dvec3(parallel ? rays.origin_y : rays.direction_y), glm::dvec3(rays.direction))));
  const glm::dvec3 away = parallel ? glm::dvec3(0.0) : rows[2];
  copy_to(glm::vec3(rows[0] * (2.0 / info.width) - away), c.clip_x);
  copy_to(glm::vec3(rows[1] * (2.0 / info.height) - away), c.clip_y);
  copy_to(glm::vec3(rows[2]), c.clip_w);
  c.orthographic = parallel ? 1 : 0;
  double farthest = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec3& low = unit.scene->bounds_min;
    const glm::vec3& high = unit.scene->bounds_max;
    const glm::vec3 p(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z);
    farthest = std::max(farthest, glm::dot(rows[2], glm::dvec3(unit.unit_of(p) - rays.origin)));
  }
  c.nearest = kNearest * float(farthest);
}

void set_hit_light(const HitLighting& lighting, CaptureConstants& c) {
  static_assert(kCaptureHitLights == kMaxRigLights);
  for (const TracedLight& light : lighting.lights) {
    CaptureHitLight& out = c.hit_lights[c.hit_light_count++];
    out.point = light.point ? 1 : 0;
    out.from_camera = light.from_camera ? 1 : 0;
    out.casts_shadow = light.casts_shadow ? 1 : 0;
    copy_to(light.where, out.where);
    copy_to(light.color, out.color);
    out.reach_squared = light.reach_squared;
  }
  copy_to(lighting.ambient, c.ambient);
  c.even_ambient = lighting.even_ambient ? 1 : 0;
  for (int k = 0; k < 48; ++k)
    c.ambient_shape[k] = lighting.ambient_shape.by_color[std::size_t(k / 16)][k / 4 % 4][k % 4];
}

/// Returns the unit space of a scene: only the members that camera_rays uses.
TracedScene unit_space(const DeviceScene& scene) {
  TracedScene unit;
  unit.scene = scene.scene;
  unit.center = scene.center;
  unit.scale = scene.scale;
  return unit;
}

/// Returns the constants that any rays from the pixels of a picture need. Does not read the host's scene.
CaptureConstants pixel_constants(const DeviceScene& scene, const CameraRays& rays, const PictureInfo& info,
                                 int stride) {
  CaptureConstants c{};
  c.width = info.width;
  c.height = info.height;
  c.stride = stride;
  c.root = scene.root;
  c.min_opacity = c.opaque = kOpaque;
  const glm::mat3 to_view(info.camera.view_from_world);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) c.to_view[3 * row + column] = to_view[column][row];
  c.unit_scale = scene.scale;
  copy_to(rays.eye, c.eye);
  copy_to(rays.origin, c.origin);
  copy_to(rays.origin_x, c.origin_x);
  copy_to(rays.origin_y, c.origin_y);
  copy_to(rays.direction, c.direction);
  copy_to(rays.direction_x, c.direction_x);
  copy_to(rays.direction_y, c.direction_y);
  return c;
}

}  // namespace

CaptureConstants capture_constants(const DeviceScene& scene, const PictureInfo& info, const CaptureSettings& settings,
                                   int stride, bool back) {
  static_assert(kCaptureLights == kMaxShadows);
  const TracedScene unit = unit_space(scene);
  const CameraRays rays = camera_rays(unit, info);
  CaptureConstants c = pixel_constants(scene, rays, info, stride);
  c.nothing_visible = scene.empty || !rays_within_limit(rays, info) ? 1 : 0;
  c.back = back ? 1 : 0;
  c.sample_index = settings.sample;
  c.blended = settings.blended ? 1 : 0;
  if (settings.blended) c.min_opacity = kMinOpacity;
  c.min_shadow_opacity = kMinShadowOpacity;
  c.glass_reflectance = kGlassReflectance;
  set_projection(unit, rays, info, c);
  for (const ShadowLight& light : shadow_lights(unit, rays, info, settings)) {
    const int k = c.light_count++;
    c.light_index[k] = light.index;
    c.light_point[k] = light.point ? 1 : 0;
    c.light_rays[k] = light.rays;
    c.light_size[k] = light.size;
    copy_to(light.where, c.light_where + 3 * k);
    copy_to(light.right, c.light_right + 3 * k);
    copy_to(light.up, c.light_up + 3 * k);
  }
  return c;
}

CaptureConstants ray_constants(const DeviceScene& scene, const PictureInfo& info, const RaySettings& settings, int ray,
                               int stride) {
  static_assert(int(Falloff::kNone) == kNoFalloff && int(Falloff::kLinear) == kLinearFalloff &&
                int(Falloff::kSmooth) == kSmoothFalloff);
  const TracedScene unit = unit_space(scene);
  CaptureConstants c = pixel_constants(scene, camera_rays(unit, info), info, stride);
  c.ray = ray;
  c.last_ray = settings.max_rays - 1;
  c.ray_length = settings.radius * scene.scale;
  c.falloff = int(settings.falloff);
  if (settings.light > 0.0f) set_hit_light(hit_lighting(unit, info, settings.ambient_bounce, c.ray_length), c);
  c.light = settings.light;
  c.directional = settings.directional;
  std::copy(settings.sky.begin(), settings.sky.end(), c.sky);
  c.seed = int(settings.seed);
  return c;
}

bool can_draw(const DeviceScene& scene, const CaptureConstants& c, const Gpu& gpu) {
  if (scene.empty || c.nothing_visible || std::max(c.width, c.height) > gpu.max_drawn_side) return false;
  // Triangles cannot be drawn either if everything is behind the camera or all rays lie in one plane.
  const auto finite = [](const float(&row)[3]) {
    return std::all_of(row, row + 3, [](float v) { return std::isfinite(v); });
  };
  return c.nearest > 0.0f && std::isfinite(c.nearest) && finite(c.clip_x) && finite(c.clip_y) && finite(c.clip_w);
}

int capture_slot(std::string_view plane) {
  constexpr std::pair<std::string_view, int> kSlots[] = {
      {"depth", kDepthSlot},
      {"normal.x", kNormalSlot},
      {"normal.y", kNormalSlot + 1},
      {"normal.z", kNormalSlot + 2},
      {"albedo.r", kAlbedoSlot},
      {"albedo.g", kAlbedoSlot + 1},
      {"albedo.b", kAlbedoSlot + 2},
      {"specular", kSpecularSlot},
      {"shininess", kShininessSlot},
      {"emission.r", kEmissionSlot},
      {"emission.g", kEmissionSlot + 1},
      {"emission.b", kEmissionSlot + 2},
      {"metallic", kMetallicSlot},
      {"roughness", kRoughnessSlot},
      {"material_ao", kMaterialAoSlot},
      {"object_id", kObjectSlot},
      {"material_id", kMaterialSlot},
      {"opacity", kOpacitySlot},
      {"transmittance.r", kTransmittanceSlot},
      {"transmittance.g", kTransmittanceSlot + 1},
      {"transmittance.b", kTransmittanceSlot + 2},
      {"ray_offset.x", kRayOffsetSlot},
      {"ray_offset.y", kRayOffsetSlot + 1},
      {"ray_offset.z", kRayOffsetSlot + 2},
  };
  for (const auto& [name, slot] : kSlots)
    if (plane == name) return slot;
  for (int light = 0; light < kMaxShadows; ++light)
    if (plane == shadow_plane(light)) return kShadowSlot + light;
  fail_check(fmt::format("plane '{}' cannot be captured", plane));
}

}  // namespace umbrage
