// Creates normals for meshes without any. They are weighted by the angle of the face at the vertex [Thürmer and
// Wüthrich 1998], so that they do not depend on how a polygon was triangulated.
#include "scene/vertex_normals.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <numeric>
#include <utility>

#include "core/check.h"
#include "scene/crease_angle.h"
#include "scene/fields.h"
#include "scene/finish.h"
#include "scene/mesh_corners.h"

namespace umbrage {
namespace {

/// Turns triangles so that neighbours, which share an edge with no third, have the same winding; in each connected part
/// the smaller number of triangles is turned. `mesh` is that of `corners`, which afterwards describes it no longer.
/// Returns whether any was turned.
bool unify_winding(Mesh& mesh, const MeshCorners& corners) {
  using Index = MeshIndex;
  enum State : std::uint8_t { kUnseen, kAsItIs, kTurned };
  const std::size_t count = corners.faces.size();
  std::vector<std::uint8_t> state(count, kUnseen);
  std::vector<Index> part;
  std::vector<Index> to_turn;
  for (Index seed = 0; seed < count; ++seed) {
    if (state[seed] != kUnseen) continue;
    part.assign(1, seed);
    state[seed] = kAsItIs;
    std::size_t turned = 0;
    for (std::size_t i = 0; i < part.size(); ++i) {
      const Index face = part[i];
      for (Index corner = 3 * face; corner < 3 * face + 3; ++corner) {
        const EdgeNeighbor other = edge_neighbor(corners, corner);
        if (other.face == kNoIndex32 || state[other.face] != kUnseen) continue;
        const bool turn = (state[face] == kTurned) != other.same_direction;
        state[other.face] = turn ? kTurned : kAsItIs;
        turned += turn;
        part.push_back(other.face);
      }
    }
    const State minority = 2 * turned > part.size() ? kAsItIs : kTurned;
    for (const Index face : part)
      if (state[face] == minority) to_turn.push_back(face);
  }
  for (const Index face : to_turn) std::swap(mesh.indices[3 * face + 1], mesh.indices[3 * face + 2]);
  return !to_turn.empty();
}

using Index = MeshIndex;

/// Which faces share a normal where they meet.
struct Creases {
  float cos, half_cos;             ///< of the crease angle and of its half
  bool none;                       ///< the crease angle is 180 degrees
  const std::uint32_t* smoothing;  ///< smoothing group of each face, 0: flat; null: there are no groups

  bool same_group(Index face_a, Index face_b) const {
    return !smoothing || (smoothing[face_a] == smoothing[face_b] && smoothing[face_a] != 0);
  }
};

Creases creases_of(const Mesh& mesh, float crease_angle_deg) {
  const float crease_deg = std::clamp(crease_angle_deg, 0.0f, 180.0f);
  constexpr float kRounding = 1e-5f;  // keeps faces together that are parallel up to rounding, at a crease angle of 0
  const bool has_groups = !mesh.smoothing.empty() && mesh.smoothing.size() == mesh.indices.size() / 3;
  return {std::cos(glm::radians(crease_deg)) - kRounding, std::cos(glm::radians(crease_deg / 2.0f)),
          crease_deg >= 180.0f, has_groups ? mesh.smoothing.data() : nullptr};
}

/// Groups the corners around one point: `group[i]` is the first corner of i's group. Two corners belong to one group if
/// their faces share an edge at the point, meet within the crease angle and are in one smoothing group.
struct CornerGroups {
  std::vector<Spoke> spokes;
  std::vector<Index> group;

  Index root(Index i) {
    while (group[i] != i) i = group[i] = group[group[i]];
    return i;
  }

  void make(const MeshCorners& corners, std::span<const Index> around, const Creases& creases) {
    group.resize(around.size());
    std::iota(group.begin(), group.end(), 0u);
    collect_spokes(corners, around, spokes);
    constexpr std::size_t kMaxFacesCompared = 8;  // bounds the work if thousands of faces share one edge
    std::size_t run = 0;
    for (std::size_t i = 1; i < spokes.size(); ++i) {
      if (spokes[i].neighbor != spokes[run].neighbor) run = i;
      for (std::size_t j = std::max(run, i - std::min(i, kMaxFacesCompared)); j < i; ++j) {
        const Index a = around[spokes[i].corner], b = around[spokes[j].corner];
        if (glm::dot(corners.normal(a), corners.normal(b)) < creases.cos) continue;
        if (!creases.same_group(a / 3, b / 3)) continue;
        const Index root_a = root(spokes[i].corner), root_b = root(spokes[j].corner);
        group[std::max(root_a, root_b)] = std::min(root_a, root_b);
      }
    }
    for (Index i = 0; i < group.size(); ++i) group[i] = root(i);
  }
};

constexpr glm::vec3 kAnyNormal{0.0f, 1.0f, 0.0f};

/// Creates vertices from groups of corners that share a normal.
class VertexMaker {
 public:
  VertexMaker(const Mesh& mesh, const std::vector<Face>& faces, const JoinedVertices& vertices)
      : mesh_(mesh), faces_(faces), vertex_of_(vertices.vertex_of()), uvs_(has_uvs(mesh)), colors_(has_colors(mesh)) {
    latest_.resize(vertices.vertex_count);
    new_mesh_.fields = empty_fields(mesh);
    new_mesh_.indices.resize(mesh.indices.size());
    new_mesh_.positions.reserve(vertices.vertex_count);
    new_mesh_.normals.reserve(vertices.vertex_count);
    if (uvs_) new_mesh_.uvs.reserve(vertices.vertex_count);
    if (colors_) new_mesh_.colors.reserve(vertices.vertex_count);
  }

