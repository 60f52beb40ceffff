// Points, faces and corners of a triangle mesh, for what needs to know which faces meet where.
#include "scene/mesh_corners.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace umbrage {
namespace {

using Index = MeshIndex;

std::uint64_t hash_of(const glm::vec2& p) { return mix_bits(std::uint64_t(bits_of(p.x)) << 32 | bits_of(p.y)); }
bool same(const glm::vec3& a, const glm::vec3& b) {
  return bits_of(a.x) == bits_of(b.x) && bits_of(a.y) == bits_of(b.y) && bits_of(a.z) == bits_of(b.z);
}
bool same(const glm::vec2& a, const glm::vec2& b) {
  return bits_of(a.x) == bits_of(b.x) && bits_of(a.y) == bits_of(b.y);
}

/// Compare the values of two vertices, and compute their hash. Fields on triangles do not matter.
std::uint64_t hash_of_values(const Mesh& mesh, Index vertex) {
  std::uint64_t hash = 0;
  for (const Field& field : mesh.fields)
    for (int c = 0; c < field.components && !field.on_triangles; ++c)
      hash = mix_bits(hash + bits_of(field.values[vertex * std::size_t(field.components) + std::size_t(c)]));
  return hash;
}
bool same_values(const Mesh& mesh, Index a, Index b) {
  for (const Field& field : mesh.fields)
    for (int c = 0; c < field.components && !field.on_triangles; ++c) {
      const auto at = [&](Index v) {
        return bits_of(field.values[v * std::size_t(field.components) + std::size_t(c)]);
      };
      if (at(a) != at(b)) return false;
    }
  return true;
}

}  // namespace

Face face_of(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const glm::dvec3 ab = glm::dvec3(b) - glm::dvec3(a), ac = glm::dvec3(c) - glm::dvec3(a), bc = ac - ab;
  const glm::dvec3 area = glm::cross(ab, ac);
  const double length = std::sqrt(glm::dot(area, area));
  Face face;
  if (!(length > 0.0) || !std::isfinite(length)) return face;
  face.normal = glm::vec3(area / length);
  // Divide first: products of tiny lengths would leave the range of floats.
  const double largest = std::max({length, std::abs(glm::dot(ab, ac)), std::abs(glm::dot(ab, bc))});
  const float sine = float(length / largest);
  face.angle[0] = std::atan2(sine, float(glm::dot(ab, ac) / largest));
  face.angle[1] = std::atan2(sine, float(-glm::dot(ab, bc) / largest));
  face.angle[2] = std::max(0.0f, std::numbers::pi_v<float> - face.angle[0] - face.angle[1]);
  return face;
}

JoinedVertices joined_vertices(const Mesh& mesh) {
  const std::vector<glm::vec3>& positions = mesh.positions;
  const bool uvs = has_uvs(mesh), colors = has_colors(mesh), values = !mesh.fields.empty();
  JoinedVertices result;
  result.point_of = number_items(
      positions.size(), result.point_count, [&](Index i) { return hash_of(positions[i]); },
      [&](Index i, Index j) { return same(positions[i], positions[j]); });
  result.vertex_count = result.point_count;
  if (!uvs && !colors && !values) return result;
  const std::vector<Index>& point_of = result.point_of;
  result.joined = number_items(
      positions.size(), result.vertex_count,
      [&](Index i) {
        const std::uint64_t base = values ? mix_bits(hash_of_values(mesh, i) + point_of[i]) : point_of[i];
        const std::uint64_t hash = uvs ? mix_bits(hash_of(mesh.uvs[i]) + base) : base;
        return colors ? mix_bits(hash_of(mesh.colors[i]) + hash) : hash;
      },
      [&](Index i, Index j) {
        return point_of[i] == point_of[j] && (!uvs || same(mesh.uvs[i], mesh.uvs[j])) &&
               (!colors || same(mesh.colors[i], mesh.colors[j])) && (!values || same_values(mesh, i, j));
      });
  return result;
}

std::vector<Face> faces_of(const Mesh& mesh) {
  const Index* corner = mesh.indices.data();
  std::vector<Face> faces(mesh.indices.size() / 3);
  for (Face& face : faces) {
    face = face_of(mesh.positions[corner[0]], mesh.positions[corner[1]], mesh.positions[corner[2]]);
    corner += 3;
  }
  return faces;
}

CornerLists corner_lists(const std::vector<Index>& indices, const JoinedVertices& vertices) {
  CornerLists result{std::vector<Index>(vertices.point_count + 1, 0), std::vector<Index>(indices.size())};
  for (const Index index : indices) ++result.first[vertices.point_of[index] + 1];
  for (Index p = 0; p < vertices.point_count; ++p) result.first[p + 1] += result.first[p];
  std::vector<Index> next(result.first.begin(), result.first.end() - 1);
  for (Index corner = 0; corner < indices.size(); ++corner)
    result.corners[next[vertices.point_of[indices[corner]]]++] = corner;
  return result;
}

void collect_spokes(const MeshCorners& corners, std::span<const Index> around, std::vector<Spoke>& spokes) {
  spokes.clear();
  for (Index i = 0; i < around.size(); ++i) {
    spokes.push_back({corners.point(next_corner(around[i])), i, true});
    spokes.push_back({corners.point(previous_corner(around[i])), i, false});
  }
  std::sort(spokes.begin(), spokes.end(), [](const Spoke& a, const Spoke& b) {
    return a.neighbor != b.neighbor ? a.neighbor < b.neighbor : a.corner < b.corner;
  });
}

EdgeNeighbor edge_neighbor(const MeshCorners& corners, Index corner) {
  const Index from = corners.point(corner), to = corners.point(next_corner(corner));
  const std::span<const Index> at_from = corners.lists.around(from), at_to = corners.lists.around(to);
  const bool by_from = at_from.size() <= at_to.size();  // the shorter list: the other may have thousands of corners
  constexpr std::size_t kMaxCorners = 64;               // bounds the work if both have
  if (std::min(at_from.size(), at_to.size()) > kMaxCorners) return {};
  const Index far = by_from ? to : from;
  EdgeNeighbor result;
  for (const Index other : by_from ? at_from : at_to) {
    if (other / 3 == corner / 3) continue;
    const bool leaves = corners.point(next_corner(other)) == far;
    if (!leaves && corners.point(previous_corner(other)) != far) continue;
    if (result.face != kNoIndex32) return {};
    result = {other / 3, leaves ? other : previous_corner(other), leaves == by_from};
  }
  return result;
}

}  // namespace umbrage
