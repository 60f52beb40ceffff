// Polygons for readers: triangulation by ear clipping [Meisters 1975], and the texture coordinates, colours and
// materials that a file gives to faces, or to corners of faces, not to vertices.
#pragma once
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "core/progress.h"
#include "scene/scene.h"

namespace umbrage {

/// Splits a polygon of n corners into n - 2 triangles and appends three corner numbers, 0 to n - 1, for each of them.
/// Triangles have the orientation of the polygon. Concave polygons are split correctly, also with collinear or repeated
/// corners and with holes that are connected by a pair of edges; strictly convex ones become a fan around corner 0. The
/// shape is judged in the plane to which the polygon is most parallel. A polygon that crosses itself, has no area or
/// coordinates that are not finite is split somehow, and any polygon once the poll ends. Less than three corners: no
/// triangles.
void split_polygon(std::span<const glm::vec3> corners, std::vector<std::uint32_t>& triangles, Poll* poll = nullptr);

/// Splits the faces of a mesh; keeps its memory between calls.
class FaceSplitter {
 public:
  explicit FaceSplitter(Poll* poll) : poll_(poll) {}

  /// Returns the corner numbers of a face's triangles. `vertices`: the index of each corner in `positions`; if one is
  /// out of range, the triangles are a fan. The result is valid until the next call.
  const std::vector<std::uint32_t>& split(std::span<const std::uint32_t> vertices,
                                          std::span<const glm::vec3> positions);

 private:
  Poll* poll_;
  std::vector<glm::vec3> corners_;
  std::vector<std::uint32_t> triangles_;
};

/// Each list is empty or complete.
struct FaceAttributes {
  std::vector<glm::vec2> uvs;     ///< one per corner, in the order of Mesh::indices
  std::vector<glm::vec3> colors;  ///< one per triangle, linear
};

/// Splits the vertices of a mesh so that each has one texture coordinate and one colour, and sets these. Triangles with
/// an index out of range keep it.
void set_face_attributes(const FaceAttributes& attributes, Mesh& mesh);

/// Splits a mesh by the material of each triangle, an index into Scene::materials. Order is kept.
std::vector<Mesh> split_by_material(Mesh mesh, const std::vector<int>& materials);

}  // namespace umbrage
