// Discs that blend: positions and normals are smoothed over neighbouring points, and normals change across each disc,
// so that the discs of a surface look like one smooth surface [Botsch et al. 2004].
#pragma once
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <utility>

#include "scene/scene.h"

namespace umbrage {

/// Returns two unit vectors that span the plane of a disc with this unit normal: the axes of Mesh::bends.
std::pair<glm::vec3, glm::vec3> axes_of_disc(const glm::vec3& normal);

/// Returns the unit normal of a disc at `offset`, scene units, from its centre.
glm::vec3 bent_normal(const glm::vec3& normal, const glm::vec3& bend, const glm::vec3& offset);

/// Replaces the normals of discs by those of a linear fit to the normals of overlapping discs, sets Mesh::bends to the
/// slopes of that fit, and moves the discs along their normals to the surface that the fit describes, by at most half
/// of their radius. Normals may have either sign; discs at a large angle to each other, as on both sides of a crease,
/// do not influence each other. `neighbors` contains `count` indices of points for each point. The mesh has unit
/// normals and radii.
void blend_discs(Mesh& mesh, std::span<const std::uint32_t> neighbors, int count);

}  // namespace umbrage
