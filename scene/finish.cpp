// The last step of building a scene: normals, removal of unusable triangles, bounds. Normals are weighted by the angle
// of the face at the vertex [Thürmer and Wüthrich 1998], so that they do not depend on how a polygon was triangulated.
#include "scene/finish.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>

#include "core/check.h"
#include "scene/strays.h"

namespace umbrage {
namespace {

using Index = std::uint32_t;
constexpr Index kNone = std::numeric_limits<Index>::max();

/// A triangle is degenerate if its doubled area is below this fraction of its longest edge squared: its width is then
/// less than a ten-millionth of its length, which is the precision of a float, and its normal is noise.
constexpr double kDegenerate = 1e-7;

/// Larger coordinates count as not finite, so that squares of lengths stay in the range of floats.
constexpr float kMaxCoordinate = 1e15f;

/// Normals of a file that are shorter count as missing.
constexpr float kMinNormalLength = 1e-12f;

constexpr glm::vec3 kAnyNormal{0.0f, 1.0f, 0.0f};

bool usable(const glm::vec3& p) {
  return std::abs(p.x) <= kMaxCoordinate && std::abs(p.y) <= kMaxCoordinate && std::abs(p.z) <= kMaxCoordinate;
}

struct Face {
  glm::vec3 normal{0.0f};      ///< unit, or zero for a face without area
  float angle[3] = {0, 0, 0};  ///< angles at its corners, radians
};

bool is_degenerate(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const glm::dvec3 ab = glm::dvec3(b) - glm::dvec3(a), ac = glm::dvec3(c) - glm::dvec3(a), bc = ac - ab;
  const double longest = std::max({glm::dot(ab, ab), glm::dot(ac, ac), glm::dot(bc, bc)});
  const glm::dvec3 area = glm::cross(ab, ac);
  return !(glm::dot(area, area) > kDegenerate * kDegenerate * longest * longest);
}

/// Returns whether a triangle can be drawn.
bool is_drawable(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  return usable(a) && usable(b) && usable(c) && !is_degenerate(a, b, c);
}

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

/// Returns the bits of a float, the same for 0 and -0.
std::uint32_t bits_of(float x) { return std::bit_cast<std::uint32_t>(x + 0.0f); }

std::uint64_t mix_bits(std::uint64_t x) {
  x ^= x >> 32;
  x *= 0xd6e8feb86659fd93ull;
  x ^= x >> 32;
  return x;
}

/// Returns the number of each item. Equal items have the same number; numbers start at 0, in order of appearance.
/// `distinct` receives how many numbers there are.
template <class Hash, class Equal>
std::vector<Index> number_items(std::size_t count, Index& distinct, Hash hash, Equal equal) {
  const std::size_t slots = std::bit_ceil(std::max<std::size_t>(16, count + count / 2));
  struct Slot {
    Index item, number;
  };
  std::vector<Slot> table(slots, Slot{kNone, 0});
  std::vector<Index> number_of(count);
  distinct = 0;
  for (Index i = 0; i < count; ++i) {
    std::size_t slot = hash(i) & (slots - 1);
    while (table[slot].item != kNone && !equal(table[slot].item, i)) slot = (slot + 1) & (slots - 1);
    if (table[slot].item == kNone) table[slot] = {i, distinct++};
    number_of[i] = table[slot].number;
  }
  return number_of;
}

std::uint64_t hash_of(const glm::vec3& p) {
  return mix_bits(mix_bits(std::uint64_t(bits_of(p.x)) << 32 | bits_of(p.y)) + bits_of(p.z));
}
std::uint64_t hash_of(const glm::vec2& p) { return mix_bits(std::uint64_t(bits_of(p.x)) << 32 | bits_of(p.y)); }
bool same(const glm::vec3& a, const glm::vec3& b) {
  return bits_of(a.x) == bits_of(b.x) && bits_of(a.y) == bits_of(b.y) && bits_of(a.z) == bits_of(b.z);
}
bool same(const glm::vec2& a, const glm::vec2& b) {
  return bits_of(a.x) == bits_of(b.x) && bits_of(a.y) == bits_of(b.y);
}

/// Groups the corners around one point: `group[i]` is the first corner of i's group. Two corners belong to one group if
/// their faces share an edge at the point and meet within the crease angle.
struct CornerGroups {
  /// An edge of a face from the point to a neighbour.
  struct Spoke {
    Index neighbor, corner;
  };
  std::vector<Spoke> spokes;
  std::vector<Index> group;

