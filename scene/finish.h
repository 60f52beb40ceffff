// What every scene goes through once its meshes stand: normals, clean triangles, bounds.
#pragma once
#include "core/progress.h"
#include "scene/points.h"
#include "scene/scene.h"

namespace umbrage {

/// Makes smooth normals for a mesh without them: angle-weighted face normals [Thürmer and Wüthrich 1998], averaged
/// over the faces around a vertex that meet within `crease_angle_deg`; vertices at equal positions are joined first,
/// and split again along creases.
void make_normals(Mesh& mesh, float crease_angle_deg, Poll* poll = nullptr);

/// Drops triangles that are degenerate, out of range or not finite, and points that are not finite, makes missing
/// normals, gives points their shape, removes empty meshes, and fills in the bounds. Returns how many triangles and
/// points were dropped. What it leaves once the poll is ended is no scene.
std::size_t finish_scene(Scene& scene, float crease_angle_deg = 80.0f, const PointSettings& points = {},
                         Poll* poll = nullptr);

}  // namespace umbrage
