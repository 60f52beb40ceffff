// Light rig: the lights of a picture as kernels read them, and the rigs that can replace those of the scene.
#pragma once
#include <vector>

#include "core/gbuffer.h"

namespace umbrage {

/// Values of the parameter `rig` of effects with lights, in the order of its choices.
enum class Rig {
  kScene,  ///< the scene's lights
  kHead,   ///< one white light at the camera, without shadow
  kKey,    ///< one white parallel light from above and to the left of the camera, without shadow
};

/// One light, in view space.
struct RigLight {
  bool point = false;  ///< a point light at `where`; otherwise `where` is the unit direction towards the light
  glm::vec3 where{0.0f};
  glm::vec3 color{1.0f};
  float size = 0.0f;           ///< sine of the angular radius; of a point light the radius of its sphere, scene units
  float reach_squared = 0.0f;  ///< (point) square of the distance at which the irradiance is `color`; 0: no falloff
};

struct LightRig {
  std::vector<RigLight> lights;  ///< the key light first; at most kMaxRigLights
  glm::vec3 ambient{0.0f};
  AmbientShape ambient_shape;
  bool shadows = true;  ///< whether the captured shadows are those of these lights
};

/// Max lights that are used; further ones are ignored.
inline constexpr int kMaxRigLights = 16;

LightRig light_rig(Rig rig, const PictureInfo& info);

/// Stores light k in constants with arrays for kind (1 for a point) and x, y, z.
template <class Constants>
void set_place(const RigLight& light, int k, Constants& c) {
  c.kind[k] = light.point ? 1 : 0;
  c.x[k] = light.where.x;
  c.y[k] = light.where.y;
  c.z[k] = light.where.z;
}

}  // namespace umbrage
