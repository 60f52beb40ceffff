// Ground: detection of a scene's own ground on a grid seen from above, and the disc below models without ground.
#include "scene/ground.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <vector>

namespace umbrage {
namespace {

/// The up direction and two directions that span the horizontal plane (the plan).
struct Plan {
  glm::vec3 up, right, front;
};

Plan plan_of(const Scene& scene) {
  const glm::vec3 up = glm::normalize(scene.up);
  const glm::vec3 other = std::fabs(up.x) < 0.9f ? glm::vec3(1, 0, 0) : glm::vec3(0, 0, 1);
  const glm::vec3 right = glm::normalize(glm::cross(other, up));
  return {up, right, glm::cross(up, right)};
}

/// The bounds of the model in the axes right, up and front of the plan.
struct Extent {
  glm::vec3 min{std::numeric_limits<float>::infinity()}, max{-std::numeric_limits<float>::infinity()};
};

Extent extent_of(const Scene& scene, const Plan& plan) {
  Extent extent;
  for (const Mesh& mesh : scene.meshes)
    for (const glm::vec3& p : mesh.positions) {
      const glm::vec3 q(glm::dot(p, plan.right), glm::dot(p, plan.up), glm::dot(p, plan.front));
      extent.min = glm::min(extent.min, q);
      extent.max = glm::max(extent.max, q);
    }
  return extent;
}

/// Height and slope of the top surface in each cell of the plan, seen from straight above.
class PlanGrid {
 public:
  PlanGrid(const Plan& plan, const Extent& extent)
      : plan_(plan), min_(extent.min), scale_(float(kCells) / glm::max(extent.max - extent.min, 1e-30f)) {}

  void add_triangle(glm::vec3 a, glm::vec3 b, glm::vec3 c, bool floor) {
    const glm::vec3 p = cell_of(a), q = cell_of(b), r = cell_of(c);
    const float twice = (q.x - p.x) * (r.z - p.z) - (r.x - p.x) * (q.z - p.z);
    if (!(std::fabs(twice) > 0.0f)) return;
    const glm::vec3 normal = glm::cross(b - a, c - a);
    const float cosine = std::fabs(glm::dot(normal, plan_.up)) / glm::length(normal);
    const glm::vec3 low = glm::min(glm::min(p, q), r), high = glm::max(glm::max(p, q), r);
    for (int row = first(low.z); row <= last(high.z); ++row)
      for (int column = first(low.x); column <= last(high.x); ++column) {
        const float x = float(column) + 0.5f - p.x, z = float(row) + 0.5f - p.z;
        const float to_q = (x * (r.z - p.z) - (r.x - p.x) * z) / twice;
        const float to_r = ((q.x - p.x) * z - x * (q.z - p.z)) / twice;
        if (to_q < 0.0f || to_r < 0.0f || to_q + to_r > 1.0f) continue;
        put(row, column, p.y + to_q * (q.y - p.y) + to_r * (r.y - p.y), cosine, floor);
      }
  }

  /// Adds a disc. A tilted disc is replaced by a horizontal one of the same projected area.
  void add_disc(glm::vec3 center, float radius, float cosine) {
    const glm::vec3 p = cell_of(center);
    const float seen = radius * std::sqrt(cosine), wide = seen * scale_.x, deep = seen * scale_.z;
    for (int row = first(p.z - deep); row <= last(p.z + deep); ++row)
      for (int column = first(p.x - wide); column <= last(p.x + wide); ++column) {
        const float x = (float(column) + 0.5f - p.x) / wide, z = (float(row) + 0.5f - p.z) / deep;
        if (x * x + z * z <= 1.0f) put(row, column, p.y, cosine, true);
      }
  }

  /// Returns the fraction of the plan whose top surface is at most `height` high and level: its cosine is at least
  /// `min_cosine`.
  float fraction(float height, float min_cosine) const {
    int count = 0;
    for (const Top& top : tops_) count += std::isfinite(top.height) && top.height <= height && top.cosine >= min_cosine;
    return float(count) / float(kCells * kCells);
  }

  /// Returns the fraction of the plan whose top surface is more than `height` above the lowest upward-facing surface.
  float fraction_under_roofs(float height) const {
    int count = 0;
    for (const Top& top : tops_) count += top.height - top.floor > height;
    return float(count) / float(kCells * kCells);
  }

 private:
  static constexpr int kCells = 64;
  struct Top {
    float height = -std::numeric_limits<float>::infinity(), cosine = 0.0f;
    float floor = std::numeric_limits<float>::infinity();  // height of the lowest upward-facing surface
  };

