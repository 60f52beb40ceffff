// The crease angle of a mesh without normals: from how its faces meet, whether it is a part with edges or a scan.
#pragma once
#include <cstdint>
#include <vector>

#include "core/progress.h"
#include "scene/mesh_corners.h"

namespace umbrage {

/// Crease angle of meshes without edges that stand out, such as scans. Degrees.
inline constexpr float kSmoothCreaseDeg = 80.0f;

/// Crease angles that survey_edges chooses are larger than this. Degrees.
inline constexpr float kMinBendDeg = 22.0f;

/// Returns for each point whether faces around it may differ by more than kMinBendDeg.
std::vector<std::uint8_t> rough_points(const MeshCorners& corners);

struct EdgeSurvey {
  float crease_deg = kSmoothCreaseDeg;
  bool mixed_winding = false;  ///< two faces run through their common edge in one direction
};

/// Chooses the crease angle of a mesh by the lengths of its edges over their bend, the angle between the normals of the
/// two faces. Edges of a part have faces beside them that are flat, and are separated from bends that stand for
/// curvature by a range of angles in which there is hardly any edge: the crease angle is in the middle of the first
/// such range. In scans, however coarse or noisy, bends of all angles occur: the crease angle is kSmoothCreaseDeg.
/// Edges of 28 degrees and more stay sharp if there are hardly any of 22 to 28; but cylinders and spheres are round
/// from 11 equal sides on.
EdgeSurvey survey_edges(const MeshCorners& corners, const std::vector<std::uint8_t>& rough, Poll* poll);

}  // namespace umbrage
