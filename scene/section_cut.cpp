// Parts of a model, and meshes cut by a plane. A new vertex depends on the positions of its edge alone, not on the
// order of the triangles there, so that neighbouring triangles, also those of files without shared vertices, stay
// joined.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <unordered_map>

#include "scene/mesh_corners.h"
#include "scene/section_parts.h"

namespace umbrage {
namespace {

constexpr std::uint32_t kNoVertex = kNoIndex32;

/// The box and the volume of a part, scene units.
struct PartExtent {
  glm::vec3 low{std::numeric_limits<float>::max()}, high{std::numeric_limits<float>::lowest()};
  double volume = 0.0;      ///< negative if its triangles face inward
  std::uint64_t edges = 0;  ///< of the hashes of its edges, all that occur an odd number of times; 0: it is closed
  int object = 0;

  void add(const std::array<glm::vec3, 3>& p, const std::uint32_t (&vertices)[3]) {
    volume += glm::dot(glm::dvec3(p[0]), glm::cross(glm::dvec3(p[1]), glm::dvec3(p[2]))) / 6.0;
    for (std::size_t k = 0; k < 3; ++k) {
      low = glm::min(low, p[k]), high = glm::max(high, p[k]);
      const auto [a, b] = std::minmax(vertices[k], vertices[(k + 1) % 3]);
      std::uint64_t h = (std::uint64_t(a) << 32 | b) * 0x9e3779b97f4a7c15ull;
      h = (h ^ (h >> 31)) * 0xbf58476d1ce4e5b9ull;
      edges ^= h ^ (h >> 29);
    }
  }
  double size() const { return double(high.x - low.x) * double(high.y - low.y) * double(high.z - low.z); }
};

/// Makes the open pieces of an object one part: in many files, cracks divide the surface of a body.
void join_open(const std::vector<PartExtent>& extents, std::vector<std::uint32_t>& whole_of) {
  std::map<int, std::uint32_t> first_of;  // by object
  for (std::uint32_t k = 0; k < extents.size(); ++k)
    if (extents[k].edges != 0) whole_of[k] = first_of.try_emplace(extents[k].object, k).first->second;
}

/// Makes the surfaces of cavities, which face inward, parts of the smallest solid around them.
void join_cavities(const std::vector<PartExtent>& extents, std::vector<std::uint32_t>& whole_of) {
  std::vector<std::uint32_t> solids, cavities;
  for (std::uint32_t k = 0; k < extents.size(); ++k) {
    if (extents[k].volume > 0.0) solids.push_back(k);
    if (extents[k].volume < 0.0 && extents[k].edges == 0) cavities.push_back(k);
  }
  for (const std::uint32_t cavity : cavities) {
    const PartExtent& inner = extents[cavity];
    std::uint32_t best = kNoVertex;
    for (const std::uint32_t solid : solids) {
      const PartExtent& outer = extents[solid];
      if (outer.object != inner.object || outer.volume < -inner.volume || glm::min(outer.low, inner.low) != outer.low ||
          glm::max(outer.high, inner.high) != outer.high)
        continue;
      if (best == kNoVertex || outer.size() < extents[best].size()) best = solid;
    }
    if (best != kNoVertex) whole_of[cavity] = whole_of[best];
  }
}

/// A mesh that is cut.
class MeshCutter {
 public:
  MeshCutter(const CutPlane& plane, PartedMesh& from, std::vector<CutSegment>& segments)
      : plane_(plane), from_(from.mesh), parted_(from), segments_(segments) {
    distances_.reserve(from_.positions.size());
    for (const glm::vec3& p : from_.positions) distances_.push_back(plane_.distance(p));
  }

  bool is_whole() const {
    return std::all_of(distances_.begin(), distances_.end(), [](double d) { return d < 0.0; });
  }

  void cut() {
    numbers_.assign(from_.positions.size(), kNoVertex);
    to_.name = from_.name, to_.material = from_.material, to_.object = from_.object;
    to_.points = from_.points, to_.spheres = from_.spheres;
    if (from_.points) {
      for (std::uint32_t k = 0; k < from_.positions.size(); ++k)
        if (distances_[k] < 0.0) copied(k);
    } else {
      for (std::size_t i = 0; i < from_.indices.size(); i += 3) cut_triangle(i);
    }
    from_ = std::move(to_);
    parted_.parts = std::move(parts_);
  }

 private:
  /// Returns the number of a vertex in the new mesh.
  std::uint32_t copied(std::uint32_t vertex) {
    if (numbers_[vertex] != kNoVertex) return numbers_[vertex];
    numbers_[vertex] = std::uint32_t(to_.positions.size());
    append(vertex, vertex, 0.0, from_.positions[vertex]);
    return numbers_[vertex];
  }

  /// Returns the number of the vertex at which an edge meets the plane, one end of which stays.
  std::uint32_t crossing(std::uint32_t a, std::uint32_t b) {
    const glm::vec3 &p = from_.positions[a], &q = from_.positions[b];
    if (std::array{p.x, p.y, p.z} > std::array{q.x, q.y, q.z}) std::swap(a, b);
    const auto [found, is_new] =
        crossings_.try_emplace(std::uint64_t(a) << 32 | b, std::uint32_t(to_.positions.size()));
    if (!is_new) return found->second;
    const double t = distances_[a] / (distances_[a] - distances_[b]);
    const glm::dvec3 from(from_.positions[a]), to(from_.positions[b]);
    glm::vec3 position(t == 0.0 ? from : t == 1.0 ? to : from + t * (to - from));
    for (int k = 0; k < 3; ++k)
      if (std::abs(plane_.normal[k]) == 1.0) position[k] = float(plane_.normal[k] * plane_.offset);
    append(a, b, t, position);
    return found->second;
  }

