// Gaussian splats [Kerbl et al. 2023] as opaque discs and spheres.
#include "scene/readers/ply_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "core/lists.h"
#include "scene/fields.h"
#include "scene/readers/vertex_colors.h"

namespace umbrage::ply {
namespace {

constexpr float kHarmonicOfDegree0 = 0.28209479f;  // 1 / (2 sqrt(pi))
constexpr float kMinSplatOpacity = 0.3f;           // more transparent ones would look like a crust over what is behind
constexpr float kFlat = 0.5f;      // max ratio of the shortest axis to the middle one of a Gaussian drawn as a disc
constexpr float kRadius = 1.5f;    // in standard deviations: a third of the peak remains there
constexpr double kQuantile = 0.9;  // radii are bounded by this quantile of all
constexpr float kMaxRatio = 3.0f;  // times this: the Gaussians of a sky would hide the model

/// Returns the axis with this number of a rotation, a unit quaternion.
glm::vec3 axis_of(const glm::vec4& q, int axis) {
  const float w = q.x, x = q.y, y = q.z, z = q.w;
  if (axis == 0) return {1.0f - 2.0f * (y * y + z * z), 2.0f * (x * y + w * z), 2.0f * (x * z - w * y)};
  if (axis == 1) return {2.0f * (x * y - w * z), 1.0f - 2.0f * (x * x + z * z), 2.0f * (y * z + w * x)};
  return {2.0f * (x * z + w * y), 2.0f * (y * z - w * x), 1.0f - 2.0f * (x * x + y * y)};
}

/// What one Gaussian is drawn as.
struct Shape {
  float radius;
  glm::vec3 normal{0.0f};  ///< of a disc; zero: a sphere
};

Shape shape_of(const Splat& splat) {
  int order[3] = {0, 1, 2};
  std::sort(order, order + 3, [&](int a, int b) { return splat.log_scale[a] < splat.log_scale[b]; });
  const glm::vec3 scale(std::exp(splat.log_scale[order[0]]), std::exp(splat.log_scale[order[1]]),
                        std::exp(splat.log_scale[order[2]]));
  const float length = glm::length(splat.rotation);
  if (scale.x <= kFlat * scale.y && length > 0.0f && std::isfinite(length))
    return {kRadius * std::sqrt(scale.y * scale.z), axis_of(splat.rotation / length, order[0])};
  return {kRadius * std::cbrt(scale.x * scale.y * scale.z)};
}

}  // namespace

void draw_splats(const std::vector<Splat>& splats, Scene& scene) {
  const Mesh source = std::move(scene.meshes.at(0));
  Mesh discs, spheres;
  discs.name = source.name;
  spheres.name = source.name;
  discs.fields = spheres.fields = empty_fields(source);
  discs.points = spheres.points = spheres.spheres = true;
  std::vector<float> radii;
  std::size_t transparent = 0;
  for (std::size_t i = 0; i < splats.size(); ++i) {
    const Splat& splat = splats[i];
    if (!(1.0f / (1.0f + std::exp(-splat.opacity)) >= kMinSplatOpacity)) {
      ++transparent;
      continue;
    }
    const Shape shape = shape_of(splat);
    Mesh& mesh = shape.normal == glm::vec3(0.0f) ? spheres : discs;
    mesh.positions.push_back(source.positions[i]);
    mesh.radii.push_back(shape.radius);
    append_vertex_values(source, std::uint32_t(i), mesh);
    mesh.colors.push_back(linear_color(0.5f + kHarmonicOfDegree0 * splat.harmonics));
    if (!mesh.spheres) mesh.normals.push_back(shape.normal);
    if (std::isfinite(shape.radius)) radii.push_back(shape.radius);
  }
  if (!radii.empty()) {
    const float max = kMaxRatio * quantile(std::move(radii), kQuantile);
    for (Mesh* mesh : {&discs, &spheres})
      for (float& radius : mesh->radii) radius = std::min(radius, max);
  }
  scene.meshes.clear();
  for (Mesh* mesh : {&discs, &spheres})
    if (!mesh->positions.empty()) scene.meshes.push_back(std::move(*mesh));
  // Gaussians are trained from pictures, whose y axis points down.
  scene.up = {0.0f, -1.0f, 0.0f};
  scene.warnings.push_back(fmt::format(
      "the file's {} Gaussian splats are drawn as opaque discs and spheres, with -y up{}; colours that change with the "
      "direction of view are not drawn",
      splats.size(), transparent == 0 ? "" : fmt::format(", without {} of low opacity", transparent)));
}

}  // namespace umbrage::ply
