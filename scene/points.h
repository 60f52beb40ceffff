// Points: sizes, normals and shapes for files of vertices without faces, such as scans. Discs blend: positions and
// normals are smoothed over neighbouring points, and normals change across each disc, so that the discs of a surface
// look like one smooth surface [Botsch et al. 2004].
#pragma once
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <utility>

#include "core/length.h"
#include "scene/scene.h"

namespace umbrage {

enum class PointShape {
  kAuto,   ///< discs if the points have normals or lie on surfaces, unless Mesh::spheres is set; else spheres
  kDiscs,  ///< perpendicular to the normals, which are estimated where the file has none
  kSpheres,
};

/// How points are drawn.
struct PointSettings {
  PointShape shape = PointShape::kAuto;
  /// Diameter, scene units or percent of the bounding-sphere radius; 0: from the points' spacing.
  Length size{0.0f, 0};
};

/// Drops points that are not finite, points with a given radius that is not positive and finite, and duplicates of
/// other positions. Reorders the rest so that neighbours are close in memory. Returns the number of points dropped as
/// not finite.
std::size_t clean_points(Mesh& mesh);

/// Sets the radii of cleaned points, unless they have some, and, for discs, the missing normals. With radii from the
/// spacing, the discs or spheres of a surface leave no hole, and the spheres of a cloud would touch on a grid; all
/// spheres have one size. Discs without given radii blend: see blend_discs. A missing normal
/// is that of the plane fitted to a point's neighbours [Hoppe et al. 1992], with either sign: renderers flip it towards
/// the viewer.
void shape_points(Mesh& mesh, const PointSettings& settings, float scene_radius);

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
