#include "core/light_rig.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

namespace umbrage {

LightRig light_rig(Rig rig, const PictureInfo& info) {
  LightRig out{.lights = {}, .ambient = info.ambient, .ambient_shape = info.ambient_shape};
  std::vector<Light> lights = info.lights;
  if (rig != Rig::kScene) {
    // The light of [Chamberlin 2011]: ambient 0.3 and diffuse 0.7, so that white facing the camera is white.
    constexpr float kAmbient = 0.3f, kLight = 0.7f;
    const glm::vec3 above_left = glm::normalize(glm::vec3(-0.45f, 0.65f, 0.62f));
    const LightKind kind = rig == Rig::kHead ? LightKind::kHead : LightKind::kDirectional;
    lights.assign(1, Light{.kind = kind, .direction = above_left, .color = glm::vec3(kLight)});
    out.ambient = glm::vec3(kAmbient);
    out.ambient_shape = {};
    out.shadows = false;
  }
  for (int k = 0; k < std::min(int(lights.size()), kMaxRigLights); ++k) {
    const Light& light = lights[k];
    // A head light is parallel along the view axis for an orthographic camera and a point at the camera otherwise.
    const bool head = light.kind == LightKind::kHead;
    const bool point = light.kind == LightKind::kPoint || (head && info.camera.projection == Projection::kPerspective);
    glm::vec3 where = point ? light.position : light.direction;
    if (head) where = point ? glm::vec3(0.0f) : glm::vec3(0.0f, 0.0f, 1.0f);
    // Both rigs and head lights are fixed to the first camera, for every layer.
    if (head && point)
      where = glm::vec3(info.view_from_first[3]);
    else if (head || rig == Rig::kKey)
      where = glm::mat3(info.view_from_first) * where;
    const float size = point ? light.radius : std::sin(glm::radians(0.5f * light.angle_deg));
    out.lights.push_back({point, where, light.color, head ? 0.0f : size, head ? 0.0f : light.reach * light.reach});
  }
  return out;
}

}  // namespace umbrage
