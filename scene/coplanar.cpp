// Faces of different meshes in one plane: where they overlap, rounding would decide at each pixel which is in front.
// Triangles within the box of another mesh are sorted by their plane, rounded; overlaps within a plane are found by a
// bounding volume hierarchy.
#include "scene/finish.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>
#include <glm/vector_relational.hpp>
#include <map>
#include <numeric>
#include <set>
#include <span>
#include <unordered_map>

#include "scene/fields.h"
#include "scene/mesh_corners.h"
#include "scene/strays.h"

namespace umbrage {
namespace {

using Index = MeshIndex;

// In radii of the scene. Decimals of files put corners of one plane up to some millionths apart.
constexpr double kSamePlane = 4e-6;
constexpr double kStep = 1e-5;  // more than kSamePlane, and far above the rounding of depths

/// Cells into which planes are rounded. The noise of the normal of a triangle of a hundredth of the radius is smaller.
constexpr double kNormalCell = 2e-3, kDistanceCell = 2e-4;

/// Max numbers of pairs of boxes that are tested, per box, and of pairs of meshes that overlap, per triangle of a
/// plane. Above them, all faces of later meshes move; for a stack of meshes that is the same.
constexpr std::size_t kMaxBoxTests = 256, kMaxMeshPairs = 16;
constexpr float kDown = 0.01f;  // of the component of a normal along up; less is rounding
constexpr int kMaxLevel = 100;  // steps by which faces on top of each other are moved

struct Triangle {
  Index mesh, face;
  std::uint64_t cell;  ///< of its plane
};

struct RaisedFace {
  Triangle triangle;
  int level;       ///< number of steps
  glm::vec3 side;  ///< normal of the earliest mesh in the plane: faces move to its side
};

/// Returns the normal of a face, on the side of its vertices' normals.
glm::vec3 facing_normal(const Mesh& mesh, Index face) {
  const Index* corner = &mesh.indices[3 * std::size_t(face)];
  const glm::vec3 normal =
      face_of(mesh.positions[corner[0]], mesh.positions[corner[1]], mesh.positions[corner[2]]).normal;
  const glm::vec3 stored = mesh.normals[corner[0]] + mesh.normals[corner[1]] + mesh.normals[corner[2]];
  return glm::dot(normal, stored) < 0.0f ? -normal : normal;
}

bool overlaps(const SceneBox& a, const SceneBox& b) {
  return glm::all(glm::lessThanEqual(a.low, b.high)) && glm::all(glm::lessThanEqual(b.low, a.high));
}

std::uint64_t id_of(const Triangle& t) { return std::uint64_t(t.mesh) << 32 | t.face; }

struct Corners {
  glm::dvec3 at[3];
  /// Returns the normal with the length of twice the area.
  glm::dvec3 normal() const { return glm::cross(at[1] - at[0], at[2] - at[0]); }
};

/// The triangles of a scene, with its centre as origin and its radius as unit.
class Triangles {
 public:
  explicit Triangles(const Scene& scene) : scene_(scene), center_(scene.center()), scale_(1.0 / scene.radius()) {}

  Corners corners(Index mesh, Index face) const {
    const Mesh& m = scene_.meshes[mesh];
    const auto at = [&](int k) { return (glm::dvec3(m.positions[m.indices[3 * face + k]]) - center_) * scale_; };
    return {at(0), at(1), at(2)};
  }

  /// Returns the plane of a triangle, its normal and distance from the centre, in cells.
  glm::vec4 plane(Index mesh, Index face) const {
    const Corners c = corners(mesh, face);
    const glm::dvec3 n = c.normal();
    // A direction in which planes are rarely parallel: the sign of a normal must not depend on rounding.
    const double side = glm::dot(n, glm::dvec3(0.531, 0.742, 0.409)) < 0.0 ? -1.0 : 1.0;
    const double scale = side / glm::length(n), distance = scale / 3.0 * glm::dot(n, c.at[0] + c.at[1] + c.at[2]);
    return glm::vec4(n * (scale / kNormalCell), distance / kDistanceCell);
  }

