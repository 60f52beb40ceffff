#include "scene/readers/polygon.h"
#include "scene/fields.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace umbrage {
namespace {

using Index = std::uint32_t;

constexpr std::uint32_t kNotFound = std::numeric_limits<std::uint32_t>::max();

/// Copies the vertex `from` of a mesh to the end of another one.
void copy_vertex(const Mesh& source, std::uint32_t from, Mesh& out) {
  out.positions.push_back(source.positions[from]);
  if (!source.normals.empty()) out.normals.push_back(source.normals[from]);
  if (!source.uvs.empty()) out.uvs.push_back(source.uvs[from]);
  if (!source.colors.empty()) out.colors.push_back(source.colors[from]);
  append_vertex_values(source, from, out);
}

/// Returns a mesh without vertices and triangles, otherwise equal.
Mesh empty_like(const Mesh& mesh) {
  Mesh out;
  out.name = mesh.name;
  out.fields = empty_fields(mesh);
  out.material = mesh.material;
  out.object = mesh.object;
  return out;
}

}  // namespace

const std::vector<Index>& FaceSplitter::split(std::span<const Index> vertices, std::span<const glm::vec3> positions) {
  triangles_.clear();
  const auto is_in_range = [&](Index v) { return v < positions.size(); };
  if (vertices.size() > 3 && std::all_of(vertices.begin(), vertices.end(), is_in_range)) {
    corners_.clear();
    for (const Index v : vertices) corners_.push_back(positions[v]);
    split_polygon(corners_, triangles_, poll_);
  } else {
    for (Index i = 2; i < vertices.size(); ++i) triangles_.insert(triangles_.end(), {0, i - 1, i});
  }
  return triangles_;
}

void set_face_attributes(const FaceAttributes& attributes, Mesh& mesh) {
  const bool has_uvs = !attributes.uvs.empty(), has_colors = !attributes.colors.empty();
  if (!has_uvs && !has_colors) return;
  Mesh out = empty_like(mesh);
  out.indices.reserve(mesh.indices.size());
  if (has_uvs) mesh.uvs.clear();
  if (has_colors) mesh.colors.clear();
  // The new vertices of an old one form a list, which is short: most vertices have one or two.
  std::vector<std::uint32_t> first(mesh.positions.size(), kNotFound), next;
  for (std::size_t corner = 0; corner < mesh.indices.size(); ++corner) {
    const std::uint32_t old = mesh.indices[corner];
    if (old >= mesh.positions.size()) {
      out.indices.push_back(kNotFound);
      continue;
    }
    const glm::vec2 uv = has_uvs ? attributes.uvs[corner] : glm::vec2(0.0f);
    const glm::vec3 color = has_colors ? attributes.colors[corner / 3] : glm::vec3(0.0f);
    constexpr int kMaxCompared = 16;  // bounds the work if thousands of faces share one vertex
    std::uint32_t found = kNotFound;
    int compared = 0;
    for (std::uint32_t v = first[old]; v != kNotFound && found == kNotFound && compared < kMaxCompared;
         v = next[v], ++compared)
      if ((!has_uvs || out.uvs[v] == uv) && (!has_colors || out.colors[v] == color)) found = v;
    if (found == kNotFound) {
      found = std::uint32_t(out.positions.size());
      copy_vertex(mesh, old, out);
      if (has_uvs) out.uvs.push_back(uv);
      if (has_colors) out.colors.push_back(color);
      next.push_back(first[old]);
      first[old] = found;
    }
    out.indices.push_back(found);
  }
  for (std::size_t f = 0; f < mesh.fields.size(); ++f)
    if (mesh.fields[f].on_triangles) out.fields[f] = std::move(mesh.fields[f]);
  mesh = std::move(out);
}

std::vector<Mesh> split_by_material(Mesh mesh, const std::vector<int>& materials) {
  std::vector<Mesh> parts;
  std::map<int, std::size_t> part_of;
  for (const int material : materials)
    if (part_of.emplace(material, parts.size()).second) {
      parts.push_back(empty_like(mesh));
      parts.back().material = material;
    }
  if (parts.size() < 2) {
    if (!parts.empty()) mesh.material = parts[0].material;
    parts = {std::move(mesh)};
    return parts;
  }
  std::vector<std::vector<std::size_t>> triangles_of(parts.size());
  for (std::size_t i = 0; i < materials.size(); ++i) triangles_of[part_of[materials[i]]].push_back(i);
  std::vector<std::uint32_t> number(mesh.positions.size(), kNotFound), numbered(mesh.positions.size(), kNotFound);
  for (std::uint32_t p = 0; p < parts.size(); ++p)
    for (const std::size_t triangle : triangles_of[p]) {
      append_triangle_values(mesh, triangle, parts[p]);
      for (std::size_t corner = 3 * triangle; corner < 3 * triangle + 3; ++corner) {
        const std::uint32_t old = mesh.indices[corner];
        if (old >= mesh.positions.size()) {
          parts[p].indices.push_back(kNotFound);
          continue;
        }
        if (numbered[old] != p) {
          numbered[old] = p;
          number[old] = std::uint32_t(parts[p].positions.size());
          copy_vertex(mesh, old, parts[p]);
        }
        parts[p].indices.push_back(number[old]);
      }
    }
  return parts;
}

}  // namespace umbrage
