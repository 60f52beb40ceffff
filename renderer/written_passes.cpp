#include "renderer/written_passes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "core/color.h"
#include "core/lists.h"
#include "effects/outline/outline.h"
#include "effects/output/output.h"
#include "renderer/passes.h"
#include "scene/scene.h"

namespace umbrage {
namespace {

/// Returns the background value of a plane; nullopt for planes that set_background leaves as they are. On the first
/// layer the effect `hide_ground` sets depth and ids.
std::optional<float> background_value(std::string_view plane) {
  const std::string pass = pass_of(name_on_first_layer(plane));
  if (pass == "ao" || pass == "material_ao" || is_shadow_plane(pass)) return 1.0f;
  if (pass == "roughness") return kNoRoughness;
  for (const std::string_view name : {"normal", "albedo", "specular", "shininess", "metallic", "emission", "direct",
                                      "ambient", "open_light", "indirect"})
    if (pass == name) return 0.0f;
  if (layer_of_plane(plane) == 0) return std::nullopt;
  if (pass == "depth") return std::numeric_limits<float>::infinity();
  if (pass == "object_id" || pass == "material_id") return -1.0f;
  return std::nullopt;
}

}  // namespace

std::vector<std::string> background_planes(const std::vector<std::string>& names, bool has_ground) {
  std::set<int> layers;
  for (const std::string& name : names)
    if (background_value(name)) layers.insert(layer_of_plane(name));
  std::vector<std::string> planes;
  for (const int layer : layers) {
    planes.push_back(layer_plane(layer, "depth"));
    if (has_ground) planes.push_back(layer_plane(layer, "object_id"));
  }
  return planes;
}

void set_background(Image& image, int ground_object) {
  std::map<int, Plane> empty_by_layer;  // 1 at pixels without surface
  for (const std::string& name : image.names) {
    const int layer = layer_of_plane(name);
    if (!background_value(name) || empty_by_layer.contains(layer)) continue;
    const Plane* depth = image.find(layer_plane(layer, "depth"));
    if (!depth) continue;  // a layer that was not captured is uniform
    const Plane* object = ground_object >= 0 ? image.find(layer_plane(layer, "object_id")) : nullptr;
    Plane& empty = empty_by_layer.emplace(layer, Plane(image.width, image.height)).first->second;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const bool is_ground = object && object->row(y)[x] == float(ground_object);
        empty.row(y)[x] = is_ground || !std::isfinite(depth->row(y)[x]) ? 1.0f : 0.0f;
      }
  }
  for (std::size_t k = 0; k < image.names.size(); ++k) {
    const auto value = background_value(image.names[k]);
    const auto empty = empty_by_layer.find(layer_of_plane(image.names[k]));
    if (!value || empty == empty_by_layer.end()) continue;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        if (empty->second.row(y)[x] != 0.0f) image.planes[k].row(y)[x] = *value;
  }
}

Result<Image> download_passes(Device& device, const Frame& frame, const std::vector<std::string>& names) {
  const auto of_background = background_planes(names, frame.info.ground_object >= 0);
  if (of_background.empty()) return device.view(frame, names);
  std::vector<std::string> all = names;
  const auto available = device.plane_names(frame);
  for (const std::string& name : of_background) {
    if (contains(all, name)) continue;
    if (contains(available, name)) all.push_back(name);
  }
  auto image = device.download(frame, all);
  if (image) set_background(*image, frame.info.ground_object);
  return image;
}

Image picture_of_passes(const Image& frame, const std::vector<std::string>& names, const PictureInfo& info) {
  Image out(frame.width, frame.height);
  constexpr std::array kChannels = {"color.r", "color.g", "color.b", "color.a"};
  // Min depth range, relative to the max depth. Avoids 0 / 0 for a scene that is one plane facing the camera.
  constexpr float kMinDepthRange = 1e-4f;
  const float span = std::max(info.depth_max - info.depth_min, kMinDepthRange * info.depth_max);
  for (std::size_t k = 0; k < names.size(); ++k) {
    const Plane& in = frame.plane(names[k]);
    Plane& plane = out.add(names.size() == 1 ? names[0] : kChannels[std::min(k, kChannels.size() - 1)]);
    const bool colour = names[k].ends_with(".r") || names[k].ends_with(".g") || names[k].ends_with(".b");
    const bool light = colour && !names[k].starts_with("color.");  // `color` has display values already
    const bool vector = names[k].ends_with(".x") || names[k].ends_with(".y") || names[k].ends_with(".z");
    for (int y = 0; y < out.height; ++y)
      for (int x = 0; x < out.width; ++x) {
        float v = in.at(x, y);
        if (vector) v = 0.5f * v + 0.5f;
        if (light) v = srgb_from_linear(v);
        if (names[k] == "depth" || names[k].ends_with(".depth"))
          v = std::isfinite(v) ? 1.0f - (v - info.depth_min) / span : 0.0f;
        plane.at(x, y) = v;
      }
  }
  return out;
}

Image picture_of_lines(const Plane& cover, const EffectSettings& settings) {
  const auto& line = params_of<OutlineParams>(settings);
  const bool srgb = params_of<OutputParams>(settings).transfer == kTransferSrgb;
  Image out(cover.width, cover.height);
  for (const auto& [name, value] : {std::pair{"color.r", line.r}, {"color.g", line.g}, {"color.b", line.b}})
    out.add(name) = Plane(cover.width, cover.height, srgb ? srgb_from_linear(value) : value);
  out.add("color.a") = cover;
  return out;
}

}  // namespace umbrage
