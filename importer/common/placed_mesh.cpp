#include "importer/common/placed_mesh.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <utility>

#include "scene/readers/positions.h"

namespace umbrage {
namespace {

/// Transforms normals by the inverse transpose of `linear`.
struct NormalTransform {
  glm::dmat3 cofactor;
  double sign = 1.0;

  explicit NormalTransform(const glm::dmat3& linear)
      // The cofactor matrix is the inverse transpose up to a factor, and exists for singular transforms, too.
      : cofactor(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]), glm::cross(linear[0], linear[1])),
        sign(glm::determinant(linear) < 0.0 ? -1.0 : 1.0) {}
  glm::vec3 operator()(const glm::vec3& n) const {
    const glm::dvec3 turned = sign * (cofactor * glm::dvec3(n));
    const double length = glm::length(turned);
    return length > 0.0 ? glm::vec3(turned / length) : glm::vec3(0.0f);
  }
};

void turn_triangles(Mesh& mesh) {
  for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) std::swap(mesh.indices[k + 1], mesh.indices[k + 2]);
}

}  // namespace

PlacedMesh placed(Mesh source, const glm::dmat4& world_from_mesh) {
  PlacedMesh result{std::move(source), {}};
  if (world_from_mesh == glm::dmat4(1.0)) return result;
  Mesh& mesh = result.mesh;
  result.positions.resize(mesh.positions.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    result.positions[i] = glm::dvec3(world_from_mesh * glm::dvec4(mesh.positions[i], 1.0));
  const NormalTransform turned{glm::dmat3(world_from_mesh)};
  if (glm::determinant(glm::dmat3(world_from_mesh)) == 0.0)
    mesh.normals.clear();
  else
    for (glm::vec3& n : mesh.normals) n = turned(n);
  if (turned.sign < 0.0) turn_triangles(mesh);
  return result;
}

PlacedMesh skinned(Mesh source, const std::function<glm::dmat4(std::size_t)>& world_from_vertex) {
  PlacedMesh result{std::move(source), {}};
  Mesh& mesh = result.mesh;
  result.positions.resize(mesh.positions.size());
  std::size_t mirrored = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::dmat4 transform = world_from_vertex(i);
    result.positions[i] = glm::dvec3(transform * glm::dvec4(mesh.positions[i], 1.0));
    const NormalTransform turned{glm::dmat3(transform)};
    mirrored += turned.sign < 0.0;
    if (!mesh.normals.empty()) mesh.normals[i] = turned(mesh.normals[i]);
  }
  if (2 * mirrored > mesh.positions.size()) turn_triangles(mesh);
  return result;
}

void move_to_scene(std::vector<PlacedMesh> meshes, Scene& scene, const std::vector<glm::dvec3>& motion) {
  OriginFinder finder;
  for (const glm::dvec3& p : motion) finder.add(p);
  for (const PlacedMesh& mesh : meshes) {
    if (!motion.empty()) break;
    for (const glm::dvec3& p : mesh.positions) finder.add(p);
    if (mesh.positions.empty())
      for (const glm::vec3& p : mesh.mesh.positions) finder.add(glm::dvec3(p));
  }
  const glm::dvec3 origin = scene.origin = finder.origin();
  for (const glm::dvec3& p : motion) scene.motion.emplace_back(p - origin);
  for (PlacedMesh& placed : meshes) {
    Mesh& mesh = placed.mesh;
    if (placed.positions.empty() && origin != glm::dvec3(0.0))
      for (glm::vec3& p : mesh.positions) p = glm::vec3(glm::dvec3(p) - origin);
    mesh.positions.resize(std::max(mesh.positions.size(), placed.positions.size()));
    for (std::size_t i = 0; i < placed.positions.size(); ++i)
      mesh.positions[i] = glm::vec3(placed.positions[i] - origin);
    scene.meshes.push_back(std::move(mesh));
    placed = {};
  }
}

}  // namespace umbrage
