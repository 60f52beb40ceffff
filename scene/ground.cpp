// Ground: detection of a scene's own ground by its relief, and the disc below models.
#include "scene/ground.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat3x3.hpp>
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
  const auto add = [&](const glm::vec3& p, float radius) {
    const glm::vec3 q(glm::dot(p, axes.right), glm::dot(p, axes.up), glm::dot(p, axes.front));
    extent = {glm::min(extent.min, q - radius), glm::max(extent.max, q + radius)};
  };
  for (const glm::vec3& p : scene.motion) add(p, 0.0f);
  if (!scene.motion.empty()) return extent;
  for (const Mesh& mesh : scene.meshes)
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      const glm::vec3& p = mesh.positions[i];
      if (is_in_bounds(scene, p)) add(p, mesh.spheres ? mesh.radii[i] : 0.0f);
    }
  return extent;
}

constexpr float kNothing = -std::numeric_limits<float>::infinity();

/// The heights of a scene above its centre as seen from above: the highest surface in each cell of a square grid around
/// the centre, kNothing where there is none.
struct Relief {
  static constexpr int kCells = 64;  // per side
  glm::vec3 center;
  GroundAxes axes;
  float half;  // of a side, scene units
  std::vector<float> heights;

  explicit Relief(const Scene& scene) : center(scene.center()), axes(axes_of(scene)) {
    const glm::vec3 size = 0.5f * (scene.bounds_max - scene.bounds_min);
    half = std::max(glm::dot(size, glm::abs(axes.right)), glm::dot(size, glm::abs(axes.front)));
  }
  float cell() const { return 2.0f * half / float(kCells); }
  /// Returns a position as its components right, up and front of the centre.
  glm::vec3 local(const glm::vec3& p) const { return rotated(p - center); }
  glm::vec3 rotated(const glm::vec3& v) const {
    return {glm::dot(v, axes.right), glm::dot(v, axes.up), glm::dot(v, axes.front)};
  }
  /// Returns the index of the cell at a position; empty outside of the grid.
  std::optional<std::size_t> index_at(const glm::vec3& p) const {
    const float x = std::floor((p.x + half) / cell()), y = std::floor((p.z + half) / cell());
    if (!(std::min(x, y) >= 0.0f && std::max(x, y) < float(kCells))) return {};
    return std::size_t(y) * kCells + std::size_t(x);
  }
  float height_at(const glm::vec3& p) const {
    const auto index = index_at(p);
    return index ? heights[*index] : kNothing;
  }
  void add(const glm::vec3& p) {
    if (const auto index = index_at(p)) heights[*index] = std::max(heights[*index], p.y);
  }
  /// Adds points of a triangle that are at most half a cell apart.
  void add_triangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const auto steps = [&](const glm::vec3& edge) {
      constexpr float kMaxSteps = 8.0f * kCells;  // for strays
      return std::ceil(std::clamp(2.0f * std::sqrt(edge.x * edge.x + edge.z * edge.z) / cell(), 1.0f, kMaxSteps));
    };
    const float rows = steps(b - a), columns = steps(c - a);
    for (float i = 0.0f; i <= rows; ++i) {
      const glm::vec3 from = a + (b - a) * (i / rows), to = c + (b - c) * (i / rows);
      const float count = std::ceil(columns * (1.0f - i / rows));
      for (float j = 0.0f; j <= count; ++j) add(from + (to - from) * (j / std::max(count, 1.0f)));
    }
  }
};

std::vector<float> heights_of(const Scene& scene, Relief relief) {
  relief.heights.assign(Relief::kCells * Relief::kCells, kNothing);
  tbb::enumerable_thread_specific<Relief> parts(relief);
  const auto for_all = [&](std::size_t count, auto add) {
    constexpr std::size_t kGrain = 4096;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kGrain), [&](const auto& range) {
      Relief& part = parts.local();
      for (std::size_t i = range.begin(); i < range.end(); ++i) add(part, i);
    });
  };
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.object == scene.ground_object) continue;
    for_all(mesh.radii.size(), [&](Relief& part, std::size_t i) {
      const glm::vec3 p = relief.local(mesh.positions[i]);
      const float r = mesh.radii[i];
      part.add_triangle(p + glm::vec3(-r, 0, -r), p + glm::vec3(r, 0, -r), p + glm::vec3(-r, 0, r));
      part.add_triangle(p + glm::vec3(r, 0, r), p + glm::vec3(r, 0, -r), p + glm::vec3(-r, 0, r));
    });
    for_all(mesh.indices.size() / 3, [&](Relief& part, std::size_t i) {
      const auto corner = [&](std::size_t k) { return relief.local(mesh.positions[mesh.indices[3 * i + k]]); };
      part.add_triangle(corner(0), corner(1), corner(2));
    });
  }
  for (const Relief& part : parts)
    std::transform(part.heights.begin(), part.heights.end(), relief.heights.begin(), relief.heights.begin(),
                   [](float a, float b) { return std::max(a, b); });
  return std::move(relief.heights);
}

/// Returns whether a ray, in components of the relief, comes to a surface less steep than 45 degrees first.
bool meets_level(const Relief& relief, const glm::vec3& origin, const glm::vec3& direction, bool starts_there) {
  const glm::vec2 from(origin.x, origin.z), along(direction.x, direction.z);
  const float speed = std::max(glm::length(along), 1e-4f), reach = glm::root_two<float>() * relief.half;
  // From where the ray enters the circle around the grid, in steps of half a cell.
  const float nearest = -glm::dot(from, along) / (speed * speed), aside = glm::length(from + nearest * along);
  if (!(aside <= reach)) return false;
  const float chord = std::sqrt(reach * reach - aside * aside) / speed, step = 0.5f * relief.cell() / speed;
  const float first = starts_there ? std::max(nearest - chord, 0.0f) : nearest - chord;
  const int steps = int(std::ceil((nearest + chord - first) / step));
  for (int k = 0; k <= steps; ++k) {
    const glm::vec3 p = origin + (first + float(k) * step) * direction;
    const float height = relief.height_at(p), before = std::max(p.y, p.y - step * direction.y);
    if (p.y < height) return height - before <= relief.cell();
  }
  return false;
}

}  // namespace

bool shows_own_ground(const Scene& scene, const Camera& camera) {
  constexpr int kAzimuths = 32;
  if (scene.start) return shows_own_ground(*scene.start, camera);
  Relief relief(scene);
  if (!(relief.half > 0.0f)) return false;
  relief.heights = scene.shape_facts->relief.of(scene.up, [&] { return heights_of(scene, relief); });
  // The ray through the middle of the lower border.
  const bool perspective = camera.projection == Projection::kPerspective;
  const glm::mat3 world_from_view = glm::transpose(glm::mat3(camera.view_from_world));
  const glm::vec3 on_border(0.5f * (camera.left + camera.right), camera.bottom, 0.0f);
  const glm::vec3 ahead(0, 0, -1);
  const glm::vec3 origin = relief.local(camera.eye() + (perspective ? glm::vec3(0.0f) : world_from_view * on_border));
  const glm::vec3 direction = relief.rotated(world_from_view * (perspective ? on_border + ahead : ahead));
  int level = 0;
  for (int k = 0; k < kAzimuths; ++k) {
    const glm::mat3 turn(glm::rotate(glm::mat4(1.0f), glm::two_pi<float>() * float(k) / kAzimuths, glm::vec3(0, 1, 0)));
    level += meets_level(relief, turn * origin, turn * direction, perspective);
  }
  return 2 * level > kAzimuths;
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
