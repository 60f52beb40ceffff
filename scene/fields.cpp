// Fields of values through the changes that readers and finish_scene make to a mesh.
#include "scene/fields.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace umbrage {
namespace {

/// Appends the values at an index of `from` to `to`.
void append_values(const Field& from, std::size_t index, Field& to) {
  const auto first = from.values.begin() + std::ptrdiff_t(index * std::size_t(from.components));
  to.values.insert(to.values.end(), first, first + from.components);
}

void append_values_of(const Mesh& source, std::size_t index, bool on_triangles, Mesh& to) {
  for (std::size_t f = 0; f < source.fields.size(); ++f)
    if (source.fields[f].on_triangles == on_triangles) append_values(source.fields[f], index, to.fields[f]);
}

template <class T>
void gather_items(const std::vector<std::uint32_t>& from, std::vector<T>& items) {
  if (items.empty()) return;
  std::vector<T> gathered;
  gathered.reserve(from.size());
  for (const std::uint32_t index : from) gathered.push_back(items[index]);
  items = std::move(gathered);
}

}  // namespace

const Field* find_values(const Mesh& mesh, std::string_view name) {
  const auto found =
      std::find_if(mesh.fields.begin(), mesh.fields.end(), [&](const Field& field) { return field.name == name; });
  return found == mesh.fields.end() ? nullptr : &*found;
}

void gather_values(std::span<const std::uint32_t> from, Field& field) {
  const auto components = std::size_t(field.components);
  const std::size_t count = field.values.size() / components;
  std::vector<float> gathered(from.size() * components, std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < from.size(); ++i)
    if (from[i] < count) std::copy_n(&field.values[from[i] * components], components, &gathered[i * components]);
  field.values = std::move(gathered);
}

std::vector<Field> empty_fields(const Mesh& mesh) {
  std::vector<Field> fields;
  for (const Field& field : mesh.fields)
    fields.push_back(
        {.name = field.name, .components = field.components, .on_triangles = field.on_triangles, .values = {}});
  return fields;
}

void append_vertex_values(const Mesh& source, std::uint32_t vertex, Mesh& to) {
  append_values_of(source, vertex, false, to);
}

void append_triangle_values(const Mesh& source, std::size_t triangle, Mesh& to) {
  append_values_of(source, triangle, true, to);
}

void drop_incomplete_fields(Mesh& mesh) {
  std::erase_if(mesh.fields, [&](const Field& field) {
    const std::size_t count = field.on_triangles ? mesh.indices.size() / 3 : mesh.positions.size();
    return field.components < 1 || field.values.size() != count * std::size_t(field.components);
  });
}

void spread_triangle_values(Mesh& mesh) {
  if (std::none_of(mesh.fields.begin(), mesh.fields.end(), [](const Field& field) { return field.on_triangles; }))
    return;
  const std::vector<std::uint32_t> corners = mesh.indices;
  for (std::uint32_t corner = 0; corner < corners.size(); ++corner) mesh.indices[corner] = corner;
  gather_items(corners, mesh.positions);
  gather_items(corners, mesh.normals);
  gather_items(corners, mesh.uvs);
  gather_items(corners, mesh.colors);
  std::vector<std::uint32_t> triangles(corners.size());
  for (std::uint32_t corner = 0; corner < corners.size(); ++corner) triangles[corner] = corner / 3;
  for (Field& field : mesh.fields) {
    gather_values(field.on_triangles ? triangles : corners, field);
    field.is_spread = std::exchange(field.on_triangles, false);
  }
}

}  // namespace umbrage
