// Winding: the order of a triangle's corners, which decides the side its normal is on.
#pragma once
#include "scene/mesh_corners.h"

namespace umbrage {

/// Turns triangles so that neighbours, which share an edge with no third, have the same winding; in each connected part
/// the smaller number of triangles is turned. `mesh` is that of `corners`, which afterwards describes it no longer.
/// Returns whether any was turned.
bool unify_winding(Mesh& mesh, const MeshCorners& corners);

}  // namespace umbrage
