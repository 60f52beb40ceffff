// Ground: detection of a scene's own ground on a grid seen from above, and the disc below models without ground.
#include "scene/ground.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <vector>

#include "scene/strays.h"

namespace umbrage {
namespace {

/// The up direction and two directions that span the horizontal plane. The projection along `up` is the plan view.
struct GroundAxes {
  glm::vec3 up, right, front;
};

GroundAxes axes_of(const Scene& scene) {
  const glm::vec3 up = glm::normalize(scene.up);
  const glm::vec3 other = std::fabs(up.x) < 0.9f ? glm::vec3(1, 0, 0) : glm::vec3(0, 0, 1);
  const glm::vec3 right = glm::normalize(glm::cross(other, up));
  return {up, right, glm::cross(up, right)};
}

/// The bounds of the model along the axes right, up and front.
struct Extent {
  glm::vec3 min{std::numeric_limits<float>::infinity()}, max{-std::numeric_limits<float>::infinity()};
};

Extent extent_of(const Scene& scene, const GroundAxes& axes) {
  Extent extent;
  for (const Mesh& mesh : scene.meshes)
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      const glm::vec3& p = mesh.positions[i];
      if (!is_in_bounds(scene, p)) continue;
      const glm::vec3 q(glm::dot(p, axes.right), glm::dot(p, axes.up), glm::dot(p, axes.front));
      const float radius = mesh.spheres ? mesh.radii[i] : 0.0f;
      extent.min = glm::min(extent.min, q - radius);
      extent.max = glm::max(extent.max, q + radius);
    }
  return extent;
}

/// A grid over the plan view: height and slope of the top surface in each cell.
class PlanGrid {
 public:
  PlanGrid(const GroundAxes& axes, const Extent& extent)
      : axes_(axes), min_(extent.min), scale_(float(kCells) / glm::max(extent.max - extent.min, 1e-30f)) {}

  void add_triangle(glm::vec3 a, glm::vec3 b, glm::vec3 c, bool floor) {
    const glm::vec3 p = cell_of(a), q = cell_of(b), r = cell_of(c);
    const float doubled_area = (q.x - p.x) * (r.z - p.z) - (r.x - p.x) * (q.z - p.z);
    if (!(std::fabs(doubled_area) > 0.0f)) return;
    const glm::vec3 normal = glm::cross(b - a, c - a);
    const float cosine = std::fabs(glm::dot(normal, axes_.up)) / glm::length(normal);
    const glm::vec3 low = glm::min(glm::min(p, q), r), high = glm::max(glm::max(p, q), r);
    for (int row = first(low.z); row <= last(high.z); ++row)
      for (int column = first(low.x); column <= last(high.x); ++column) {
        const float x = float(column) + 0.5f - p.x, z = float(row) + 0.5f - p.z;
        const float weight_q = (x * (r.z - p.z) - (r.x - p.x) * z) / doubled_area;
        const float weight_r = ((q.x - p.x) * z - x * (q.z - p.z)) / doubled_area;
        if (weight_q < 0.0f || weight_r < 0.0f || weight_q + weight_r > 1.0f) continue;
        add_surface(row, column, p.y + weight_q * (q.y - p.y) + weight_r * (r.y - p.y), cosine, floor);
      }
  }

  /// Adds a disc. A tilted disc is replaced by a horizontal one of the same projected area.
  void add_disc(glm::vec3 center, float radius, float cosine) {
    const glm::vec3 p = cell_of(center);
    const float projected = radius * std::sqrt(cosine), wide = projected * scale_.x, deep = projected * scale_.z;
    for (int row = first(p.z - deep); row <= last(p.z + deep); ++row)
      for (int column = first(p.x - wide); column <= last(p.x + wide); ++column) {
        const float x = (float(column) + 0.5f - p.x) / wide, z = (float(row) + 0.5f - p.z) / deep;
        if (x * x + z * z <= 1.0f) add_surface(row, column, p.y, cosine, true);
      }
  }

  /// Returns the fraction of the cells whose top surface is at most `height` high and has a slope with a cosine of at
  /// least `min_cosine`.
  float fraction(float height, float min_cosine) const {
    int count = 0;
    for (const Top& top : tops_) count += std::isfinite(top.height) && top.height <= height && top.cosine >= min_cosine;
    return float(count) / float(kCells * kCells);
  }

  /// Returns the fraction of the cells whose top surface is more than `height` above the lowest upward-facing surface.
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
    const glm::vec3 q(glm::dot(p, axes_.right), glm::dot(p, axes_.up), glm::dot(p, axes_.front));
    return {(q.x - min_.x) * scale_.x, q.y, (q.z - min_.z) * scale_.z};
  }
  /// Returns the first cell whose centre is at or after `x`; last() returns the last cell whose centre is at or before
  /// `x`.
  static int first(float x) { return int(std::ceil(std::clamp(x - 0.5f, 0.0f, float(kCells)))); }
  static int last(float x) { return int(std::floor(std::clamp(x - 0.5f, -1.0f, float(kCells - 1)))); }
  void add_surface(int row, int column, float height, float cosine, bool floor) {
    Top& top = tops_[std::size_t(row * kCells + column)];
    if (height > top.height) {
      top.height = height;
      top.cosine = cosine;
    }
    if (floor) top.floor = std::min(top.floor, height);
  }