  void add_group(std::span<const Index> corners) {
    const glm::vec3 normal = normal_of(corners);
    for (const Index corner : corners) {
      const Index old = mesh_.indices[corner];
      Latest& latest = latest_[vertex_of_[old]];
      if (latest.group != group_number_) {
        latest = {group_number_, Index(new_mesh_.positions.size())};
        new_mesh_.positions.push_back(mesh_.positions[old]);
        new_mesh_.normals.push_back(normal);
        if (uvs_) new_mesh_.uvs.push_back(mesh_.uvs[old]);
        if (colors_) new_mesh_.colors.push_back(mesh_.colors[old]);
        append_vertex_values(mesh_, old, new_mesh_);
      }
      new_mesh_.indices[corner] = latest.vertex;
    }
    ++group_number_;
  }

  /// Returns a mesh of positions, normals, texture coordinates, colours, fields on positions and indices.
  Mesh take() { return std::move(new_mesh_); }

 private:
  /// The new vertex that was created last for an old vertex, and the number of its group.
  struct Latest {
    Index group = kNoIndex32, vertex = 0;
  };

  glm::vec3 normal_of(std::span<const Index> corners) const {
    glm::vec3 sum(0.0f);
    for (const Index corner : corners) sum += faces_[corner / 3].angle[corner % 3] * faces_[corner / 3].normal;
    float length = glm::length(sum);
    for (std::size_t i = 0; i < corners.size() && !(length > kMinNormalLength); ++i) {
      sum = faces_[corners[i] / 3].normal;
      length = glm::length(sum);
    }
    return length > kMinNormalLength ? sum / length : kAnyNormal;
  }

  const Mesh& mesh_;
  const std::vector<Face>& faces_;
  const std::vector<Index>& vertex_of_;
  const bool uvs_, colors_;
  std::vector<Latest> latest_;
  Index group_number_ = 0;
  Mesh new_mesh_;
};

/// Returns whether all faces at a point are in one smoothing group and within half the crease angle of their mean, so
/// that each pair is within the crease angle. A fast test that is true for most points.
bool is_smooth(std::span<const Index> around, const MeshCorners& corners, const Creases& creases) {
  glm::vec3 sum(0.0f);
  for (const Index corner : around) sum += corners.normal(corner);
  const float min = creases.half_cos * glm::length(sum);
  return std::all_of(around.begin(), around.end(), [&](Index corner) {
    return (creases.none || (min > 0.0f && glm::dot(sum, corners.normal(corner)) >= min)) &&
           creases.same_group(around[0] / 3, corner / 3);
  });
}

MeshCorners corners_of(const Mesh& mesh) {
  MeshCorners corners{&mesh, joined_vertices(mesh), faces_of(mesh), {}};
  corners.lists = corner_lists(mesh.indices, corners.vertices);
  return corners;
}

/// `rough` is 0 for points around which all faces are within kMinBendDeg.
Mesh with_normals(const MeshCorners& corners, const Creases& creases, const std::vector<std::uint8_t>& rough,
                  Poll* poll) {
  VertexMaker maker(*corners.mesh, corners.faces, corners.vertices);
  CornerGroups groups;
  std::vector<Index> order, members;
  const bool bends_are_known = !creases.smoothing && creases.cos <= std::cos(glm::radians(kMinBendDeg));
  for (Index p = 0; p < corners.vertices.point_count; ++p) {
    if (stops(poll, p, corners.vertices.point_count)) break;
    const std::span<const Index> around = corners.lists.around(p);
    if (around.empty()) continue;
    if ((bends_are_known && !rough[p]) || is_smooth(around, corners, creases)) {
      maker.add_group(around);
      continue;
    }
    const Index count = Index(around.size());
    groups.make(corners, around, creases);
    order.resize(count);
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return groups.group[a] < groups.group[b]; });
    for (Index i = 0; i < count;) {
      members.clear();
      const Index group = groups.group[order[i]];
      for (; i < count && groups.group[order[i]] == group; ++i) members.push_back(around[order[i]]);
      maker.add_group(members);
    }
  }
  return maker.take();
}

}  // namespace

void make_normals(Mesh& mesh, std::optional<float> crease_angle_deg, Poll* poll) {
  for (Index index : mesh.indices) check_less(index, mesh.positions.size(), "vertex index");
  MeshCorners corners = corners_of(mesh);
  if (poll && poll->passing(0.0)) return;
  std::vector<std::uint8_t> rough = rough_points(corners);
  EdgeSurvey survey = survey_edges(corners, rough, poll);
  if (poll && poll->passing(0.0)) return;
  if (survey.mixed_winding && unify_winding(mesh, corners)) {
    corners = corners_of(mesh);
    rough = rough_points(corners);
    survey = survey_edges(corners, rough, poll);
    if (poll && poll->passing(0.0)) return;
  }
  const float chosen_deg = mesh.smoothing.empty() ? survey.crease_deg : kSmoothCreaseDeg;
  Mesh result = with_normals(corners, creases_of(mesh, crease_angle_deg.value_or(chosen_deg)), rough, poll);
  if (poll && poll->ended()) return;
  mesh.positions = std::move(result.positions);
  mesh.normals = std::move(result.normals);
  mesh.uvs = std::move(result.uvs);
  mesh.colors = std::move(result.colors);
  for (std::size_t f = 0; f < mesh.fields.size(); ++f)
    if (!mesh.fields[f].on_triangles) mesh.fields[f] = std::move(result.fields[f]);
  mesh.indices = std::move(result.indices);
}

}  // namespace umbrage
