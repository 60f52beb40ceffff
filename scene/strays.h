// Bounds of a scene that disregard stray points and parts, which would make everything else tiny in the picture.
#pragma once
#include <cstddef>
#include <glm/common.hpp>
#include <string>

#include "scene/finish.h"
#include "scene/scene.h"

namespace umbrage {

inline void extend(SceneBox& box, const glm::vec3& p) { box = {glm::min(box.low, p), glm::max(box.high, p)}; }

/// What is far from nearly all of the scene.
struct Strays {
  SceneBox rest;  ///< box around the vertices and points of the rest
  std::size_t triangles = 0, points = 0;
  float distance = 0.0f;  ///< of the farthest one from the centre of the rest
  bool any() const { return triangles > 0 || points > 0; }
};

/// Finds strays in a scene whose vertices are in the box `all`. If some of 100 or more points are outside of the box of
/// 80 % of them along each axis by three times its size, all that are outside by 0.7 of it are strays, as those of a
/// sparse reconstruction; unless they are more than one in eight, or close together, as those of a part. Strays among
/// triangles, points of small sets, and the rest of a point set as a whole are up to a third of them, separated from
/// the rest along an axis by an empty space of five times the size of the rest. A triangle with one corner that is 30
/// times as far away as nearly all vertices is a stray, too. Fast if there are none.
Strays find_strays(const Scene& scene, const SceneBox& all);

/// Returns whether a point with this radius, moved by at most the radius, belongs to the rest.
bool is_within(const glm::vec3& point, float radius, const SceneBox& rest);

/// Returns whether a position is within the bounds of a scene, which strays are not.
bool is_in_bounds(const Scene& scene, const glm::vec3& p);

/// Returns one sentence about strays that are outside of the default picture.
std::string strays_text(const Strays& strays);

}  // namespace umbrage
