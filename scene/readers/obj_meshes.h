// Meshes from the parsed text of an OBJ file.
#pragma once
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/result.h"
#include "scene/readers/obj.h"
#include "scene/readers/obj_text.h"

namespace umbrage {

/// Gathers the vertices of all blocks, and the faces into meshes by object and material.
class ObjMeshes {
 public:
  ObjMeshes(const ObjFile& file, std::vector<ObjBlock> blocks, Poll* poll);

  /// Does the work of read_obj after parsing. To be called once.
  Result<ObjScene> scene();

 private:
  /// Consecutive faces of a block that belong to one mesh.
  struct Run {
    std::uint32_t block;
    std::size_t first, last;
    std::uint32_t smoothing;
  };
  /// The faces of one object and material.
  struct Part {
    std::string name;
    int object, material;
    std::vector<Run> runs;
  };
  /// The names of objects, groups and materials, each of which is compared once per statement.
  struct Names {
    std::unordered_map<std::string_view, int> numbers;
    std::vector<std::string_view> all;
    int number_of(std::string_view name);
  };
  enum FaceKind : std::uint8_t { kPlain = 0, kWithUvs = 1, kWithNormals = 2, kBad = 4 };

  bool ended() const { return poll_ && poll_->ended(); }
  void check_faces();
  void convert_vertices();
  void sort_faces();
  std::size_t part_of(std::pair<int, int> object, int material_name);
  int material_named(int number);
  void add_meshes(const Part& part);
  Mesh mesh_of(const Part& part, FaceKind kind);
  std::uint32_t vertex_of(const ObjCorner& corner);
  bool add_points();
  void warn_of_elements();
  void warn_of_missing_faces();
  void warn_of_materials();
  std::string bad_line() const;
  std::size_t line_of(const ObjBlock& block, const ObjFace& face) const;

  const ObjFile& file_;
  std::vector<ObjBlock> blocks_;
  Poll* poll_;
  ObjScene result_;
  std::size_t face_count_ = 0, bad_count_ = 0, first_bad_line_ = 0, lost_uvs_ = 0;
  ObjLines bad_positions_, commas_, lines_, points_, curves_;  ///< of all blocks
  std::size_t last_positions_ = 0;                             ///< number of positions after the last face
  bool has_smoothing_ = false;

  std::vector<glm::vec3> positions_, normals_, colors_;  ///< of all blocks
  std::vector<glm::vec2> uvs_;
  std::vector<std::size_t> position_counts_;      ///< of each block
  std::vector<std::vector<std::uint8_t>> kinds_;  ///< FaceKind of each face of each block
  std::vector<Part> parts_;
  std::map<std::pair<int, int>, std::size_t> part_numbers_;  ///< by object and material
  Names names_;
  std::map<std::pair<int, int>, int> object_numbers_;    ///< by numbers of the object's name and the group's
  std::unordered_map<int, const MtlMaterial*> defined_;  ///< materials of libraries, by number of their name
  std::unordered_map<int, int> material_numbers_;        ///< of materials of the scene, by number of their name
  std::vector<std::string> undefined_;                   ///< names of materials that no library defines

  /// A vertex of the mesh that is being made, and the next one at the same position.
  struct Vertex {
    ObjCorner corner;
    std::uint32_t next;
  };
  std::vector<Vertex> vertices_;
  std::vector<std::uint32_t> newest_;  ///< for each position its newest vertex
};

}  // namespace umbrage