  GroundAxes axes_;
  glm::vec3 min_, scale_;
  std::vector<Top> tops_ = std::vector<Top>(std::size_t(kCells * kCells));
};

}  // namespace

bool lacks_own_ground(const Scene& scene) {
  constexpr float kFlat = 0.25f;    // height over width of a landscape
  constexpr float kFilled = 0.95f;  // fraction of the cells that a landscape fills
  constexpr float kLow = 0.12f;     // maximum height of a slab's top over the bottom, as a fraction of the width
  constexpr float kLevel = 0.9f;    // minimum cosine of the slope of a level surface
  // Max fraction of the cells in which a level slab is on top in a scene without ground. A round slab fills 0.79 of its
  // square, minus the objects on it.
  constexpr float kMaxPlanFraction = 0.4f;
  constexpr float kMaxValley = 0.2f;      // the same fraction for low land between hills
  constexpr float kMaxUnderRoofs = 0.5f;  // max fraction of the cells under roofs in hills: trees count as roofs
  if (scene.meshes.empty()) return false;
  const GroundAxes axes = axes_of(scene);
  const Extent extent = extent_of(scene, axes);
  const glm::vec3 size = extent.max - extent.min;
  const float width = std::max(size.x, size.z);
  if (!(width > 0.0f) || !std::isfinite(width)) return false;
  PlanGrid grid(axes, extent);
  for (const Mesh& mesh : scene.meshes) {
    for (std::size_t i = 0; i < mesh.radii.size(); ++i)
      grid.add_disc(mesh.positions[i], mesh.radii[i],
                    mesh.spheres ? 1.0f : std::fabs(glm::dot(mesh.normals[i], axes.up)));
    for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
      const glm::vec3 a = mesh.positions[mesh.indices[k]], b = mesh.positions[mesh.indices[k + 1]],
                      c = mesh.positions[mesh.indices[k + 2]];
      const glm::vec3 n = mesh.normals.empty() ? glm::cross(b - a, c - a) : mesh.normals[mesh.indices[k]];
      grid.add_triangle(a, b, c, glm::dot(n, axes.up) > 0.0f);
    }
  }
  const bool filled = grid.fraction(extent.max.y, 0.0f) > kFilled;
  if (filled && size.y < kFlat * width) return false;
  // In a hilly landscape the low surfaces are valleys, not floors under roofs.
  const bool hills = filled && grid.fraction_under_roofs(kLow * width) < kMaxUnderRoofs;
  return grid.fraction(extent.min.y + kLow * width, kLevel) <= (hills ? kMaxValley : kMaxPlanFraction);
}

void add_ground(Scene& scene, std::optional<float> lowest_light_deg) {
  constexpr int kCorners = 96;
  constexpr float kDefaultRadius = 3.0f;  // radius in radii of the model: enough for its shadow in typical light
  constexpr float kDefaultFade = 1.4f;    // likewise: a longer shadow would end at the picture's border
  constexpr float kMaxRadius = 16.0f;
  // Distance of the disc below the model, as a fraction of the model's radius: keeps its lowest faces visible.
  constexpr float kOffsetBelow = 1e-4f;
  const GroundAxes axes = axes_of(scene);
  const Extent extent = extent_of(scene, axes);
  const float radius = scene.radius();
  float radii = kDefaultRadius;
  scene.ground_fade_distance = kDefaultFade * radius;
  if (lowest_light_deg) {
    const float max_shadow_length = 4.0f / std::tan(glm::radians(std::clamp(*lowest_light_deg, 1.0f, 90.0f)));
    radii = std::clamp(kDefaultRadius + max_shadow_length, kDefaultRadius, kMaxRadius);
    scene.ground_fade_distance = radii * radius;
  }
  const float height = extent.min.y - kOffsetBelow * radius;
  const glm::vec3 middle = scene.center() + axes.up * (height - glm::dot(scene.center(), axes.up));
  scene.ground_center = middle;
  Mesh disc;
  disc.name = "ground";
  disc.positions.push_back(middle);
  for (int k = 0; k < kCorners; ++k) {
    const float angle = 2.0f * glm::pi<float>() * float(k) / kCorners;
    disc.positions.push_back(middle + radii * radius * (std::cos(angle) * axes.right + std::sin(angle) * axes.front));
    const auto next = std::uint32_t(k + 1 == kCorners ? 1 : k + 2);
    disc.indices.insert(disc.indices.end(), {0u, next, std::uint32_t(k + 1)});
  }
  disc.normals.assign(disc.positions.size(), axes.up);
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
