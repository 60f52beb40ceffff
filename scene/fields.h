// Fields of values through the changes that readers and finish_scene make to a mesh.
#pragma once
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "scene/scene.h"

namespace umbrage {

/// Returns the field of that name, or null.
const Field* find_values(const Mesh& mesh, std::string_view name);

/// Replaces the values of a field by those with these indices, in order; of an index out of range they are missing.
void gather_values(std::span<const std::uint32_t> from, Field& field);

/// Returns the fields of a mesh, without values.
std::vector<Field> empty_fields(const Mesh& mesh);

/// Appends the values of a vertex to the fields of `to`, which are those of `source`. Fields on triangles stay.
void append_vertex_values(const Mesh& source, std::uint32_t vertex, Mesh& to);

/// Does the same with the values of a triangle, for fields on triangles.
void append_triangle_values(const Mesh& source, std::size_t triangle, Mesh& to);

/// Removes fields whose number of values is not that of the mesh's positions or triangles.
void drop_incomplete_fields(Mesh& mesh);

/// Makes fields on triangles fields on positions: each triangle gets positions of its own, with their normals, texture
/// coordinates and colours. Meshes without such fields stay as they are.
void spread_triangle_values(Mesh& mesh);

}  // namespace umbrage
