// Scenes with known edges for the tests of `outline`: their G-buffers are ray traced in double from half-spaces,
// spheres and rings.
#pragma once
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <limits>
#include <numbers>

#include "run_effect.h"
#include "support.h"

namespace umbrage::test {

using glm::dmat3;
using glm::dvec3;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kTanHalfView = 0.36397023426620234;  // for a view of 40 degrees, as in empty_gbuffer

inline double radians(double deg) { return deg * std::numbers::pi / 180.0; }

inline dmat3 rotation(double about_x_deg, double about_y_deg, double about_z_deg = 0.0) {
  const double a = radians(about_x_deg), b = radians(about_y_deg), c = radians(about_z_deg);
  const dmat3 x(1, 0, 0, 0, std::cos(a), std::sin(a), 0, -std::sin(a), std::cos(a));
  const dmat3 y(std::cos(b), 0, -std::sin(b), 0, 1, 0, std::sin(b), 0, std::cos(b));
  const dmat3 z(std::cos(c), std::sin(c), 0, -std::sin(c), std::cos(c), 0, 0, 0, 1);
  return z * x * y;
}

/// The intersection of a ray. `distance` is a multiple of the ray's direction, whose z is -1, and so equals the view
/// depth.
struct Hit {
  double distance = kInfinity;
  dvec3 normal{0.0};
  int object = -1, material = -1;
};
using RayScene = std::function<Hit(const dvec3& origin, const dvec3& direction)>;

/// The points for which dot(normal, p) < offset.
struct HalfSpace {
  dvec3 normal;
  double offset;
};

/// Returns the intersection of half-spaces. If `from_inside`, rays hit its walls from inside.
inline RayScene convex_solid(std::vector<HalfSpace> sides, int object = 0, bool from_inside = false) {
  return [=](const dvec3& origin, const dvec3& direction) {
    Hit in{.distance = -kInfinity, .object = object, .material = object}, out = in;
    out.distance = kInfinity;
    for (const HalfSpace& side : sides) {
      const double speed = glm::dot(side.normal, direction);
      const double gap = side.offset - glm::dot(side.normal, origin);
      if (speed == 0.0) {
        if (gap < 0.0) return Hit{};
        continue;
      }
      const double t = gap / speed;
      if (speed < 0.0 && t > in.distance) in.distance = t, in.normal = side.normal;
      if (speed > 0.0 && t < out.distance) out.distance = t, out.normal = -side.normal;
    }
    if (from_inside) return out;
    return in.distance > 0.0 && in.distance < out.distance ? in : Hit{};
  };
}

inline RayScene sphere(dvec3 center, double radius, int object) {
  return [=](const dvec3& origin, const dvec3& direction) {
    const dvec3 from = origin - center;
    const double a = glm::dot(direction, direction), b = glm::dot(from, direction),
                 c = glm::dot(from, from) - radius * radius;
    const double root = b * b - a * c;
    if (root <= 0.0) return Hit{};
    const double t = (-b - std::sqrt(root)) / a;
    if (t <= 0.0) return Hit{};
    return Hit{t, (from + direction * t) / radius, object, object};
  };
}

/// Returns a scene that consists of several.
inline RayScene together(std::vector<RayScene> scenes) {
  return [=](const dvec3& origin, const dvec3& direction) {
    Hit nearest;
    for (const RayScene& scene : scenes)
      if (const Hit hit = scene(origin, direction); hit.distance < nearest.distance) nearest = hit;
    return nearest;
  };
}

/// Returns a cube; its edges are bevels of width `bevel` if that is > 0. `half` is half of its side.
inline RayScene box(dvec3 center, dmat3 turn, double half, double bevel = 0.0, int object = 0) {
  std::vector<HalfSpace> sides;
  const auto add = [&](const dvec3& n, double offset) {
    const dvec3 normal = turn * n;
    sides.push_back({normal, offset + glm::dot(normal, center)});
  };
  for (int axis = 0; axis < 3; ++axis)
    for (int sign : {-1, 1}) {
      dvec3 n(0.0);
      n[axis] = sign;
      add(n, half);
    }
  if (bevel > 0.0)
    for (int axis = 0; axis < 3; ++axis)
      for (int s : {-1, 1})
        for (int t : {-1, 1}) {
          dvec3 n(0.0);
          n[(axis + 1) % 3] = s * std::sqrt(0.5);
          n[(axis + 2) % 3] = t * std::sqrt(0.5);
          add(n, std::sqrt(2.0) * half - 0.5 * bevel);
        }
  return convex_solid(sides, object);
}

/// Depth at which orthographic and perspective views have the same scale.
constexpr double kFocus = 6.0;

struct Lens {
  int width = 256, height = 256;
  bool orthographic = false;
  double shift_x_px = 0.0, shift_y_px = 0.0;  // shift of the view window, to the right and up

