// The origin of a scene whose file has coordinates too large for floats, such as georeferenced ones.
#pragma once
#include <glm/common.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace umbrage {

/// Returns the position that a reader subtracts, in double precision, from the coordinates of a file with this bounding
/// box, before it converts them to floats, and that it stores in Scene::origin. Zero if the box is near the origin for
/// its size: then floats are precise enough and coordinates stay as they are. Otherwise near the box's centre, a
/// multiple of a power of two, so that the subtraction is exact.
glm::dvec3 scene_origin(const glm::dvec3& low, const glm::dvec3& high);

struct Scene;

/// Moves the scene's origin to this position in the coordinates of the file: all positions change, what is drawn does
/// not. Rounds to floats.
void set_origin(const glm::dvec3& origin, Scene& scene);

/// Returns a view matrix for the coordinates of the file from one for those of the scene.
glm::dmat4 view_from_file(const glm::mat4& view_from_scene, const glm::dvec3& origin);

}  // namespace umbrage
