// Points: what a file of bare vertices becomes, such as a scan.
#pragma once
#include "core/length.h"
#include "scene/scene.h"

namespace umbrage {

enum class PointShape {
  kAuto,   ///< discs where the points have normals or lie on surfaces, else spheres
  kDiscs,  ///< across the normals, which are made where the file has none
  kSpheres,
};

struct PointSettings {
  PointShape shape = PointShape::kAuto;
  Length size{0.0f, 0};  ///< across, in scene units or as a share of the scene's radius; 0: from the points' spacing
};

/// Drops points that are not finite, or whose given radius is not above 0 and finite, or that stand where another one
/// does; the others get a new order, in which neighbours are near each other. Returns how many were not finite.
std::size_t clean_points(Mesh& mesh);

/// Gives cleaned points their radii, unless they have some, and, if they are discs, the normals that they lack. Radii
/// from spacing are such that the discs of a surface leave no hole, and spheres, all alike, would touch on a grid. A
/// normal is that of the plane nearest to a point's neighbours [Hoppe et al. 1992], on either side: what sees it turns
/// it towards itself.
void shape_points(Mesh& mesh, const PointSettings& settings, float scene_radius);

}  // namespace umbrage
