// The last step of building a scene: removal of unusable triangles, normals, bounds.
#include "scene/finish.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <thread>

#include "core/lists.h"
#include "scene/fields.h"
#include "scene/mesh_corners.h"
#include "scene/strays.h"

namespace umbrage {
namespace {

using Index = MeshIndex;

/// A triangle is degenerate if its doubled area is below this fraction of its longest edge squared: its width is then
/// less than a ten-millionth of its length, which is the precision of a float, and its normal is noise.
constexpr double kDegenerate = 1e-7;

constexpr glm::vec3 kAnyNormal{0.0f, 1.0f, 0.0f};

bool usable(const glm::vec3& p) {
  return std::abs(p.x) <= kMaxCoordinate && std::abs(p.y) <= kMaxCoordinate && std::abs(p.z) <= kMaxCoordinate;
}

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

/// Keeps the vertices for which `used` is set, in order.
void compact(Mesh& mesh, const std::vector<std::uint8_t>& used) {
  std::vector<Index> number_of(used.size(), kNoIndex32);
  Index count = 0;
  std::vector<Index> kept;
  for (Index v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    if (!mesh.fields.empty()) kept.push_back(v);
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
  for (Field& field : mesh.fields)
    if (!field.on_triangles) gather_values(kept, field);
  for (Index& index : mesh.indices) index = number_of[index];
}

/// Removes triangles that cannot be drawn and vertices without triangles. Returns the number of removed triangles.
std::size_t clean_triangles(Mesh& mesh) {
  const std::size_t before = (mesh.indices.size() + 2) / 3;
  std::vector<std::uint8_t> used(mesh.positions.size(), 0);
  std::size_t kept = 0;
  std::vector<Index> kept_triangles;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const Index a = mesh.indices[i], b = mesh.indices[i + 1], c = mesh.indices[i + 2];
    if (std::max({a, b, c}) >= mesh.positions.size()) continue;
    const glm::vec3 &p = mesh.positions[a], &q = mesh.positions[b], &r = mesh.positions[c];
    if (!is_drawable(p, q, r)) continue;
    if (!mesh.smoothing.empty()) mesh.smoothing[kept / 3] = mesh.smoothing[i / 3];
    if (!mesh.fields.empty()) kept_triangles.push_back(Index(i / 3));
    mesh.indices[kept++] = a;
    mesh.indices[kept++] = b;
    mesh.indices[kept++] = c;
    used[a] = used[b] = used[c] = 1;
  }
  mesh.indices.resize(kept);
  if (!mesh.smoothing.empty()) mesh.smoothing.resize(kept / 3);
  for (Field& field : mesh.fields)
    if (field.on_triangles) gather_values(kept_triangles, field);
  if (contains(used, 0)) compact(mesh, used);
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

}  // namespace

void for_each_index(std::size_t count, Poll* poll, const std::function<void(std::size_t, Poll*)>& work) {
  std::atomic<bool> ended = poll && poll->ended();
  const std::thread::id caller = std::this_thread::get_id();
  const ProgressMonitor goes_on = [&](double) { return !ended.load(std::memory_order_relaxed); };
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count),
      [&](const tbb::blocked_range<std::size_t>& range) {
        Poll of_worker(goes_on);
        Poll* own = !poll || std::this_thread::get_id() == caller ? poll : &of_worker;
        for (std::size_t i = range.begin(); i < range.end() && !ended.load(std::memory_order_relaxed); ++i) {
          work(i, own);
          if (own && own->passing(0.0)) ended = true;  // which ends the polls of all threads
        }
      },
      tbb::simple_partitioner());
}

DamagedTriangles count_damaged(const Scene& scene) {
  DamagedTriangles count;
  for (const Mesh& mesh : scene.meshes) {
    const bool all_usable = std::all_of(mesh.positions.begin(), mesh.positions.end(), usable);
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      const Index* corner = &mesh.indices[i];
      if (std::max({corner[0], corner[1], corner[2]}) >= mesh.positions.size())
        ++count.out_of_range;
      else if (!all_usable)
        count.not_finite += !std::all_of(corner, corner + 3, [&](Index v) { return usable(mesh.positions[v]); });
    }
  }
  return count;
}

void add_triangles(const Mesh& mesh, const glm::mat4& world_from_mesh, SceneBox& box) {
  const auto at = [&](Index vertex) { return glm::vec3(world_from_mesh * glm::vec4(mesh.positions[vertex], 1.0f)); };
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const Index* corner = &mesh.indices[i];
    if (std::max({corner[0], corner[1], corner[2]}) >= mesh.positions.size()) continue;
    const glm::vec3 corners[3] = {at(corner[0]), at(corner[1]), at(corner[2])};
    if (!is_drawable(corners[0], corners[1], corners[2])) continue;
    for (const glm::vec3& p : corners) extend(box, p);
  }
}

