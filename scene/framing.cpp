// Fits the camera to the projected extent of the scene's vertices, so that a model of any shape fills the picture.
#include "scene/framing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat3x3.hpp>
#include <glm/trigonometric.hpp>
#include <limits>

#include "scene/finish.h"
#include "scene/fitted_vertices.h"
#include "scene/front.h"

namespace umbrage {
namespace {

constexpr float kMinMargin = 0.06f;           ///< fraction of the picture that a shift for a shadow leaves free
constexpr float kAzimuthDeg = 30.0f;          ///< to the right of the model's front
constexpr float kElevationDeg = 20.0f;        ///< above the horizon
constexpr float kHorizonElevationDeg = 8.0f;  ///< instead of both, if the picture shows the horizon
constexpr float kFlatElevationDeg = 45.0f;    ///< for flat scenes, which from 20 degrees are a thin strip
constexpr float kFlat = 0.3f;                 ///< height over width below which the elevation increases
constexpr float kMinAngleDeg = 0.01f, kMaxAngleDeg = 175.0f;
constexpr float kNearest = 0.02f;  ///< min. distance from the camera to the scene, as a fraction of its radius

bool is_direction(const glm::vec3& v) {
  const float length = glm::length(v);
  return length > 0.0f && std::isfinite(length);
}

glm::vec3 unit_or(const std::optional<glm::vec3>& requested, const glm::vec3& otherwise) {
  if (requested && is_direction(*requested)) return glm::normalize(*requested);
  return is_direction(otherwise) ? glm::normalize(otherwise) : glm::vec3(0.0f, 1.0f, 0.0f);
}

/// Returns the default direction from the scene to the camera.
glm::vec3 default_side(const Scene& scene, const glm::vec3& up, bool shows_horizon) {
  const glm::vec3 front = front_of(scene, up), right = glm::cross(up, front);
  const glm::vec3 size = scene.bounds_max - scene.bounds_min;
  const float height = glm::dot(size, glm::abs(up));
  const float width = std::max(glm::dot(size, glm::abs(front)), glm::dot(size, glm::abs(right)));
  const float flatness = width > 0.0f ? std::clamp(1.0f - height / (kFlat * width), 0.0f, 1.0f) : 0.0f;
  const float elevation = glm::radians(shows_horizon ? kHorizonElevationDeg
                                                     : kElevationDeg + flatness * (kFlatElevationDeg - kElevationDeg));
  const float azimuth = glm::radians(kAzimuthDeg);
  return std::cos(elevation) * (std::cos(azimuth) * front + std::sin(azimuth) * right) + std::sin(elevation) * up;
}

glm::vec3 rotated(const glm::vec3& v, const glm::vec3& axis, float angle_deg) {
  return glm::vec3(glm::rotate(glm::mat4(1.0f), glm::radians(angle_deg), axis) * glm::vec4(v, 0.0f));
}

/// Rotates `side` about `up` and then towards it. Stops short of the pole, past which the picture would flip.
glm::vec3 turned(glm::vec3 side, const glm::vec3& up, float azimuth_deg, float elevation_deg) {
  if (azimuth_deg != 0.0f) side = rotated(side, up, azimuth_deg);
  if (elevation_deg != 0.0f) {
    constexpr float kMaxElevationDeg = 89.9f;
    const float distance = glm::length(side);
    const float now = glm::degrees(std::asin(std::clamp(glm::dot(side, up) / distance, -1.0f, 1.0f)));
    const glm::vec3 flat = side - glm::dot(side, up) * up;
    const glm::vec3 level = is_direction(flat) ? glm::normalize(flat) : usual_front(up);
    const float goal = glm::radians(std::clamp(now + elevation_deg, -kMaxElevationDeg, kMaxElevationDeg));
    side = distance * (std::cos(goal) * level + std::sin(goal) * up);
  }
  return side;
}

struct Interval {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  void add(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
  double middle() const { return 0.5 * (low + high); }
  double size() const { return high - low; }
  bool operator==(const Interval&) const = default;
};

/// Result of a fit: the picture's centre at the scene's depth, and the distance of the camera from there.
struct Fit {
  glm::vec3 target;
  float distance = 1.0f;
  float height = 1.0f;  ///< height of the window, orthographic only
};

/// Axes of a camera that looks along -side, relative to `origin`.
struct Axes {
  glm::dvec3 origin, right, up, forward;
  glm::dvec3 view(const glm::vec3& p) const {
    const glm::dvec3 q = glm::dvec3(p) - origin;
    return {glm::dot(right, q), glm::dot(up, q), glm::dot(forward, q)};
  }
};

Axes axes_of(const glm::vec3& origin, const glm::vec3& side, const glm::vec3& up) {
  const Camera camera = orthographic_camera(side, glm::vec3(0.0f), up, 1.0f, 1.0f);
  return {glm::dvec3(origin), glm::dvec3(glm::row(camera.view_from_world, 0)),
          glm::dvec3(glm::row(camera.view_from_world, 1)), -glm::dvec3(glm::row(camera.view_from_world, 2))};
}

/// Fits an orthographic camera. With `keep_middle` the origin of the axes stays in the middle of the picture.
Fit fit_orthographic(const FittedVertices& vertices, double radius, const Axes& axes, float aspect, float margin,
                     bool keep_middle) {
  auto [x, y, z] = vertices.extremes(std::array<Interval, 3>{}, [&](auto& found, const glm::vec3& p, double r) {
    const glm::dvec3 q = axes.view(p);
    for (int axis = 0; axis < 3; ++axis)
      found[std::size_t(axis)].add(q[axis] - r), found[std::size_t(axis)].add(q[axis] + r);
    return true;
  });
  if (keep_middle) x.add(-x.low), x.add(-x.high), y.add(-y.low), y.add(-y.high);
  Fit fit;
  fit.target = glm::vec3(axes.origin + x.middle() * axes.right + y.middle() * axes.up);
  fit.distance = float(std::max(2.0 * radius, radius - z.low));
  fit.height = float(std::max({y.size(), x.size() / aspect, 1e-6 * radius}) / (1.0 - 2.0 * margin));
  return fit;
}

/// Fits a perspective camera. Each of the four side planes of the view frustum is moved outwards until it touches a
/// vertex, which gives the camera's position in closed form from one traversal of the vertices. The axis with space to
/// spare is then centred by iteration.
Fit fit_perspective(const FittedVertices& vertices, double radius, const Axes& axes, float angle_deg, float aspect,
                    float margin, bool keep_middle) {
  const double tan_y = std::tan(glm::radians(double(angle_deg)) / 2.0) * (1.0 - 2.0 * margin), tan_x = tan_y * aspect;
  const double secant_x = std::sqrt(1.0 + tan_x * tan_x), secant_y = std::sqrt(1.0 + tan_y * tan_y);
  constexpr double kLowest = std::numeric_limits<double>::lowest();
  struct Planes {
    double right = kLowest, left = kLowest, top = kLowest, bottom = kLowest, front = kLowest;
    bool operator==(const Planes&) const = default;
  };
  const auto [right, left, top, bottom, front] =
      vertices.extremes(Planes(), [&](Planes& found, const glm::vec3& p, double r) {
        const glm::dvec3 q = axes.view(p);
        found.right = std::max(found.right, q.x - tan_x * q.z + r * secant_x);
        found.left = std::max(found.left, -q.x - tan_x * q.z + r * secant_x);
        found.top = std::max(found.top, q.y - tan_y * q.z + r * secant_y);
        found.bottom = std::max(found.bottom, -q.y - tan_y * q.z + r * secant_y);
        found.front = std::max(found.front, r - q.z);
        return true;
      });
  double eye_x = 0.0, eye_y = 0.0, eye_z = -front - kNearest * radius;
  if (keep_middle) {
    eye_z = std::min({eye_z, -kNearest * radius, -right / tan_x, -left / tan_x, -top / tan_y, -bottom / tan_y});
  } else {
    eye_x = 0.5 * (right - left);
    eye_y = 0.5 * (top - bottom);
    eye_z = std::min({eye_z, -0.5 * (right + left) / tan_x, -0.5 * (top + bottom) / tan_y});
    constexpr int kRounds = 3;  // each reduces the offset to a few percent
    for (int round = 0; round < kRounds; ++round) {
      struct Edges {
        Interval x, y;
        double depth_left = 1.0, depth_right = 1.0, depth_bottom = 1.0, depth_top = 1.0;
        bool operator==(const Edges&) const = default;
      };
      const auto [x, y, depth_left, depth_right, depth_bottom, depth_top] =
          vertices.extremes(Edges(), [&](Edges& found, const glm::vec3& p, double r) {
            const glm::dvec3 q = axes.view(p);
            const double depth = q.z - eye_z, u = (q.x - eye_x) / depth, v = (q.y - eye_y) / depth;
            const double du = r * std::sqrt(1.0 + u * u) / depth, dv = r * std::sqrt(1.0 + v * v) / depth;
            if (u - du < found.x.low) found.x.low = u - du, found.depth_left = depth;
            if (u + du > found.x.high) found.x.high = u + du, found.depth_right = depth;
            if (v - dv < found.y.low) found.y.low = v - dv, found.depth_bottom = depth;
            if (v + dv > found.y.high) found.y.high = v + dv, found.depth_top = depth;
            return depth > 0.0;
          });
      // A step s moves the extremes by -s / depth; this step makes them equal and opposite.
      eye_x += (x.low + x.high) / (1.0 / depth_left + 1.0 / depth_right);
      eye_y += (y.low + y.high) / (1.0 / depth_bottom + 1.0 / depth_top);
    }
  }
  Fit fit;
  fit.target = glm::vec3(axes.origin + eye_x * axes.right + eye_y * axes.up);
  fit.distance = float(-eye_z);
  return fit;
}

Camera camera_at(const glm::vec3& eye, const glm::vec3& target, const glm::vec3& up, float angle_deg, float height,
                 float aspect, const Framing& framing) {
  Camera camera = framing.orthographic ? orthographic_camera(eye, target, up, height, aspect)
                                       : perspective_camera(eye, target, up, angle_deg, aspect);
  const float zoom = framing.zoom > 0.0f && std::isfinite(framing.zoom) ? framing.zoom : 1.0f;
  for (float* edge : {&camera.left, &camera.right, &camera.bottom, &camera.top}) *edge /= zoom;
  return camera;
}

/// Returns how far the middle of a window that ends at -half and half is shifted to centre `all`, but keeps `model`
/// inside with kMinMargin.
float shift_to(const Interval& all, const Interval& model, double half) {
  const double room = half * (1.0 - 2.0 * kMinMargin);
  return float(std::clamp(all.middle(), std::min(model.high - room, 0.0), std::max(model.low + room, 0.0)));
}

/// Shifts the window of a fitted camera: see Framing::centers_shadow.
void center_shadow(const Scene& scene, const FittedVertices& vertices, const Framing& framing, Camera& camera) {
  constexpr double kMinSine = 0.2;  // shadows of lower lights are too long to fit
  const glm::dvec3 up = glm::normalize(glm::dvec3(scene.up));
  const Light key = scene.lights.empty() ? studio_lighting(camera, scene.up).lights[0] : scene.lights[0];
  if (key.kind != LightKind::kDirectional) return;
  const glm::dvec3 light(framing.light_deg ? light_direction(camera, *framing.light_deg) : key.direction);
  const double sine = glm::dot(light, up), ground = glm::dot(glm::dvec3(scene.ground_center), up);
  if (sine < kMinSine) return;
  const glm::dmat4 view(camera.view_from_world);
  const bool parallel = camera.projection == Projection::kOrthographic;
  struct Edges {
    Interval x, y, all_x, all_y;
    bool operator==(const Edges&) const = default;
  };
  Edges edges = vertices.extremes(Edges(), [&](Edges& found, const glm::vec3& vertex, double r) {
    const glm::dvec3 p(vertex), at(view * glm::dvec4(p, 1.0));
    const glm::dvec3 shadow(view * glm::dvec4(p - light * ((glm::dot(p, up) - ground) / sine), 1.0));
    for (const double reach : {-r, r}) {
      found.x.add((at.x + reach) / (parallel ? 1.0 : -at.z)), found.y.add((at.y + reach) / (parallel ? 1.0 : -at.z));
    }
    if (shadow.z >= 0.0) return false;
    for (const double reach : {-r, r}) {
      found.all_x.add((shadow.x + reach) / (parallel ? 1.0 : -shadow.z));
      found.all_y.add((shadow.y + reach) / (parallel ? 1.0 : -shadow.z));
    }
    return at.z < 0.0;
  });
  auto& [x, y, all_x, all_y] = edges;
  // The soft end of a shadow weighs less than the model.
  constexpr double kWeight = 0.5;
  for (auto [all, model] : {std::pair{&all_x, &x}, std::pair{&all_y, &y}}) {
    all->low = std::min(glm::mix(model->low, all->low, kWeight), model->low);
    all->high = std::max(glm::mix(model->high, all->high, kWeight), model->high);
  }
  const float right = shift_to(all_x, x, camera.right * framing.zoom),
              above = shift_to(all_y, y, camera.top * framing.zoom);
  camera.left += right, camera.right += right;
  camera.bottom += above, camera.top += above;
}

/// Returns a camera at a given position, without a fit. An orthographic window is as large as the view frustum at the
/// target, unless its height is given.
Camera placed(glm::vec3 eye, const glm::vec3& target, const glm::vec3& up, float angle_deg, float aspect,
              Framing framing, float window_height = 0.0f) {
  if (is_direction(eye - target)) {
    eye = target + turned(eye - target, up, framing.azimuth_deg, framing.elevation_deg);
  }
  // A camera at the target itself has no distance to derive the window from: use one unit.
  const float distance = is_direction(eye - target) ? glm::distance(eye, target) : 1.0f;
  if (window_height > 0.0f) framing.orthographic = true;
  const float height =
      window_height > 0.0f ? window_height : 2.0f * distance * std::tan(glm::radians(angle_deg) / 2.0f);
  return camera_at(eye, target, up, angle_deg, height, aspect, framing);
}

/// Returns whether the scene's own view is used.
bool uses_scene_view(const Scene& scene, const Framing& framing) {
  return !scene.views.empty() && !framing.position && !framing.focal_point && !framing.direction;
}

/// Converts a position from the coordinates of the file to those of the scene.
glm::vec3 in_scene(const Scene& scene, const glm::dvec3& position) { return glm::vec3(position - scene.origin); }

/// Returns the focal point that the user has set, or else the centre of the scene.
glm::vec3 focal_point_of(const Scene& scene, const Framing& framing) {
  return framing.focal_point ? in_scene(scene, *framing.focal_point) : scene.center();
}

/// Returns the point that a camera at a given position looks at.
glm::vec3 target_of(const Scene& scene, const Framing& framing) {
  if (framing.focal_point || !framing.direction || !is_direction(*framing.direction))
    return focal_point_of(scene, framing);
  const glm::vec3 position = in_scene(scene, *framing.position);
  const float to_center = glm::distance(position, scene.center());
  return position +
         (to_center > 0.0f ? to_center : std::max(scene.radius(), 1.0f)) * glm::normalize(*framing.direction);
}

/// Moves a camera by the azimuth and elevation of a framing around `center`.
Camera orbited(Camera camera, const glm::vec3& center, const glm::vec3& up, const Framing& framing) {
  camera = turned_around(camera, center, up, framing.azimuth_deg);
  const glm::vec3 side(glm::row(camera.view_from_world, 2)), right(glm::row(camera.view_from_world, 0));
  const glm::vec3 raised = turned(side, up, 0.0f, framing.elevation_deg);
  const float sine = glm::dot(glm::cross(raised, side), right);
  return turned_around(camera, center, right, -glm::degrees(std::atan2(sine, glm::dot(raised, side))));
}

}  // namespace

FarthestPoints::FarthestPoints() {
  constexpr int kSteps = 2;
  for (int x = -kSteps; x <= kSteps; ++x)
    for (int y = -kSteps; y <= kSteps; ++y)
      for (int z = -kSteps; z <= kSteps; ++z)
        if (std::max({std::abs(x), std::abs(y), std::abs(z)}) == kSteps) directions_.push_back({glm::dvec3(x, y, z)});
}

void FarthestPoints::add(const glm::dvec3& p) {
  if (!(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= double(kMaxCoordinate))) return;
  for (Direction& each : directions_)
    if (const double distance = glm::dot(each.direction, p); is_empty_ || distance > each.distance)
      each.distance = distance, each.farthest = p;
  is_empty_ = false;
}

std::vector<glm::dvec3> FarthestPoints::points() const {
  std::vector<glm::dvec3> points;
  for (const Direction& each : directions_)
    if (!is_empty_) points.push_back(each.farthest);
  return points;
}

std::vector<glm::vec3> points_around(const Scene& scene) {
  FarthestPoints farthest;
  FittedVertices(scene).for_each([&](const glm::vec3& p, double radius) {
    farthest.add(glm::dvec3(p) - radius);
    if (radius > 0.0) farthest.add(glm::dvec3(p) + radius);
  });
  const auto points = farthest.points();
  return {points.begin(), points.end()};
}

Camera frame_scene(const Scene& scene, const Framing& framing, int width, int height) {
  const float aspect = float(std::max(width, 1)) / float(std::max(height, 1));
  const bool by_view = uses_scene_view(scene, framing);
  const glm::vec3 up =
      unit_or(framing.view_up, by_view && is_direction(scene.views[0].up) ? scene.views[0].up : scene.up);
  const float requested_angle =
      framing.view_angle_deg.value_or(by_view ? scene.views[0].angle_deg : framing.usual_view_angle_deg);
  const float angle_deg = std::clamp(requested_angle, kMinAngleDeg, kMaxAngleDeg);
  if (by_view) {
    const View& view = scene.views[0];
    return placed(view.eye, view.target, up, angle_deg, aspect, framing, view.height);
  }

  if (framing.position)
    return placed(in_scene(scene, *framing.position), target_of(scene, framing), up, angle_deg, aspect, framing);
  if (framing.orbits && (framing.azimuth_deg != 0.0f || framing.elevation_deg != 0.0f)) {
    Framing first = framing;
    first.azimuth_deg = first.elevation_deg = 0.0f;
    return orbited(frame_scene(scene, first, width, height), turn_center(scene, framing), up, framing);
  }
  const bool has_direction = framing.direction && is_direction(*framing.direction);
  glm::vec3 side = has_direction ? -glm::normalize(*framing.direction) : default_side(scene, up, framing.shows_horizon);
  side = turned(side, up, framing.azimuth_deg, framing.elevation_deg);
  const Axes axes = axes_of(focal_point_of(scene, framing), side, up);
  const glm::vec2 used = 1.0f - framing.free_space;
  const float used_aspect = aspect * used.x / used.y;
  const bool keep_middle = framing.focal_point.has_value();
  const FittedVertices vertices(scene);
  const double radius = std::max(double(scene.radius()), 1e-30);
  const Fit fit = framing.orthographic
                      ? fit_orthographic(vertices, radius, axes, used_aspect, framing.margin, keep_middle)
                      : fit_perspective(vertices, radius, axes, angle_deg, used_aspect, framing.margin, keep_middle);
  Camera camera =
      camera_at(fit.target + fit.distance * side, fit.target, up, angle_deg, fit.height, used_aspect, framing);
  if (framing.centers_shadow && scene.ground_object >= 0 && !keep_middle)
    center_shadow(scene, vertices, framing, camera);
  camera.right += (camera.right - camera.left) * framing.free_space.x / used.x;
  camera.bottom -= (camera.top - camera.bottom) * framing.free_space.y / used.y;
  return camera;
}

glm::vec3 turn_center(const Scene& scene, const Framing& framing) {
  if (uses_scene_view(scene, framing)) return scene.views[0].target;
  return framing.position ? target_of(scene, framing) : focal_point_of(scene, framing);
}

bool is_fitted(const Scene& scene, const Framing& framing) {
  return !framing.position && !uses_scene_view(scene, framing);
}

Camera turned_around(Camera camera, const glm::vec3& center, const glm::vec3& up, float angle_deg) {
  // Rotating the camera is rotating the world backwards.
  glm::dmat4 turn = glm::translate(glm::dmat4(1.0), glm::dvec3(center));
  turn = glm::rotate(turn, -glm::radians(double(angle_deg)), glm::dvec3(unit_or(std::nullopt, up)));
  turn = glm::translate(turn, -glm::dvec3(center));
  camera.view_from_world = glm::mat4(glm::dmat4(camera.view_from_world) * turn);
  return camera;
}

namespace {

/// Returns a directional light from this azimuth and elevation, with a disc of `disc_deg` degrees.
Light light_from(const Camera& camera, float azimuth_deg, float elevation_deg, glm::vec3 color, float disc_deg) {
  Light light;
  light.direction = light_direction(camera, {azimuth_deg, elevation_deg});
  light.color = color;
  light.angle_deg = disc_deg;
  light.casts_shadow = true;
  return light;
}

}  // namespace

glm::vec3 light_direction(const Camera& camera, const glm::vec2& light_deg) {
  const glm::vec2 angle = glm::radians(light_deg);
  const glm::vec3 in_view(std::cos(angle.y) * std::sin(angle.x), std::sin(angle.y),
                          std::cos(angle.y) * std::cos(angle.x));
  return glm::normalize(glm::transpose(glm::mat3(camera.view_from_world)) * in_view);
}

namespace {

/// Sets ambient light of these radiances on level surfaces that face `up` and down. Between them it changes linearly
/// with the sine of the normal's elevation.
void set_ambient(const glm::vec3& above, const glm::vec3& below, const glm::vec3& up, Lighting& lighting) {
  const glm::vec3 vertical = glm::normalize(up);
  lighting.ambient = 0.5f * (above + below);
  for (int color = 0; color < 3; ++color) {
    glm::mat4& shape = lighting.ambient_shape.by_color[color];
    for (int axis = 0; axis < 3; ++axis)
      shape[axis][3] = shape[3][axis] = 0.25f * (above[color] - below[color]) * vertical[axis];
  }
}

}  // namespace

Lighting default_lighting(const Camera& camera, const glm::vec3& up) {
  // A white surface that faces the light is just white.
  constexpr glm::vec3 kAbove(0.37f, 0.39f, 0.42f), kBelow(0.23f, 0.21f, 0.19f);
  constexpr float kKey = 0.62f;
  constexpr float kDiscDeg = 4.0f;  // a lamp of 35 cm at 5 m: shadows are sharp at contact and soft farther away
  Lighting lighting;
  lighting.lights = {light_from(camera, -35.0f, 40.0f, glm::vec3(kKey), kDiscDeg)};
  set_ambient(kAbove, kBelow, up, lighting);
  return lighting;
}

Lighting studio_lighting(const Camera& camera, const glm::vec3& up) {
  constexpr glm::vec3 kAbove(0.18f, 0.20f, 0.23f), kBelow(0.053f, 0.05f, 0.046f);
  constexpr float kBelowHorizon = 0.02f;  // sine; so that the rim light casts no shadow on level ground
  const glm::vec3 vertical = glm::normalize(up);
  Lighting studio;
  // A soft box of 1 m at 3 m, a large reflector on the opposite side, and a strip light behind, as high as the model.
  studio.lights = {light_from(camera, -50.0f, 43.0f, glm::vec3(0.94f, 0.9f, 0.81f), 18.0f),
                   light_from(camera, 50.0f, 8.0f, glm::vec3(0.09f, 0.11f, 0.135f), 35.0f),
                   light_from(camera, 145.0f, 20.0f, glm::vec3(1.2f, 1.25f, 1.32f), 18.0f)};
  glm::vec3& rim = studio.lights[2].direction;
  const glm::vec3 level = rim - glm::dot(rim, vertical) * vertical;
  if (is_direction(level)) rim = glm::normalize(glm::normalize(level) - kBelowHorizon * vertical);
  set_ambient(kAbove, kBelow, up, studio);
  return studio;
}

}  // namespace umbrage