  void append(std::uint32_t a, std::uint32_t b, double t, const glm::vec3& position) {
    const auto mix = [&](const auto& from, auto& to) {
      if (!from.empty()) to.push_back(a == b ? from[a] : from[a] + float(t) * (from[b] - from[a]));
    };
    to_.positions.push_back(position);
    mix(from_.normals, to_.normals);
    if (a != b && !to_.normals.empty()) {
      glm::vec3& normal = to_.normals.back();
      const float length = glm::length(normal);
      normal = length > 0.0f ? normal / length : from_.normals[a];
    }
    mix(from_.uvs, to_.uvs);
    mix(from_.colors, to_.colors);
    mix(from_.radii, to_.radii);
    mix(from_.bends, to_.bends);
  }

  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t part) {
    const glm::vec3 &p = to_.positions[a], &q = to_.positions[b], &r = to_.positions[c];
    if (p == q || q == r || r == p) return;
    to_.indices.insert(to_.indices.end(), {a, b, c});
    parts_.push_back(part);
  }

  void cut_triangle(std::size_t first) {
    const std::uint32_t* const corners = &from_.indices[first];
    const std::uint32_t part = parted_.parts[first / 3];
    const int kept = (distances_[corners[0]] < 0.0) + (distances_[corners[1]] < 0.0) + (distances_[corners[2]] < 0.0);
    if (kept == 0) return;
    if (kept == 3) {
      add_triangle(copied(corners[0]), copied(corners[1]), copied(corners[2]), part);
      return;
    }
    // From the corner that is alone on its side.
    int alone = 0;
    while ((distances_[corners[alone]] < 0.0) != (kept == 1)) ++alone;
    const std::uint32_t a = corners[alone], b = corners[(alone + 1) % 3], c = corners[(alone + 2) % 3];
    const std::uint32_t ab = crossing(a, b), ac = crossing(a, c);
    if (kept == 1) {
      add_triangle(copied(a), ab, ac, part);
    } else {
      add_triangle(ab, copied(b), copied(c), part);
      add_triangle(ab, copied(c), ac, part);
    }
    const glm::vec3 &from = to_.positions[kept == 1 ? ac : ab], &to = to_.positions[kept == 1 ? ab : ac];
    if (from != to) segments_.push_back({part, from, to});
  }

  const CutPlane& plane_;
  Mesh& from_;
  PartedMesh& parted_;
  std::vector<CutSegment>& segments_;
  std::vector<double> distances_;
  Mesh to_;
  std::vector<std::uint32_t> parts_, numbers_;
  std::unordered_map<std::uint64_t, std::uint32_t> crossings_;
};

}  // namespace

std::uint32_t find_parts(std::vector<PartedMesh>& meshes) {
  std::vector<std::pair<int, glm::vec3>> vertices;  // of all meshes: object and position
  std::vector<std::size_t> first_of;
  for (const auto& [mesh, parts, cap_of] : meshes) {
    first_of.push_back(vertices.size());
    for (std::size_t k = 0; !mesh.points && k < mesh.positions.size(); ++k)
      vertices.emplace_back(mesh.object, mesh.positions[k]);
  }
  std::uint32_t count = 0;
  const std::vector<std::uint32_t> numbers = number_items(
      vertices.size(), count, [&](MeshIndex i) { return mix_bits(hash_of(vertices[i].second) + vertices[i].first); },
      [&](MeshIndex i, MeshIndex j) { return vertices[i] == vertices[j]; });
  std::vector<std::uint32_t> parents(count);
  std::iota(parents.begin(), parents.end(), 0u);
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const std::vector<std::uint32_t>& indices = meshes[m].mesh.indices;
    for (std::size_t i = 0; i < indices.size(); ++i)
      parents[root_of(parents, numbers[first_of[m] + indices[i]])] =
          root_of(parents, numbers[first_of[m] + indices[i - i % 3]]);
  }
  std::vector<std::uint32_t> number_of(parents.size(), kNoVertex);  // of parts, by root
  std::vector<PartExtent> extents;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const Mesh& mesh = meshes[m].mesh;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
      const std::uint32_t* const corners = &mesh.indices[i];
      std::uint32_t ends[3];
      for (std::size_t k = 0; k < 3; ++k) ends[k] = numbers[first_of[m] + corners[k]];
      std::uint32_t& number = number_of[root_of(parents, ends[0])];
      if (number == kNoVertex) number = std::uint32_t(extents.size()), extents.emplace_back().object = mesh.object;
      meshes[m].parts.push_back(number);
      extents[number].add({mesh.positions[corners[0]], mesh.positions[corners[1]], mesh.positions[corners[2]]}, ends);
    }
  }
  std::vector<std::uint32_t> whole_of(extents.size());
  std::iota(whole_of.begin(), whole_of.end(), 0u);
  join_open(extents, whole_of);
  join_cavities(extents, whole_of);
  for (PartedMesh& each : meshes)
    for (std::uint32_t& part : each.parts) part = whole_of[part];
  return std::uint32_t(extents.size());
}

void cut_mesh(const CutPlane& plane, PartedMesh& mesh, std::vector<CutSegment>& segments) {
  MeshCutter cutter(plane, mesh, segments);
  if (!cutter.is_whole()) cutter.cut();
}

}  // namespace umbrage