namespace {

/// Returns whether anything of a mesh is seen.
bool is_seen(const Scene& scene, const Mesh& mesh) {
  const auto index = std::size_t(mesh.material);
  if (index >= scene.materials.size()) return true;
  const Material& material = scene.materials[index];
  const float opacity = material.blended ? material.opacity : 1.0f;
  const float min_opacity = material.alpha_mask ? std::max(material.alpha_cutoff, kMinOpacity) : kMinOpacity;
  const auto texture = std::size_t(material.texture);
  if (mesh.uvs.empty() || texture >= scene.textures.size() || !(material.blended || material.alpha_mask))
    return opacity >= kMinOpacity;
  const std::vector<std::uint8_t>& rgba = scene.textures[texture].rgba;
  for (std::size_t i = 3; i < rgba.size(); i += 4)
    if (opacity * float(rgba[i]) >= min_opacity * 255.0f) return true;
  return false;
}

/// Sets the bounds to the box of all vertices and points, or of all but strays, and warns of these.
Strays set_bounds(Scene& scene, BoundsOf bounds) {
  SceneBox all;
  for (const Mesh& mesh : scene.meshes)
    for (const glm::vec3& p : mesh.positions) extend(all, p);
  const Strays strays = bounds == BoundsOf::kAll ? Strays{.rest = all} : find_strays(scene, all);
  if (strays.any()) scene.warnings.push_back(strays_text(strays));
  scene.bounds_min = scene.meshes.empty() ? glm::vec3(0.0f) : strays.rest.low;
  scene.bounds_max = scene.meshes.empty() ? glm::vec3(0.0f) : strays.rest.high;
  return strays;
}

/// Cleans one mesh and creates its normals. Returns the number of dropped triangles or points.
std::size_t finish_mesh(Mesh& mesh, int materials, std::optional<float> crease_angle_deg, Poll* poll) {
  if (mesh.normals.size() != mesh.positions.size()) mesh.normals.clear();
  if (mesh.uvs.size() != mesh.positions.size()) mesh.uvs.clear();
  if (mesh.colors.size() != mesh.positions.size()) mesh.colors.clear();
  if (mesh.radii.size() != mesh.positions.size()) mesh.radii.clear();
  mesh.bends.clear();
  if (mesh.smoothing.size() != mesh.indices.size() / 3) mesh.smoothing.clear();
  drop_incomplete_fields(mesh);
  for (glm::vec3& color : mesh.colors) {
    for (int c = 0; c < 3; ++c) color[c] = color[c] >= 0.0f ? std::min(color[c], 1.0f) : 0.0f;
  }
  if (mesh.material < 0 || mesh.material >= materials) mesh.material = 0;
  if (mesh.points) return clean_points(mesh);
  mesh.radii.clear();
  mesh.spheres = false;
  const std::size_t dropped = clean_triangles(mesh);
  if (poll && poll->passing(0.0)) return dropped;
  if (mesh.indices.empty()) return dropped;
  if (mesh.normals.empty() || !repair_normals(mesh)) make_normals(mesh, crease_angle_deg, poll);
  if (poll && poll->ended()) return dropped;
  mesh.smoothing = {};
  spread_triangle_values(mesh);
  for (glm::vec2& uv : mesh.uvs) {
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) uv = glm::vec2(0.0f);
  }
  return dropped;
}

}  // namespace

bool show_if_invisible(Scene& scene) {
  if (std::any_of(scene.meshes.begin(), scene.meshes.end(), [&](const Mesh& mesh) { return is_seen(scene, mesh); }))
    return false;
  for (Material& material : scene.materials) material.blended = material.alpha_mask = false;
  return true;
}

std::size_t finish_scene(Scene& scene, std::optional<float> crease_angle_deg, const PointSettings& points, Poll* poll,
                         BoundsOf bounds) {
  scene.shape_facts = std::make_shared<ShapeFacts>();
  if (scene.materials.empty()) scene.materials.emplace_back();
  for (Material& material : scene.materials) {
    for (int* texture : textures_of(material)) {
      if (*texture < 0 || *texture >= int(scene.textures.size())) *texture = kNoTexture;
    }
  }
  std::vector<std::size_t> dropped_of(scene.meshes.size());
  for_each_index(scene.meshes.size(), poll, [&](std::size_t m, Poll* own) {
    dropped_of[m] = finish_mesh(scene.meshes[m], int(scene.materials.size()), crease_angle_deg, own);
  });
  if (poll && poll->ended()) return 0;
  const std::size_t dropped = std::accumulate(dropped_of.begin(), dropped_of.end(), std::size_t(0));
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
