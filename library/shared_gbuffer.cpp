#include "library/shared_gbuffer.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "core/rows.h"
#include "core/suggest.h"
#include "gbuffers/camera_guess.h"
#include "gbuffers/conventions.h"
#include "gbuffers/extent.h"
#include "gbuffers/ids.h"
#include "gbuffers/normal_guess.h"
#include "library/lens.h"
#include "renderer/passes.h"

namespace umbrage {
namespace {

constexpr float kNoSurface = std::numeric_limits<float>::infinity();

/// Returns whether a distance is one of the values that renderers write where there is no surface: 1e10 (Cycles), 65504
/// (infinity stored as a half float that may not be infinite), the largest float.
bool means_no_surface(float distance) {
  constexpr float kCyclesBackground = 1e10f, kMaxHalf = 65504.0f;
  return distance == kCyclesBackground || distance == kMaxHalf || distance == std::numeric_limits<float>::max();
}

/// Computes the view depth of one pixel; infinity where there is no surface.
class ViewDepth {
 public:
  explicit ViewDepth(const Lens& lens) : lens_(lens) {}

  float at(float value, int x, int y) const {
    if (!std::isfinite(value)) return kNoSurface;
    const float n = lens_.near_plane, f = lens_.far_plane;
    switch (lens_.depth_kind) {
      case DepthMeaning::kPlanar:
        return value > 0.0f && !means_no_surface(value) ? value : kNoSurface;
      case DepthMeaning::kDistance: {
        if (!(value > 0.0f) || means_no_surface(value)) return kNoSurface;
        if (lens_.orthographic) return value;
        const float across = lens_.left + (lens_.right - lens_.left) * (float(x) + 0.5f) / float(lens_.width);
        const float up = lens_.top + (lens_.bottom - lens_.top) * (float(y) + 0.5f) / float(lens_.height);
        return value / std::sqrt(1.0f + across * across + up * up);
      }
      case DepthMeaning::kWindow:
        if (value >= 1.0f) return kNoSurface;
        if (lens_.orthographic) return n + std::max(value, 0.0f) * (f - n);
        return std::isfinite(f) ? n * f / (f - std::max(value, 0.0f) * (f - n)) : n / (1.0f - std::max(value, 0.0f));
      case DepthMeaning::kReversed:
        if (value <= 0.0f) return kNoSurface;
        if (lens_.orthographic) return f - std::min(value, 1.0f) * (f - n);
        return std::isfinite(f) ? n * f / (n + std::min(value, 1.0f) * (f - n)) : n / std::min(value, 1.0f);
      case DepthMeaning::kDisparity:
      case DepthMeaning::kHeight:
      case DepthMeaning::kAuto:
        break;  // refused by check_settings
    }
    return kNoSurface;
  }