  Index root(Index i) {
    while (group[i] != i) i = group[i] = group[group[i]];
    return i;
  }

  void make(const Index* corners, Index count, const std::vector<Index>& indices, const std::vector<Index>& point_of,
            const std::vector<Face>& faces, float crease_cos) {
    spokes.clear();
    group.resize(count);
    std::iota(group.begin(), group.end(), 0u);
    for (Index i = 0; i < count; ++i) {
      const Index first = corners[i] / 3 * 3, corner_of_face = corners[i] % 3;
      spokes.push_back({point_of[indices[first + (corner_of_face + 1) % 3]], i});
      spokes.push_back({point_of[indices[first + (corner_of_face + 2) % 3]], i});
    }
    std::sort(spokes.begin(), spokes.end(), [](const Spoke& a, const Spoke& b) {
      return a.neighbor != b.neighbor ? a.neighbor < b.neighbor : a.corner < b.corner;
    });
    constexpr std::size_t kMaxFacesCompared = 8;  // bounds the work if thousands of faces share one edge
    std::size_t run = 0;
    for (std::size_t i = 1; i < spokes.size(); ++i) {
      if (spokes[i].neighbor != spokes[run].neighbor) run = i;
      for (std::size_t j = std::max(run, i - std::min(i, kMaxFacesCompared)); j < i; ++j) {
        const Index a = spokes[i].corner, b = spokes[j].corner;
        if (glm::dot(faces[corners[a] / 3].normal, faces[corners[b] / 3].normal) < crease_cos) continue;
        const Index root_a = root(a), root_b = root(b);
        group[std::max(root_a, root_b)] = std::min(root_a, root_b);
      }
    }
    for (Index i = 0; i < count; ++i) group[i] = root(i);
  }
};

/// Keeps the vertices for which `used` is set, in order.
void compact(Mesh& mesh, const std::vector<std::uint8_t>& used) {
  std::vector<Index> number_of(used.size(), kNone);
  Index count = 0;
  for (Index v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    mesh.positions[count] = mesh.positions[v];
    if (!mesh.normals.empty()) mesh.normals[count] = mesh.normals[v];
    if (!mesh.uvs.empty()) mesh.uvs[count] = mesh.uvs[v];
    if (!mesh.colors.empty()) mesh.colors[count] = mesh.colors[v];
    number_of[v] = count++;
  }
  mesh.positions.resize(count);
  if (!mesh.normals.empty()) mesh.normals.resize(count);
  if (!mesh.uvs.empty()) mesh.uvs.resize(count);
  if (!mesh.colors.empty()) mesh.colors.resize(count);
  for (Index& index : mesh.indices) index = number_of[index];
}

/// Removes triangles that cannot be drawn and vertices without triangles. Returns the number of removed triangles.
std::size_t clean_triangles(Mesh& mesh) {
  const std::size_t before = (mesh.indices.size() + 2) / 3;
  std::vector<std::uint8_t> used(mesh.positions.size(), 0);
  std::size_t kept = 0;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const Index a = mesh.indices[i], b = mesh.indices[i + 1], c = mesh.indices[i + 2];
    if (std::max({a, b, c}) >= mesh.positions.size()) continue;
    const glm::vec3 &p = mesh.positions[a], &q = mesh.positions[b], &r = mesh.positions[c];
    if (!is_drawable(p, q, r)) continue;
    mesh.indices[kept++] = a;
    mesh.indices[kept++] = b;
    mesh.indices[kept++] = c;
    used[a] = used[b] = used[c] = 1;
  }
  mesh.indices.resize(kept);
  if (std::find(used.begin(), used.end(), 0) != used.end()) compact(mesh, used);
  return before - kept / 3;
}

/// Normalizes the normals. Replaces those that are zero or not finite by the angle-weighted average of the faces at the
/// vertex. Returns false if no normal is valid.
bool repair_normals(Mesh& mesh) {
  std::vector<Index> bad;
  for (Index v = 0; v < mesh.normals.size(); ++v) {
    const glm::dvec3 normal(mesh.normals[v]);
    const double length = glm::length(normal);
    if (length > kMinNormalLength && std::isfinite(length)) {
      mesh.normals[v] = glm::vec3(normal / length);
    } else {
      bad.push_back(v);
      mesh.normals[v] = glm::vec3(0.0f);
    }
  }
  if (bad.size() == mesh.normals.size()) return false;
  if (bad.empty()) return true;
  std::vector<std::uint8_t> is_bad(mesh.normals.size(), 0);
  for (Index v : bad) is_bad[v] = 1;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const Index* corner = &mesh.indices[i];
    if (!is_bad[corner[0]] && !is_bad[corner[1]] && !is_bad[corner[2]]) continue;
    const Face face = face_of(mesh.positions[corner[0]], mesh.positions[corner[1]], mesh.positions[corner[2]]);
    for (int k = 0; k < 3; ++k) {
      if (is_bad[corner[k]]) mesh.normals[corner[k]] += face.angle[k] * face.normal;
    }
  }
  for (Index v : bad) {
    const float length = glm::length(mesh.normals[v]);
    mesh.normals[v] = length > kMinNormalLength ? mesh.normals[v] / length : kAnyNormal;
  }
  return true;
}

