#include "renderer/shared_gbuffer.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "core/suggest.h"
#include "renderer/lens.h"
#include "renderer/passes.h"
#include "renderer/rows.h"

namespace umbrage {
namespace {

constexpr std::size_t kMaxIds = 1 << 24;  // integers that a float represents exactly
constexpr float kNothing = std::numeric_limits<float>::infinity();

/// Computes the view depth of one pixel; infinity where there is no surface.
class ViewDepth {
 public:
  explicit ViewDepth(const Lens& r) : r_(r) {}

  float at(float value, int x, int y) const {
    if (!std::isfinite(value)) return kNothing;
    const float n = r_.near_plane, f = r_.far_plane;
    switch (r_.depth_kind) {
      case DepthMeaning::kView:
        return value > 0.0f ? value : kNothing;
      case DepthMeaning::kRay: {
        if (!(value > 0.0f)) return kNothing;
        if (r_.orthographic) return value;
        const float across = r_.left + (r_.right - r_.left) * (float(x) + 0.5f) / float(r_.width);
        const float up = r_.top + (r_.bottom - r_.top) * (float(y) + 0.5f) / float(r_.height);
        return value / std::sqrt(1.0f + across * across + up * up);
      }
      case DepthMeaning::kWindow:
        if (value >= 1.0f) return kNothing;
        if (r_.orthographic) return n + std::max(value, 0.0f) * (f - n);
        return std::isfinite(f) ? n * f / (f - std::max(value, 0.0f) * (f - n)) : n / (1.0f - std::max(value, 0.0f));
      case DepthMeaning::kReversed:
        if (value <= 0.0f) return kNothing;
        if (r_.orthographic) return f - std::min(value, 1.0f) * (f - n);
        return std::isfinite(f) ? n * f / (n + std::min(value, 1.0f) * (f - n)) : n / std::min(value, 1.0f);
    }
    return kNothing;
  }

