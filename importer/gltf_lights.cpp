// Lights of glTF files [KHR_lights_punctual].
#include "importer/gltf_parts.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace umbrage {
namespace {

constexpr float kSunAngleDeg = 0.53f;
constexpr float kLampFraction = 0.02f;  ///< radius of lamps, as a fraction of the scene's: their shadows are soft
constexpr float kMinDistance = 0.25f;   ///< of a lamp from the centre for its brightness there, as such a fraction
constexpr float kBrightness = 1.6f;     ///< sum of the irradiances at the centre

struct PlacedLight {
  Light light;
  float irradiance = 0.0f;  ///< at the centre of the scene
};

struct Sphere {
  glm::vec3 center{0.0f};
  float radius = 1.0f;
};

Sphere bounds_of(const Scene& scene) {
  glm::vec3 low(std::numeric_limits<float>::max()), high(std::numeric_limits<float>::lowest());
  for (const Mesh& mesh : scene.meshes)
    for (const glm::vec3& p : mesh.positions) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
  if (!(low.x <= high.x)) return {};
  return {0.5f * (low + high), std::max(0.5f * glm::distance(low, high), 1e-20f)};
}

PlacedLight light_of(GltfFile& file, std::size_t index, const Json& json, const glm::dmat4& world, const Scene& scene,
                     const Sphere& bounds) {
  constexpr double kMaxIntensity = 1e20;
  const JsonPlace place{"lights", index};
  const float intensity = float(number_in(json, "intensity", 1.0, 0.0, kMaxIntensity, place, file.faults));
  const glm::vec3 color = intensity * color_in(json, "color", 1.0, 1e6, place, file.faults);
  const std::string type = text_of(member(json, "type"));
  PlacedLight placed;
  Light& light = placed.light;
  light.casts_shadow = true;
  float falloff = 1.0f;
  if (type == "directional") {
    const glm::dvec3 axis(world[2]);  // the light shines along -z
    light.direction = glm::length(axis) > 0.0 ? glm::vec3(glm::normalize(axis)) : glm::vec3(0, 1, 0);
    light.angle_deg = kSunAngleDeg;
    light.color = color;
  } else {
    if (type == "spot")
      file.warn_once("spot", "the file's spot lights shine in all directions: their cones are not drawn");
    else if (type != "point")
      file.faults.add(place, "type");
    light.kind = LightKind::kPoint;
    light.position = glm::vec3(glm::dvec3(world[3]) - scene.origin);
    light.reach = bounds.radius;
    light.radius = kLampFraction * bounds.radius;
    light.color = color / (bounds.radius * bounds.radius);
    const float distance = std::max(glm::distance(light.position, bounds.center), kMinDistance * bounds.radius);
    falloff = bounds.radius * bounds.radius / (distance * distance);
  }
  placed.irradiance = falloff * std::max({light.color.x, light.color.y, light.color.z});
  return placed;
}

}  // namespace

void add_gltf_lights(GltfFile& file, const std::vector<int>& nodes, const std::vector<glm::dmat4>& world,
                     Scene& scene) {
  constexpr const char* kName = "KHR_lights_punctual";
  const Json& list = member(extension_of(file.json, kName), "lights");
  const Sphere bounds = bounds_of(scene);
  std::vector<PlacedLight> lights;
  float sum = 0.0f;
  for (const int node : nodes) {
    const int index = index_of(member(extension_of(file.list("nodes", std::size_t(node)), kName), "light"));
    if (index < 0 || std::size_t(index) >= count_of(list)) continue;
    lights.push_back(
        light_of(file, std::size_t(index), list[std::size_t(index)], world[std::size_t(node)], scene, bounds));
    sum += lights.back().irradiance;
  }
  std::stable_sort(lights.begin(), lights.end(),
                   [](const PlacedLight& a, const PlacedLight& b) { return a.irradiance > b.irradiance; });
  if (lights.size() > std::size_t(kMaxShadows)) {
    file.warn_once("many lights",
                   fmt::format("the {} brightest of the file's {} lights are used", kMaxShadows, lights.size()));
    lights.resize(std::size_t(kMaxShadows));
  }
  if (!(sum > 0.0f) || !(sum < std::numeric_limits<float>::max())) {
    file.warn_once("no lights", "the file has no light in the scene that is drawn; the look's own are used");
    return;
  }
  for (PlacedLight& each : lights) {
    each.light.color *= kBrightness / sum;
    scene.lights.push_back(each.light);
  }
}

}  // namespace umbrage
