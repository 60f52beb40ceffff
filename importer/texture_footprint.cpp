// The areas of textures that pixels of a fitted picture average.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "importer/gltf_parts.h"
#include "scene/finish.h"
#include "scene/framing.h"
#include "scene/strays.h"

namespace umbrage {
namespace {

constexpr double kMaxTaps = 8.0;  // of rays/mip_texture.cpp: the largest ratio of the sides of a footprint
/// A ratio of 1.5 takes two taps, which are 0.75 times as wide as its shorter side; and looks differ in their framing.
constexpr double kMargin = 1.5;
constexpr double kSoftArea = 1.0;  // of each material, pixels: parts of the picture that may be softer

/// The area of a material in the picture by the width of its footprints.
class Widths {
 public:
  /// `width`: in texture coordinates; `area`: in pixels.
  void add(double width, double area) {
    const double step = width > 0.0 ? kSteps * std::log2(width) + kZero : 0.0;
    area_[std::size_t(std::clamp(step, 0.0, double(kCount - 1)))] += area;
  }
  /// Returns the width that is exceeded nearly everywhere; 0 if there is none.
  float smallest() const {
    double sum = 0.0;
    for (int k = 0; k < kCount; ++k)
      if ((sum += area_[std::size_t(k)]) > kSoftArea) return k > 0 ? float(std::exp2((k - kZero) / kSteps)) : 0.0f;
    return 0.0f;
  }

 private:
  static constexpr int kCount = 256, kZero = 192;
  static constexpr double kSteps = 8.0;  // per power of two
  std::vector<double> area_ = std::vector<double>(kCount, 0.0);
};

/// Adds a triangle whose nearest pixel is `pixel` wide, scene units.
void add_triangle(const glm::dvec3 (&p)[3], const glm::dvec2 (&uv)[3], double pixel, Widths& widths) {
  const glm::dvec3 e1 = p[1] - p[0], e2 = p[2] - p[0];
  const glm::dvec2 t1 = uv[1] - uv[0], t2 = uv[2] - uv[0];
  const double e11 = glm::dot(e1, e1), e12 = glm::dot(e1, e2), e22 = glm::dot(e2, e2), squared = e11 * e22 - e12 * e12;
  if (!(squared > 0.0)) return;
  // The squares of the singular values of the map from the triangle to the texture.
  const double half = 0.5 * (glm::dot(t1, t1) * e22 - 2.0 * glm::dot(t1, t2) * e12 + glm::dot(t2, t2) * e11) / squared,
               cross = t1.x * t2.y - t1.y * t2.x, product = cross * cross / squared,
               larger = half + std::sqrt(std::max(half * half - product, 0.0)),
               smaller = larger > 0.0 ? product / larger : 0.0;
  widths.add(pixel / kMargin * std::max(std::sqrt(smaller), std::sqrt(larger) / kMaxTaps),
             0.5 * std::sqrt(squared) / (pixel * pixel));
}

/// Sets the bounds that finish_scene will set, about. Returns false if a position is not finite.
bool set_rough_bounds(Scene& scene) {
  SceneBox all;
  for (const Mesh& mesh : scene.meshes)
    for (const glm::vec3& p : mesh.positions) {
      if (!(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= kMaxCoordinate)) return false;
      all = {glm::min(all.low, p), glm::max(all.high, p)};
    }
  if (all.is_empty()) return false;
  const SceneBox rest = find_strays(scene, all).rest;
  scene.bounds_min = rest.low;
  scene.bounds_max = rest.high;
  return true;
}

}  // namespace

std::vector<float> smallest_footprints(Scene& scene, const std::vector<ImageUses>& images,
                                       const ImportSettings& settings) {
  const auto needs_none = [](const ImageUses& images) { return images.empty(); };
  if (settings.fitted_px <= 0 || std::all_of(images.begin(), images.end(), needs_none) || !set_rough_bounds(scene))
    return std::vector<float>(images.size(), 0.0f);
  Framing framing;
  if (settings.up != glm::vec3(0.0f)) framing.view_up = settings.up;
  const Camera camera = frame_scene(scene, framing, settings.fitted_px, settings.fitted_px);
  const double pixel_at_1 = double(camera.top - camera.bottom) / double(settings.fitted_px);
  std::vector<Widths> widths(images.size());
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.points || images[std::size_t(mesh.material)].empty() || mesh.uvs.size() != mesh.positions.size()) continue;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      const std::uint32_t* corner = &mesh.indices[i];
      if (std::max({corner[0], corner[1], corner[2]}) >= mesh.positions.size()) continue;
      glm::dvec3 p[3];
      glm::dvec2 uv[3];
      double depth = kMaxCoordinate;
      for (int k = 0; k < 3; ++k) {
        p[k] = mesh.positions[corner[k]];
        uv[k] = mesh.uvs[corner[k]];
        depth = std::min(depth, -(glm::dmat4(camera.view_from_world) * glm::dvec4(p[k], 1.0)).z);
      }
      if (depth > 0.0) add_triangle(p, uv, pixel_at_1 * depth, widths[std::size_t(mesh.material)]);
    }
  }
  std::vector<float> smallest;
  for (const Widths& each : widths) smallest.push_back(each.smallest());
  return smallest;
}

}  // namespace umbrage
