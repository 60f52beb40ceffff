// Polygons for readers: triangulation, and the texture coordinates, colours and materials that a file gives to faces,
// or to corners of faces, not to vertices.
#pragma once
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "scene/scene.h"
#include "scene/triangulate.h"

namespace umbrage {

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
