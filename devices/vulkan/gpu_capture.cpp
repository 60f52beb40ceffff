#include "devices/vulkan/gpu_capture.h"

#include <array>
#include <glm/mat3x3.hpp>

#include "core/check.h"
#include "rays/camera_rays.h"
#include "rays/shadow_lights.h"

namespace umbrage {
namespace {

void put(const glm::vec3& v, float* to) {
  for (int c = 0; c < 3; ++c) to[c] = v[c];
}

}  // namespace

CaptureConstants capture_constants(const DeviceScene& scene, const PictureInfo& info, const CaptureSettings& settings,
                                   int stride, bool back) {
  static_assert(kCaptureLights == kMostShadows);
  TracedScene unit;  // what of it places rays
  unit.scene = scene.scene;
  unit.center = scene.center;
  unit.scale = scene.scale;
  const CameraRays rays = camera_rays(unit, info);
  CaptureConstants c{};
  c.width = info.width;
  c.height = info.height;
  c.stride = stride;
  c.root = scene.root;
  c.nothing = scene.empty || !within_reach(rays, info) ? 1 : 0;
  c.back = back ? 1 : 0;
  c.sample_index = settings.sample;
  const glm::mat3 to_view(info.camera.view_from_world);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) c.to_view[3 * row + column] = to_view[column][row];
  put(rays.eye, c.eye);
  put(rays.origin, c.origin);
  put(rays.origin_x, c.origin_x);
  put(rays.origin_y, c.origin_y);
  put(rays.direction, c.direction);
  put(rays.direction_x, c.direction_x);
  put(rays.direction_y, c.direction_y);
  for (const ShadowLight& light : shadow_lights(unit, rays, info, settings)) {
    const int k = c.light_count++;
    c.light_index[k] = light.index;
    c.light_point[k] = light.point ? 1 : 0;
    c.light_rays[k] = light.rays;
    c.light_size[k] = light.size;
    put(light.where, c.light_where + 3 * k);
    put(light.right, c.light_right + 3 * k);
    put(light.up, c.light_up + 3 * k);
  }
  return c;
}

int capture_slot(std::string_view plane) {
  constexpr std::array<std::pair<std::string_view, int>, 14> kSlots = {{{"depth", kDepthSlot},
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
                                                                        {"object_id", kObjectSlot},
                                                                        {"material_id", kMaterialSlot}}};
  for (const auto& [name, slot] : kSlots)
    if (plane == name) return slot;
  for (int light = 0; light < kMostShadows; ++light)
    if (plane == shadow_plane(light)) return kShadowSlot + light;
  fail_check(fmt::format("plane '{}' is captured by nobody", plane));
}

}  // namespace umbrage
