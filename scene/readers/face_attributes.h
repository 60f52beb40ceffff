// Texture coordinates, colours and materials that a file gives to faces, or to corners of faces, not to vertices.
#pragma once
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "scene/scene.h"

namespace umbrage {

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