bool has_uvs(const Mesh& mesh) { return mesh.uvs.size() == mesh.positions.size() && !mesh.uvs.empty(); }
bool has_colors(const Mesh& mesh) { return mesh.colors.size() == mesh.positions.size() && !mesh.colors.empty(); }

/// Vertices grouped by equality. Vertices at equal positions are one point. Those that also have equal texture
/// coordinates and colours can become one vertex.
struct JoinedVertices {
  std::vector<Index> point_of, joined;  ///< joined: empty if each point can become one vertex
  Index point_count = 0, vertex_count = 0;
  const std::vector<Index>& vertex_of() const { return joined.empty() ? point_of : joined; }
};

JoinedVertices joined_vertices(const Mesh& mesh) {
  const std::vector<glm::vec3>& positions = mesh.positions;
  const bool uvs = has_uvs(mesh), colors = has_colors(mesh);
  JoinedVertices result;
  result.point_of = number_items(
      positions.size(), result.point_count, [&](Index i) { return hash_of(positions[i]); },
      [&](Index i, Index j) { return same(positions[i], positions[j]); });
  result.vertex_count = result.point_count;
  if (!uvs && !colors) return result;
  const std::vector<Index>& point_of = result.point_of;
  result.joined = number_items(
      positions.size(), result.vertex_count,
      [&](Index i) {
        const std::uint64_t hash = uvs ? mix_bits(hash_of(mesh.uvs[i]) + point_of[i]) : point_of[i];
        return colors ? mix_bits(hash_of(mesh.colors[i]) + hash) : hash;
      },
      [&](Index i, Index j) {
        return point_of[i] == point_of[j] && (!uvs || same(mesh.uvs[i], mesh.uvs[j])) &&
               (!colors || same(mesh.colors[i], mesh.colors[j]));
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

/// The corners around each point, stored in one array.
struct CornerLists {
  std::vector<Index> first, corners;
  std::span<const Index> around(Index point) const {
    return {corners.data() + first[point], corners.data() + first[point + 1]};
  }
};

CornerLists corner_lists(const std::vector<Index>& indices, const JoinedVertices& vertices) {
  CornerLists result{std::vector<Index>(vertices.point_count + 1, 0), std::vector<Index>(indices.size())};
  for (const Index index : indices) ++result.first[vertices.point_of[index] + 1];
  for (Index p = 0; p < vertices.point_count; ++p) result.first[p + 1] += result.first[p];
  std::vector<Index> next(result.first.begin(), result.first.end() - 1);
  for (Index corner = 0; corner < indices.size(); ++corner)
    result.corners[next[vertices.point_of[indices[corner]]]++] = corner;
  return result;
}

/// Creates vertices from groups of corners that share a normal.
class VertexMaker {
 public:
  VertexMaker(const Mesh& mesh, const std::vector<Face>& faces, const JoinedVertices& vertices)
      : mesh_(mesh), faces_(faces), vertex_of_(vertices.vertex_of()), uvs_(has_uvs(mesh)), colors_(has_colors(mesh)) {
    latest_.resize(vertices.vertex_count);
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
      }
      new_mesh_.indices[corner] = latest.vertex;
    }
    ++group_number_;
  }

  /// Returns a mesh of positions, normals, texture coordinates, colours and indices.
  Mesh take() { return std::move(new_mesh_); }

 private:
  /// The new vertex that was created last for an old vertex, and the number of its group.
  struct Latest {
    Index group = kNone, vertex = 0;
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

/// Returns whether all faces at a point are within half the crease angle of their mean, so that each pair is within the
/// crease angle. A fast test that is true for most points.
bool is_smooth(std::span<const Index> corners, const std::vector<Face>& faces, float half_crease_cos) {
  glm::vec3 mean(0.0f);
  for (const Index corner : corners) mean += faces[corner / 3].normal;
  const float min = half_crease_cos * glm::length(mean);
  return min > 0.0f && std::all_of(corners.begin(), corners.end(),
                                   [&](Index corner) { return glm::dot(mean, faces[corner / 3].normal) >= min; });
}

}  // namespace

void make_normals(Mesh& mesh, float crease_angle_deg, Poll* poll) {
  for (Index index : mesh.indices) check_less(index, mesh.positions.size(), "vertex index");
  const float crease_deg = std::clamp(crease_angle_deg, 0.0f, 180.0f);
  constexpr float kRounding = 1e-5f;  // keeps faces together that are parallel up to rounding, at a crease angle of 0
  const float crease_cos = std::cos(glm::radians(crease_deg)) - kRounding;
  const float half_crease_cos = std::cos(glm::radians(crease_deg / 2.0f));
  const bool all_smooth = crease_deg >= 180.0f;

  const auto is_ended = [&] { return poll && poll->passing(0.0); };
  const JoinedVertices vertices = joined_vertices(mesh);
  if (is_ended()) return;
  const std::vector<Face> faces = faces_of(mesh);
  if (is_ended()) return;
  const CornerLists lists = corner_lists(mesh.indices, vertices);
  VertexMaker maker(mesh, faces, vertices);
  CornerGroups groups;
  std::vector<Index> order, members;
  for (Index p = 0; p < vertices.point_count; ++p) {
    if (stops(poll, p, vertices.point_count)) return;
    const std::span<const Index> around = lists.around(p);
    if (around.empty()) continue;
    if (all_smooth || is_smooth(around, faces, half_crease_cos)) {
      maker.add_group(around);
      continue;
    }
    const Index count = Index(around.size());
    groups.make(around.data(), count, mesh.indices, vertices.point_of, faces, crease_cos);
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
  Mesh result = maker.take();
  mesh.positions = std::move(result.positions);
  mesh.normals = std::move(result.normals);
  mesh.uvs = std::move(result.uvs);
  mesh.colors = std::move(result.colors);
  mesh.indices = std::move(result.indices);
}

void add_triangles(const Mesh& mesh, const glm::mat4& world_from_mesh, SceneBox& box) {
  const auto at = [&](Index vertex) { return glm::vec3(world_from_mesh * glm::vec4(mesh.positions[vertex], 1.0f)); };
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const Index* corner = &mesh.indices[i];
    if (std::max({corner[0], corner[1], corner[2]}) >= mesh.positions.size()) continue;
    const glm::vec3 corners[3] = {at(corner[0]), at(corner[1]), at(corner[2])};
    if (!is_drawable(corners[0], corners[1], corners[2])) continue;
    for (const glm::vec3& p : corners) box = {glm::min(box.low, p), glm::max(box.high, p)};
  }
}

namespace {

/// Sets the bounds to the box of all vertices and points, or of all but strays, and warns of these.
Strays set_bounds(Scene& scene, BoundsOf bounds) {
  SceneBox all;
  for (const Mesh& mesh : scene.meshes) {
    for (const glm::vec3& p : mesh.positions) all = {glm::min(all.low, p), glm::max(all.high, p)};
  }
  const Strays strays = bounds == BoundsOf::kAll ? Strays{.rest = all} : find_strays(scene, all);
  if (strays.any()) scene.warnings.push_back(strays_text(strays));
  scene.bounds_min = scene.meshes.empty() ? glm::vec3(0.0f) : strays.rest.low;
  scene.bounds_max = scene.meshes.empty() ? glm::vec3(0.0f) : strays.rest.high;
  return strays;
}

}  // namespace

std::size_t finish_scene(Scene& scene, std::optional<float> crease_angle_deg, const PointSettings& points, Poll* poll,
                         BoundsOf bounds) {
  std::size_t dropped = 0;
  if (scene.materials.empty()) scene.materials.emplace_back();
  for (Material& material : scene.materials) {
    for (int* texture : textures_of(material)) {
      if (*texture < 0 || *texture >= int(scene.textures.size())) *texture = kNoTexture;
    }
  }
  for (Mesh& mesh : scene.meshes) {
    if (poll && poll->passing(0.0)) return dropped;
    if (mesh.normals.size() != mesh.positions.size()) mesh.normals.clear();
    if (mesh.uvs.size() != mesh.positions.size()) mesh.uvs.clear();
    if (mesh.colors.size() != mesh.positions.size()) mesh.colors.clear();
    if (mesh.radii.size() != mesh.positions.size()) mesh.radii.clear();
    if (mesh.bends.size() != mesh.positions.size()) mesh.bends.clear();
    for (glm::vec3& color : mesh.colors) {
      for (int c = 0; c < 3; ++c) color[c] = color[c] >= 0.0f ? std::min(color[c], 1.0f) : 0.0f;
    }
    if (mesh.material < 0 || mesh.material >= int(scene.materials.size())) mesh.material = 0;
    if (mesh.points) {
      dropped += clean_points(mesh);
      continue;
    }
    dropped += clean_triangles(mesh);
    if (poll && poll->passing(0.0)) return dropped;
    if (mesh.indices.empty()) continue;
    if (mesh.normals.empty() || !repair_normals(mesh)) make_normals(mesh, crease_angle_deg.value_or(80.0f), poll);
    if (poll && poll->ended()) return dropped;
    for (glm::vec2& uv : mesh.uvs) {
      if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) uv = glm::vec2(0.0f);
    }
  }
  std::erase_if(scene.meshes,
                [](const Mesh& mesh) { return mesh.points ? mesh.positions.empty() : mesh.indices.empty(); });
  const Strays strays = set_bounds(scene, bounds);
  const float radius = scene.radius();
  for (Mesh& mesh : scene.meshes) {
    if (!mesh.points) continue;
    if (poll && poll->passing(0.0)) return dropped;
    shape_points(mesh, points, radius);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      if (strays.any() && !is_within(mesh.positions[i], mesh.radii[i], strays.rest)) continue;
      scene.bounds_min = glm::min(scene.bounds_min, mesh.positions[i] - mesh.radii[i]);
      scene.bounds_max = glm::max(scene.bounds_max, mesh.positions[i] + mesh.radii[i]);
    }
  }
  return dropped;
}

}  // namespace umbrage
