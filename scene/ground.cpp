// Ground: detection of a scene's own ground at the foot of a picture, and the disc below models.
#include "scene/ground.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <utility>

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

/// The nearest surfaces along the lower border of a picture, in columns.
class Foot {
 public:
  Foot(const Camera& camera, const glm::vec3& up) : camera_(camera), up_(up) {}

  void add_triangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const glm::vec3 corners[] = {view_of(a), view_of(b), view_of(c)};
    glm::vec3 ends[2];
    int count = 0;
    for (int k = 0; k < 3 && count < 2; ++k) {
      const glm::vec3 &p = corners[k], &q = corners[(k + 1) % 3];
      const float from = above(p), to = above(q);
      if ((from < 0.0f) != (to < 0.0f)) ends[count++] = p + (q - p) * (from / (from - to));
    }
    if (count < 2) return;
    const glm::vec3 normal = glm::cross(b - a, c - a);
    add_segment(ends[0], ends[1], std::fabs(glm::dot(normal, up_)) > kMinCosine * glm::length(normal));
  }

  void add_disc(const glm::vec3& center, float radius, bool level) {
    const glm::vec3 p = view_of(center);
    const float distance = above(p) / (is_perspective() ? std::hypot(1.0f, camera_.bottom) : 1.0f);
    const float half = std::sqrt(std::max(radius * radius - distance * distance, 0.0f));
    if (half > 0.0f) add_segment(p - glm::vec3(half, 0, 0), p + glm::vec3(half, 0, 0), level);
  }

  /// Returns the fraction of the columns whose nearest surface is level.
  float level_fraction() const {
    return float(std::count_if(columns_.begin(), columns_.end(), [](const Column& c) { return c.level; })) / kColumns;
  }

 private:
  static constexpr int kColumns = 64;
  static constexpr float kMinCosine = 0.7f;  // of the slope of a level surface: below 45 degrees
  struct Column {
    float inverse_depth = -std::numeric_limits<float>::infinity();
    bool level = false;
  };

  bool is_perspective() const { return camera_.projection == Projection::kPerspective; }
  glm::vec3 view_of(const glm::vec3& p) const { return glm::vec3(camera_.view_from_world * glm::vec4(p, 1.0f)); }
  /// Returns a multiple of the height of a point in view space above the plane through the lower border.
  float above(const glm::vec3& p) const { return p.y - camera_.bottom * (is_perspective() ? -p.z : 1.0f); }

  /// Adds a segment in that plane.
  void add_segment(glm::vec3 a, glm::vec3 b, bool level) {
    constexpr float kNear = 1e-4f;  // nearest depth, relative to that of the other end
    if (a.z < b.z) std::swap(a, b);
    if (is_perspective()) {
      if (!(b.z < 0.0f)) return;
      if (const float near = kNear * b.z; a.z > near) a += (b - a) * ((a.z - near) / (a.z - b.z));
    }
    // Along the border, columns and inverse depth are linear functions of each other; with a parallel projection,
    // depth.
    const auto column_of = [&](const glm::vec3& p) {
      return float(kColumns) * ((is_perspective() ? -p.x / p.z : p.x) - camera_.left) / (camera_.right - camera_.left);
    };
    const auto inverse_depth_of = [&](const glm::vec3& p) { return is_perspective() ? -1.0f / p.z : p.z; };
    float x0 = column_of(a), x1 = column_of(b), n0 = inverse_depth_of(a), n1 = inverse_depth_of(b);
    if (x0 > x1) std::swap(x0, x1), std::swap(n0, n1);
    if (!(x1 > x0)) return;
    const int end = int(std::ceil(std::clamp(x1 - 0.5f, 0.0f, float(kColumns))));
    for (int k = int(std::ceil(std::clamp(x0 - 0.5f, 0.0f, float(kColumns)))); k < end; ++k) {
      const float inverse_depth = n0 + (n1 - n0) * (float(k) + 0.5f - x0) / (x1 - x0);
      if (inverse_depth > columns_[std::size_t(k)].inverse_depth) columns_[std::size_t(k)] = {inverse_depth, level};
    }
  }

  const Camera& camera_;
  glm::vec3 up_;
  std::array<Column, kColumns> columns_;
};

}  // namespace

bool shows_own_ground(const Scene& scene, const Camera& camera) {
  constexpr float kMinLevelFraction = 0.5f;
  constexpr float kMinDiscCosine = 0.7f;
  const glm::vec3 up = glm::normalize(scene.up);
  Foot foot(camera, up);
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.object == scene.ground_object) continue;
    for (std::size_t i = 0; i < mesh.radii.size(); ++i)
      foot.add_disc(mesh.positions[i], mesh.radii[i],
                    !mesh.spheres && std::fabs(glm::dot(mesh.normals[i], up)) > kMinDiscCosine);
    for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3)
      foot.add_triangle(mesh.positions[mesh.indices[k]], mesh.positions[mesh.indices[k + 1]],
                        mesh.positions[mesh.indices[k + 2]]);
  }
  return foot.level_fraction() > kMinLevelFraction;
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
