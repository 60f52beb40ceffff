#include "renderer/arrays.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "core/suggest.h"
#include "renderer/lens.h"
#include "renderer/passes.h"

namespace umbrage {
namespace {

constexpr std::size_t kMaxIds = 1 << 24;  // whole numbers that floats hold
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
  if (auto fine = check_lens(r); !fine) return fine;
  if (!(r.right > r.left && r.top > r.bottom))
    return usage_error("the camera's window cannot be {} to {} and {} to {}: right lies beyond left, top above bottom",
                       r.left, r.right, r.bottom, r.top);
  if (r.scene_radius < 0.0f)
    return usage_error("scene_radius cannot be {}: it is above 0, or 0 to be found", r.scene_radius);
  for (const float v : r.view_from_normal)
    if (!std::isfinite(v)) return usage_error("view_from_normal holds a number that is not finite");
  return {};
}

/// What is said of an array. Errors: kUsage.
Result<void> check_array(const ShadeRequest& request, const PixelArray& array) {
  const auto channels = channels_of(array.name);
  if (channels.empty()) {
    std::vector<std::string> names;
    for (const PassPlanes& group : grouped_planes(known_planes())) names.push_back(group.name);
    return usage_error("no effect reads an array '{}'{}", array.name, suggestion(array.name, names));
  }
  if (!array.values && !array.ids) return usage_error("the array '{}' has no values", array.name);
  if (array.values && array.ids) return usage_error("the array '{}' has both values and ids", array.name);
  if (array.ids && !is_id(array.name)) return usage_error("the array '{}' has ids, but is none", array.name);
  if (std::count_if(request.arrays.begin(), request.arrays.end(),
                    [&](const PixelArray& other) { return other.name == array.name; }) > 1)
    return usage_error("there are two arrays '{}'", array.name);
  return {};
}

/// Calls put(x, y, value) for one channel of an array that begins at `values`.
template <class T, class Put>
void read_channel(const PixelArray& array, const T* values, int channel, int channels, const Plane& plane,
                  const Put& put) {
  const std::ptrdiff_t pixel = array.pixel_stride != 0 ? array.pixel_stride : array.channel_stride == 1 ? channels : 1;
  const std::ptrdiff_t row = array.row_stride != 0 ? array.row_stride : pixel * plane.width;
  for (int y = 0; y < plane.height; ++y) {
    const T* from = values + row * y + array.channel_stride * channel;
    for (int x = 0; x < plane.width; ++x) put(x, y, from[pixel * x]);
  }
}

/// Floats do not tell all ids of 32 bits apart: planes hold their places in a list of those that there are. All layers
/// share it.
std::vector<std::uint32_t> ids_of(const ShadeRequest& request, std::string_view name) {
  std::vector<std::uint32_t> ids;
  const Plane size(request.width, request.height);
  for (const PixelArray& array : request.arrays)
    if (array.ids && of_first_layer(array.name) == name)
      read_channel(array, array.ids, 0, 1, size, [&](int, int, std::uint32_t id) {
        if (ids.empty() || ids.back() != id) ids.push_back(id);
      });
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

/// Copies an array into the planes of its layer.
void copy_array(const PixelArray& array, const SharedIds& ids, Image& layer) {
  const auto channels = channels_of(array.name);
  const std::string name(of_first_layer(array.name));
  for (std::size_t c = 0; c < channels.size(); ++c) {
    Plane& plane = layer.add(name + channels[c]) = Plane(layer.width, layer.height);
    if (!array.ids) {
      read_channel(array, array.values, int(c), int(channels.size()), plane,
                   [&](int x, int y, float value) { plane.at(x, y) = value; });
      continue;
    }
    const std::vector<std::uint32_t>& known = ids.find(name)->second;
    read_channel(array, array.ids, 0, 1, plane, [&](int x, int y, std::uint32_t id) {
      plane.at(x, y) = float(std::lower_bound(known.begin(), known.end(), id) - known.begin());
    });
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

bool is_id(std::string_view pass) {
  const std::string_view name = of_first_layer(pass);
  return name == "object_id" || name == "material_id";
}

Result<SharedGBuffer> gbuffer_of(const ShadeRequest& request) {
  if (auto fine = check(request); !fine) return fine.error();
  SharedGBuffer shared;
  GBuffer& gbuffer = shared.gbuffer;
  int layers = 1;
  for (const PixelArray& array : request.arrays) {
    if (auto fine = check_array(request, array); !fine) return fine.error();
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
  for (const char* name : {"object_id", "material_id"})
    if (auto ids = ids_of(request, name); !ids.empty()) {
      if (ids.size() > kMaxIds)
        return usage_error("{} has {} ids: at most {} can be told apart", name, ids.size(), kMaxIds);
      shared.ids[name] = std::move(ids);
    }
  for (const PixelArray& array : request.arrays)
    copy_array(array, shared.ids, gbuffer.layers[std::size_t(layer_of_plane(array.name))]);
  const ViewDepth view_depth(request);
  for (Image& layer : gbuffer.layers) {
    Plane& depth = layer.plane("depth");
    for (int y = 0; y < depth.height; ++y)
      for (int x = 0; x < depth.width; ++x) depth.at(x, y) = view_depth.at(depth.at(x, y), x, y);
    if (layer.find("normal.x")) turn_normals(request.view_from_normal, layer);
    for (const auto& [name, ids] : shared.ids)
      if (Plane* plane = layer.find(name))
        for (int y = 0; y < depth.height; ++y)
          for (int x = 0; x < depth.width; ++x)
            if (!std::isfinite(depth.at(x, y))) plane->at(x, y) = -1.0f;
  }
  PictureInfo& info = gbuffer.info;
  set_lens(request, info);
  for (LayerInfo& layer : info.more_layers) layer.camera = info.camera;
  measure_extent(request, gbuffer.layers[0].plane("depth"), info);
  return shared;
}

void give_back_ids(const SharedIds& ids, Picture& picture) {
  for (Pixels& pass : picture.passes) {
    const auto known = ids.find(std::string(of_first_layer(pass.name)));
    if (known == ids.end()) continue;
    pass.ids.reserve(pass.values.size());
    for (const float place : pass.values)
      pass.ids.push_back(place >= 0.0f && std::size_t(place) < known->second.size() ? known->second[std::size_t(place)]
                                                                                    : 0);
  }
  if (const auto known = ids.find("object_id"); known != ids.end())
    for (Stroke& stroke : picture.strokes)
      if (stroke.object >= 0 && std::size_t(stroke.object) < known->second.size())
        stroke.object = int(known->second[std::size_t(stroke.object)]);
}

}  // namespace umbrage
