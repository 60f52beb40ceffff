#include "renderer/arrays.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "core/suggest.h"
#include "renderer/passes.h"

namespace umbrage {
namespace {

constexpr float kNothing = std::numeric_limits<float>::infinity();

/// The distance along the view axis of one pixel, infinity where there is nothing.
class ViewDepth {
 public:
  explicit ViewDepth(const ShadeRequest& r) : r_(r) {}

  float at(float value, int x, int y) const {
    if (!std::isfinite(value)) return kNothing;
    const float n = r_.near_plane, f = r_.far_plane;
    switch (r_.depth_kind) {
      case DepthKind::kView:
        return value > 0.0f ? value : kNothing;
      case DepthKind::kRay: {
        if (!(value > 0.0f)) return kNothing;
        if (r_.orthographic) return value;
        const float across = r_.left + (r_.right - r_.left) * (float(x) + 0.5f) / float(r_.width);
        const float up = r_.top + (r_.bottom - r_.top) * (float(y) + 0.5f) / float(r_.height);
        return value / std::sqrt(1.0f + across * across + up * up);
      }
      case DepthKind::kWindow:
        if (value >= 1.0f) return kNothing;
        if (r_.orthographic) return n + std::max(value, 0.0f) * (f - n);
        return std::isfinite(f) ? n * f / (f - std::max(value, 0.0f) * (f - n)) : n / (1.0f - std::max(value, 0.0f));
      case DepthKind::kReversed:
        if (value <= 0.0f) return kNothing;
        if (r_.orthographic) return f - std::min(value, 1.0f) * (f - n);
        return std::isfinite(f) ? n * f / (n + std::min(value, 1.0f) * (f - n)) : n / std::min(value, 1.0f);
    }
    return kNothing;
  }

 private:
  const ShadeRequest& r_;
};

Result<void> check(const ShadeRequest& r) {
  for (const int side : {r.width, r.height})
    if (side < 1 || side > kLargestSide)
      return usage_error("a G-buffer cannot be {} pixels wide or high: 1 to {} can", side, kLargestSide);
  if (long(r.width) * r.height > kMostPixels)
    return usage_error("a G-buffer cannot have {} x {} pixels: {} together are the most", r.width, r.height,
                       kMostPixels);
  const bool window = r.depth_kind == DepthKind::kWindow || r.depth_kind == DepthKind::kReversed;
  if (window && !(r.near_plane > 0.0f && std::isfinite(r.near_plane) && r.far_plane > r.near_plane))
    return usage_error("near_plane {} and far_plane {} cannot be: 0 < near_plane < far_plane can", r.near_plane,
                       r.far_plane);
  if (window && r.orthographic && !std::isfinite(r.far_plane))
    return usage_error("an orthographic G-buffer needs a far_plane that is not at infinity");
  const bool sound = std::isfinite(r.left) && std::isfinite(r.right) && std::isfinite(r.bottom) &&
                     std::isfinite(r.top) && r.right > r.left && r.top > r.bottom;
  if (!sound)
    return usage_error("the camera's window cannot be {} to {} and {} to {}: right lies beyond left, top above bottom",
                       r.left, r.right, r.bottom, r.top);
  if (!(r.scene_radius >= 0.0f && std::isfinite(r.scene_radius)))
    return usage_error("scene_radius cannot be {}: it is above 0, or 0 to be found", r.scene_radius);
  for (const float v : r.view_from_normal)
    if (!std::isfinite(v)) return usage_error("view_from_normal holds a number that is not finite");
  return {};
}

/// Copies one channel.
void copy_channel(const PixelArray& array, int channel, int channels, Plane& plane) {
  const std::ptrdiff_t pixel = array.pixel_stride != 0 ? array.pixel_stride : array.channel_stride == 1 ? channels : 1;
  const std::ptrdiff_t row = array.row_stride != 0 ? array.row_stride : pixel * plane.width;
  for (int y = 0; y < plane.height; ++y) {
    const float* from = array.values + row * y + array.channel_stride * channel;
    float* to = plane.row(y);
    for (int x = 0; x < plane.width; ++x) to[x] = from[pixel * x];
  }
}

/// Turns normals to view space and makes them unit vectors; what is no direction is zero.
void turn_normals(const std::array<float, 9>& turn, Image& layer) {
  Plane &nx = layer.plane("normal.x"), &ny = layer.plane("normal.y"), &nz = layer.plane("normal.z");
  for (int y = 0; y < nx.height; ++y)
    for (int x = 0; x < nx.width; ++x) {
      const glm::vec3 n(nx.at(x, y), ny.at(x, y), nz.at(x, y));
      const glm::vec3 v(turn[0] * n.x + turn[1] * n.y + turn[2] * n.z, turn[3] * n.x + turn[4] * n.y + turn[5] * n.z,
                        turn[6] * n.x + turn[7] * n.y + turn[8] * n.z);
      const float length = glm::length(v);
      const glm::vec3 unit = length > 0.0f && std::isfinite(length) ? v / length : glm::vec3(0.0f);
      nx.at(x, y) = unit.x;
      ny.at(x, y) = unit.y;
      nz.at(x, y) = unit.z;
    }
}

/// Fills in how far the scene reaches, from the first layer's depth.
void measure_extent(const ShadeRequest& request, const Plane& depth, PictureInfo& info) {
  constexpr int kSamples = 1 << 16;   // pixels that tell the extent: more tell no more
  constexpr double kOutliers = 0.01;  // share of the pixels, on either side, that may lie anywhere
  float nearest = kNothing, farthest = 0.0f;
  const int every = std::max(1, int(std::sqrt(double(depth.width) * depth.height / kSamples)));
  std::vector<float> along[3];
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      const float d = depth.at(x, y);
      if (!std::isfinite(d)) continue;
      nearest = std::min(nearest, d);
      farthest = std::max(farthest, d);
      if (x % every != 0 || y % every != 0) continue;
      const float scale = request.orthographic ? 1.0f : d;
      along[0].push_back(scale * (request.left + (request.right - request.left) * float(x) / float(depth.width)));
      along[1].push_back(scale * (request.top + (request.bottom - request.top) * float(y) / float(depth.height)));
      along[2].push_back(d);
    }
  if (request.scene_radius > 0.0f) info.scene_radius = request.scene_radius;
  if (!(nearest <= farthest)) return;  // nothing is seen: as good as any
  info.depth_min = nearest;
  info.depth_max = farthest;
  if (request.scene_radius > 0.0f) return;
  float square = 0.0f;
  for (std::vector<float>& values : along) {
    if (values.empty()) continue;
    const auto at = [&](double share) {
      const auto place = values.begin() + long(share * double(values.size() - 1));
      std::nth_element(values.begin(), place, values.end());
      return *place;
    };
    const float size = at(1.0 - kOutliers) - at(kOutliers);
    square += size * size;
  }
  // One pixel, or all of them in one place: what there is to see is as large as it is far.
  info.scene_radius = square > 0.0f ? 0.5f * std::sqrt(square) : farthest;
}

}  // namespace

