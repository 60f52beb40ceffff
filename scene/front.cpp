#include "scene/front.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "core/lowercase.h"
#include "scene/strays.h"

namespace umbrage {
namespace {

/// Horizontal axes of a model: `front` is usual_front.
struct Level {
  glm::dvec3 right, up, front;
};

Level level_of(const glm::vec3& up) {
  const glm::vec3 front = usual_front(up);
  return {glm::dvec3(glm::cross(up, front)), glm::dvec3(up), glm::dvec3(front)};
}

bool is_of_ground(const Scene& scene, const Mesh& mesh) {
  return scene.ground_object >= 0 && mesh.object == scene.ground_object;
}

/// Returns a name of a part without the side that it names, or none if it names none: its last "left" or "right", or
/// else an L or R at its end, in either case, after one of "_.- " and before digits at most: "arm.L", "leg_r.001".
std::optional<std::string> without_side(const std::string& name, bool left) {
  const std::string lower = lowercase(name), side = left ? "left" : "right";
  if (const auto at = lower.rfind(side); at != std::string::npos)
    return lower.substr(0, at) + "*" + lower.substr(at + side.size());
  constexpr const char* kSeparators = "_.- ";
  const auto at = lower.find_last_not_of("0123456789_.- ");
  if (at == std::string::npos || at < 2 || lower[at] != side[0]) return {};
  if (lower.find_last_of(kSeparators, at) != at - 1) return {};
  return lower.substr(0, at) + "*" + lower.substr(at + 1);
}

/// Returns the direction that named parts face.
std::optional<glm::dvec3> front_of_parts(const Scene& scene, const Level& level) {
  struct Middles {
    glm::dvec3 sum{0.0};
    int count = 0;
    glm::dvec3 mean() const { return sum / double(count); }
  };
  std::map<std::string, std::pair<Middles, Middles>> parts;  // left and right
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.positions.empty() || is_of_ground(scene, mesh)) continue;
    glm::vec3 low = mesh.positions[0], high = low;
    for (const glm::vec3& p : mesh.positions) low = glm::min(low, p), high = glm::max(high, p);
    for (const bool left : {true, false})
      if (const auto part = without_side(mesh.name, left)) {
        Middles& middles = left ? parts[*part].first : parts[*part].second;
        middles.sum += 0.5 * glm::dvec3(low + high);
        ++middles.count;
      }
  }
  glm::dvec3 to_left(0.0);
  for (const auto& [name, sides] : parts)
    if (sides.first.count > 0 && sides.second.count > 0) to_left += sides.first.mean() - sides.second.mean();
  const glm::dvec3 facing = glm::cross(to_left, level.up);
  const double ahead = glm::dot(facing, level.front), aside = glm::dot(facing, level.right);
  if (std::max(std::abs(ahead), std::abs(aside)) <= 1e-3 * double(scene.radius())) return {};
  if (std::abs(ahead) >= std::abs(aside)) return ahead > 0.0 ? level.front : -level.front;
  return aside > 0.0 ? level.right : -level.right;
}

/// Area-weighted sums over a surface.
struct Moments {
  double area = 0.0;
  glm::dvec3 sum{0.0}, squares{0.0};
  double across_along = 0.0, across_height = 0.0;  // of products; x is across, y the height, z along
  void add(double weight, const glm::dvec3& p) {
    area += weight, sum += weight * p, squares += weight * p * p;
    across_along += weight * p.x * p.z, across_height += weight * p.x * p.y;
  }
  glm::dvec3 mean() const { return sum / area; }
  glm::dvec3 deviation() const { return glm::sqrt(glm::max(squares / area - mean() * mean(), glm::dvec3(0.0))); }
};

/// Returns the direction towards the head of an animal: see front_of.
std::optional<glm::dvec3> front_of_animal(const Scene& scene, const Level& level) {
  constexpr double kMinLength = 1.25;     // in widths
  constexpr double kTop = 0.75;           // height where the top quarter begins
  constexpr double kMinShift = 0.2;       // of the top quarter, in lengths
  constexpr double kMinDeviation = 0.05;  // along, of the top quarter, in lengths
  constexpr double kAlike = 0.03;         // max shift in widths, and max correlation of the sides with the rest
  const glm::dvec3 low(scene.bounds_min), high(scene.bounds_max), center = 0.5 * (low + high);
  const auto size = [&](const glm::dvec3& axis) { return glm::dot(glm::abs(axis), high - low); };
  const bool lengthwise = size(level.front) >= size(level.right);
  const glm::dvec3 along = lengthwise ? level.front : level.right, across = lengthwise ? level.right : level.front;
  const glm::dvec3 extent(size(across), size(level.up), size(along));
  if (extent.x <= 0.0 || extent.y <= 0.0 || extent.z < kMinLength * extent.x) return {};
  Moments all, top;
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.points || is_of_ground(scene, mesh)) continue;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      const glm::vec3 &a = mesh.positions[mesh.indices[i]], &b = mesh.positions[mesh.indices[i + 1]],
                      &c = mesh.positions[mesh.indices[i + 2]];
      if (!is_in_bounds(scene, a) || !is_in_bounds(scene, b) || !is_in_bounds(scene, c)) continue;
      // The middles of the sides give exact moments of second order.
      const double third = glm::length(glm::cross(glm::dvec3(b - a), glm::dvec3(c - a))) / 3.0;
      for (const auto& [from, to] : {std::pair{&a, &b}, {&b, &c}, {&c, &a}}) {
        const glm::dvec3 q = 0.5 * (glm::dvec3(*from) + glm::dvec3(*to)) - center;
        const glm::dvec3 p = glm::dvec3(glm::dot(across, q), glm::dot(level.up, q), glm::dot(along, q)) / extent;
        all.add(third, p);
        if (p.y + 0.5 > kTop) top.add(third, p);
      }
    }
  }
  if (all.area <= 0.0 || top.area <= 0.0) return {};
  const glm::dvec3 mean = all.mean(), deviation = all.deviation();
  const auto correlated = [&](double products, double a, double b, double deviations) {
    return std::abs(products / all.area - a * b) > kAlike * deviations;
  };
  if (std::abs(mean.x) > kAlike || correlated(all.across_along, mean.x, mean.z, deviation.x * deviation.z) ||
      correlated(all.across_height, mean.x, mean.y, deviation.x * deviation.y))
    return {};
  const double shift = top.mean().z - mean.z;
  if (std::abs(shift) < kMinShift || top.deviation().z < kMinDeviation) return {};
  return shift > 0.0 ? along : -along;
}

}  // namespace

std::string axis_text(glm::vec3 direction) {
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(direction[axis]) == 1.0f) return fmt::format("{}{}", direction[axis] > 0.0f ? '+' : '-', "XYZ"[axis]);
  return fmt::format("{:.3g},{:.3g},{:.3g}", direction.x, direction.y, direction.z);
}

glm::vec3 usual_front(const glm::vec3& up) {
  constexpr float kNearlyParallel = 0.9f;
  const glm::vec3 front = std::abs(up.z) < kNearlyParallel ? glm::vec3(0, 0, 1) : glm::vec3(0, -1, 0);
  return glm::normalize(front - glm::dot(front, up) * up);
}

glm::vec3 front_of(const Scene& scene, const glm::vec3& up) {
  if (scene.start) return front_of(*scene.start, up);
  return scene.shape_facts->front.of(up, [&] {
    const Level level = level_of(up);
    std::optional<glm::dvec3> found = front_of_parts(scene, level);
    if (!found && !scene.has_front) found = front_of_animal(scene, level);
    return glm::vec3(found.value_or(level.front));
  });
}

}  // namespace umbrage
