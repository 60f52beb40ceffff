// Values as colours. The position of a vertex's value on the scale becomes its texture coordinate in a texture that
// holds the colour map, so that devices interpolate values and then look up colours; a
// logarithmic scale interpolates logarithms.
#include "scene/value_colors.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/color.h"
#include "core/suggest.h"
#include "scene/fields.h"

namespace umbrage {
namespace {

using Scale = ValueColors::Scale;

constexpr float kNoValue = std::numeric_limits<float>::quiet_NaN();
constexpr float kMaxPosition = 1e6f;      // so that positions on the scale are interpolated in finite numbers
constexpr float kLinearFraction = 1e-3f;  // linear_threshold of the range's larger end
constexpr int kSteadyColors = 256;        // texels of a texture that is interpolated

/// Returns the scale of a value in no unit, so that a range of it is divided evenly.
float scaled(const ValueColors& colors, float value) {
  if (colors.scale == Scale::kLinear) return value;
  if (colors.scale == Scale::kLog) return value > 0.0f ? std::log(value) : kNoValue;
  const float ratio = std::abs(value) / colors.linear_threshold;
  return std::copysign(ratio <= 1.0f ? ratio : 1.0f + std::log(ratio), value);
}

std::string component_text(int component) {
  return component < 3 ? std::string(1, "xyz"[component]) : std::to_string(component);
}

/// Returns the error for a field that no scene has.
Error missing_field_error(const std::string& name, std::span<const Scene* const> scenes) {
  std::set<std::string> names;
  std::string files;
  for (const Scene* scene : scenes) {
    files += (files.empty() ? "" : ", ") + (scene->name.empty() ? "the scene" : "'" + scene->name + "'");
    for (const Mesh& mesh : scene->meshes)
      for (const Field& field : mesh.fields) names.insert(field.name);
  }
  if (names.empty())
    return field_error("color_by", name, "`{}` '{}': {} {} no fields of values", files,
                       scenes.size() > 1 ? "have" : "has");
  return field_error("color_by", name, "`{}` '{}': {} {} no such field{}", files, scenes.size() > 1 ? "have" : "has",
                     suggestion(name, names));
}

/// The extent of a scene's values.
struct Extent {
  float low = std::numeric_limits<float>::infinity(), high = -low;
  bool has_field = false;
};

/// Adds the values of a mesh that the scale has. Errors: kUsage for a missing component.
Result<void> add_values(const Mesh& mesh, const ValueSettings& settings, Extent& extent) {
  const Field* field = find_values(mesh, settings.field);
  if (!field) return {};
  extent.has_field = true;
  if (settings.component && *settings.component >= field->components)
    return field_error(
        "color_component", *settings.component, "`{}` cannot be '{}': '{}' has {}", settings.field,
        field->components == 1 ? "one component, 0" : fmt::format("the components 0 to {}", field->components - 1));
  for (std::size_t k = 0; k < mesh.positions.size(); ++k) {
    const float value = value_of(*field, k, settings.component);
    if (!std::isfinite(value) || (settings.scale == Scale::kLog && !(value > 0.0f))) continue;
    extent.low = std::min(extent.low, value);
    extent.high = std::max(extent.high, value);
  }
  return {};
}

/// Widens a range of one value.
void widen(bool logarithmic, float& low, float& high) {
  const float value = low;
  if (logarithmic) {
    low = value / 2.0f, high = value * 2.0f;
  } else {
    const float half = value == 0.0f ? 0.5f : 0.5f * std::abs(value);
    low = value - half, high = value + half;
  }
}

std::uint8_t byte_of_color(float v) { return std::uint8_t(std::clamp(v, 0.0f, 1.0f) * 255.0f + 0.5f); }

/// Returns a texture with one colour after the other.
Texture texture_of_colors(const ValueColors& colors) {
  const int width = colors.bands > 0 ? colors.bands : kSteadyColors;
  Texture texture{.name = colors.map.name, .width = width, .height = 1, .rgba = {}};
  texture.nearest = colors.bands > 0;
  texture.clamped = true;
  for (int k = 0; k < width; ++k) {
    for (const float v : colors.at((float(k) + 0.5f) / float(width))) texture.rgba.push_back(byte_of_color(v));
    texture.rgba.push_back(255);
  }
  return texture;
}

glm::vec3 linear_of(const std::array<float, 3>& c) {
  return {linear_from_srgb(c[0]), linear_from_srgb(c[1]), linear_from_srgb(c[2])};
}

/// The materials of a scene that shows values.
enum ValueMaterial { kShown, kMissing, kPoints };

/// What show_values counts.
struct Missing {
  std::size_t values = 0, triangles = 0, points = 0;
};

void color_points(const std::vector<float>& positions, const ValueColors& colors, Mesh& mesh, Missing& missing) {
  mesh.material = kPoints;
  mesh.colors.clear();
  for (const float position : positions) {
    mesh.colors.push_back(linear_of(std::isnan(position) ? colors.missing : colors.at(position)));
    missing.points += std::isnan(position);
  }
}

/// Sets the texture coordinates of a mesh. Moves the triangles without a value to the mesh that is returned.
Mesh color_triangles(const std::vector<float>& positions, Mesh& mesh, Missing& missing) {
  mesh.material = kShown;
  mesh.colors.clear();
  mesh.uvs.clear();
  for (const float position : positions)
    mesh.uvs.emplace_back(std::isnan(position) ? 0.0f : std::clamp(position, -kMaxPosition, kMaxPosition), 0.5f);
  Mesh without;
  without.name = mesh.name;
  without.object = mesh.object;
  without.material = kMissing;
  std::vector<std::uint32_t> kept, number(positions.size(), std::numeric_limits<std::uint32_t>::max());
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const std::uint32_t* const corner = &mesh.indices[i];
    if (std::none_of(corner, corner + 3, [&](std::uint32_t v) { return std::isnan(positions[v]); })) {
      kept.insert(kept.end(), corner, corner + 3);
      continue;
    }
    ++missing.triangles;
    for (int k = 0; k < 3; ++k) {
      std::uint32_t& to = number[corner[k]];
      if (to == std::numeric_limits<std::uint32_t>::max()) {
        to = std::uint32_t(without.positions.size());
        without.positions.push_back(mesh.positions[corner[k]]);
        without.normals.push_back(mesh.normals[corner[k]]);
      }
      without.indices.push_back(to);
    }
  }
  if (!without.indices.empty()) mesh.indices = std::move(kept);
  return without;
}

/// Adds a warning about what has the missing colour.
void warn_of_missing(const ValueSettings& settings, const Missing& missing, Scene& scene) {
  const auto counted = [](std::size_t count, std::size_t all, const char* what) {
    return count == 0 ? std::string() : fmt::format("{} of {} {}", count, all, what);
  };
  const std::string triangles = counted(missing.triangles, scene.triangle_count(), "triangles"),
                    points = counted(missing.points, scene.point_count(), "points");
  if (triangles.empty() && points.empty()) return;
  const auto& c = settings.missing;
  scene.warnings.push_back(fmt::format("{}{}{} have no {}'{}'{} and are drawn in `missing_color` #{:02x}{:02x}{:02x}",
                                       triangles, triangles.empty() || points.empty() ? "" : " and ", points,
                                       settings.scale == Scale::kLog ? "" : "finite ", settings.field,
                                       settings.scale == Scale::kLog ? " above 0" : "", byte_of_color(c[0]),
                                       byte_of_color(c[1]), byte_of_color(c[2])));
}

}  // namespace

