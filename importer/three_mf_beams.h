// Beam lattices of 3MF files [3MF beam lattice extension 1.2] as triangles and spheres.
#pragma once
#include <pugixml.hpp>
#include <vector>

#include "importer/placed_mesh.h"

namespace umbrage {

/// Returns the beams of a mesh, as triangles, and the balls at their ends, as spheres. `vertices`: those of the mesh,
/// world space; `scale`: the factor of lengths from the mesh to world space. Beams between vertices that the mesh does
/// not have are left out.
std::vector<PlacedMesh> beams_of(const pugi::xml_node& lattice, const std::vector<glm::dvec3>& vertices, double scale);

}  // namespace umbrage
