// Faces of different meshes in one plane: where they overlap, rounding would decide at each pixel which is in front.
#pragma once
#include "core/progress.h"
#include "scene/scene.h"

namespace umbrage {

/// Moves faces that overlap a face of an earlier mesh in the same plane to its front, by 1e-5 of the scene's radius, so
/// that they hide it. "Front" is the side of the earlier face's normals, since a decal may be wound either way. The
/// vertices at one position move together. Surfaces are seen from both sides, and those of a
/// ground may face down: then a copy of the moved faces, unless they are blended, hides the upper side, in meshes
/// without a name that are added to the scene.
/// For a finished scene. Returns the number of faces moved. If the poll ends, only some of them move.
std::size_t separate_coplanar_faces(Scene& scene, Poll* poll = nullptr);

}  // namespace umbrage