  double pixel() const { return 2.0 * kTanHalfView * (orthographic ? kFocus : 1.0) / height; }
  double left() const { return -0.5 * width * pixel() + shift_x_px * pixel(); }
  double top() const { return 0.5 * height * pixel() + shift_y_px * pixel(); }
};

/// Returns the G-buffer of a scene.
inline GBuffer seen(const Lens& lens, const RayScene& scene) {
  GBuffer g = empty_gbuffer(lens.width, lens.height);
  g.info.camera.projection = lens.orthographic ? Projection::kOrthographic : Projection::kPerspective;
  g.info.camera.left = float(lens.left());
  g.info.camera.right = float(lens.left() + lens.width * lens.pixel());
  g.info.camera.top = float(lens.top());
  g.info.camera.bottom = float(lens.top() - lens.height * lens.pixel());
  Image& image = g.layers[0];
  for (const char* name : {"depth", "normal.x", "normal.y", "normal.z", "object_id", "material_id"}) image.add(name);
  tbb::parallel_for(0, lens.height, [&](int y) {
    for (int x = 0; x < lens.width; ++x) {
      const double wx = lens.left() + (x + 0.5) * lens.pixel(), wy = lens.top() - (y + 0.5) * lens.pixel();
      const Hit hit = lens.orthographic ? scene({wx, wy, 0.0}, {0, 0, -1}) : scene(dvec3(0.0), {wx, wy, -1.0});
      image.planes[0].at(x, y) = float(hit.distance);
      for (int c = 0; c < 3; ++c) image.planes[1 + c].at(x, y) = float(hit.normal[c]);
      image.planes[4].at(x, y) = float(hit.object);
      image.planes[5].at(x, y) = float(hit.material);
    }
  });
  return g;
}

/// Returns a plane that is seen at an elevation angle, at `depth` in the middle of the picture, with smooth errors of
/// its normals of up to `error_deg`.
inline RayScene ground(double elevation_deg, double error_deg, double depth = kFocus, int object = 0) {
  const dvec3 normal(0.0, std::cos(radians(elevation_deg)), std::sin(radians(elevation_deg)));
  const RayScene plane = convex_solid({{normal, glm::dot(normal, dvec3(0, 0, -depth))}}, object);
  return [=](const dvec3& origin, const dvec3& direction) {
    Hit hit = plane(origin, direction);
    if (error_deg > 0.0 && hit.distance < kInfinity) {
      const dvec3 p = origin + direction * hit.distance;
      const double angle = 5.0 * p.x + 1.7 * p.z, max = std::tan(radians(error_deg));
      hit.normal = glm::normalize(hit.normal + max * dvec3(std::cos(angle), 0.0, std::sin(angle)));
    }
    return hit;
  };
}

/// Returns a torus whose axis is z rotated by `turn`. Rays find it by sphere tracing, to within 1e-9.
inline RayScene ring(dvec3 center, dmat3 turn, double radius, double tube, int object) {
  const auto distance = [=](const dvec3& p) {
    const dvec3 q = (p - center) * turn;
    return std::hypot(std::hypot(q.x, q.y) - radius, q.z) - tube;
  };
  return [=](const dvec3& origin, const dvec3& direction) {
    const double speed = glm::length(direction);
    double t = 0.0;
    for (int step = 0; step < 400 && t < 20.0; ++step) {
      const double d = distance(origin + direction * t);
      if (d < 1e-9) {
        const dvec3 p = origin + direction * t, q = (p - center) * turn;
        const double around = std::hypot(q.x, q.y);
        const dvec3 spine = dvec3(q.x, q.y, 0.0) * (radius / around);
        return Hit{t, turn * ((q - spine) / tube), object, object};
      }
      t += d / speed;
    }
    return Hit{};
  };
}

}  // namespace umbrage::test