 private:
  const Scene& scene_;
  const glm::dvec3 center_;
  const double scale_;
};

/// Returns the number of the cell of a plane. `shift` moves the borders of the cells, in cells.
std::uint64_t cell_of(const glm::vec4& plane, float shift) {
  // Positive, so that conversion rounds down. 0.3: planes through zero are common; they must not be on the border of
  // two cells.
  constexpr float kOffset = float(int(2.0 / kDistanceCell)) + 0.3f;
  constexpr float kMaxCell = 1e9f;  // strays may be farther away than an integer can count
  std::uint64_t hash = 0;
  for (int i = 0; i < 4; ++i) {
    hash = (hash ^ std::uint64_t(std::clamp(plane[i] + (kOffset + shift), 0.0f, kMaxCell))) * 0x9e3779b97f4a7c15ull;
    hash ^= hash >> 29;
  }
  return hash;
}

/// Returns the box of each mesh in world space, grown by `margin`; an empty one for points.
std::vector<SceneBox> boxes_of_meshes(const Scene& scene, float margin) {
  std::vector<SceneBox> boxes(scene.meshes.size());
  for (std::size_t m = 0; m < boxes.size(); ++m) {
    if (scene.meshes[m].points) continue;
    SceneBox& box = boxes[m];
    for (const glm::vec3& p : scene.meshes[m].positions) extend(box, p);
    box = {box.low - margin, box.high + margin};
  }
  return boxes;
}

/// Which meshes may touch a triangle of another mesh, by their boxes.
class MeshNeighbors {
 public:
  explicit MeshNeighbors(const Scene& scene) : boxes_(boxes_of_meshes(scene, float(kSamePlane) * scene.radius())) {
    std::vector<Index> order(boxes_.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](Index a, Index b) { return boxes_[a].low.x < boxes_[b].low.x; });
    of_.resize(boxes_.size());
    std::size_t tests = 0;
    for (std::size_t i = 0; i < order.size(); ++i)
      for (std::size_t j = i + 1; j < order.size() && boxes_[order[j]].low.x <= boxes_[order[i]].high.x; ++j) {
        if (++tests > kMaxBoxTests * boxes_.size()) {
          of_.clear();
          return;
        }
        if (!overlaps(boxes_[order[i]], boxes_[order[j]])) continue;
        of_[order[i]].push_back(order[j]);
        of_[order[j]].push_back(order[i]);
      }
  }

  /// Returns whether `test` is true for a mesh whose box meets this triangle; true if there are too many to test.
  template <typename Test>
  bool any(const Mesh& mesh, Index index, Index face, const Test& test) const {
    constexpr std::size_t kMaxTested = 64;  // testing more would take longer than what it saves
    if (of_.empty() || of_[index].size() > kMaxTested) return true;
    if (of_[index].empty()) return false;
    const auto at = [&](int k) { return mesh.positions[mesh.indices[3 * std::size_t(face) + k]]; };
    const SceneBox box{glm::min(glm::min(at(0), at(1)), at(2)), glm::max(glm::max(at(0), at(1)), at(2))};
    return std::any_of(of_[index].begin(), of_[index].end(),
                       [&](Index other) { return overlaps(box, boxes_[other]) && test(other); });
  }

