#include "apps/cli/hints.h"

#include <cmath>
#include <glm/vec4.hpp>

#include "scene/framing.h"

namespace umbrage::cli {

void HintStatistics::add(const Plane& depth, const Plane* ao) {
  has_ao = ao != nullptr;
  constexpr float kVisible = 1.0f / 255.0f;  // one step of an 8-bit picture
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      if (!std::isfinite(depth.at(x, y))) continue;
      ++surfaces;
      changed += ao && std::abs(ao->at(x, y) - 1.0f) > kVisible;
    }
}

std::vector<std::string> hint_planes(const Recipe& recipe) {
  std::vector<std::string> planes = {"depth"};
  if (recipe.radius && recipe.occlusion != kNoOcclusion && recipe.wants("ao")) planes.emplace_back("ao");
  return planes;
}

namespace {

/// Returns a hint if the radius set by the user leaves hardly any occlusion; else an empty string.
std::string radius_hint(const Recipe& recipe, const HintStatistics& statistics, float scene_radius) {
  constexpr double kMinChangedFraction = 1e-3;         // fraction of the pixels that show a surface
  constexpr double kTooSmall = 0.5, kSuggested = 5.0;  // percent of the bounding-sphere radius
  const auto& length = recipe.radius;
  if (!length || recipe.occlusion == kNoOcclusion || !statistics.has_ao) return "";
  const double percent =
      length->relative ? double(length->value) : 100.0 * double(length->value) / double(scene_radius);
  const double pixels = double(statistics.surfaces), changed = double(statistics.changed);
  if (statistics.surfaces == 0 || percent >= kTooSmall || changed > kMinChangedFraction * pixels) return "";
  return fmt::format(
      "occlusion changes {:.2g} % of the model's pixels: its radius is {:.2g} % of the bounding-sphere radius; try "
      "--ao-radius {:g}%",
      100.0 * changed / pixels, percent, kSuggested);
}

/// Returns whether the centre of any point of the scene is inside the picture.
bool has_points_in_view(const Recipe& recipe, const Scene& scene) {
  const Camera camera = frame_scene(scene, recipe.framing, recipe.width, recipe.height);
  for (const Mesh& mesh : scene.meshes)
    for (std::size_t i = 0; mesh.points && i < mesh.positions.size(); ++i) {
      const glm::vec3 p(camera.view_from_world * glm::vec4(mesh.positions[i], 1.0f));
      const float depth = camera.projection == Projection::kOrthographic ? 1.0f : -p.z;
      const bool inside = p.z < 0.0f && p.x >= camera.left * depth && p.x <= camera.right * depth &&
                          p.y >= camera.bottom * depth && p.y <= camera.top * depth;
      if (inside) return true;
    }
  return false;
}

}  // namespace

void print_hints(const Recipe& recipe, const HintStatistics& statistics, const Scene& scene) {
  if (statistics.surfaces == 0 && has_points_in_view(recipe, scene)) {
    print_warning(fmt::format("the points of {} are smaller than a pixel; use a larger --point-size", scene.name));
  } else if (statistics.surfaces == 0 && !has_blended(scene)) {
    const Framing& framing = recipe.framing;
    const bool is_fitted = !framing.position && !framing.focal_point && !framing.direction;
    print_warning(
        is_fitted ? fmt::format("nothing of {} covers a pixel; {}", scene.name,
                                !recipe.sections.planes.empty()
                                    ? "the view fits it as it was before --section, which leaves little of it"
                                : scene.start ? "the view also fits other models or times, which are much larger"
                                              : "its parts are far apart, or very thin")
                  : fmt::format("nothing of {} is in view; move the camera or omit the camera options", scene.name));
  }
  if (const std::string hint = radius_hint(recipe, statistics, scene.radius()); !hint.empty()) print_warning(hint);
}

}  // namespace umbrage::cli
