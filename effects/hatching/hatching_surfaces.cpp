#include "effects/hatching/hatching_surfaces.h"

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>

#include "core/gbuffer.h"

namespace umbrage {

HatchingSurfaces::HatchingSurfaces(const HostFrame& frame)
    : f(frame.frame),
      depth(frame.input("depth")),
      breaks(frame.input("hatching_break")),
      view_from_world(frame.info.camera.view_from_world),
      world_from_view(glm::inverse(view_from_world)) {}

float HatchingSurfaces::pixel_size(int x, int y) const {
  return std::max(std::abs(f.ray_scale_x), std::abs(f.ray_scale_y)) * spread(depth.row(y)[x]);
}

glm::vec3 HatchingSurfaces::at(float x, float y, float z) const {
  const float px = x * f.ray_scale_x + f.ray_offset_x, py = y * f.ray_scale_y + f.ray_offset_y;
  return glm::vec3(world_from_view * glm::vec4(px * spread(z), py * spread(z), -z, 1.0f));
}

HatchingSurfaces::Local HatchingSurfaces::surface_at(Point p) const {
  const int x = std::clamp(int(p.x), 0, f.width - 1), y = std::clamp(int(p.y), 0, f.height - 1);
  // Linear on the picture: depth in a parallel picture, its inverse in perspective.
  const auto value = [&](int u, int v) { return f.orthographic != 0 ? depth.row(v)[u] : 1.0f / depth.row(v)[u]; };
  const auto joined = [&](int u, int v, bool right) {
    const bool inside = u >= 0 && v >= 0 && u + int(right) < f.width && v + int(!right) < f.height;
    return inside && !(int(breaks.row(v)[u]) & (right ? kHatchingBreakRight : kHatchingBreakBelow));
  };
  const float own = value(x, y);
  const auto slope = [&](bool right, float fraction) {  // towards the neighbour beside the point, or the other one
    const int i = int(right), j = int(!right);
    const bool after = joined(x, y, right), before = joined(x - i, y - j, right);
    if (after && (fraction >= 0.0f || !before)) return value(x + i, y + j) - own;
    return before ? own - value(x - i, y - j) : 0.0f;
  };
  const float fx = p.x - float(x) - 0.5f, fy = p.y - float(y) - 0.5f;
  const float right = slope(true, fx), down = slope(false, fy), steep = std::abs(right) + std::abs(down);
  const float sum = own + fx * right + fy * down;
  if (f.orthographic != 0) return {sum, steep};
  return {sum > 0.5f * own ? 1.0f / sum : 1.0f / own, steep / (own * own)};
}

std::optional<HatchingSurfaces::Point> HatchingSurfaces::seen(const glm::vec3& world) const {
  constexpr float kMaxOffPx = 2.0f;  // from the surface of the pixel, along the ray
  const glm::vec4 view = view_from_world * glm::vec4(world, 1.0f);
  const float z = -view.z;
  if (f.orthographic == 0 && !(z > 0.0f)) return {};
  const Point p = {(view.x / spread(z) - f.ray_offset_x) / f.ray_scale_x,
                   (view.y / spread(z) - f.ray_offset_y) / f.ray_scale_y};
  if (!(p.x >= 0.0f && p.y >= 0.0f && p.x < float(f.width) && p.y < float(f.height))) return {};
  const Local surface = surface_at(p);
  const bool same = std::abs(surface.depth - z) < kMaxOffPx * pixel_size(int(p.x), int(p.y)) + surface.slope;
  return same ? std::optional(p) : std::nullopt;
}

}  // namespace umbrage