 private:
  const Lens& lens_;
};

/// Returns the first field of these settings that is set and applies to files alone, or null.
const char* set_for_files(const GBufferSettings& set) {
  const GBufferSettings initial;
  const std::pair<const char*, bool> fields[] = {
      {"view", !set.view.empty()},
      {"depth_scale", set.depth_scale.has_value()},
      {"depth_offset", set.depth_offset.has_value()},
      {"depth_range", !set.depth_range.empty()},
      {"depth_invert", set.depth_invert},
      {"depth_packing", set.depth_packing != initial.depth_packing},
      {"depth_background", set.depth_background.has_value()},
      {"flip", set.flip},
      {"cell_size", set.cell_size.has_value()},
      {"repair", set.repair != initial.repair},
      {"normal_space", set.normal_space != initial.normal_space},
      {"position_space", set.position_space != initial.position_space},
      {"fov_deg", set.fov_deg.has_value()},
      {"focal_length_mm", set.focal_length_mm.has_value()},
      {"sensor_width_mm", set.sensor_width_mm != initial.sensor_width_mm},
  };
  for (const auto& [field, is_set] : fields)
    if (is_set) return field;
  return nullptr;
}

/// Checks the camera and the settings of a G-buffer. Errors: kUsage.
Result<void> check_settings(const Request& request, const Lens& lens) {
  if (lens.depth_kind > DepthMeaning::kReversed)
    return field_error("depth_kind", request.gbuffer.depth_kind,
                       "`{}` {} is for files: an image in memory takes planar, distance, window or reversed");
  if (const char* field = set_for_files(request.gbuffer))
    return field_error(
        field, "",
        "`{}` is for files: images in memory hold planar depth in scene units or the depth_kind that is set, "
        "and take `window` or `view_from_normal`");
  if (!request.gbuffer.focal_length_px.empty() && !request.gbuffer.window.empty())
    return usage_error("`window` and `focal_length_px` exclude each other: give one");
  if (auto status = check_lens(lens); !status) return status;
  if (!(lens.right > lens.left && lens.top > lens.bottom))
    return usage_error(
        "the camera's window cannot be {} to {} and {} to {}: right must be above left, and top above bottom",
        lens.left, lens.right, lens.bottom, lens.top);
  if (lens.scene_radius < 0.0f)
    return field_error("scene_radius", lens.scene_radius,
                       "`{}` cannot be '{}': it takes a number above 0, or 0 to derive it from the depth");
  for (const float v : request.gbuffer.view_from_normal)
    if (!std::isfinite(v)) return field_error("view_from_normal", "", "`{}` holds a number that is not finite");
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

bool has_integer_ids(const NamedImage& named) { return is_id(named.name) && is_whole(named.image.type); }

/// Returns the ids that occur in the images of a plane in any layer, sorted. Planes hold indices into this list,
/// because floats cannot represent all 32-bit ids.
std::vector<std::uint32_t> ids_of(std::span<const NamedImage> images, std::string_view name) {
  std::vector<std::uint32_t> ids;
  for (const NamedImage& named : images)
    if (has_integer_ids(named) && name_on_first_layer(named.name) == name)
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
    if (!has_integer_ids(named)) {
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
bool is_true_everywhere(const Plane& plane, const Test& test) {
  std::atomic<bool> all = true;
  for_rows(0, plane.height, [&](int y) {
    int wrong = 0;
    for (int x = 0; x < plane.width; ++x) wrong |= int(!test(x, y));
    if (wrong != 0) all = false;
  });
  return all;
}

/// Copies a view, so that the plane can be written.
void make_owned(Plane& plane) {
  if (plane.is_view()) plane = Plane(plane);
}

/// The min and max finite depth; infinity and 0 if there is none.
struct DepthRange {
  float nearest = kNoSurface, farthest = 0.0f;
  long negative = 0;  ///< number of lengths below 0, which show no surface

  void include(const DepthRange& other) {
    negative += other.negative;
    nearest = std::min(nearest, other.nearest);
    farthest = std::max(farthest, other.farthest);
  }
};

/// Returns the range of the finite depths; all depths must be > 0, and may be infinite. Compares bits as integers:
/// positive floats have the same order, and integer comparisons vectorize.
DepthRange range_of(const float* depths, int count) {
  constexpr auto kInfinity = std::bit_cast<std::int32_t>(kNoSurface);
  std::int32_t nearest = kInfinity, farthest = 0;
  for (int x = 0; x < count; ++x) {
    const auto bits = std::bit_cast<std::int32_t>(depths[x]);
    nearest = std::min(nearest, bits);
    farthest = std::max(farthest, bits < kInfinity ? bits : 0);
  }
  return {std::bit_cast<float>(nearest), std::bit_cast<float>(farthest)};
}

/// Converts depth to view depth, in place. Returns the range of the view depth.
DepthRange convert_depth(const Lens& lens, Plane& depth) {
  std::vector<DepthRange> row_ranges(std::size_t(depth.height));
  const auto whole_range = [&] {
    DepthRange range;
    for (const DepthRange& row : row_ranges) range.include(row);
    return range;
  };
  std::atomic<bool> is_view_depth = lens.depth_kind == DepthMeaning::kPlanar;
  if (is_view_depth)
    for_rows(0, depth.height, [&](int y) {
      int wrong = 0;
      for (int x = 0; x < depth.width; ++x)  // infinity is valid
        wrong |= int(!(depth.row(y)[x] > 0.0f)) | int(means_no_surface(depth.row(y)[x]));
      if (wrong != 0) is_view_depth = false;
      row_ranges[std::size_t(y)] = range_of(depth.row(y), depth.width);
    });
  if (is_view_depth) return whole_range();
  make_owned(depth);
  const ViewDepth view_depth(lens);
  const bool is_length = lens.depth_kind == DepthMeaning::kPlanar || lens.depth_kind == DepthMeaning::kDistance;
  for_rows(0, depth.height, [&](int y) {
    float* row = depth.row(y);
    const long negative = is_length ? std::count_if(row, row + depth.width, [](float v) { return v < 0.0f; }) : 0;
    for (int x = 0; x < depth.width; ++x) row[x] = view_depth.at(row[x], x, y);
    row_ranges[std::size_t(y)] = range_of(row, depth.width);
    row_ranges[std::size_t(y)].negative = negative;
  });
  return whole_range();
}

/// Returns samples of the planes of a layer whose values may tell that they are not what they are to be.
Samples samples_of(const Image& layer) {
  constexpr int kCount = 2048, kNarrow = 90, kWidth = 240, kMinReach = 4;  // as for depth in files that is in steps
  RawRows rows;
  for (const auto& [role, name] : {std::pair(Role::kDepth, "depth"), std::pair(Role::kNormal, "normal"),
                                   std::pair(Role::kAlbedo, "albedo"), std::pair(Role::kBeauty, "beauty")}) {
    const auto channels = channels_of(name);
    for (std::size_t c = 0; c < channels.size(); ++c)
      if (const Plane* plane = layer.find(name + channels[c])) {
        rows.names.push_back(raw_plane(role, c));
        rows.planes.push_back(plane);
      }
  }
  const int reach = std::max(std::clamp(layer.width / kNarrow, 1, kMinReach), layer.width / kWidth);
  return *sample(
      layer.width, layer.height, [&](const Rows&) -> Result<RawRows> { return rows; }, reach, kCount);
}

/// Warns of values that make a wrong picture. Returns NormalCheck::unsigned_max.
std::optional<double> check_values(const GBufferSettings& settings, const Camera& camera, const Image& layer,
                                   std::vector<std::string>& warnings) {
  const Samples samples = samples_of(layer);
  const NormalCheck check = layer.find("normal.x") ? check_normals(samples, camera, settings) : NormalCheck();
  std::string encoded;
  if (check.unsigned_max && settings.normal_encoding == "auto")
    encoded = fmt::format(
        "`normal` has components from 0 to {:g}{}, which are decoded to -1 to 1: `normal_encoding` unsigned says so, "
        "and signed prevents it",
        *check.unsigned_max, *check.unsigned_max == 1.0 ? ", or to the max of integers" : "");
  for (const std::string& warning : {color_warning(samples, Role::kAlbedo, "`albedo`"),
                                     color_warning(samples, Role::kBeauty, "`beauty`"), encoded, check.mismatch})
    if (!warning.empty()) warnings.push_back(warning);
  return check.unsigned_max;
}

/// Decodes normals whose components from 0 to `unsigned_max` stand for -1 to 1, if that is set; rotates them to view
/// space, and normalizes them. Invalid ones become zero.
void convert_normals(std::optional<double> unsigned_max, const std::vector<float>& rotation, Image& layer) {
  constexpr float kUnitTolerance = 2e-6f;  // for the squared length of a unit vector
  Plane &nx = layer.plane("normal.x"), &ny = layer.plane("normal.y"), &nz = layer.plane("normal.z");
  const std::vector<float> identity = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const bool is_rotated = !rotation.empty() && rotation != identity;
  const auto is_unit = [](const glm::vec3& n) { return std::abs(glm::dot(n, n) - 1.0f) <= kUnitTolerance; };
  const auto at = [&](int x, int y) { return glm::vec3(nx.row(y)[x], ny.row(y)[x], nz.row(y)[x]); };
  const float scale = unsigned_max ? float(2.0 / *unsigned_max) : 1.0f, offset = unsigned_max ? -1.0f : 0.0f;
  if (!is_rotated && !unsigned_max && is_true_everywhere(nx, [&](int x, int y) {
        const glm::vec3 n = at(x, y);
        const float square = glm::dot(n, n);
        return (std::abs(square - 1.0f) <= kUnitTolerance) | ((n.x == 0.0f) & (n.y == 0.0f) & (n.z == 0.0f));
      }))
    return;
  for (Plane* plane : {&nx, &ny, &nz}) make_owned(*plane);
  for_rows(0, nx.height, [&](int y) {
    for (int x = 0; x < nx.width; ++x) {
      const glm::vec3 stored = at(x, y), n = stored == glm::vec3(0.0f) ? stored : scale * stored + offset;
      glm::vec3 v = n;
      if (is_rotated)
        v = {rotation[0] * n.x + rotation[1] * n.y + rotation[2] * n.z,
             rotation[3] * n.x + rotation[4] * n.y + rotation[5] * n.z,
             rotation[6] * n.x + rotation[7] * n.y + rotation[8] * n.z};
      const float length = glm::length(v);
      if (!is_unit(v)) v = length > 0.0f && std::isfinite(length) ? v / length : glm::vec3(0.0f);
      nx.at(x, y) = v.x;
      ny.at(x, y) = v.y;
      nz.at(x, y) = v.z;
    }
  });
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
  if (auto status = check_settings(request, lens); !status) return status.error();
  SharedGBuffer shared;
  GBuffer& gbuffer = shared.gbuffer;
  if (std::none_of(images.begin(), images.end(), [](const NamedImage& named) { return named.name == "depth"; }))
    return usage_error("a G-buffer needs an image 'depth'");
  int layers = 1;
  for (const NamedImage& named : images) {
    if (auto status = check_image(lens, images, named); !status) return status.error();
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
  PictureInfo& info = gbuffer.info;
  set_lens(lens, info);
  for (LayerInfo& layer : info.more_layers) layer.camera = info.camera;
  if (!request.gbuffer.focal_length_px.empty())
    if (auto warning = center_warning(info.camera, info.width, info.height); !warning.empty())
      shared.warnings.push_back(std::move(warning));
  DepthRange first_range;
  long negative = 0;
  for (Image& layer : gbuffer.layers) {
    Plane& depth = layer.plane("depth");
    const DepthRange range = convert_depth(lens, depth);
    if (&layer == &gbuffer.layers[0]) first_range = range;
    negative += range.negative;
    const auto unsigned_max = check_values(request.gbuffer, info.camera, layer, shared.warnings);
    if (layer.find("normal.x")) convert_normals(unsigned_max, request.gbuffer.view_from_normal, layer);
    for (const auto& [name, ids] : shared.ids)
      if (Plane* plane = layer.find(name)) {
        make_owned(*plane);
        for (int y = 0; y < depth.height; ++y)
          for (int x = 0; x < depth.width; ++x)
            if (!std::isfinite(depth.at(x, y))) plane->at(x, y) = -1.0f;
      }
  }
  for (const Image& layer : gbuffer.layers)
    shared.copied +=
        std::count_if(layer.planes.begin(), layer.planes.end(), [](const Plane& p) { return !p.is_view(); });
  if (negative > 0)
    shared.warnings.push_back(fmt::format("{} of {} depths are below 0 and show no surface", negative,
                                          long(request.width) * request.height * layers));
  if (first_range.farthest == 0.0f) shared.warnings.emplace_back("the depth shows no surface: all of it is background");
  ExtentOfDepth extent(info);
  extent.add_range(first_range.nearest, first_range.farthest);
  const Plane& depth = gbuffer.layers[0].plane("depth");
  for (int y = 0; y < depth.height; ++y) extent.add_sample(depth.row(y), y);
  extent.finish(lens.scene_radius, info);
  return shared;
}

std::uint32_t caller_id(std::span<const std::uint32_t> known, float index) {
  return index >= 0.0f && index < float(known.size()) ? known[std::size_t(index)] : 0;
}

}  // namespace umbrage
