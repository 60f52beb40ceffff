#include "renderer/turntable.h"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat3x3.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vector_relational.hpp>

#include "renderer/hdri.h"

namespace umbrage {

Turntable::Turntable(const Scene& scene, const DrawSettings& settings)
    : framing_(settings.framing), rotation_deg_(settings.hdri.rotation_deg), has_lights_(!scene.lights.empty()) {
  const glm::vec3 eye = frame_scene(scene, framing_, settings.width, settings.height).eye();
  lit_inside_ = glm::all(glm::greaterThan(eye, scene.bounds_min)) && glm::all(glm::lessThan(eye, scene.bounds_max));
}

void Turntable::turn_to(float angle_deg, Scene& scene, DrawSettings& settings) {
  settings.stops = &stops_;
  settings.framing.turn_deg = framing_.turn_deg + angle_deg;
  settings.hdri.rotation_deg = rotation_deg_ + angle_deg;
  if (angle_deg == 0.0f) return;
  if (settings.hdri.lights()) {
    light_by(settings.hdri, scene);
    return;
  }
  if (has_lights_ || lit_inside_) return;
  if (lights_.empty()) lights_ = scene.lights;
  const glm::mat3 turn(glm::rotate(glm::mat4(1.0f), glm::radians(angle_deg), glm::normalize(scene.up)));
  const glm::vec3 center = turn_center(scene, framing_);
  scene.lights = lights_;
  for (Light& light : scene.lights) {
    light.direction = glm::normalize(turn * light.direction);
    light.position = center + turn * (light.position - center);
  }
}

}  // namespace umbrage
