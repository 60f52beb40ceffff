// Compares the captured planes of two devices.
#pragma once
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <string>

#include "devices/shared/capture_info.h"
#include "rays/camera_rays.h"
#include "support.h"
#include "vulkan_support.h"

namespace umbrage::test {

/// The two ways in which a GPU captures scenes itself.
inline constexpr VulkanCapture kGpuCaptures[] = {VulkanCapture::kRays, VulkanCapture::kRaster};

/// Returns a device that captures scenes itself in this way, one of kGpuCaptures; null if there is none, which is a
/// failure if CI is set.
inline Device* capturing_device(VulkanCapture capture) {
  static Device* const devices[] = {new_vulkan_device({.capture = kGpuCaptures[0]}).release(),
                                    new_vulkan_device({.capture = kGpuCaptures[1]}).release()};
  return expect_in_ci(devices[capture == kGpuCaptures[1]]);
}

inline const char* name_of(VulkanCapture capture) { return capture == VulkanCapture::kRays ? "rays" : "raster"; }

/// The planes of one picture, from both devices.
struct Both {
  Image gpu, cpu;
};

/// Returns all planes that a device captures, including the guard band.
inline Image captured(Device& device, const Scene& scene, const Camera& camera, const CaptureSettings& settings) {
  const auto ready = device.prepare(scene);
  EXPECT_TRUE(ready) << (ready ? "" : ready.error().message);
  auto frame = device.capture(camera, settings);
  EXPECT_TRUE(frame) << (frame ? "" : frame.error().message);
  frame->info.guard = 0;  // keep the guard band
  return *device.download_all(*frame);
}

/// Returns whether surfaces meet at a pixel of a layer, that is, objects, depths or normals of neighbours differ a lot.
inline bool at_edge(const Image& image, int layer, int x, int y) {
  const Plane& depth = image.plane(layer_plane(layer, "depth"));
  const Plane& object = image.plane(layer_plane(layer, "object_id"));
  const Plane* normal[3] = {&image.plane(layer_plane(layer, "normal.x")), &image.plane(layer_plane(layer, "normal.y")),
                            &image.plane(layer_plane(layer, "normal.z"))};
  for (int j = std::max(y - 1, 0); j <= std::min(y + 1, image.height - 1); ++j)
    for (int i = std::max(x - 1, 0); i <= std::min(x + 1, image.width - 1); ++i) {
      if (object.at(i, j) != object.at(x, y)) return true;
      if (!(std::fabs(depth.at(i, j) - depth.at(x, y)) <= 0.02f * depth.at(x, y)) && std::isfinite(depth.at(x, y)))
        return true;
      float cosine = 0.0f;
      for (const Plane* p : normal) cosine += p->at(i, j) * p->at(x, y);
      if (std::isfinite(depth.at(x, y)) && cosine < 0.9f) return true;
    }
  return false;
}

/// Finds the surfaces at a point of a scene. Two may coincide, such as the top of a block and the underside of a block
/// on it. A ray hits either of them, and the width of Embree's kernels decides which.
class SurfacesAt {
 public:
  SurfacesAt(const Scene& scene, const PictureInfo& info)
      : scene_(scene), world_{.scene = &scene}, rays_(camera_rays(world_, info)) {}

  /// Returns whether a triangle of this object is at this depth on the pixel's ray.
  bool contain(float object, int x, int y, float depth) const {
    const float px = float(x) + 0.5f, py = float(y) + 0.5f, near = 1e-5f * depth;
    const glm::vec3 at = rays_.origin_at(px, py) + rays_.direction_at(px, py) * depth;
    for (const Mesh& mesh : scene_.meshes) {
      if (float(mesh.object) != object) continue;
      for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
        const glm::vec3 a = mesh.positions[mesh.indices[k]];
        const glm::vec3 u = mesh.positions[mesh.indices[k + 1]] - a, v = mesh.positions[mesh.indices[k + 2]] - a;
        const glm::vec3 n = glm::cross(u, v);
        const float squared = glm::dot(n, n);  // square of twice the area
        if (!(squared > 0.0f) || std::fabs(glm::dot(at - a, n)) > near * std::sqrt(squared)) continue;
        const float s = glm::dot(glm::cross(at - a, v), n) / squared, t = glm::dot(glm::cross(u, at - a), n) / squared;
        const float margin = near / std::sqrt(std::sqrt(squared));
        if (s >= -margin && t >= -margin && s + t <= 1.0f + margin) return true;
      }
    }
    return false;
  }

