// Pictures with known occlusion for the tests of `bitmask`, and the values of single pixels.
#pragma once
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "devices/shared/dispatches.h"
#include "effects/bitmask/bitmask.h"
#include "kernel/kernel_frame.h"
#include "run_effect.h"
#include "support.h"

namespace umbrage::test {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kRadian = kPi / 180.0;
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A plane, or a part of one.
struct Wall {
  glm::dvec3 point, normal;
  /// Returns whether a point of the plane is part of the wall.
  std::function<bool(glm::dvec3)> contains = [](glm::dvec3) { return true; };
};

/// A ray from the camera, view space.
struct ViewRay {
  glm::dvec3 origin, direction;  ///< direction.z is -1, so that the parameter of the ray is view depth
};

inline ViewRay view_ray_of(const Camera& camera, int width, int height, int x, int y) {
  const double u = camera.left + (camera.right - camera.left) * (x + 0.5) / width;
  const double v = camera.top - (camera.top - camera.bottom) * (y + 0.5) / height;
  if (camera.projection == Projection::kOrthographic) return {{u, v, 0.0}, {0.0, 0.0, -1.0}};
  return {{0.0, 0.0, 0.0}, {u, v, -1.0}};
}

/// Returns a G-buffer of walls given in view space.
inline GBuffer picture(int width, int height, const Camera& camera, const std::vector<Wall>& walls) {
  GBuffer g = empty_gbuffer(width, height);
  g.info.camera = camera;
  Image& image = g.layers[0];
  for (const char* name : {"depth", "normal.x", "normal.y", "normal.z"}) image.add(name);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const ViewRay ray = view_ray_of(camera, width, height, x, y);
      double nearest = kInfinity;
      glm::dvec3 normal(0.0);
      for (const Wall& wall : walls) {
        const double depth = glm::dot(wall.point - ray.origin, wall.normal) / glm::dot(ray.direction, wall.normal);
        if (!(depth > 1e-6 && depth < nearest) || !wall.contains(ray.origin + depth * ray.direction)) continue;
        nearest = depth;
        normal = glm::dot(wall.normal, ray.direction) < 0.0 ? wall.normal : -wall.normal;
      }
      image.planes[0].at(x, y) = nearest < 1e6 ? float(nearest) : kInfinity;
      for (int k = 0; k < 3; ++k) image.planes[1 + k].at(x, y) = nearest < 1e6 ? float(normal[k]) : 0.0f;
    }
  return g;
}

inline Camera camera_of(bool orthographic, double height_at_depth_5, int width, int height) {
  const float aspect = float(width) / float(height);
  if (orthographic) return orthographic_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, float(height_at_depth_5), aspect);
  return perspective_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0},
                            float(2.0 * std::atan(height_at_depth_5 / 10.0) / kRadian), aspect);
}

inline constexpr int kSide = 801;  // width and height of the pictures below, pixels; 1 unit is 160 pixels at depth 5

/// Returns an orthographic view straight down on a floor 5 units below the camera, with objects of a height above the
/// floor.
inline GBuffer floor_from_above(const std::function<double(double x, double y)>& height,
                                const glm::dvec3& normal = {0, 0, 1}) {
  const Camera camera = camera_of(true, 5.0, kSide, kSide);
  GBuffer g = picture(kSide, kSide, camera, {{{0.0, 0.0, -5.0}, normal}});
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const ViewRay ray = view_ray_of(camera, kSide, kSide, x, y);
      g.layers[0].planes[0].at(x, y) = float(5.0 - height(ray.origin.x, ray.origin.y));
    }
  return g;
}

/// Returns the values of the planes `names` at the middle of the picture. Of the dispatches that search occluders, only
/// one tile of 16 pixels is computed. If the picture has a plane `bitmask_mips`, it is used as it is.
inline std::vector<double> values_at_middle(GBuffer& g, const Settings& settings, std::vector<std::string> names,
                                            bool scalar) {
  const Effect& effect = *find_effect("bitmask");
  const ParameterBytes params = parameters_of(effect, settings);
  BitmaskConstants constants;
  effect.constants(params, g.info, &constants);
  const int width = g.info.width, height = g.info.height;
  Image& image = g.layers[0];
  std::vector<double> values(names.size());
  Plane zeros(width, height, 0.0f), background(width, height, kInfinity);  // for planes that the picture lacks
  for (const Dispatch& dispatch : effect.dispatches) {
    if (!runs(dispatch, params)) continue;
    if (dispatch.name == "mips" && image.find("bitmask_mips")) continue;
    std::vector<KernelPlane> planes;
    for (std::string_view name : dispatch.outputs)
      if (!name.starts_with("layer")) image.add(name);
    for (std::string_view name : dispatch.inputs) {
      const bool exists = image.find(name) != nullptr;
      planes.push_back({name, exists                    ? image.plane(name).data()
                              : name.ends_with("depth") ? background.data()
                                                        : zeros.data()});
    }
    for (std::string_view name : dispatch.outputs)
      planes.push_back({name, name.starts_with("layer") ? nullptr : image.plane(name).data()});
    const FrameConstants frame = frame_constants(g.info, image.planes[0].stride, 0);
    const int m = height / 2, x0 = width / 2 / 16 * 16;
    const KernelFrame kernel_frame{frame, &constants, planes};
    const bool gathers = dispatch.name != "mips" && dispatch.name != "sent";
    const Tile tile = gathers ? Tile{x0, m, x0 + 16, m + 1} : Tile{0, 0, width, height};
    (scalar ? dispatch.kernel.scalar : dispatch.kernel.lanes)(kernel_frame, tile);
  }
  for (std::size_t k = 0; k < names.size(); ++k) values[k] = image.plane(names[k]).at(width / 2, height / 2);
  return values;
}

/// Returns the means over 8 sample indices of what values_at_middle() returns.
inline std::vector<double> mean_values_at_middle(GBuffer g, const Settings& settings,
                                                 const std::vector<std::string>& names, bool scalar = false) {
  std::vector<double> sum(names.size(), 0.0);
  constexpr int kSamples = 8;
  for (int sample = 0; sample < kSamples; ++sample) {
    const auto values =
        values_at_middle(g, joined(settings, {{"sample_index", std::to_string(sample)}}), names, scalar);
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += values[k] / kSamples;
  }
  return sum;
}

/// Slices and steps so fine that the pixels limit the accuracy; occluders of infinite thickness.
inline const Settings kFineSettings = {
    {"slices", "64"}, {"steps", "512"}, {"distribution", "2"}, {"slope", "1e-6"}, {"thickness", "1e2"}};

}  // namespace umbrage::test
