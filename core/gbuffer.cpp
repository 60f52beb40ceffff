#include "core/gbuffer.h"

#include <fmt/core.h>
#include <algorithm>
#include <charconv>

#include <glm/matrix.hpp>

namespace umbrage {
namespace {

/// Returns the camera with its window extended by `pixels` on each side.
Camera widened(Camera camera, int width, int height, int pixels) {
  const float across = (camera.right - camera.left) / float(width) * float(pixels);
  const float down = (camera.top - camera.bottom) / float(height) * float(pixels);
  camera.left -= across;
  camera.right += across;
  camera.bottom -= down;
  camera.top += down;
  return camera;
}

/// Returns the camera of a picture with one pixel in `factor`, across and down, starting with the first. A ray goes
/// through the centre of its pixel, so the window extends (factor - 1) / 2 pixels beyond the first pixel.
Camera camera_of_every_nth(Camera camera, int width, int height, int factor) {
  const double across = (double(camera.right) - camera.left) / width;
  const double down = (double(camera.top) - camera.bottom) / height;
  const double beyond_first = (factor - 1) / 2.0;
  const double left = camera.left - beyond_first * across, top = camera.top + beyond_first * down;
  camera.left = float(left);
  camera.top = float(top);
  camera.right = float(left + across * factor * reduced_side(width, factor));
  camera.bottom = float(top - down * factor * reduced_side(height, factor));
  return camera;
}

}  // namespace

int reduced_side(int whole, int factor) { return (whole + factor - 1) / factor; }

PictureInfo with_guard(PictureInfo inner, int guard) {
  inner.camera = widened(inner.camera, inner.width, inner.height, guard);
  inner.width += 2 * guard;
  inner.height += 2 * guard;
  inner.guard = guard;
  return inner;
}

Camera inner_camera(const PictureInfo& info) { return widened(info.camera, info.width, info.height, -info.guard); }

PictureInfo inner_info(const PictureInfo& info) {
  PictureInfo inner = info;
  inner.camera = inner_camera(info);
  inner.width = info.inner_width();
  inner.height = info.inner_height();
  inner.guard = 0;
  for (LayerInfo& layer : inner.more_layers)
    if (layer.kind == LayerKind::kOther) layer.camera = widened(layer.camera, info.width, info.height, -info.guard);
  return inner;
}

PictureInfo reduced_info(const PictureInfo& whole, int factor) {
  PictureInfo out = whole;
  out.whole_width = whole.reduced > 1 ? whole.whole_width : whole.inner_width();
  out.whole_height = whole.reduced > 1 ? whole.whole_height : whole.inner_height();
  out.reduced = whole.reduced * factor;
  out.guard = 0;
  out.width = reduced_side(whole.width, factor);
  out.height = reduced_side(whole.height, factor);
  out.camera = camera_of_every_nth(whole.camera, whole.width, whole.height, factor);
  for (LayerInfo& layer : out.more_layers)
    layer.camera = camera_of_every_nth(layer.camera, whole.width, whole.height, factor);
  return out;
}

std::string pass_of(std::string_view plane) {
  const bool channel = plane.size() > 2 && plane[plane.size() - 2] == '.';
  return std::string(channel ? plane.substr(0, plane.size() - 2) : plane);
}

std::string reduced_plane(std::string_view name) { return "reduced_" + std::string(name); }
std::string other_plane(std::string_view name) { return "other_" + std::string(name); }

PictureInfo layer_info(const PictureInfo& info, int layer) {
  PictureInfo out = info;
  if (layer == 0 || layer > int(info.more_layers.size())) return out;
  const LayerInfo& shown = info.more_layers[std::size_t(layer) - 1];
  if (shown.kind != LayerKind::kOther) return out;
  out.camera = shown.camera;
  const glm::mat4 other_from_view = shown.camera.view_from_world * glm::inverse(info.camera.view_from_world);
  out.view_from_first = other_from_view;
  for (Light& light : out.lights) {
    light.direction = glm::mat3(other_from_view) * light.direction;
    light.position = glm::vec3(other_from_view * glm::vec4(light.position, 1.0f));
  }
  out.ground_center = glm::vec3(other_from_view * glm::vec4(out.ground_center, 1.0f));
  out.ambient_shape = turned(out.ambient_shape, glm::mat3(other_from_view));
  return out;
}

std::string shadow_plane(int light) { return light == 0 ? "shadow" : fmt::format("shadow{}", light); }

bool is_shadow_plane(std::string_view plane) {
  constexpr std::string_view kShadow = "shadow";
  return plane == kShadow || (plane.size() == kShadow.size() + 1 && plane.starts_with(kShadow) && plane.back() >= '1' &&
                              plane.back() <= '9');
}

std::string layer_plane(int layer, std::string_view name) {
  return layer == 0 ? std::string(name) : fmt::format("layer{}.{}", layer, name);
}

int layer_of_plane(std::string_view name) {
  constexpr std::string_view kStart = "layer";
  int layer = 0;
  if (name.starts_with(kStart)) std::from_chars(name.data() + kStart.size(), name.data() + name.size(), layer);
  return layer;
}

std::string_view name_on_first_layer(std::string_view plane) {
  return layer_of_plane(plane) > 0 ? plane.substr(plane.find('.') + 1) : plane;
}

PictureInfo info_of(const GBuffer& gbuffer) {
  PictureInfo info = gbuffer.info;
  const auto has = [&](std::string_view plane) {
    return std::any_of(gbuffer.layers.begin(), gbuffer.layers.end(),
                       [&](const Image& layer) { return layer.find(plane) != nullptr; });
  };
  info.has_roughness = has("roughness");
  info.has_material_ao = has("material_ao");
  return info;
}

}  // namespace umbrage