 private:
  const Lens& r_;
};

Result<void> check(const Request& request, const Lens& lens) {
  if (auto fine = check_lens(lens); !fine) return fine;
  if (!(lens.right > lens.left && lens.top > lens.bottom))
    return usage_error(
        "the camera's window cannot be {} to {} and {} to {}: right must be above left, and top above bottom",
        lens.left, lens.right, lens.bottom, lens.top);
  if (lens.scene_radius < 0.0f)
    return usage_error("`scene_radius` cannot be {}: it takes a number above 0, or 0 to derive it from the depth",
                       lens.scene_radius);
  for (const float v : request.gbuffer.view_from_normal)
    if (!std::isfinite(v)) return usage_error("`view_from_normal` holds a number that is not finite");
  return {};
}

/// Checks the description of an image. Errors: kUsage.
Result<void> check_image(const Lens& lens, std::span<const NamedImage> images, const NamedImage& named) {
  const SharedImage& image = named.image;
  const auto channels = channels_of(named.name);
  if (channels.empty()) return unknown_image(named.name);
  if (!image.data) return usage_error("the image '{}' has no pixels", named.name);
  if (image.width != lens.width || image.height != lens.height)
    return usage_error("the image '{}' has {} x {} pixels: the picture has {} x {}", named.name, image.width,
                       image.height, lens.width, lens.height);
  // A colour may have an alpha channel, which is ignored.
  if (image.channels < int(channels.size()))
    return usage_error("the image '{}' cannot have {} channels: it takes {}", named.name, image.channels,
                       channels.size());
  if (image.type == PixelType::kUint32 && !is_id(named.name))
    return usage_error("the image '{}' cannot hold 32-bit integers: only ids can", named.name);
  if (std::any_of(images.begin(), images.end(), [&](const NamedImage& other) {
        return is_id(named.name) && name_on_first_layer(other.name) == name_on_first_layer(named.name) &&
               is_whole(other.image.type) != is_whole(image.type);
      }))
    return usage_error("the image '{}' has integers in one layer and floats in another: all layers take the same",
                       named.name);
  if (std::count_if(images.begin(), images.end(), [&](const NamedImage& other) { return other.name == named.name; }) >
      1)
    return usage_error("there are two images '{}'", named.name);
  return {};
}

bool holds_ids(const NamedImage& named) { return is_id(named.name) && is_whole(named.image.type); }

/// Floats cannot represent all 32-bit ids: planes hold indices into a sorted list of the ids that occur. All layers
/// share the list.
std::vector<std::uint32_t> ids_of(std::span<const NamedImage> images, std::string_view name) {
  std::vector<std::uint32_t> ids;
  for (const NamedImage& named : images)
    if (holds_ids(named) && name_on_first_layer(named.name) == name)
      read_ids(named.image, [&](int, int, std::uint32_t id) {
        if (ids.empty() || ids.back() != id) ids.push_back(id);
      });
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

/// Returns whether the image has the memory layout of a plane, so that it can be used without a copy.
bool has_plane_layout(const NamedImage& named, int channels) {
  const SharedImage& image = named.image;
  const auto size = std::ptrdiff_t(sizeof(float));
  return image.type == PixelType::kFloat32 && image.pixel_stride == size && image.width % kRowAlignment == 0 &&
         image.row_stride == size * plane_stride(image.width) &&
         reinterpret_cast<std::uintptr_t>(image.data) % sizeof(float) == 0 &&
         (channels == 1 || image.channel_stride % size == 0);
}

/// Adds the planes of an image to a layer, as views of the image where possible.
void add_image(const NamedImage& named, const SharedIds& ids, Image& layer) {
  const auto channels = channels_of(named.name);
  const std::string name(name_on_first_layer(named.name));
  for (std::size_t c = 0; c < channels.size(); ++c) {
    Plane& plane = layer.add(name + channels[c]);
    if (has_plane_layout(named, int(channels.size()))) {
      plane =
          Plane::view(reinterpret_cast<const float*>(place_of(named.image, int(c), 0, 0)), layer.width, layer.height);
      continue;
    }
    plane = Plane(layer.width, layer.height);
    if (!holds_ids(named)) {
      read_channel(named.image, int(c), plane);
      continue;
    }
    const std::vector<std::uint32_t>& known = ids.find(name)->second;
    read_ids(named.image, [&](int x, int y, std::uint32_t id) {
      plane.at(x, y) = float(std::lower_bound(known.begin(), known.end(), id) - known.begin());
    });
  }
}

/// Returns whether test(x, y) is true for every pixel. All pixels of a row are tested, so that the loop vectorizes.
template <class Test>
bool holds_everywhere(const Plane& plane, const Test& test) {
  std::atomic<bool> all = true;
  for_rows(plane.height, [&](int y) {
    int wrong = 0;
    for (int x = 0; x < plane.width; ++x) wrong |= int(!test(x, y));
    if (wrong != 0) all = false;
  });
  return all;
}

/// Copies a view, so that the plane can be written.
void own(Plane& plane) {
  if (plane.is_view()) plane = Plane(plane);
}

/// The min and max finite depth; infinity and 0 if there is none.
struct DepthRange {
  float nearest = kNothing, farthest = 0.0f;

  void include(const DepthRange& other) {
    nearest = std::min(nearest, other.nearest);
    farthest = std::max(farthest, other.farthest);
  }
};

/// Returns the range of depths > 0, infinity included. Positive floats have the order of their bits, and integer
/// comparisons vectorize.
DepthRange range_of(const float* depths, int count) {
  constexpr auto kInfinity = std::bit_cast<std::int32_t>(kNothing);
  std::int32_t nearest = kInfinity, farthest = 0;
  for (int x = 0; x < count; ++x) {
    const auto bits = std::bit_cast<std::int32_t>(depths[x]);
    nearest = std::min(nearest, bits);
    farthest = std::max(farthest, bits < kInfinity ? bits : 0);
  }
  return {std::bit_cast<float>(nearest), std::bit_cast<float>(farthest)};
}

/// Converts depth to view depth, in place. Returns its range.
DepthRange convert_depth(const Lens& lens, Plane& depth) {
  std::vector<DepthRange> of_rows(std::size_t(depth.height));
  const auto whole_range = [&] {
    DepthRange range;
    for (const DepthRange& row : of_rows) range.include(row);
    return range;
  };
  std::atomic<bool> is_taken = lens.depth_kind == DepthMeaning::kView;
  if (is_taken)
    for_rows(depth.height, [&](int y) {
      int wrong = 0;
      for (int x = 0; x < depth.width; ++x) wrong |= int(!(depth.row(y)[x] > 0.0f));  // infinity is valid
      if (wrong != 0) is_taken = false;
      of_rows[std::size_t(y)] = range_of(depth.row(y), depth.width);
    });
  if (is_taken) return whole_range();
  own(depth);
  const ViewDepth view_depth(lens);
  for_rows(depth.height, [&](int y) {
    for (int x = 0; x < depth.width; ++x) depth.at(x, y) = view_depth.at(depth.at(x, y), x, y);
    of_rows[std::size_t(y)] = range_of(depth.row(y), depth.width);
  });
  return whole_range();
}

/// Rotates normals to view space and normalizes them; invalid ones become zero.
void rotate_normals(const std::vector<float>& turn, Image& layer) {
  constexpr float kUnit = 2e-6f;  // tolerance of the squared length of a unit vector
  Plane &nx = layer.plane("normal.x"), &ny = layer.plane("normal.y"), &nz = layer.plane("normal.z");
  const bool turned = turn != GBufferSettings().view_from_normal;
  const auto is_unit = [](const glm::vec3& n) { return std::abs(glm::dot(n, n) - 1.0f) <= kUnit; };
  const auto at = [&](int x, int y) { return glm::vec3(nx.row(y)[x], ny.row(y)[x], nz.row(y)[x]); };
  if (!turned && holds_everywhere(nx, [&](int x, int y) {
        const glm::vec3 n = at(x, y);
        const float square = glm::dot(n, n);
        return (std::abs(square - 1.0f) <= kUnit) | ((n.x == 0.0f) & (n.y == 0.0f) & (n.z == 0.0f));
      }))
    return;
  for (Plane* plane : {&nx, &ny, &nz}) own(*plane);
  for_rows(nx.height, [&](int y) {
    for (int x = 0; x < nx.width; ++x) {
      const glm::vec3 n = at(x, y);
      glm::vec3 v = n;
      if (turned)
        v = {turn[0] * n.x + turn[1] * n.y + turn[2] * n.z, turn[3] * n.x + turn[4] * n.y + turn[5] * n.z,
             turn[6] * n.x + turn[7] * n.y + turn[8] * n.z};
      const float length = glm::length(v);
      if (!is_unit(v)) v = length > 0.0f && std::isfinite(length) ? v / length : glm::vec3(0.0f);
      nx.at(x, y) = v.x;
      ny.at(x, y) = v.y;
      nz.at(x, y) = v.z;
    }
  });
}

/// Computes the extent of the scene from the depth of the first layer and its range.
void compute_extent(const Lens& request, const Plane& depth, const DepthRange& range, PictureInfo& info) {
  constexpr int kSamples = 1 << 16;          // pixels to sample: more do not improve the estimate
  constexpr double kOutlierFraction = 0.01;  // fraction of the pixels to ignore, on either side
  const int every = std::max(1, int(std::sqrt(double(depth.width) * depth.height / kSamples)));
  std::vector<float> along[3];
  for (int y = 0; y < depth.height; y += every)
    for (int x = 0; x < depth.width; x += every) {
      const float d = depth.at(x, y);
      if (!std::isfinite(d)) continue;
      const float scale = request.orthographic ? 1.0f : d;
      along[0].push_back(scale * (request.left + (request.right - request.left) * float(x) / float(depth.width)));
      along[1].push_back(scale * (request.top + (request.bottom - request.top) * float(y) / float(depth.height)));
      along[2].push_back(d);
    }
  if (request.scene_radius > 0.0f) info.scene_radius = request.scene_radius;
  if (range.nearest > range.farthest) return;  // no surface is visible: the defaults remain
  info.depth_min = range.nearest;
  info.depth_max = range.farthest;
  if (request.scene_radius > 0.0f) return;
  std::array<float, 3> squares{};
  tbb::parallel_for(std::size_t(0), std::size_t(3), [&](std::size_t axis) {
    std::vector<float>& values = along[axis];
    if (values.empty()) return;
    const auto at = [&](double fraction) {
      const auto place = values.begin() + long(fraction * double(values.size() - 1));
      std::nth_element(values.begin(), place, values.end());
      return *place;
    };
    const float size = at(1.0 - kOutlierFraction) - at(kOutlierFraction);
    squares[axis] = size * size;
  });
  const float square = squares[0] + squares[1] + squares[2];
  // All samples coincide (for example, there is one pixel): use the distance as the size.
  info.scene_radius = square > 0.0f ? 0.5f * std::sqrt(square) : range.farthest;
}

}  // namespace

Error unknown_image(const std::string& name) {
  std::vector<std::string> names;
  for (const PassPlanes& group : grouped_planes(known_planes())) names.push_back(group.name);
  return usage_error("no effect reads or writes an image '{}'{}", name, suggestion(name, names));
}

bool is_id(std::string_view pass) {
  const std::string_view name = name_on_first_layer(pass);
  return name == "object_id" || name == "material_id";
}

Result<SharedGBuffer> gbuffer_of(const Request& request, std::span<const NamedImage> images) {
  const Lens lens = lens_of(request);
  if (auto fine = check(request, lens); !fine) return fine.error();
  SharedGBuffer shared;
  GBuffer& gbuffer = shared.gbuffer;
  if (std::none_of(images.begin(), images.end(), [](const NamedImage& named) { return named.name == "depth"; }))
    return usage_error("a G-buffer needs an image 'depth'");
  int layers = 1;
  for (const NamedImage& named : images) {
    if (auto fine = check_image(lens, images, named); !fine) return fine.error();
    layers = std::max(layers, layer_of_plane(named.name) + 1);
  }
  if (layers > kMaxMixedLayers)
    return usage_error("there are {} layers: at most {} can be shaded", layers, kMaxMixedLayers);
  for (int layer = 0; layer < layers; ++layer) {
    const std::string depth = layer_plane(layer, "depth");
    if (std::none_of(images.begin(), images.end(), [&](const NamedImage& named) { return named.name == depth; }))
      return usage_error("a G-buffer needs an image '{}'", depth);
    gbuffer.layers.emplace_back(request.width, request.height);
    if (layer > 0) gbuffer.info.more_layers.push_back({.kind = LayerKind::kBehind, .of = layer - 1, .camera = {}});
  }
  for (const char* name : {"object_id", "material_id"})
    if (auto ids = ids_of(images, name); !ids.empty()) {
      if (ids.size() > kMaxIds)
        return usage_error("{} has {} ids: at most {} can be distinguished", name, ids.size(), kMaxIds);
      shared.ids[name] = std::move(ids);
    }
  for (const NamedImage& named : images)
    add_image(named, shared.ids, gbuffer.layers[std::size_t(layer_of_plane(named.name))]);
  DepthRange first_range;
  for (Image& layer : gbuffer.layers) {
    Plane& depth = layer.plane("depth");
    const DepthRange range = convert_depth(lens, depth);
    if (&layer == &gbuffer.layers[0]) first_range = range;
    if (layer.find("normal.x")) rotate_normals(request.gbuffer.view_from_normal, layer);
    for (const auto& [name, ids] : shared.ids)
      if (Plane* plane = layer.find(name)) {
        own(*plane);
        for (int y = 0; y < depth.height; ++y)
          for (int x = 0; x < depth.width; ++x)
            if (!std::isfinite(depth.at(x, y))) plane->at(x, y) = -1.0f;
      }
  }
  for (const Image& layer : gbuffer.layers)
    shared.copied +=
        std::count_if(layer.planes.begin(), layer.planes.end(), [](const Plane& p) { return !p.is_view(); });
  PictureInfo& info = gbuffer.info;
  set_lens(lens, info);
  for (LayerInfo& layer : info.more_layers) layer.camera = info.camera;
  compute_extent(lens, gbuffer.layers[0].plane("depth"), first_range, info);
  return shared;
}

std::uint32_t callers_id(std::span<const std::uint32_t> known, float place) {
  return place >= 0.0f && place < float(known.size()) ? known[std::size_t(place)] : 0;
}

}  // namespace umbrage