std::array<float, 3> ValueColors::at(float position) const {
  if (bands == 0) return map.at(position);
  const int band = std::min(int(std::clamp(position, 0.0f, 1.0f) * float(bands)), bands - 1);
  return map.at(bands == 1 ? 0.5f : float(band) / float(bands - 1));
}

float value_of(const Field& field, std::size_t position, const std::optional<int>& component) {
  const float* const values = &field.values[position * std::size_t(field.components)];
  if (component || field.components == 1) return values[component.value_or(0)];
  double sum = 0.0;
  for (int c = 0; c < field.components; ++c) sum += double(values[c]) * double(values[c]);
  return float(std::sqrt(sum));
}

std::string key_of(const ValueSettings& settings) {
  std::vector<float> numbers(settings.missing.begin(), settings.missing.end());
  if (settings.range) numbers.insert(numbers.end(), settings.range->begin(), settings.range->end());
  for (const auto& color : settings.map.colors) numbers.insert(numbers.end(), color.begin(), color.end());
  return fmt::format(" values '{}' {} {} {} {} {}", settings.field, settings.component.value_or(-1),
                     int(settings.scale), settings.bands, settings.map.smooth, fmt::join(numbers, " "));
}

float position_on_scale(const ValueColors& colors, float value) {
  if (!std::isfinite(value)) return kNoValue;
  const double low = scaled(colors, colors.low), high = scaled(colors, colors.high);
  return float((double(scaled(colors, value)) - low) / (high - low));
}

