// What every scene goes through once its meshes stand: normals, clean triangles, bounds.
#pragma once
#include <glm/mat4x4.hpp>
#include <limits>

#include "core/progress.h"
#include "scene/points.h"
#include "scene/scene.h"

namespace umbrage {

/// Makes smooth normals for a mesh without them: angle-weighted face normals [Thürmer and Wüthrich 1998], averaged
/// over the faces around a vertex that meet within `crease_angle_deg`; vertices at equal positions are joined first,
/// and split again along creases.
void make_normals(Mesh& mesh, float crease_angle_deg, Poll* poll = nullptr);

/// Drops triangles that are degenerate, out of range or not finite, and points that are not finite or whose radius is
/// not, makes missing normals, gives points their shape, removes empty meshes, and fills in the bounds. Returns how
/// many triangles and points were dropped. What it leaves once the poll is ended is no scene.
std::size_t finish_scene(Scene& scene, float crease_angle_deg = 80.0f, const PointSettings& points = {},
                         Poll* poll = nullptr);

/// A box about parts of a scene.
struct SceneBox {
  glm::vec3 low{std::numeric_limits<float>::max()}, high{std::numeric_limits<float>::lowest()};
  bool is_empty() const { return low.x > high.x; }
};

/// Makes the box hold those triangles of a mesh, at a place, that finish_scene would keep there.
void add_triangles(const Mesh& mesh, const glm::mat4& world_from_mesh, SceneBox& box);

}  // namespace umbrage
