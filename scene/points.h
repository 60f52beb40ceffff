// Points: sizes, normals and shapes for files of vertices without faces, such as scans.
#pragma once
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

}  // namespace umbrage