  /// Converts to grid coordinates: x and z in cells, y unchanged.
  glm::vec3 cell_of(glm::vec3 p) const {
    const glm::vec3 q(glm::dot(p, plan_.right), glm::dot(p, plan_.up), glm::dot(p, plan_.front));
    return {(q.x - min_.x) * scale_.x, q.y, (q.z - min_.z) * scale_.z};
  }
  /// Returns the first or last cell with its centre not before or not after `x`.
  static int first(float x) { return int(std::ceil(std::clamp(x - 0.5f, 0.0f, float(kCells)))); }
  static int last(float x) { return int(std::floor(std::clamp(x - 0.5f, -1.0f, float(kCells - 1)))); }
  void put(int row, int column, float height, float cosine, bool floor) {
    Top& top = tops_[std::size_t(row * kCells + column)];
    if (height > top.height) {
      top.height = height;
      top.cosine = cosine;
    }
    if (floor) top.floor = std::min(top.floor, height);
  }

  Plan plan_;
  glm::vec3 min_, scale_;
  std::vector<Top> tops_ = std::vector<Top>(std::size_t(kCells * kCells));
};

}  // namespace

bool lacks_ground(const Scene& scene) {
  constexpr float kFlat = 0.25f;    // height over width of a landscape
  constexpr float kFilled = 0.95f;  // fraction of its plan that a landscape fills
  constexpr float kLow = 0.12f;     // maximum height of a slab's top over the bottom, as a fraction of the width
  constexpr float kLevel = 0.9f;    // minimum cosine of the slope of a level surface
  // Maximum fraction of the plan that a slab fills in a scene without ground. A round slab fills 0.79 of its square,
  // minus the objects on it.
  constexpr float kMaxPlanFraction = 0.4f;
  constexpr float kMaxValley = 0.2f;      // the same for low land between hills
  constexpr float kMaxUnderRoofs = 0.5f;  // for hills: trees count as roofs
  if (scene.meshes.empty()) return false;
  const Plan plan = plan_of(scene);
  const Extent extent = extent_of(scene, plan);
  const glm::vec3 size = extent.max - extent.min;
  const float width = std::max(size.x, size.z);
  if (!(width > 0.0f) || !std::isfinite(width)) return false;
  PlanGrid seen(plan, extent);
  for (const Mesh& mesh : scene.meshes) {
    for (std::size_t i = 0; i < mesh.radii.size(); ++i)
      seen.add_disc(mesh.positions[i], mesh.radii[i],
                    mesh.spheres ? 1.0f : std::fabs(glm::dot(mesh.normals[i], plan.up)));
    for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
      const glm::vec3 a = mesh.positions[mesh.indices[k]], b = mesh.positions[mesh.indices[k + 1]],
                      c = mesh.positions[mesh.indices[k + 2]];
      const glm::vec3 n = mesh.normals.empty() ? glm::cross(b - a, c - a) : mesh.normals[mesh.indices[k]];
      seen.add_triangle(a, b, c, glm::dot(n, plan.up) > 0.0f);
    }
  }
  const bool filled = seen.fraction(extent.max.y, 0.0f) > kFilled;
  if (filled && size.y < kFlat * width) return false;
  // In a hilly landscape low ground is a valley, not a floor under a roof.
  const bool hills = filled && seen.fraction_under_roofs(kLow * width) < kMaxUnderRoofs;
  return seen.fraction(extent.min.y + kLow * width, kLevel) <= (hills ? kMaxValley : kMaxPlanFraction);
}

void add_ground(Scene& scene, std::optional<float> lowest_light_deg) {
  constexpr int kCorners = 96;
  constexpr float kUsual = 3.0f;  // in radii of the model, enough for its shadow at usual light directions
  constexpr float kMaxWidth = 16.0f;
  constexpr float kBelow = 1e-4f;  // fraction of the radius: faces on the ground stay in front of it
  const Plan plan = plan_of(scene);
  const Extent extent = extent_of(scene, plan);
  const float radius = scene.radius();
  float wide = kUsual;
  if (lowest_light_deg) {
    const float longest = 4.0f / std::tan(glm::radians(std::clamp(*lowest_light_deg, 1.0f, 90.0f)));
    wide = std::clamp(kUsual + longest, kUsual, kMaxWidth);
    scene.ground_fade_distance = wide * radius;
  }
  const float height = extent.min.y - kBelow * radius;
  const glm::vec3 middle = scene.center() + plan.up * (height - glm::dot(scene.center(), plan.up));
  scene.ground_center = middle;
  Mesh disc;
  disc.name = "ground";
  disc.positions.push_back(middle);
  for (int k = 0; k < kCorners; ++k) {
    const float angle = 2.0f * glm::pi<float>() * float(k) / kCorners;
    disc.positions.push_back(middle + wide * radius * (std::cos(angle) * plan.right + std::sin(angle) * plan.front));
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
