#include "devices/shared/planes.h"

#include <limits>
#include <string>

#include "core/gbuffer.h"
#include "scene/scene.h"

namespace umbrage {

std::optional<float> neutral_value(std::string_view plane) {
  bool has_layer_prefix = false;
  if (const std::string start = reduced_plane(""); plane.starts_with(start)) plane.remove_prefix(start.size());
  if (const std::string start = first_plane(""); plane.starts_with(start)) {
    plane.remove_prefix(start.size());
    if (plane == "resample_depth") return 0.0f;  // no surface
    if (plane.starts_with("normal.")) return 0.0f;
  }
  // A layer that does not exist has no surface.
  if (plane.starts_with("layer") && plane.ends_with(".depth")) return std::numeric_limits<float>::infinity();
  if (plane.starts_with("layer")) {
    const std::size_t dot = plane.find('.');
    plane = plane.substr(dot == std::string_view::npos ? plane.size() : dot + 1);
    if (plane.starts_with("normal.")) return 0.0f;
    has_layer_prefix = true;
  }
  if (plane.starts_with("albedo.")) return 0.8f;
  if (plane == "specular") return 0.0f;
  if (plane == "shininess") return 1.0f;
  if (is_shadow_plane(plane)) return 1.0f;
  if (plane == "metallic") return 0.0f;
  if (plane == "roughness") return kNoRoughness;
  if (plane == "ao" || plane == "material_ao" || plane == "coverage" || plane == "beauty.a") return 1.0f;
  if (plane == "outline" || plane == "cover" || plane == "cover_for_eye" || plane == "shadow_catcher" ||
      plane == "open_light" || plane == "object_id" || plane == "material_id" || plane == "bitmask_mips" ||
      plane == "hatching_ink")
    return 0.0f;
  if (plane.starts_with("direct.") || plane.starts_with("ambient.") || plane.starts_with("indirect.") ||
      plane.starts_with("emission.") || plane.starts_with("sky.") || plane.starts_with("lit_direct.") ||
      plane.starts_with("lit_indirect.") || plane.starts_with("line."))
    return 0.0f;
  if (has_layer_prefix) return 0.0f;  // an effect's output of a layer that does not exist
  return std::nullopt;
}

}  // namespace umbrage
