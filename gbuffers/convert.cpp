#include "gbuffers/convert.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "core/color.h"
#include "core/rows.h"
#include "gbuffers/depth_values.h"

namespace umbrage {
namespace {

constexpr float kNoSurface = std::numeric_limits<float>::infinity();
constexpr const char* kRgb[] = {".r", ".g", ".b"};
constexpr const char* kXyz[] = {".x", ".y", ".z"};

/// Returns the pixel of a row whose value stands for that of the pixel x: itself if is_valid(x), else the nearest valid
/// one close by; -1 if there is none. A row alone decides, so that strips do not show.
template <class IsValid>
int valid_beside(int x, int width, const IsValid& is_valid) {
  constexpr int kReach = 4;  // pixels
  if (is_valid(x)) return x;
  for (int distance = 1; distance <= kReach; ++distance)
    for (const int at : {x - distance, x + distance})
      if (at >= 0 && at < width && is_valid(at)) return at;
  return -1;
}

/// Linear light for stored colours: a table for integers, whose transfer function is slow to compute.
class ColorDecoder {
 public:
  explicit ColorDecoder(const ColorConvention& convention) : factor_(1.0f) {
    constexpr double kMaxTable = 65535.0;
    if (convention.max_integer > 0.0) factor_ = float(1.0 / convention.max_integer);
    is_srgb_ = convention.is_srgb;
    if (!is_srgb_ || !(convention.max_integer > 0.0 && convention.max_integer <= kMaxTable)) return;
    for (int k = 0; k <= int(convention.max_integer); ++k) table_.push_back(linear_from_srgb(float(k) * factor_));
  }
  float operator()(float stored) const {
    if (!std::isfinite(stored)) return 0.0f;
    if (!table_.empty() && stored >= 0.0f && stored < float(table_.size())) return table_[std::size_t(stored)];
    const float v = stored * factor_;
    return is_srgb_ ? linear_from_srgb(std::max(v, 0.0f)) : v;
  }

