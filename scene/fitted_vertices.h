// What a camera is fitted to, and its extremes without a visit to each vertex.
#pragma once
#include <tbb/parallel_for.h>

#include <algorithm>
#include <glm/common.hpp>
#include <span>
#include <vector>

#include "scene/scene.h"
#include "scene/strays.h"

namespace umbrage {

/// Consecutive vertices or points, and a box around the centres or, of discs, around the ends of those that count.
struct VertexBlock {
  std::span<const glm::vec3> positions;
  std::span<const float> radii;  ///< of points; else empty
  bool spheres = false;
  glm::vec3 low, high;
  double radius = 0.0;  ///< max, of spheres
};

/// What the camera is fitted to: the vertices and points within the bounds of a scene, or the points of Scene::motion
/// in their place, if there are any.
class FittedVertices {
 public:
  explicit FittedVertices(const Scene& scene) : scene_(scene) {
    const bool moves = !scene.motion.empty();
    if (moves) add({.positions = scene.motion});
    for (const Mesh& mesh : scene.meshes)
      if (!moves && (scene.ground_object < 0 || mesh.object != scene.ground_object))
        add({.positions = mesh.positions,
             .radii = mesh.points ? mesh.radii : std::span<const float>(),
             .spheres = mesh.spheres});
    if (!moves && scene.meshes.empty())
      add({.positions = {&scene.bounds_min, 1}}), add({.positions = {&scene.bounds_max, 1}});
    tbb::parallel_for(std::size_t(0), blocks_.size(), [&](std::size_t k) { set_box(blocks_[k]); });
  }

  /// Calls visit(position, radius): the centre and radius of a sphere, the ends of a disc, with a radius of 0.
  template <class Visit>
  void for_each(Visit visit) const {
    for (const VertexBlock& block : blocks_) for_each_of(block, visit);
  }

  /// Returns `found`, a struct of extremes, extended by visit(found, position, radius) for all that for_each visits.
  /// Each extreme must be that of a quasi-convex function in front of the camera: if the corners of a block's box do
  /// not extend it, no vertex in the block does. Of spheres, an extreme may lack the square of their angular radius.
  /// `visit` returns whether the position is in front of the camera.
  template <class Found, class Visit>
  Found extremes(Found found, Visit visit) const {
    for (const VertexBlock& block : blocks_) {
      Found bound = found;
      bool is_in_front = true;
      for (int corner = 0; corner < 8; ++corner) {
        const auto end = [&](int axis) { return corner >> axis & 1 ? block.high[axis] : block.low[axis]; };
        is_in_front = visit(bound, glm::vec3(end(0), end(1), end(2)), block.radius) && is_in_front;
      }
      if (is_in_front && bound == found) continue;
      for_each_of(block, [&](const glm::vec3& p, double r) { visit(found, p, r); });
    }
    return found;
  }

 private:
  void add(const VertexBlock& all) {
    constexpr std::size_t kSize = 128;
    for (std::size_t first = 0; first < all.positions.size(); first += kSize) {
      VertexBlock& block = blocks_.emplace_back(all);
      block.positions = all.positions.subspan(first, std::min(kSize, all.positions.size() - first));
      if (!all.radii.empty()) block.radii = all.radii.subspan(first, block.positions.size());
    }
  }

  void set_box(VertexBlock& block) const {
    block.low = block.high = block.positions[0];
    for (const glm::vec3& p : block.positions) block.low = glm::min(block.low, p), block.high = glm::max(block.high, p);
    if (scene_.motion.empty())
      block.low = glm::max(block.low, scene_.bounds_min), block.high = glm::min(block.high, scene_.bounds_max);
    const float radius = block.radii.empty() ? 0.0f : *std::max_element(block.radii.begin(), block.radii.end());
    if (block.spheres) block.radius = double(radius);
    if (!block.spheres) block.low -= radius, block.high += radius;
  }

  template <class Visit>
  void for_each_of(const VertexBlock& block, Visit visit) const {
    for (std::size_t i = 0; i < block.positions.size(); ++i) {
      const glm::vec3& p = block.positions[i];
      if (scene_.motion.empty() && !is_in_bounds(scene_, p)) continue;
      if (block.spheres || block.radii.empty()) {
        visit(p, block.radii.empty() ? 0.0 : double(block.radii[i]));
        continue;
      }
      for (int axis = 0; axis < 3; ++axis) {
        glm::vec3 reach(0.0f);
        reach[axis] = block.radii[i];
        visit(p - reach, 0.0);
        visit(p + reach, 0.0);
      }
    }
  }

  const Scene& scene_;
  std::vector<VertexBlock> blocks_;
};

}  // namespace umbrage
