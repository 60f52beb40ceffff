// A scene for tests, ray-cast in double: a sphere and a box on a floor before a wall, with known depth and normals; and
// files in the conventions of renderers, in memory.
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <string>
#include <vector>

#include "gbuffers/conventions.h"
#include "gbuffers/convert.h"
#include "gbuffers/packing.h"
#include "gbuffers/role_values.h"
#include "gbuffers/roles.h"
#include "gbuffers/samples.h"

namespace umbrage::test {

struct Hit {
  bool found = false;
  double depth = 0.0, distance = 0.0;  ///< along the axis; along the ray
  glm::dvec3 world{0.0}, normal_world{0.0};
  glm::dvec3 view{0.0}, normal_view{0.0};
  int object = -1;
};

/// The scene seen by a camera at a corner, in a world with z up.
struct TestScene {
  int width = 240, height = 160;
  double fov_deg = 40.0;
  double window_height = 0.0;  ///< of the window of an orthographic camera; 0: perspective
  glm::dvec3 eye{4.0, -6.0, 3.0}, target{0.0, 0.0, 0.8};
  glm::dmat3 view_from_world{1.0};
  std::vector<Hit> hits;

  explicit TestScene(double fov = 40.0, double window = 0.0) : fov_deg(fov), window_height(window) {
    const glm::dvec3 forward = glm::normalize(target - eye), right = glm::normalize(glm::cross(forward, {0, 0, 1})),
                     up = glm::cross(right, forward);
    view_from_world = glm::transpose(glm::dmat3(right, up, -forward));
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) hits.push_back(cast(x, y));
  }

  double top() const { return std::tan(fov_deg * 3.14159265358979323846 / 360.0); }

  Hit cast(double x, double y) const {
    const double u = top() * width / height * (2.0 * (x + 0.5) / width - 1.0),
                 v = top() * (1.0 - 2.0 * (y + 0.5) / height);
    const bool orthographic = window_height > 0.0;
    const glm::dvec3 offset_view =
                         orthographic ? window_height / (2.0 * top()) * glm::dvec3(u, v, 0.0) : glm::dvec3(0.0),
                     ray_view(orthographic ? 0.0 : u, orthographic ? 0.0 : v, -1.0);
    const glm::dvec3 ray = glm::transpose(view_from_world) * ray_view,
                     origin = eye + glm::transpose(view_from_world) * offset_view;
    Hit hit;
    hit.depth = 1e300;
    const auto offer = [&](double t, const glm::dvec3& normal, int object) {
      if (!(t > 0.0 && t < hit.depth)) return;
      hit.found = true;
      hit.depth = t;
      hit.world = origin + t * ray;
      hit.normal_world = glm::dot(normal, ray) > 0.0 ? -normal : normal;
      hit.object = object;
    };
    // The sphere.
    const glm::dvec3 center(0.9, -0.4, 1.0);
    const glm::dvec3 o = origin - center;
    const double a = glm::dot(ray, ray), b = glm::dot(o, ray), c = glm::dot(o, o) - 1.0, root = b * b - a * c;
    if (root > 0.0) {
      const double t = (-b - std::sqrt(root)) / a;
      offer(t, origin + t * ray - center, 1);
    }
    // The box, turned about the vertical axis.
    const double turn = 0.5;
    const glm::dmat3 box(glm::dvec3(std::cos(turn), std::sin(turn), 0), glm::dvec3(-std::sin(turn), std::cos(turn), 0),
                         glm::dvec3(0, 0, 1));
    const glm::dvec3 low(-2.2, -0.6, 0.0), high(-0.8, 0.8, 1.6);
    const glm::dvec3 from = glm::transpose(box) * origin, along = glm::transpose(box) * ray;
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {low[axis], high[axis]}) {
        const double t = (side - from[axis]) / along[axis];
        const glm::dvec3 p = from + t * along;
        bool inside = true;
        for (int other = 0; other < 3; ++other)
          inside = inside && (other == axis || (p[other] >= low[other] && p[other] <= high[other]));
        if (inside) offer(t, box[axis], 2);
      }
    // The floor, of limited size, so that there is background above it.
    const double t = -origin.z / ray.z;
    const glm::dvec3 p = origin + t * ray;
    if (std::abs(p.x) < 8.0 && std::abs(p.y) < 8.0) offer(t, {0, 0, 1}, 0);
    if (!hit.found) return hit;
    hit.normal_world = glm::normalize(hit.normal_world);
    hit.distance = hit.depth * glm::length(ray);
    hit.view = offset_view + hit.depth * ray_view;
    hit.normal_view = view_from_world * hit.normal_world;
    return hit;
  }
};

/// A file of a test: its header, and the values of its channels, filled one by one.
struct TestFile {
  LayeredFile header;
  std::vector<std::vector<float>> values;  ///< of each channel, row by row
  const TestScene& scene;
  double max_integer = 0.0;  ///< of the channels that are added next; 0: floats