 private:
  float factor_;
  bool is_srgb_ = false;
  std::vector<float> table_;
};

void add_planes(Image& image, const std::string& name, const char* const (&endings)[3]) {
  for (const char* ending : endings) image.add(name + ending) = Plane(image.width, image.height);
}

/// Decodes a colour role; a single channel fills all three. `times`: a role to multiply by, if it is there.
void convert_color(const RawRows& raw, const Conventions& c, Role role, const std::string& name, Role times,
                   const Rows& rows, Image& out) {
  const Plane* first = raw.find(role, 0);
  if (!first || c.is_unusable[std::size_t(role)]) return;
  add_planes(out, name, kRgb);
  const ColorDecoder decode(c.color[std::size_t(role)]), decode_times(c.color[std::size_t(times)]);
  for (std::size_t channel = 0; channel < 3; ++channel) {
    const Plane* stored = raw.find(role, channel);
    if (!raw.find(role, 1) || !stored) stored = first;
    const Plane* factor = times == role ? nullptr : raw.find(times, channel);
    if (times != role && !factor) factor = raw.find(times, 0);
    Plane& plane = out.plane(name + kRgb[channel]);
    for_rows(rows.begin, rows.end, [&](int y) {
      const float* from = stored->row(y - raw.first);
      const float* by = factor ? factor->row(y - raw.first) : nullptr;
      float* to = plane.row(y - rows.begin);
      for (int x = 0; x < out.width; ++x) {
        const int at = valid_beside(x, out.width, [&](int k) { return std::isfinite(from[k]); });
        to[x] = at < 0 ? 0.0f : decode(from[at]) * (by ? decode_times(by[x]) : 1.0f);
      }
    });
  }
}

/// Returns the plane of the beauty's coverage: its own fourth channel, or a layer; null if there is none.
const Plane* alpha_of(const RawRows& raw) {
  const Plane* own = raw.find(Role::kBeauty, 3);
  return own ? own : raw.find(Role::kAlpha, 0);
}

/// Fills beauty.a and divides premultiplied colours by it.
void convert_alpha(const RawRows& raw, const Conventions& c, const Rows& rows, Image& out) {
  const Plane* alpha = alpha_of(raw);
  if (!alpha || !raw.find(Role::kBeauty, 0) || c.is_unusable[std::size_t(Role::kBeauty)]) return;
  const Role role = raw.find(Role::kBeauty, 3) ? Role::kBeauty : Role::kAlpha;
  const double max = c.color[std::size_t(role)].max_integer;
  const float factor = max > 0.0 ? float(1.0 / max) : 1.0f;
  out.add("beauty.a") = Plane(out.width, out.height);
  std::vector<Plane*> colors;
  if (c.is_premultiplied)
    for (const char* name : {"beauty", "ambient"})
      for (const char* channel : kRgb)
        if (Plane* plane = out.find(std::string(name) + channel)) colors.push_back(plane);
  Plane& to = out.plane("beauty.a");
  for_rows(rows.begin, rows.end, [&](int y) {
    const float* from = alpha->row(y - raw.first);
    for (int x = 0; x < out.width; ++x) {
      const float a = std::isfinite(from[x]) ? std::clamp(from[x] * factor, 0.0f, 1.0f) : 0.0f;
      to.at(x, y - rows.begin) = a;
      // Light without coverage, as of flames, stays as it is.
      if (a > 0.0f)
        for (Plane* plane : colors) plane->at(x, y - rows.begin) /= a;
    }
  });
}

void convert_normals(const RawRows& raw, const Conventions& c, const Rows& rows, Image& out) {
  if (!raw.find(Role::kNormal, 2) || c.is_unusable[std::size_t(Role::kNormal)]) return;
  const Plane *sx = raw.find(Role::kNormal, 0), *sy = raw.find(Role::kNormal, 1), *sz = raw.find(Role::kNormal, 2);
  add_planes(out, "normal", kXyz);
  const Plane& depth = out.plane("depth");
  Plane &nx = out.plane("normal.x"), &ny = out.plane("normal.y"), &nz = out.plane("normal.z");
  const PixelGrid grid(c.camera, c.width, c.height);
  const glm::mat3 rotation(c.normal.view_from_stored);
  for_rows(rows.begin, rows.end, [&](int y) {
    const int from = y - raw.first, to = y - rows.begin;
    const auto v = float(grid.v(y));
    const auto is_valid = [&](int k) {
      return std::isfinite(sx->at(k, from)) && std::isfinite(sy->at(k, from)) && std::isfinite(sz->at(k, from));
    };
    for (int x = 0; x < out.width; ++x) {
      const int source = valid_beside(x, out.width, is_valid);
      const glm::vec3 stored =
          source < 0 ? glm::vec3(0.0f) : glm::vec3(sx->at(source, from), sy->at(source, from), sz->at(source, from));
      const bool empty = stored == glm::vec3(0.0f) || !std::isfinite(depth.at(x, to));
      glm::vec3 n = empty ? glm::vec3(0.0f) : rotation * glm::vec3(c.normal.decoded(stored));
      const float length = glm::length(n);
      n = length > 0.0f && std::isfinite(length) ? n / length : glm::vec3(0.0f);
      // Normals of surfaces that are seen from behind are turned. Smoothed normals may point slightly away.
      constexpr float kAway = 0.3f;  // cosine
      const glm::vec3 ray = grid.orthographic ? glm::vec3(0, 0, -1) : glm::vec3(float(grid.u(x)), v, -1.0f);
      if (glm::dot(n, ray) > kAway * glm::length(ray)) n = -n;
      nx.at(x, to) = n.x;
      ny.at(x, to) = n.y;
      nz.at(x, to) = n.z;
    }
  });
}

void convert_ids(const RawRows& raw, Role role, const std::string& name, const IdTable& table, const Rows& rows,
                 Image& out) {
  if (!raw.find(role, 0)) return;
  const IdReader ids(raw, role);
  Plane& plane = out.add(name) = Plane(out.width, out.height);
  const Plane& depth = out.plane("depth");
  for_rows(rows.begin, rows.end, [&](int y) {
    std::uint32_t last = 0;
    float index = table.index_of(last);
    for (int x = 0; x < out.width; ++x) {
      const std::uint32_t id = ids.at(x, y - raw.first);
      if (id != last) index = table.index_of(id), last = id;
      plane.at(x, y - rows.begin) = std::isfinite(depth.at(x, y - rows.begin)) ? index : -1.0f;
    }
  });
}

void convert_own(const RawRows& raw, const Conversion& conversion, const Rows& rows, Image& out) {
  for (std::size_t k = 0; k < conversion.own.size(); ++k) {
    const Plane* from = raw.find(Role::kOwn, k);
    if (!from) continue;
    Plane& to = out.add(conversion.own[k]) = Plane(out.width, out.height);
    for_rows(rows.begin, rows.end,
             [&](int y) { std::copy_n(from->row(y - raw.first), out.width, to.row(y - rows.begin)); });
  }
}

}  // namespace

Plane converted_depth(const RawRows& raw, const Conventions& c, const Rows& rows) {
  Plane out(c.width, rows.count());
  const PixelGrid grid(c.camera, c.width, c.height);
  const Role role = c.depth.from_position ? Role::kPosition : Role::kDepth;
  const Plane* channels[3] = {raw.find(role, 0), raw.find(role, 1), raw.find(role, 2)};
  const bool by_ray = c.depth.model.meaning == DepthMeaning::kDistance && !c.depth.from_position;
  for_rows(rows.begin, rows.end, [&](int y) {
    for (int x = 0; x < c.width; ++x) {
      std::array<double, 3> stored{};
      for (std::size_t k = 0; k < 3; ++k)
        if (channels[k]) stored[k] = channels[k]->at(x, y - raw.first);
      double depth = kNoDepth;
      if (c.depth.from_position) {
        const glm::dvec3 p(stored[0], stored[1], stored[2]);
        depth = glm::dot(c.position.forward, p - c.position.eye);
        if (p == glm::dvec3(0.0) || !(depth > 0.0) || is_never_depth(depth)) depth = kNoDepth;
      } else {
        depth = view_depth(c.depth.model, stored_depth(c.depth, stored[0]), by_ray ? grid.ray(x, y) : 1.0);
      }
      const auto value = float(depth);
      out.at(x, y - rows.begin) = value > 0.0f ? value : kNoSurface;
    }
  });
  return out;
}

std::vector<std::string> converted_names(const RawPlanes& raw, const Conversion& conversion) {
  std::vector<std::string> names = {"depth"};
  const auto add = [&](const std::string& name, const char* const(&endings)[3]) {
    for (const char* ending : endings) names.push_back(name + ending);
  };
  const auto has = [&](Role role, std::size_t channel = 0) {
    return raw.has(role, channel) && !conversion.conventions.is_unusable[std::size_t(role)];
  };
  if (has(Role::kNormal, 2)) add("normal", kXyz);
  if (has(Role::kAlbedo)) add("albedo", kRgb);
  if (raw.has(Role::kEmission)) add("emission", kRgb);
  if (has(Role::kBeauty)) add("beauty", kRgb);
  if (raw.has(Role::kIndirect)) add("ambient", kRgb);
  if (has(Role::kBeauty) && (raw.has(Role::kBeauty, 3) || raw.has(Role::kAlpha))) names.emplace_back("beauty.a");
  if (raw.has(Role::kObjectId)) names.emplace_back("object_id");
  if (raw.has(Role::kMaterialId)) names.emplace_back("material_id");
  for (const std::string& own : conversion.own) names.push_back(own);
  return names;
}

Image convert(const RawRows& raw, const Conversion& conversion, const Rows& rows) {
  const Conventions& c = conversion.conventions;
  Image out(c.width, rows.count());
  out.add("depth") = converted_depth(raw, c, rows);
  convert_normals(raw, c, rows, out);
  convert_color(raw, c, Role::kAlbedo, "albedo", Role::kAlbedo, rows, out);
  convert_color(raw, c, Role::kEmission, "emission", Role::kEmission, rows, out);
  convert_color(raw, c, Role::kBeauty, "beauty", Role::kBeauty, rows, out);
  convert_color(raw, c, Role::kIndirect, "ambient",
                raw.find(Role::kIndirectColor, 0) ? Role::kIndirectColor : Role::kIndirect, rows, out);
  convert_alpha(raw, c, rows, out);
  convert_ids(raw, Role::kObjectId, "object_id", conversion.object_ids, rows, out);
  convert_ids(raw, Role::kMaterialId, "material_id", conversion.material_ids, rows, out);
  convert_own(raw, conversion, rows, out);
  return out;
}

}  // namespace umbrage