 private:
  std::vector<SceneBox> boxes_;
  std::vector<std::vector<Index>> of_;  ///< for each mesh the others; empty: too many boxes to test
};

/// A triangle that may overlap one of another mesh, and its plane.
struct Candidate {
  Index mesh, face;
  glm::vec4 plane;
};

/// Returns the triangles whose box overlaps the box of another mesh, sorted by mesh and face.
std::vector<Candidate> candidates_of(const Scene& scene, const Triangles& triangles, const MeshNeighbors& neighbors,
                                     Poll* poll) {
  std::vector<std::vector<Candidate>> of_mesh(scene.meshes.size());
  for_each_index(scene.meshes.size(), poll, [&](std::size_t m, Poll* own) {
    const Mesh& mesh = scene.meshes[m];
    const std::size_t count = mesh.points ? 0 : mesh.indices.size() / 3;
    for (Index face = 0; face < count && !stops(own, face, count); ++face)
      if (neighbors.any(mesh, Index(m), face, [](Index) { return true; }))
        of_mesh[m].push_back({Index(m), face, triangles.plane(Index(m), face)});
  });
  std::vector<Candidate> result;
  for (std::vector<Candidate>& some : of_mesh) {
    result.insert(result.end(), some.begin(), some.end());
    some = {};
  }
  return result;
}

/// Returns the triangles in whose cell there are also triangles of a mesh that meets them, sorted by cell; also others,
/// whose cells share a bit in a table.
std::vector<Triangle> shared_planes(const Scene& scene, const std::vector<Candidate>& all,
                                    const MeshNeighbors& neighbors, float shift) {
  constexpr std::size_t kBits = 16;  // per triangle, so that cells rarely share one
  std::vector<bool> has_triangles(std::bit_ceil(kBits * all.size() + 1));
  const auto bit_of = [&](std::uint64_t cell, Index mesh) {
    const std::uint64_t hash = (cell ^ mesh) * 0x9e3779b97f4a7c15ull;
    return (hash ^ hash >> 32) & (has_triangles.size() - 1);
  };
  for (const Candidate& c : all) has_triangles[bit_of(cell_of(c.plane, shift), c.mesh)] = true;
  std::vector<Triangle> result;
  for (const Candidate& c : all) {
    const std::uint64_t cell = cell_of(c.plane, shift);
    const auto has = [&](Index other) { return bool(has_triangles[bit_of(cell, other)]); };
    if (neighbors.any(scene.meshes[c.mesh], c.mesh, c.face, has)) result.push_back({c.mesh, c.face, cell});
  }
  std::sort(result.begin(), result.end(), [](const Triangle& a, const Triangle& b) {
    return a.cell != b.cell ? a.cell < b.cell : id_of(a) < id_of(b);
  });
  return result;
}

/// Returns whether two triangles in about one plane are within kSamePlane of each other and overlap, by more than that.
bool overlap(const Corners& a, const Corners& b) {
  const glm::dvec3 normal_a = a.normal(), normal_b = b.normal();
  const bool by_a = glm::dot(normal_a, normal_a) >= glm::dot(normal_b, normal_b);
  const Corners &large = by_a ? a : b, &small = by_a ? b : a;
  const glm::dvec3 n = glm::normalize(by_a ? normal_a : normal_b);
  for (const glm::dvec3& p : small.at)
    if (std::abs(glm::dot(n, p - large.at[0])) > kSamePlane) return false;
  for (const Corners* of : {&a, &b})
    for (int k = 0; k < 3; ++k) {
      // Triangles are apart if one of their edges separates them.
      const glm::dvec3 axis = glm::cross(n, of->at[(k + 1) % 3] - of->at[k]);
      double low[2], high[2];
      for (int i = 0; i < 2; ++i) {
        const Corners& c = i == 0 ? a : b;
        const double x = glm::dot(axis, c.at[0]), y = glm::dot(axis, c.at[1]), z = glm::dot(axis, c.at[2]);
        low[i] = std::min({x, y, z});
        high[i] = std::max({x, y, z});
      }
      const double width = std::min(high[0], high[1]) - std::max(low[0], low[1]);
      if (width <= 0.0 || width * width <= 4.0 * kSamePlane * kSamePlane * glm::dot(axis, axis)) return false;
    }
  return true;
}

struct Boxed {
  Triangle triangle;
  Corners corners;
  glm::dvec3 low, high;
  bool is_above = false;  ///< overlaps a face of an earlier mesh
};

std::vector<Boxed> boxes_of(const Triangles& triangles, std::span<const Triangle> plane) {
  std::vector<Boxed> boxes;
  boxes.reserve(plane.size());
  for (const Triangle& t : plane) {
    const Corners c = triangles.corners(t.mesh, t.face);
    boxes.push_back(
        {t, c, glm::min(glm::min(c.at[0], c.at[1]), c.at[2]), glm::max(glm::max(c.at[0], c.at[1]), c.at[2])});
  }
  return boxes;
}

/// A bounding volume hierarchy over boxes, which is split at medians.
class BoxTree {
 public:
  explicit BoxTree(const std::vector<Boxed>& boxes) : boxes_(boxes), order_(boxes.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    add_node(0, Index(boxes.size()));
  }

