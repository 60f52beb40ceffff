
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <map>

#include "importer/three_mf_parts.h"

namespace umbrage {
namespace {

using pugi::xml_node;

/// An end of a beam.
struct End {
  glm::dvec3 center;
  double radius;
};

/// Adds a frustum of a cone between two ends; with flat ends if `is_closed`.
void add_beam(const End& a, const End& b, bool is_closed, PlacedMesh& to) {
  constexpr int kSides = 24;
  const double length = glm::length(b.center - a.center);
  if (!(length > 0.0)) return;
  const glm::dvec3 along = (b.center - a.center) / length;
  const glm::dvec3 helper = std::abs(along.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 x = glm::normalize(glm::cross(helper, along)), y = glm::cross(along, x);
  const auto base = std::uint32_t(to.positions.size());
  const auto add = [&](const glm::dvec3& position, const glm::dvec3& normal) {
    to.positions.push_back(position);
    to.mesh.normals.emplace_back(glm::normalize(normal));
    return std::uint32_t(to.positions.size() - 1);
  };
  const auto out = [&](int k) {
    const double angle = glm::two_pi<double>() * double(k % kSides) / kSides;
    return std::cos(angle) * x + std::sin(angle) * y;
  };
  for (int k = 0; k < kSides; ++k)
    for (const End& end : {a, b})
      add(end.center + end.radius * out(k), out(k) + (a.radius - b.radius) / length * along);
  for (std::uint32_t k = 0; k < kSides; ++k) {
    const std::uint32_t i = base + 2 * k, j = base + 2 * ((k + 1) % kSides);
    to.mesh.indices.insert(to.mesh.indices.end(), {i, j, j + 1, i, j + 1, i + 1});
  }
  for (int side = 0; is_closed && side < 2; ++side) {
    const End& end = side == 0 ? a : b;
    const glm::dvec3 normal = side == 0 ? -along : along;
    const std::uint32_t center = add(end.center, normal);
    for (int k = 0; k < kSides; ++k) add(end.center + end.radius * out(k), normal);
    for (std::uint32_t k = 0; k < kSides; ++k) {
      const std::uint32_t i = center + 1 + k, j = center + 1 + (k + 1) % kSides;
      to.mesh.indices.insert(to.mesh.indices.end(), {center, side == 0 ? j : i, side == 0 ? i : j});
    }
  }
}

}  // namespace

std::vector<PlacedMesh> beams_of(const xml_node& lattice, const std::vector<glm::dvec3>& vertices, double scale) {
  const auto length = [&](const xml_node& node, std::string_view name, double otherwise) {
    return std::abs(number<double>(attribute(node, name)).value_or(otherwise));
  };
  const bool is_flat = attribute(lattice, "cap") == "butt", balls_at_all = attribute(lattice, "ballmode") == "all";
  const double radius = length(lattice, "radius", 0.0), ball_radius = length(lattice, "ballradius", radius);
  std::vector<PlacedMesh> made(2);
  std::map<std::uint32_t, double> balls;  // radii, by vertex
  const auto add_ball = [&](std::uint32_t vertex, double of) { balls[vertex] = std::max(balls[vertex], of); };
  for (const xml_node& beam : child(lattice, "beams").children()) {
    const auto v1 = number<std::uint32_t>(attribute(beam, "v1")), v2 = number<std::uint32_t>(attribute(beam, "v2"));
    if (!v1 || !v2 || *v1 >= vertices.size() || *v2 >= vertices.size()) continue;
    const double r1 = length(beam, "r1", radius), r2 = length(beam, "r2", r1);
    add_beam({vertices[*v1], scale * r1}, {vertices[*v2], scale * r2}, is_flat, made[0]);
    if (!is_flat) add_ball(*v1, r1), add_ball(*v2, r2);
    if (balls_at_all) add_ball(*v1, ball_radius), add_ball(*v2, ball_radius);
  }
  for (const xml_node& ball : child(lattice, "balls").children())
    if (const auto vertex = number<std::uint32_t>(attribute(ball, "vindex")); vertex && *vertex < vertices.size())
      add_ball(*vertex, length(ball, "r", ball_radius));
  for (const auto& [vertex, of] : balls) {
    made[1].positions.push_back(vertices[vertex]);
    made[1].mesh.radii.push_back(float(scale * of));
  }
  made[1].mesh.points = made[1].mesh.spheres = true;
  std::erase_if(made, [](const PlacedMesh& each) { return each.positions.empty(); });
  return made;
}

}  // namespace umbrage
