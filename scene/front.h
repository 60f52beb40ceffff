// The front of a model: the side from which the default camera sees it.
#pragma once
#include "scene/scene.h"

namespace umbrage {

/// Returns a direction as "+Z" if it is that of an axis, else its components.
std::string axis_text(glm::vec3 direction);

/// Returns the direction that models usually face, perpendicular to `up`: +z, or -y where z is up. Unit.
glm::vec3 usual_front(const glm::vec3& up);

/// Returns the direction that a model faces, unit and perpendicular to `up`; `up` is unit. In this order:
/// 1. that of its parts, where meshes have names that differ only by "left" and "right" or by an L and an R at their
/// ends, such
///    as armLeft and armRight, or arm.L and arm.R:
///    to the horizontal axis from which the left parts are on the right side;
/// 2. usual_front, if the format of the file defines the front: Scene::has_front;
/// 3. towards the head of an animal: a model is taken for one if it is longer than wide, alike on the left and the
///    right, and its top quarter is at one end and not only a thin plate such as a fin or a headboard;
/// 4. usual_front.
glm::vec3 front_of(const Scene& scene, const glm::vec3& up);

}  // namespace umbrage