  /// Calls `visit` with the index of each box of an earlier mesh that overlaps a box, until it returns false.
  template <typename Visit>
  void find_earlier(const Boxed& box, const Visit& visit) const {
    std::vector<Index> stack{0};
    while (!stack.empty()) {
      const Node& node = nodes_[stack.back()];
      stack.pop_back();
      if (node.min_mesh >= box.triangle.mesh || !meets(box, node.low, node.high)) continue;
      if (node.right != 0) {
        stack.push_back(node.right);
        stack.push_back(Index(&node - nodes_.data()) + 1);
        continue;
      }
      for (Index i = node.first; i < node.last; ++i) {
        const Boxed& other = boxes_[order_[i]];
        if (other.triangle.mesh < box.triangle.mesh && meets(box, other.low, other.high) && !visit(order_[i])) return;
      }
    }
  }

 private:
  struct Node {
    glm::dvec3 low{1e9}, high{-1e9};
    Index min_mesh = kNoIndex32, first = 0, last = 0,
          right = 0;  ///< the left child follows its parent; a leaf has none
  };

  static bool meets(const Boxed& box, const glm::dvec3& low, const glm::dvec3& high) {
    return glm::all(glm::lessThanEqual(box.low, high + kSamePlane)) &&
           glm::all(glm::lessThanEqual(low, box.high + kSamePlane));
  }

  Index add_node(Index first, Index last) {
    constexpr Index kMaxInLeaf = 8;
    Node node{.first = first, .last = last};
    for (Index i = first; i < last; ++i) {
      const Boxed& box = boxes_[order_[i]];
      node.low = glm::min(node.low, box.low);
      node.high = glm::max(node.high, box.high);
      node.min_mesh = std::min(node.min_mesh, box.triangle.mesh);
    }
    const auto index = Index(nodes_.size());
    nodes_.push_back(node);
    if (last - first <= kMaxInLeaf) return index;
    const glm::dvec3 size = node.high - node.low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const Index middle = first + (last - first) / 2;
    const auto center = [&](Index i) { return boxes_[i].low[axis] + boxes_[i].high[axis]; };
    std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                     [&](Index a, Index b) { return center(a) < center(b); });
    add_node(first, middle);
    nodes_[index].right = add_node(middle, last);
    return index;
  }

  const std::vector<Boxed>& boxes_;
  std::vector<Index> order_;
  std::vector<Node> nodes_;
};

/// Meshes of which a face of the second overlaps one of the first, which is earlier.
using MeshPairs = std::set<std::pair<Index, Index>>;

/// Finds overlaps among triangles of one cell. Returns false if there are too many to test. Stops if the poll ends.
bool find_overlaps(std::vector<Boxed>& boxes, Poll* poll, MeshPairs& pairs) {
  constexpr std::size_t kTestsPerPoll = 4096;
  const BoxTree tree(boxes);
  std::size_t tests = 0;
  bool is_complete = true;
  for (std::size_t i = boxes.size();
       i-- > 0 && is_complete && !(poll && poll->ended());) {  // the last mesh of a stack overlaps most
    Boxed& above = boxes[i];
    tree.find_earlier(above, [&](Index j) {
      is_complete = ++tests <= kMaxBoxTests * boxes.size() && pairs.size() <= kMaxMeshPairs * boxes.size();
      if (!is_complete || (poll && tests % kTestsPerPoll == 0 && poll->passing(0.0))) return false;
      const std::pair<Index, Index> meshes(boxes[j].triangle.mesh, above.triangle.mesh);
      if ((above.is_above && pairs.contains(meshes)) || !overlap(boxes[j].corners, above.corners)) return true;
      above.is_above = true;
      pairs.insert(meshes);
      return true;
    });
  }
  return is_complete;
}