  explicit TestFile(const TestScene& made, std::string_view format = "EXR") : scene(made) {
    header.path = "test.exr";
    header.format = format;
    header.width = made.width;
    header.height = made.height;
    header.data = {0, 0, made.width, made.height};
  }

  /// Adds the channel "layer.name" with value(hit) at each pixel; `none`: where nothing was hit.
  void add(const std::string& full_name, float none, const std::function<double(const Hit&)>& value,
           ChannelType type = ChannelType::kFloat, const std::string& part = "") {
    Channel channel;
    const std::size_t dot = full_name.rfind('.');
    channel.part = part;
    if (dot != std::string::npos) channel.layer = full_name.substr(0, dot);
    channel.name = full_name.substr(dot == std::string::npos ? 0 : dot + 1);
    channel.type = type;
    channel.max_integer = max_integer;
    channel.is_srgb = max_integer > 0.0;
    channel.index = int(header.channels.size());
    header.channels.push_back(channel);
    auto& plane = values.emplace_back();
    for (const Hit& hit : scene.hits) plane.push_back(hit.found ? float(value(hit)) : none);
  }

  /// Adds a vector: the names are layer + each of `letters`.
  void add_vector(const std::string& layer, const std::function<glm::dvec3(const Hit&)>& value,
                  std::string_view letters = "XYZ", const std::string& part = "") {
    const std::string start = layer.empty() ? "" : layer + ".";
    for (int axis = 0; axis < 3; ++axis)
      add(
          start + letters[std::size_t(axis)], 0.0f, [&](const Hit& hit) { return value(hit)[axis]; },
          ChannelType::kFloat, part);
  }
};

/// What was understood of a file, and the planes that follow.
struct Understood {
  Roles roles;
  GBufferFacts facts;
  Conventions conventions;
  Image planes;
  std::string error;

  std::string text() const {
    std::string all;
    for (const auto& list : {facts.lines, facts.warnings})
      for (const std::string& line : list) all += line + "\n";
    return all + error;
  }
};

inline Understood understand(const TestFile& file, const GBufferSettings& settings = {}) {
  Understood out;
  const std::vector<RoleFile> files = {{Role::kDepth, true, "test.exr", ""}};
  const std::vector<LayeredFile> headers = {file.header};
  auto roles = find_roles(files, headers, settings.view);
  if (!roles) return out.error = roles.error().message, out;
  out.roles = *roles;
  RawReading reading{.flip = settings.flip};
  reading.read_rows = [&](const LayeredFile& header, std::span<const int> channels, const TakeLayerRows& take) {
    Image stored(header.width, header.height);
    for (const int channel : channels) {
      Plane& plane = stored.add(header.channels[std::size_t(channel)].full_name()) = Plane(stored.width, stored.height);
      const auto& values = file.values[std::size_t(channel)];
      for (int y = 0; y < stored.height; ++y)
        std::copy_n(values.begin() + long(y) * stored.width, stored.width, plane.row(y));
    }
    return take(stored, 0);
  };
  const auto sample_roles = [&](const Roles& some) {
    return sample(*RawPlanes::read(headers, some, reading), 2, 1 << 15);
  };
  if (auto found = find_roles_by_values(settings, headers, sample_roles, out.roles, out.facts); !found)
    return out.error = found.error().message, out;
  if (out.roles[Role::kDepth].empty() && out.roles[Role::kPosition].empty()) return out.error = "no role", out;
  reading.packing = find_packing(settings.depth_packing);
  const auto raw = RawPlanes::read(headers, out.roles, reading);
  const auto samples = sample(*raw, 2, 1 << 15);
  auto conventions = decide_conventions(settings, headers, out.roles, *samples, out.facts);
  if (!conventions) return out.error = conventions.error().message, out;
  out.conventions = *conventions;
  if (!conventions->step_warning.empty()) out.facts.warnings.push_back(conventions->step_warning);
  Conversion conversion{*conventions, out.roles.own, {}, {}};
  if (!out.roles[Role::kObjectId].empty()) conversion.object_ids = *collect_ids(*raw, Role::kObjectId, false);
  const Rows all{0, file.header.height};
  out.planes = convert(*raw->rows(all), conversion, all);
  return out;
}

/// The scene that tests share.
inline const TestScene& scene() {
  static const TestScene made;
  return made;
}

inline const Hit& hit_at(int x, int y) { return scene().hits[std::size_t(y * scene().width + x)]; }

inline bool has_warning(const Understood& got, std::string_view word) {
  for (const std::string& warning : got.facts.warnings)
    if (warning.find(word) != std::string::npos) return true;
  return false;
}

/// A grey PNG without layers, with integers up to `max`.
inline TestFile grey_png(double max, float none, const std::function<double(const Hit&)>& value) {
  TestFile file(scene(), "PNG");
  file.max_integer = max;
  file.add(
      "Y", none, [&](const Hit& hit) { return std::round(value(hit)); },
      max > 255.0 ? ChannelType::kUint16 : ChannelType::kUint8);
  return file;
}

}  // namespace umbrage::test
