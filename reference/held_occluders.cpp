#include "reference/held_occluders.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace umbrage {
namespace {

// Max distance of two surfaces that count as one, as in captures: a fraction of the sum of a hit's distances from the
// scene's centre and from the ray's start.
constexpr float kLayerStep = 1e-5f;
// A surface at a smaller cosine to the ray of the camera covers no pixel: it is seen edge-on.
constexpr float kMinCosine = 1e-4f;

/// Returns the parameter at which the search for the next surface along ray k starts. It is above that of the hit.
float behind_hit(const RayPacket& rays, int k) {
  const float t = rays.hit_distance(k);
  const glm::vec3 along = rays.direction(k) * t, hit = rays.origin(k) + along;
  const float step = kLayerStep * (glm::length(hit) + glm::length(along)) / glm::length(rays.direction(k));
  return std::max(t + step, std::nextafter(t, kRayInfinity));
}

/// Sets lane k of `to_points` to the camera's ray to a point of a surface, with t from 0 to 1. The lane stays idle
/// where the point is outside the picture, or its surface is seen edge-on.
void aim(const TracedScene& traced, const HeldView& view, Surface surface, int k, RayPacket& to_points) {
  const Camera& camera = view.camera;
  const bool perspective = camera.projection == Projection::kPerspective;
  const glm::vec3 in_view = glm::transpose(view.rays.world_from_view) * (surface.position - view.rays.eye);
  const float depth = -in_view.z / traced.scale;
  if (!(depth > 0.0f)) return;
  const glm::vec3 at = in_view / (perspective ? -in_view.z : traced.scale);
  if (!(at.x >= camera.left && at.x <= camera.right && at.y >= camera.bottom && at.y <= camera.top)) return;
  const glm::vec3 start = perspective ? view.rays.eye : surface.position + view.rays.world_from_view[2] * -in_view.z;
  const glm::vec3 toward = start - surface.position;
  const float cosine = glm::dot(surface.geometric, toward) / glm::length(toward);
  if (!(std::abs(cosine) > kMinCosine)) return;
  if (cosine < 0.0f) surface.geometric = -surface.geometric;
  to_points.set(k, start, ray_origin_above(traced, surface, start) - start, 0.0f, 1.0f);
}

/// Finds which points of a packet of camera rays are among the first surfaces along them.
std::array<bool, kPacket> among_first(const TracedScene& traced, int layers, float min_opacity, RayPacket& to_points) {
  std::array<bool, kPacket> held{};
  for (int layer = 0; layer < layers && to_points.any(); ++layer) {
    to_points.find_hits(traced, Coherence::kIncoherent, min_opacity);
    for (int k = 0; k < kPacket; ++k) {
      if (!to_points.is_set(k)) continue;
      const float next = to_points.hit(k) ? behind_hit(to_points, k) : 1.0f;
      held[k] = !(next < 1.0f);
      held[k] ? to_points.set_idle(k) : to_points.set_range(k, next, 1.0f);
    }
  }
  return held;
}

}  // namespace

std::vector<HeldView> held_views(const TracedScene& traced, const PictureInfo& info, Occluders occluders) {
  if (occluders == Occluders::kAll) return {};
  std::vector<HeldView> views = {{info.camera, camera_rays(traced, info), 1}};
  if (occluders == Occluders::kWindow) return views;
  for (std::size_t k = 0; k < info.more_layers.size(); ++k) {
    if (info.more_layers[k].kind == LayerKind::kBehind) ++views[0].layers;
    if (info.more_layers[k].kind != LayerKind::kOther) continue;
    const PictureInfo other = layer_info(info, int(k) + 1);
    views.push_back({other.camera, camera_rays(traced, other), 1});
  }
  return views;
}

std::array<float, kPacket> held_hit_distances(const TracedScene& traced, const std::vector<HeldView>& views,
                                              float length, float min_opacity, RayPacket& rays) {
  std::array<float, kPacket> distances;
  distances.fill(kRayInfinity);
  rays.find_hits(traced, Coherence::kIncoherent);
  while (rays.any()) {
    for (int k = 0; k < kPacket; ++k)
      if (!rays.hit(k)) rays.set_idle(k);
    for (const HeldView& view : views) {
      RayPacket to_points;
      for (int k = 0; k < kPacket; ++k)
        if (rays.is_set(k)) aim(traced, view, rays.surface(traced, k), k, to_points);
      const auto held = among_first(traced, view.layers, min_opacity, to_points);
      for (int k = 0; k < kPacket; ++k) {
        if (!held[k]) continue;
        distances[k] = rays.hit_distance(k);
        rays.set_idle(k);
      }
    }
    // Behind a hit that no view holds, the same ray may meet one that is held.
    for (int k = 0; k < kPacket; ++k) {
      if (!rays.is_set(k)) continue;
      if (const float next = behind_hit(rays, k); next < length)
        rays.set_range(k, next, length);
      else
        rays.set_idle(k);
    }
    rays.find_hits(traced, Coherence::kIncoherent);
  }
  return distances;
}

}  // namespace umbrage
