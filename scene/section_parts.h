// The steps of a section: parts, cut meshes, caps. Internal to scene/section.cpp.
#pragma once
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "scene/section.h"

namespace umbrage {

/// A plane in the coordinates of a scene; what has dot(normal, p) < offset stays.
struct CutPlane {
  glm::dvec3 normal;
  double offset;
  double tolerance;  ///< positions that are closer to the plane are in it
  std::string text;

  /// Returns the distance of a position from the plane, negative on the side that stays; 0 in the plane.
  double distance(const glm::vec3& p) const {
    const double d = glm::dot(normal, glm::dvec3(p)) - offset;
    return d < tolerance && d > -tolerance ? 0.0 : d;
  }
};

/// A part of a model; see cut_scene.
struct SectionPart {
  bool has_gaps = false;  ///< at one of the planes, which its caps close
  bool is_open = false;   ///< at one of the planes
  int style = 0;          ///< of its hatching and colour: neighbouring parts differ
};

/// A mesh with the part of each triangle. Points have no parts.
struct PartedMesh {
  Mesh mesh;
  std::vector<std::uint32_t> parts;  ///< one per triangle
  int cap_of = -1;                   ///< number of the plane that a cap is in; below 0: it is no cap
};

/// An edge of a cap. The cap is on its left as seen from the removed side.
struct CutSegment {
  std::uint32_t part;
  glm::vec3 from, to;
};

/// Returns the first of the items that are joined to an item, by the item to which each is joined.
inline std::uint32_t root_of(std::vector<std::uint32_t>& parents, std::uint32_t k) {
  while (parents[k] != k) k = parents[k] = parents[parents[k]];
  return k;
}

/// Sets the part of each triangle of a scene. Returns the number of parts; some of them may have no triangle.
std::uint32_t find_parts(std::vector<PartedMesh>& meshes);

/// Removes what is not on the side of a plane that stays. Appends the cut edges to `segments`.
void cut_mesh(const CutPlane& plane, PartedMesh& mesh, std::vector<CutSegment>& segments);

/// Returns the caps that segments in a plane enclose, a mesh for each part. Marks the parts whose edges do not close.
std::vector<PartedMesh> caps_of(const CutPlane& plane, std::vector<CutSegment> segments, const glm::vec3& up,
                                std::vector<SectionPart>& parts);

/// Turns caps into meshes of a scene: with objects, materials and, if they are hatched, strips. Caps of different parts
/// that may overlap are moved apart by 1e-5 of `radius`, the smaller one outward. `object`: number of
/// the first one.
void add_caps(const SectionSettings& settings, std::span<const CutPlane> planes, std::vector<PartedMesh> caps,
              std::vector<SectionPart>& parts, float radius, int object, Scene& scene);

}  // namespace umbrage
