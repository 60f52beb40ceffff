#include "scene/ground.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <limits>

namespace umbrage {
namespace {

/// Two directions that span the plan.
struct Plan {
  glm::vec3 up, right, front;
};

Plan plan_of(const Scene& scene) {
  const glm::vec3 up = glm::normalize(scene.up);
  const glm::vec3 other = std::fabs(up.x) < 0.9f ? glm::vec3(1, 0, 0) : glm::vec3(0, 0, 1);
  const glm::vec3 right = glm::normalize(glm::cross(other, up));
  return {up, right, glm::cross(up, right)};
}

/// The extent of the model in the plan's directions.
struct Extent {
  glm::vec3 least{std::numeric_limits<float>::infinity()}, most{-std::numeric_limits<float>::infinity()};
};

Extent extent_of(const Scene& scene, const Plan& plan) {
  Extent extent;
  for (const Mesh& mesh : scene.meshes)
    for (const glm::vec3& p : mesh.positions) {
      const glm::vec3 q(glm::dot(p, plan.right), glm::dot(p, plan.up), glm::dot(p, plan.front));
      extent.least = glm::min(extent.least, q);
      extent.most = glm::max(extent.most, q);
    }
  return extent;
}

}  // namespace

bool lacks_ground(const Scene& scene) {
  constexpr float kFlat = 0.25f;  // height over width of what is a landscape, and how much of its plan it fills
  constexpr float kFilled = 0.95f;
  constexpr float kLow = 0.12f;        // share of the width within which a slab's top lies over the bottom
  constexpr float kLevel = 0.9f;       // cosine of a slope that one stands on
  constexpr float kMostOfPlan = 0.4f;  // a round slab fills 0.79 of its square, less what stands on it
  if (scene.meshes.empty()) return false;
  const Plan plan = plan_of(scene);
  const Extent extent = extent_of(scene, plan);
  const glm::vec3 size = extent.most - extent.least;
  const float width = std::max(size.x, size.z);
  if (!(width > 0.0f) || !std::isfinite(width)) return false;
  double upward = 0.0, low = 0.0;
  for (const Mesh& mesh : scene.meshes) {
    // Discs overlap: each stands for about the square of its radius.
    for (std::size_t i = 0; i < mesh.radii.size(); ++i) {
      const float cosine = mesh.spheres ? 1.0f : std::fabs(glm::dot(mesh.normals[i], plan.up));
      const double seen = double(mesh.radii[i]) * mesh.radii[i] * cosine;
      upward += seen;
      const float height = glm::dot(mesh.positions[i], plan.up) - extent.least.y;
      if (height < kLow * width && cosine > kLevel) low += seen;
    }
    for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
      const glm::vec3 a = mesh.positions[mesh.indices[k]], b = mesh.positions[mesh.indices[k + 1]],
                      c = mesh.positions[mesh.indices[k + 2]];
      const glm::vec3 twice = glm::cross(b - a, c - a);  // twice the area, along the normal
      const float area = glm::length(twice);
      if (!(area > 0.0f)) continue;
      const float cosine = glm::dot(twice, plan.up) / area;
      const glm::vec3 n = mesh.normals.empty() ? twice : mesh.normals[mesh.indices[k]];
      if (glm::dot(n, plan.up) <= 0.0f) continue;
      const double seen = 0.5 * area * std::fabs(cosine);
      upward += seen;
      const float height = glm::dot(a + b + c, plan.up) / 3.0f - extent.least.y;
      if (height < kLow * width && std::fabs(cosine) > kLevel) low += seen;
    }
  }
  const double filled = double(size.x) * size.z;
  const bool landscape = size.y < kFlat * width && upward > kFilled * filled;
  return !landscape && low <= kMostOfPlan * filled;
}

void add_ground(Scene& scene) {
  constexpr int kCorners = 96;
  constexpr float kWide = 3.0f;    // radii of the model: its shadow ends before
  constexpr float kBelow = 1e-4f;  // of the radius: faces that lie on the ground stay in front of it
  const Plan plan = plan_of(scene);
  const Extent extent = extent_of(scene, plan);
  const float radius = scene.radius();
  const float height = extent.least.y - kBelow * radius;
  const glm::vec3 middle = scene.center() + plan.up * (height - glm::dot(scene.center(), plan.up));
  Mesh disc;
  disc.name = "ground";
  disc.positions.push_back(middle);
  for (int k = 0; k < kCorners; ++k) {
    const float angle = 2.0f * glm::pi<float>() * float(k) / kCorners;
    disc.positions.push_back(middle + kWide * radius * (std::cos(angle) * plan.right + std::sin(angle) * plan.front));
    const auto next = std::uint32_t(k + 1 == kCorners ? 1 : k + 2);
    disc.indices.insert(disc.indices.end(), {0u, next, std::uint32_t(k + 1)});
  }
  disc.normals.assign(disc.positions.size(), plan.up);
  disc.material = int(scene.materials.size());
  for (const Mesh& mesh : scene.meshes) disc.object = std::max(disc.object, mesh.object + 1);
  scene.ground_object = disc.object;
  Material white;
  white.name = "ground";
  white.albedo = glm::vec3(1.0f);
  scene.materials.push_back(std::move(white));
  scene.meshes.push_back(std::move(disc));
}

}  // namespace umbrage
