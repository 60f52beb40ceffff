// Points, faces and corners of a triangle mesh, for what needs to know which faces meet where.
#pragma once
#include <algorithm>
#include <bit>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <vector>

#include "scene/scene.h"

namespace umbrage {

using MeshIndex = std::uint32_t;
inline constexpr MeshIndex kNoIndex32 = std::numeric_limits<MeshIndex>::max();

/// Returns the bits of a float, the same for 0 and -0.
inline std::uint32_t bits_of(float x) { return std::bit_cast<std::uint32_t>(x + 0.0f); }
inline std::uint64_t mix_bits(std::uint64_t x) {
  x ^= x >> 32;
  x *= 0xd6e8feb86659fd93ull;
  x ^= x >> 32;
  return x;
}

/// Returns the number of each item. Equal items have the same number; numbers start at 0, in order of appearance.
/// `distinct` receives how many numbers there are.
template <class Hash, class Equal>
std::vector<MeshIndex> number_items(std::size_t count, MeshIndex& distinct, Hash hash, Equal equal) {
  const std::size_t slots = std::bit_ceil(std::max<std::size_t>(16, count + count / 2));
  struct Slot {
    MeshIndex item, number;
  };
  std::vector<Slot> table(slots, Slot{kNoIndex32, 0});
  std::vector<MeshIndex> number_of(count);
  distinct = 0;
  for (MeshIndex i = 0; i < count; ++i) {
    std::size_t slot = hash(i) & (slots - 1);
    while (table[slot].item != kNoIndex32 && !equal(table[slot].item, i)) slot = (slot + 1) & (slots - 1);
    if (table[slot].item == kNoIndex32) table[slot] = {i, distinct++};
    number_of[i] = table[slot].number;
  }
  return number_of;
}

inline std::uint64_t hash_of(const glm::vec3& p) {
  return mix_bits(mix_bits(std::uint64_t(bits_of(p.x)) << 32 | bits_of(p.y)) + bits_of(p.z));
}

/// Returns the corner before or after a corner in its triangle. Corner c is mesh.indices[c], of triangle c / 3.
inline MeshIndex next_corner(MeshIndex corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }
inline MeshIndex previous_corner(MeshIndex corner) { return corner % 3 == 0 ? corner + 2 : corner - 1; }

inline bool has_uvs(const Mesh& mesh) { return mesh.uvs.size() == mesh.positions.size() && !mesh.uvs.empty(); }
inline bool has_colors(const Mesh& mesh) { return mesh.colors.size() == mesh.positions.size() && !mesh.colors.empty(); }

struct Face {
  glm::vec3 normal{0.0f};      ///< unit, or zero for a face without area
  float angle[3] = {0, 0, 0};  ///< angles at its corners, radians
};

Face face_of(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);
std::vector<Face> faces_of(const Mesh& mesh);

/// Vertices grouped by equality. Vertices at equal positions are one point. Those that also have equal texture
/// coordinates, colours and values of fields can become one vertex.
struct JoinedVertices {
  std::vector<MeshIndex> point_of, joined;  ///< joined: empty if each point can become one vertex
  MeshIndex point_count = 0, vertex_count = 0;
  const std::vector<MeshIndex>& vertex_of() const { return joined.empty() ? point_of : joined; }
};

JoinedVertices joined_vertices(const Mesh& mesh);

/// The corners around each point, stored in one array.
struct CornerLists {
  std::vector<MeshIndex> first, corners;
  std::span<const MeshIndex> around(MeshIndex point) const {
    return {corners.data() + first[point], corners.data() + first[point + 1]};
  }
};

CornerLists corner_lists(const std::vector<MeshIndex>& indices, const JoinedVertices& vertices);

/// A mesh with its points, faces and corners.
struct MeshCorners {
  const Mesh* mesh;
  JoinedVertices vertices;
  std::vector<Face> faces;
  CornerLists lists;

  MeshIndex point(MeshIndex corner) const { return vertices.point_of[mesh->indices[corner]]; }
  const glm::vec3& normal(MeshIndex corner) const { return faces[corner / 3].normal; }
};

/// An edge of a face from the point that a list of corners is around to a neighbour.
struct Spoke {
  MeshIndex neighbor;  ///< a point
  MeshIndex corner;    ///< position in the list
  bool leaves;         ///< the face runs through the edge towards the neighbour
};

/// Sets `spokes` to two edges of each corner in the list `around`, sorted by neighbour, then corner.
void collect_spokes(const MeshCorners& corners, std::span<const MeshIndex> around, std::vector<Spoke>& spokes);

/// The other face at the edge of a triangle that starts at a corner.
struct EdgeNeighbor {
  MeshIndex face = kNoIndex32;    ///< none unless exactly two faces share the edge
  MeshIndex corner = kNoIndex32;  ///< its corner at the start of the edge
  bool same_direction = false;    ///< both faces run through the edge in one direction: their windings differ
};

/// Where more than 64 corners meet at both ends of an edge, no face is found.
EdgeNeighbor edge_neighbor(const MeshCorners& corners, MeshIndex corner);

}  // namespace umbrage
