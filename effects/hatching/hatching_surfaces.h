// The surfaces of a picture: from pixels to world space and back. Internal to effects/hatching.
#pragma once
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "effects/hatching/hatching_strokes.h"

namespace umbrage {

struct HatchingSurfaces {
  using Point = HatchingLine::Point;

  /// Reads the inputs depth and hatching_break of the frame, which must outlive this object.
  explicit HatchingSurfaces(const HostFrame& frame);

  float pixel_size(int x, int y) const;
  /// Returns the world-space position of the centre of a pixel.
  glm::vec3 at(int x, int y) const { return at(float(x) + 0.5f, float(y) + 0.5f, depth.row(y)[x]); }
  /// Returns that of a point on the surface that its pixel shows.
  glm::vec3 at(Point p) const { return at(p.x, p.y, surface_at(p).depth); }
  /// Returns where the picture shows a point of a surface; nothing if it is hidden or outside of the picture.
  std::optional<Point> seen(const glm::vec3& world) const;

  FrameConstants f;
  HostPlane depth, breaks;
  glm::mat4 view_from_world, world_from_view;

 private:
  float spread(float z) const { return f.orthographic != 0 ? 1.0f : z; }
  glm::vec3 at(float x, float y, float z) const;
  struct Local {
    float depth, slope;  // slope: about the change of depth from pixel to pixel
  };
  /// Returns the surface of a pixel at a point in it, linear within the surface.
  Local surface_at(Point p) const;
};

}  // namespace umbrage