/// Returns the faces of one cell that are to be moved.
std::vector<RaisedFace> raised_faces(const Scene& scene, const Triangles& triangles, std::span<const Triangle> plane,
                                     Poll* poll) {
  std::vector<Boxed> boxes = boxes_of(triangles, plane);
  MeshPairs pairs;
  if (!find_overlaps(boxes, poll, pairs)) {
    pairs.clear();
    std::set<Index> meshes;
    for (Boxed& box : boxes) meshes.insert(box.triangle.mesh);
    for (Boxed& box : boxes) box.is_above = box.triangle.mesh != *meshes.begin();
    for (auto mesh = meshes.begin(); std::next(mesh) != meshes.end(); ++mesh) pairs.insert({*mesh, *std::next(mesh)});
  }
  std::map<Index, int> level_of;  // pairs are sorted by the earlier mesh, whose level is final by then
  for (const auto& [below, above] : pairs)
    level_of[above] = std::max(level_of[above], std::min(level_of[below] + 1, kMaxLevel));
  const auto earliest = std::min_element(plane.begin(), plane.end(),
                                         [](const Triangle& a, const Triangle& b) { return a.mesh < b.mesh; });
  const glm::vec3 side = facing_normal(scene.meshes[earliest->mesh], earliest->face);
  std::vector<RaisedFace> raised;
  for (const Boxed& box : boxes)
    if (box.is_above) raised.push_back({box.triangle, level_of[box.triangle.mesh], side});
  return raised;
}

/// The movement of a point of a mesh along the normal of one of its faces.
struct Move {
  Index point;
  glm::vec3 normal;
  int level;
};

void move_points(Mesh& mesh, const std::vector<Index>& point_of, std::vector<Move>& moves, float step) {
  // The face that moves further comes first; others of the same plane are then left out.
  std::sort(moves.begin(), moves.end(),
            [](const Move& a, const Move& b) { return a.point != b.point ? a.point < b.point : a.level > b.level; });
  std::unordered_map<Index, glm::vec3> offset_of;
  std::vector<glm::vec3> normals;
  constexpr float kSameNormal = 0.999f;
  for (std::size_t i = 0; i < moves.size(); ++i) {
    if (i == 0 || moves[i].point != moves[i - 1].point) normals.clear();
    const glm::vec3 n = moves[i].normal;
    if (std::any_of(normals.begin(), normals.end(), [&](const glm::vec3& m) { return glm::dot(m, n) > kSameNormal; }))
      continue;
    normals.push_back(n);
    offset_of[moves[i].point] += step * float(moves[i].level) * n;
  }
  for (Index v = 0; v < mesh.positions.size(); ++v)
    if (const auto found = offset_of.find(point_of[v]); found != offset_of.end()) mesh.positions[v] += found->second;
}

/// Adds the vertices of a face of a mesh, moved, as a triangle of another mesh.
void add_moved_face(const Mesh& from, Index face, const glm::vec3& offset, Mesh& to) {
  for (Index corner = 3 * face; corner < 3 * face + 3; ++corner) {
    const Index v = from.indices[corner];
    to.indices.push_back(Index(to.positions.size()));
    to.positions.push_back(from.positions[v] + offset);
    to.normals.push_back(from.normals[v]);
    if (!from.uvs.empty()) to.uvs.push_back(from.uvs[v]);
    if (!from.colors.empty()) to.colors.push_back(from.colors[v]);
    append_vertex_values(from, v, to);
  }
}

/// Returns each raised face once, with its max level, sorted by mesh. A face is in the cells of both shifts.
std::vector<RaisedFace> unique_faces(std::vector<RaisedFace> raised) {
  std::sort(raised.begin(), raised.end(), [](const RaisedFace& a, const RaisedFace& b) {
    return id_of(a.triangle) != id_of(b.triangle) ? id_of(a.triangle) < id_of(b.triangle) : a.level > b.level;
  });
  const auto same = [](const RaisedFace& a, const RaisedFace& b) { return id_of(a.triangle) == id_of(b.triangle); };
  raised.erase(std::unique(raised.begin(), raised.end(), same), raised.end());
  return raised;
}

}  // namespace

