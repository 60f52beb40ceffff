// Creates normals for meshes without any.
#pragma once
#include <optional>

#include "core/progress.h"
#include "scene/scene.h"

namespace umbrage {

/// Creates smooth normals for a mesh without normals: angle-weighted face normals [Thürmer and Wüthrich 1998], averaged
/// over the faces around a vertex that meet within the crease angle and are in one smoothing group. Vertices at equal
/// positions are merged first and split again along creases. Triangles whose winding differs from that of their
/// neighbours are turned. A crease angle that is not given is kSmoothCreaseDeg for meshes with smoothing groups, and
/// for others chosen by survey_edges. If the poll ends, the mesh stays without normals.
void make_normals(Mesh& mesh, std::optional<float> crease_angle_deg = {}, Poll* poll = nullptr);

}  // namespace umbrage