 private:
  const Scene& scene_;
  TracedScene world_;
  CameraRays rays_;
};

struct Deviation {
  std::map<std::string, long> inside;  // by plane: differing pixels away from edges
  long anywhere = 0;                   // pixels with a different surface
  long pixels = 0;
};

/// Returns whether the ray offsets of a pixel have equal lengths, and their directions are those of one triangle: on
/// the border of two, the devices may see either, and the other one is seen beside it.
inline bool same_ray_offset(const Both& both, int layer, int x, int y) {
  constexpr double kMaxDifference = 1e-3;  // relative length; angle, rad
  const auto offset = [&](const Image& image, int i, int j) {
    const auto at = [&](const char* name) { return double(image.plane(layer_plane(layer, name)).at(i, j)); };
    return glm::dvec3(at("ray_offset.x"), at("ray_offset.y"), at("ray_offset.z"));
  };
  const glm::dvec3 on_gpu = offset(both.gpu, x, y);
  const double length = glm::length(on_gpu), expected_length = glm::length(offset(both.cpu, x, y));
  if (length == 0.0 || expected_length == 0.0) return length == expected_length;
  if (!(std::fabs(length - expected_length) <= kMaxDifference * expected_length)) return false;
  for (int j = std::max(y - 1, 0); j <= std::min(y + 1, both.cpu.height - 1); ++j)
    for (int i = std::max(x - 1, 0); i <= std::min(x + 1, both.cpu.width - 1); ++i)
      if (const glm::dvec3 seen = offset(both.cpu, i, j); glm::length(seen) > 0.0)
        if (glm::distance(on_gpu / length, glm::normalize(seen)) <= kMaxDifference) return true;
  return false;
}

/// Counts differing pixels. `surfaces`, for layers of one camera, excludes coincident surfaces from the count.
inline Deviation deviation(const Both& both, int layers, const SurfacesAt* surfaces = nullptr) {
  Deviation d;
  for (int layer = 0; layer < layers; ++layer) {
    const auto a = [&](const char* name) -> const Plane& { return both.gpu.plane(layer_plane(layer, name)); };
    const auto b = [&](const char* name) -> const Plane& { return both.cpu.plane(layer_plane(layer, name)); };
    for (int y = 0; y < both.cpu.height; ++y)
      for (int x = 0; x < both.cpu.width; ++x) {
        ++d.pixels;
        const float depth = b("depth").at(x, y);
        const bool is_surface = std::isfinite(depth);
        const bool depth_differs = is_surface ? !(std::fabs(a("depth").at(x, y) - depth) <= 1e-4f * depth)
                                              : std::isfinite(a("depth").at(x, y));
        const float object = a("object_id").at(x, y);
        d.anywhere += depth_differs || (object != b("object_id").at(x, y) &&
                                        !(surfaces && is_surface && surfaces->contain(object, x, y, depth)));
        if (at_edge(both.cpu, layer, x, y)) continue;
        d.inside["depth"] += depth_differs;
        double squared = 0.0;  // squared difference of the normals; its root is the angle, rad
        for (const char* name : {"normal.x", "normal.y", "normal.z"})
          squared += std::pow(double(a(name).at(x, y)) - b(name).at(x, y), 2.0);
        d.inside["normal"] += !(std::sqrt(squared) <= 0.1 * 3.14159265 / 180.0);
        if (both.cpu.find("ray_offset.x")) d.inside["ray_offset"] += !same_ray_offset(both, layer, x, y);
        for (std::size_t p = 0; p < both.cpu.names.size(); ++p) {
          const std::string& name = both.cpu.names[p];
          if (layer_of_plane(name) != layer) continue;
          const std::string plain = layer == 0 ? name : name.substr(name.find('.') + 1);
          if (plain == "depth" || plain.starts_with("normal.") || plain.starts_with("ray_offset.")) continue;
          const float v = both.cpu.planes[p].at(x, y), w = both.gpu.plane(name).at(x, y);
          const float bound = plain.starts_with("albedo.") || plain.starts_with("shadow") ? 2.0f / 255.0f : 0.0f;
          d.inside[plain] += !(std::fabs(v - w) <= bound);
        }
      }
  }
  return d;
}

}  // namespace umbrage::test