std::size_t separate_coplanar_faces(Scene& scene, Poll* poll) {
  const auto has_faces = [](const Mesh& mesh) { return !mesh.points; };
  if (poll && poll->ended()) return 0;
  if (std::count_if(scene.meshes.begin(), scene.meshes.end(), has_faces) < 2 || !(scene.radius() > 0.0f)) return 0;
  std::vector<RaisedFace> raised;
  {
    const Triangles triangles(scene);
    const MeshNeighbors neighbors(scene);
    const std::vector<Candidate> candidates = candidates_of(scene, triangles, neighbors, poll);
    if (poll && poll->ended()) return 0;
    std::vector<Triangle> shared_with[2];  // planes on both sides of a border of cells are together in the other
    for_each_index(2, poll, [&](std::size_t k, Poll*) {
      shared_with[k] = shared_planes(scene, candidates, neighbors, 0.5f * float(k));
    });
    for (const std::vector<Triangle>& shared : shared_with) {
      std::vector<std::span<const Triangle>> planes;
      for (std::size_t first = 0, last = 0; first < shared.size(); first = last) {
        while (last < shared.size() && shared[last].cell == shared[first].cell) ++last;
        if (shared[first].mesh != shared[last - 1].mesh)
          planes.push_back(std::span(shared).subspan(first, last - first));
      }
      std::vector<std::vector<RaisedFace>> raised_in(planes.size());
      for_each_index(planes.size(), poll,
                     [&](std::size_t i, Poll* own) { raised_in[i] = raised_faces(scene, triangles, planes[i], own); });
      for (const std::vector<RaisedFace>& some : raised_in) raised.insert(raised.end(), some.begin(), some.end());
    }
    if (poll && poll->ended()) return 0;
  }
  raised = unique_faces(std::move(raised));
  const float step = float(kStep) * scene.radius();
  const SceneBox bounds{scene.bounds_min, scene.bounds_max};
  const float max_move = 3.0f * float(kMaxLevel) * step;  // along three normals; strays are farther outside
  std::vector<Mesh> backs;
  for (std::size_t first = 0, last = 0; first < raised.size(); first = last) {
    if (poll && poll->passing(0.0)) return 0;
    Mesh& mesh = scene.meshes[raised[first].triangle.mesh];
    const std::vector<Index> point_of = joined_vertices(mesh).point_of;
    std::vector<Move> moves;
    Mesh& back = backs.emplace_back();
    back.material = mesh.material;
    back.object = mesh.object;
    const bool is_blended = scene.materials[std::size_t(mesh.material)].blended;  // would be seen twice
    for (; last < raised.size() && raised[last].triangle.mesh == raised[first].triangle.mesh; ++last) {
      const Index* corner = &mesh.indices[3 * raised[last].triangle.face];
      glm::vec3 normal = facing_normal(mesh, raised[last].triangle.face);
      if (glm::dot(normal, raised[last].side) < 0.0f) normal = -normal;
      for (int k = 0; k < 3; ++k) moves.push_back({point_of[corner[k]], normal, raised[last].level});
      if (!is_blended && glm::dot(normal, scene.up) < -kDown)
        add_moved_face(mesh, raised[last].triangle.face, -step * float(raised[last].level) * normal, back);
    }
    move_points(mesh, point_of, moves, step);
    for (const glm::vec3& p : mesh.positions) {
      if (!is_within(p, max_move, bounds)) continue;
      scene.bounds_min = glm::min(scene.bounds_min, p);
      scene.bounds_max = glm::max(scene.bounds_max, p);
    }
  }
  for (Mesh& back : backs)
    if (!back.indices.empty()) scene.meshes.push_back(std::move(back));
  return raised.size();
}

}  // namespace umbrage
