#include "devices/shared/capture_info.h"

#include <algorithm>
#include <glm/mat3x3.hpp>
#include <limits>

#include "core/lists.h"
#include "kernels/soften.h"
#include "kernels/soften_reach.h"
#include "rays/extra_cameras.h"
#include "rays/shadow_lights.h"

namespace umbrage {
namespace {

bool has_occlusion_map(const Material& material) {
  return material.surface_texture != kNoTexture && material.occlusion_strength > 0.0f;
}

}  // namespace

PictureInfo picture_info(const Scene& scene, const Camera& camera, const CaptureSettings& settings) {
  PictureInfo info = with_guard({.width = settings.width, .height = settings.height, .camera = camera}, settings.guard);
  const Lighting lighting = settings.lighting ? *settings.lighting : lighting_of(scene);
  info.ambient = lighting.ambient;
  info.scene_radius = scene.radius();
  info.ground_object = scene.ground_object;
  info.ground_center = glm::vec3(camera.view_from_world * glm::vec4(scene.ground_center, 1.0f));
  info.ground_fade_distance = scene.ground_fade_distance;
  float nearest = std::numeric_limits<float>::infinity(), farthest = 0.0f;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec3 p(corner & 1 ? scene.bounds_max.x : scene.bounds_min.x,
                      corner & 2 ? scene.bounds_max.y : scene.bounds_min.y,
                      corner & 4 ? scene.bounds_max.z : scene.bounds_min.z);
    const float depth = -(camera.view_from_world * glm::vec4(p, 1.0f)).z;
    nearest = std::min(nearest, depth);
    farthest = std::max(farthest, depth);
  }
  constexpr float kMinNearToFarthest = 1e-3f;  // for a camera inside the scene
  info.depth_max = farthest > 0.0f ? farthest : 1.0f;
  info.depth_min = std::clamp(nearest, kMinNearToFarthest * info.depth_max, info.depth_max);
  const glm::mat3 rotation(camera.view_from_world);
  info.ambient_shape = turned(lighting.ambient_shape, rotation);
  info.reflections = lighting.reflections;
  info.has_roughness = has_roughness(scene);
  info.has_material_ao = std::any_of(scene.materials.begin(), scene.materials.end(), has_occlusion_map);
  info.lit_white_luminance = lighting.lit_white_luminance;
  for (Light light : lighting.lights) {
    light.direction = rotation * light.direction;
    light.position = glm::vec3(camera.view_from_world * glm::vec4(light.position, 1.0f));
    info.lights.push_back(light);
  }
  return info;
}

void add_layers(const TracedScene& traced, const CaptureSettings& settings, PictureInfo& info) {
  for (int layer = 1; layer < settings.layers; ++layer) info.more_layers.push_back({LayerKind::kBehind, layer - 1, {}});
  for (int layer = 0; settings.back_sides && layer < settings.layers; ++layer)
    info.more_layers.push_back({LayerKind::kBack, layer, {}});
  if (settings.extra_views == 0) return;  // `traced` is not needed
  for (const Camera& camera : extra_cameras(traced, info, settings.extra_views))
    info.more_layers.push_back({LayerKind::kOther, 0, camera});
}

std::vector<std::string> captured_planes(const Scene& scene, const PictureInfo& info, const CaptureSettings& settings) {
  std::vector<std::string> planes = {"depth", "normal.x", "normal.y", "normal.z"};
  const auto add = [&](const char* name) {
    const auto& requested = settings.planes;
    if (!requested || contains(*requested, name)) planes.emplace_back(name);
  };
  for (const char* name : {"albedo.r", "albedo.g", "albedo.b", "specular", "shininess"}) add(name);
  planes.emplace_back("shadow");
  for (const char* name : {"object_id", "material_id"}) add(name);
  for (int k = 1; k < std::min({int(info.lights.size()), settings.shadows, kMaxShadows}); ++k)
    if (casts_visible_shadow(info.lights[k])) planes.push_back(shadow_plane(k));
  const bool emits = std::any_of(scene.materials.begin(), scene.materials.end(),
                                 [](const Material& material) { return material.emission != glm::vec3(0.0f); });
  if (emits)
    for (const char* name : {"emission.r", "emission.g", "emission.b"}) add(name);
  if (info.has_roughness)
    for (const char* name : {"metallic", "roughness"}) add(name);
  if (info.has_material_ao) add("material_ao");
  if (settings.blended)
    planes.insert(planes.end(), {"opacity", "transmittance.r", "transmittance.g", "transmittance.b"});
  if (settings.ray_offsets) planes.insert(planes.end(), {"ray_offset.x", "ray_offset.y", "ray_offset.z"});
  return planes;
}

std::vector<int> softened_lights(const PictureInfo& info, const CaptureSettings& settings) {
  std::vector<int> soft;
  if (settings.shadow_rays > 0)
    for (int k = 0; k < std::min({int(info.lights.size()), settings.shadows, kMaxShadows}); ++k)
      if (casts_visible_shadow(info.lights[k]) && light_size(info.lights[k]) > 0.0f) soft.push_back(k);
  return soft;
}

const Dispatch& soften_reach_dispatch() {
  static const Dispatch dispatch = {
      .name = "soften reach", .inputs = {"penumbra"}, .outputs = {"soften_reach"}, .kernel = soften_reach_kernel()};
  return dispatch;
}

const Dispatch& soften_dispatch() {
  static const Dispatch dispatch = {
      .name = "soften",
      .inputs = {"depth", "normal.x", "normal.y", "normal.z", "soften_from", "soften_reach"},
      .outputs = {"soften_to"},
      .kernel = soften_kernel()};
  return dispatch;
}

}  // namespace umbrage
