// The last step of building a scene: normals, removal of unusable triangles and points, bounds, faces in one plane.
#pragma once
#include <functional>
#include <glm/mat4x4.hpp>
#include <limits>
#include <optional>

#include "core/progress.h"
#include "scene/points.h"
#include "scene/scene.h"
#include "scene/vertex_normals.h"

namespace umbrage {

/// Larger coordinates count as not finite, so that squares of lengths stay in the range of floats.
inline constexpr float kMaxCoordinate = 1e15f;
/// Normals that are shorter count as missing.
inline constexpr float kMinNormalLength = 1e-12f;

/// Calls `work` for each index below `count`, on several threads, with a poll of the thread, or null if there is none.
/// The calling thread polls while it works; once its poll has ended, all end and the rest is left out.
void for_each_index(std::size_t count, Poll* poll, const std::function<void(std::size_t, Poll*)>& work);

/// What Scene::bounds_min and bounds_max contain.
enum class BoundsOf { kAll, kAllButStrays };

/// Drops triangles that are degenerate, have an index out of range or coordinates that are not finite. Drops points
/// whose position or radius is not usable (clean_points). Creates missing normals, shapes points (shape_points),
/// removes empty meshes and computes the bounds; strays outside of them (scene/strays.h) cause a warning. Returns the
/// number of dropped triangles and points. If the poll ends, the scene is incomplete and must be discarded.
std::size_t finish_scene(Scene& scene, std::optional<float> crease_angle_deg = {}, const PointSettings& points = {},
                         Poll* poll = nullptr, BoundsOf bounds = BoundsOf::kAll);

/// Triangles of a scene before finish_scene that a damaged file has, and that finish_scene drops.
struct DamagedTriangles {
  std::size_t out_of_range = 0;  ///< with an index out of range
  std::size_t not_finite = 0;    ///< of the others, with a coordinate that is not finite or above 1e15
};

DamagedTriangles count_damaged(const Scene& scene);

/// Makes all materials opaque if no mesh of the scene is seen, because all are transparent or cut out. Returns whether
/// it did.
bool show_if_invisible(Scene& scene);

/// An axis-aligned box around parts of a scene, world space.
struct SceneBox {
  glm::vec3 low{std::numeric_limits<float>::max()}, high{std::numeric_limits<float>::lowest()};
  bool is_empty() const { return low.x > high.x; }
};

/// Extends the box by the triangles of a mesh that finish_scene would keep, transformed by `world_from_mesh`.
void add_triangles(const Mesh& mesh, const glm::mat4& world_from_mesh, SceneBox& box);

/// Moves faces that overlap a face of an earlier mesh in the same plane to its front, by 1e-5 of the scene's radius, so
/// that they hide it. "Front" is the side of the earlier face's normals, since a decal may be wound either way. The
/// vertices at one position move together. Surfaces are seen from both sides, and those of a ground may face down: then
/// a copy of the moved faces, unless they are blended, hides the upper side, in meshes without a name that are added to
/// the scene. For a finished scene. Returns the number of faces moved. If the poll ends, only some of them move.
std::size_t separate_coplanar_faces(Scene& scene, Poll* poll = nullptr);

}  // namespace umbrage