Result<GBuffer> gbuffer_of(const ShadeRequest& request) {
  if (auto fine = check(request); !fine) return fine.error();
  GBuffer gbuffer;
  int layers = 1;
  for (const PixelArray& array : request.arrays) {
    if (channels_of(array.name).empty()) {
      std::vector<std::string> names;
      for (const PassPlanes& group : grouped_planes(known_planes())) names.push_back(group.name);
      return usage_error("no effect reads an array '{}'{}", array.name, suggestion(array.name, names));
    }
    if (!array.values) return usage_error("the array '{}' has no values", array.name);
    if (std::count_if(request.arrays.begin(), request.arrays.end(),
                      [&](const PixelArray& other) { return other.name == array.name; }) > 1)
      return usage_error("there are two arrays '{}'", array.name);
    layers = std::max(layers, layer_of_plane(array.name) + 1);
  }
  if (layers > kMostMixedLayers)
    return usage_error("there are {} layers: at most {} can be shaded", layers, kMostMixedLayers);
  for (int layer = 0; layer < layers; ++layer) {
    const std::string depth = layer_plane(layer, "depth");
    if (std::none_of(request.arrays.begin(), request.arrays.end(),
                     [&](const PixelArray& array) { return array.name == depth; }))
      return usage_error("a G-buffer needs an array '{}'", depth);
    gbuffer.layers.emplace_back(request.width, request.height);
    if (layer > 0) gbuffer.info.more_layers.push_back({.kind = LayerKind::kBehind, .of = layer - 1, .camera = {}});
  }
  for (const PixelArray& array : request.arrays) {
    const auto channels = channels_of(array.name);
    const std::string name(of_first_layer(array.name));
    for (std::size_t c = 0; c < channels.size(); ++c) {
      Plane& plane = gbuffer.layers[std::size_t(layer_of_plane(array.name))].add(name + channels[c]) =
          Plane(request.width, request.height);
      copy_channel(array, int(c), int(channels.size()), plane);
    }
  }
  const ViewDepth view_depth(request);
  for (Image& layer : gbuffer.layers) {
    Plane& depth = layer.plane("depth");
    for (int y = 0; y < depth.height; ++y)
      for (int x = 0; x < depth.width; ++x) depth.at(x, y) = view_depth.at(depth.at(x, y), x, y);
    if (layer.find("normal.x")) turn_normals(request.view_from_normal, layer);
  }
  PictureInfo& info = gbuffer.info;
  info.width = request.width;
  info.height = request.height;
  info.camera.projection = request.orthographic ? Projection::kOrthographic : Projection::kPerspective;
  info.camera.left = request.left;
  info.camera.right = request.right;
  info.camera.bottom = request.bottom;
  info.camera.top = request.top;
  for (LayerInfo& layer : info.more_layers) layer.camera = info.camera;
  measure_extent(request, gbuffer.layers[0].plane("depth"), info);
  return gbuffer;
}

}  // namespace umbrage