float value_on_scale(const ValueColors& colors, float position) {
  const double low = scaled(colors, colors.low), high = scaled(colors, colors.high);
  const double at = low + double(position) * (high - low);
  if (colors.scale == Scale::kLinear) return float(at);
  if (colors.scale == Scale::kLog) return float(std::exp(at));
  const double ratio = std::abs(at) <= 1.0 ? std::abs(at) : std::exp(std::abs(at) - 1.0);
  return float(std::copysign(ratio * double(colors.linear_threshold), at));
}

Result<ValueColors> value_colors(const ValueSettings& settings, std::span<const Scene* const> scenes,
                                 std::vector<std::string>& warnings) {
  Extent extent;
  for (const Scene* scene : scenes)
    for (const Mesh& mesh : scene->meshes)
      if (auto added = add_values(mesh, settings, extent); !added) return added.error();
  if (!extent.has_field) return missing_field_error(settings.field, scenes);
  const bool logarithmic = settings.scale == Scale::kLog;
  if (!(extent.low <= extent.high) && !settings.range)
    return field_error("color_by", settings.field, "`{}` '{}': it has no {}",
                       logarithmic ? "value above 0" : "finite value");
  ValueColors out;
  out.name = settings.field;
  if (settings.component) out.name += "." + component_text(*settings.component);
  out.scale = settings.scale;
  out.map = settings.map;
  out.bands = settings.bands;
  out.missing = settings.missing;
  out.low = settings.range ? (*settings.range)[0] : extent.low;
  out.high = settings.range ? (*settings.range)[1] : extent.high;
  if (out.low == out.high) {
    widen(logarithmic, out.low, out.high);
    warnings.push_back(fmt::format("all values of '{}' are {:g}; `color_range` is {:g},{:g}", out.name, extent.low,
                                   out.low, out.high));
  } else if (settings.range && (extent.high < out.low || extent.low > out.high)) {
    warnings.push_back(fmt::format("all values of '{}' are outside of `color_range` {:g},{:g}: they are {:g} to {:g}",
                                   out.name, out.low, out.high, extent.low, extent.high));
  }
  const double spacing = std::max(std::abs(extent.low), std::abs(extent.high)) * std::numeric_limits<float>::epsilon();
  constexpr double kMinSteps = 500.0;  // twice the colours that a picture tells apart
  if (extent.low < extent.high && double(out.high) - double(out.low) < kMinSteps * spacing)
    warnings.push_back(
        fmt::format("values of '{}' are kept as floats, {:.3g} apart in their range: subtract a constant in the file "
                    "to see more of it",
                    out.name, spacing));
  if (out.scale == Scale::kSymlog)
    out.linear_threshold = kLinearFraction * std::max(std::abs(out.low), std::abs(out.high));
  return out;
}

Result<void> show_values(const ValueSettings& settings, Scene& scene) {
  const Scene* const scenes[] = {&scene};
  auto found =
      scene.value_colors ? Result<ValueColors>(*scene.value_colors) : value_colors(settings, scenes, scene.warnings);
  if (!found) return found.error();
  ValueColors& colors = *found;
  Missing missing;
  std::vector<Mesh> without;
  for (Mesh& mesh : scene.meshes) {
    const Field* field = find_values(mesh, settings.field);
    std::vector<float> positions(mesh.positions.size(), kNoValue);
    for (std::size_t k = 0; field && k < positions.size(); ++k)
      positions[k] = position_on_scale(colors, value_of(*field, k, settings.component));
    for (const float position : positions) missing.values += std::isnan(position);
    mesh.fields.clear();
    if (mesh.points)
      color_points(positions, colors, mesh, missing);
    else if (Mesh rest = color_triangles(positions, mesh, missing); !rest.indices.empty())
      without.push_back(std::move(rest));
  }
  for (Mesh& mesh : without) scene.meshes.push_back(std::move(mesh));
  std::erase_if(scene.meshes, [](const Mesh& mesh) { return !mesh.points && mesh.indices.empty(); });
  scene.textures = {texture_of_colors(colors)};
  scene.materials.assign(3, Material{.albedo = glm::vec3(1.0f)});
  scene.materials[kShown].name = colors.name;
  scene.materials[kShown].texture = 0;
  scene.materials[kMissing].albedo = linear_of(settings.missing);
  warn_of_missing(settings, missing, scene);
  colors.missing_count = missing.values;
  scene.value_colors = std::make_shared<const ValueColors>(std::move(colors));
  return {};
}

}  // namespace umbrage
