#include "kit/frame_fields.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <glm/geometric.hpp>

#include "core/check.h"
#include "devices/shared/dispatches.h"

namespace umbrage {
namespace {

constexpr std::string_view kFrameHeader = "kernel/frame_constants.h";
constexpr double kTolerance = 2e-5;  // relative: constants are computed in single precision

/// A view, by quantities that can change one at a time.
struct View {
  double pixel_width = 0.0021, pixel_height = 0.0023, width = 640.0, height = 400.0, scene_radius = 1.7,
         depth_min = 2.1, depth_max = 5.3;
  double centre_x = 0.45, centre_y = 0.57;  // of the view axis, in the width and height
  bool orthographic = false;
  double left() const { return -centre_x * pixel_width * width; }
  double top() const { return centre_y * pixel_height * height; }
  glm::vec3 light{0.3f, 0.8f, 0.52f};
};

struct Quantity {
  const char* name;
  double View::*value;
};
constexpr Quantity kQuantities[] = {
    {"pixel_width", &View::pixel_width}, {"pixel_height", &View::pixel_height}, {"width", &View::width},
    {"height", &View::height},           {"scene_radius", &View::scene_radius}, {"depth_min", &View::depth_min},
    {"depth_max", &View::depth_max},
};

PictureInfo info_of(const View& view, int factor) {
  PictureInfo info;
  info.width = int(view.width);
  info.height = int(view.height);
  info.camera.projection = view.orthographic ? Projection::kOrthographic : Projection::kPerspective;
  info.camera.left = float(view.left());
  info.camera.right = float(view.left() + view.pixel_width * view.width);
  info.camera.top = float(view.top());
  info.camera.bottom = float(view.top() - view.pixel_height * view.height);
  info.scene_radius = float(view.scene_radius);
  info.depth_min = float(view.depth_min);
  info.depth_max = float(view.depth_max);
  info.reduced = factor;
  info.whole_width = factor * info.width;
  info.whole_height = factor * info.height;
  info.lights = {Light{.direction = glm::normalize(view.light), .casts_shadow = true}};
  return info;
}

/// Computes the constants of an effect, 4 bytes each.
class Constants {
 public:
  Constants(const Effect& effect, const ParameterBytes& params, int factor)
      : effect_(effect), params_(params), factor_(factor) {}

  std::vector<std::uint32_t> of(const View& view) const {
    std::vector<std::uint32_t> words(effect_.constants_size / 4);
    effect_.constants(params_, info_of(view, factor_), words.data());
    return words;
  }

 private:
  const Effect& effect_;
  const ParameterBytes& params_;
  int factor_;
};

/// Returns views that differ from the first in everything.
std::vector<View> other_views() {
  std::vector<View> views;
  for (int k = 0; k < 6; ++k) {
    View view;
    view.orthographic = k % 2 != 0;
    view.pixel_width *= 0.6 + 0.31 * k;
    view.pixel_height *= 0.5 + 0.27 * k;
    view.centre_x += 0.07 * k;
    view.centre_y -= 0.05 * k;
    view.width = 500.0 + 130.0 * k;
    view.height = 700.0 - 70.0 * k;
    view.scene_radius *= 0.4 + 0.9 * k;
    view.depth_min *= 0.3 + 0.2 * k;
    view.depth_max *= 1.2 + 0.8 * k;
    view.light = {0.2f - 0.1f * float(k), 0.1f + 0.2f * float(k), 0.6f};
    views.push_back(view);
  }
  return views;
}

std::string number_text(double value) {
  for (int digits = 1; digits < 9; ++digits) {
    const std::string text = fmt::format("{:.{}g}", value, digits);
    if (std::abs(std::stod(text) / value - 1.0) < 2e-7) return text;
  }
  return fmt::format("{:.9g}", value);
}

/// A constant as a factor times powers of quantities.
struct Monomial {
  double factor = 1.0;
  std::vector<double> exponents = std::vector<double>(std::size(kQuantities), 0.0);

  double of(const View& view) const {
    double value = factor;
    for (std::size_t k = 0; k < exponents.size(); ++k) value *= std::pow(view.*kQuantities[k].value, exponents[k]);
    return value;
  }

  std::string text() const {
    std::string above, below;
    const auto add = [](std::string& text, std::string_view factor) {
      text += (text.empty() ? "" : " * ") + std::string(factor);
    };
    for (std::size_t k = 0; k < exponents.size(); ++k) {
      for (double left = std::abs(exponents[k]); left > 0.25; left -= 1.0) {
        const std::string name = left < 0.75 ? fmt::format("sqrt({})", kQuantities[k].name) : kQuantities[k].name;
        add(exponents[k] > 0.0 ? above : below, name);
      }
    }
    const bool is_one = std::abs(std::abs(factor) - 1.0) < 1e-7 && !above.empty();
    std::string text = is_one ? (factor < 0.0 ? "-" : "") + above : number_text(factor);
    if (!is_one && !above.empty()) text += " * " + above;
    if (below.find('*') != std::string::npos) below = "(" + below + ")";
    return below.empty() ? text : text + " / " + below;
  }
};

bool are_close(double a, double b) { return std::abs(a - b) <= kTolerance * std::max(std::abs(a), std::abs(b)); }

using ValueOf = std::function<double(const View&)>;

/// Returns the formula of a real constant, or an empty text if it is no monomial of the quantities.
std::string monomial_text(const ValueOf& value) {
  Monomial result;
  const View first;
  const double start = value(first);
  if (start == 0.0) return {};
  for (std::size_t k = 0; k < std::size(kQuantities); ++k) {
    View doubled = first;
    doubled.*kQuantities[k].value *= 2.0;
    const double ratio = value(doubled) / start;
    if (!(ratio > 0.0)) return {};
    result.exponents[k] = std::round(2.0 * std::log2(ratio)) / 2.0;
  }
  result.factor = start / result.of(first);
  for (const View& view : other_views())
    if (!are_close(result.of(view), value(view))) return {};
  return result.text();
}

/// Returns the shortest number in [low, high).
std::string number_between(double low, double high) {
  for (int digits = 1; digits < 17; ++digits) {
    const std::string text = fmt::format("{:.{}g}", 0.5 * (low + high), digits);
    if (const double value = std::stod(text); value >= low && value < high) return text;
  }
  return fmt::format("{:.17g}", low);
}

/// Returns the formula of an integer that grows with the height of the picture in steps, min(max(floor(k height + b),
/// min), max); or an empty text.
std::string steps_text(const ValueOf& value) {
  constexpr int kMaxHeight = 16384;
  std::vector<int> values;
  for (int height = 1; height <= kMaxHeight; ++height) {
    View view;
    view.height = height;
    values.push_back(int(value(view)));
  }
  for (const View& view : other_views())  // it depends on nothing else
    if (int(value(view)) != values[std::size_t(view.height) - 1]) return {};
  const int min = values.front(), max = values.back();
  for (const double offset : {0.5, 0.25, 0.75, 0.0, -0.25, -0.5}) {
    double low = 0.0, high = 1e9;  // range of k
    for (int height = 1; height <= kMaxHeight; ++height) {
      const int v = values[std::size_t(height) - 1];
      if (v > min) low = std::max(low, (v - offset) / height);
      if (v < max) high = std::min(high, (v + 1 - offset) / height);
    }
    if (low < high && max > min)
      return fmt::format("min(max(floor({} * height + {}), {}), {})", number_between(low, high), offset, min, max);
  }
  return {};
}

/// Returns the name of a quantity that a constant equals, or an empty text.
std::string name_text(const ValueOf& value) {
  const std::pair<const char*, double (*)(const View&)> names[] = {
      {"orthographic", [](const View& view) { return view.orthographic ? 1.0 : 0.0; }},
      {"left", [](const View& view) { return view.left(); }},
      {"top", [](const View& view) { return view.top(); }},
      {"light_x", [](const View& view) { return double(glm::normalize(view.light).x); }},
      {"light_y", [](const View& view) { return double(glm::normalize(view.light).y); }},
      {"light_z", [](const View& view) { return double(glm::normalize(view.light).z); }},
  };
  const auto views = other_views();
  for (const auto& [name, of] : names) {
    if (std::all_of(views.begin(), views.end(), [&](const View& view) { return are_close(of(view), value(view)); }))
      return name;
  }
  return {};
}

/// Returns the formula of a real constant: a monomial, or one times a side of the window or what the range of a depth
/// buffer makes of depth; or an empty text.
std::string real_text(const ValueOf& value) {
  const std::pair<const char*, double (*)(const View&)> factors[] = {
      {"", [](const View&) { return 1.0; }},
      {"left", [](const View& view) { return view.left(); }},
      {"top", [](const View& view) { return view.top(); }},
      {"depth_max / (depth_max - depth_min)",
       [](const View& view) { return view.depth_max / (view.depth_max - view.depth_min); }},
      {" / (depth_max - depth_min)", [](const View& view) { return 1.0 / (view.depth_max - view.depth_min); }},
  };
  for (const auto& [name, factor] : factors) {
    std::string text = monomial_text([&, of = factor](const View& view) { return value(view) / of(view); });
    if (text.empty()) continue;
    if (std::string_view(name).starts_with(' ')) return text + name;
    return !*name ? text : text == "1" ? name : std::string(name) + " * " + text;
  }
  return {};
}

/// Constants whose formulas are functions that frame.h and frame.js define.
constexpr struct {
  std::string_view effect, field, formula;
} kFunctions[] = {{"bitmask", "mip_levels", "mip_levels(width, height)"},
                  {"bitmask", "mip_rows", "mip_rows(width, height)"}};

std::string formula_of(const Effect& effect, const ConstantField& field, const ValueOf& value) {
  for (const auto& row : kFunctions)
    if (row.effect == effect.name && row.field == field.name) return std::string(row.formula);
  if (std::string text = name_text(value); !text.empty()) return text;
  if (field.type != "int") return real_text(value);
  std::string text = steps_text(value);
  if (!text.empty()) return text;
  text = steps_text([&](const View& view) { return -value(view); });
  return text.empty() ? text : "-" + text;
}

/// Leaves out the zeros at the end of a long array, which no kernel reads.
std::vector<std::uint32_t> trimmed(std::vector<std::uint32_t> words) {
  constexpr std::size_t kShort = 32;
  if (words.size() <= kShort) return words;
  while (words.size() > 1 && words.back() == 0) words.pop_back();
  return words;
}

/// The fields of FrameConstants that shaders may use.
std::vector<FrameField> common_fields() {
  const std::pair<const char*, const char*> formulas[] = {
      {"width", "width"},
      {"height", "height"},
      {"orthographic", "orthographic"},
      {"round", "round"},
      {"ray_scale_x", "pixel_width"},
      {"ray_offset_x", "left"},
      {"ray_scale_y", "-pixel_height"},
      {"ray_offset_y", "top"},
  };
  std::vector<FrameField> fields;
  for (const ConstantField& field : constant_fields(kFrameHeader, "FrameConstants"))
    for (const auto& [name, formula] : formulas)
      if (field.name == name) fields.push_back({field, formula, field.name});
  return fields;
}

}  // namespace

double value_of(const ConstantField& field, std::uint32_t bits) {
  if (field.type == "int") return double(std::int32_t(bits));
  float value = 0.0f;
  std::memcpy(&value, &bits, sizeof value);
  return double(value);
}

PictureInfo usual_picture() {
  View view;
  view.width = 1920.0;
  view.height = 1080.0;
  return info_of(view, 1);
}

EffectFields effect_fields(const Effect& effect, const ParameterBytes& params, std::string_view header,
                           std::string_view constants, int factor) {
  EffectFields result{common_fields(), {}};
  const Constants computed(effect, params, factor);
  const View usual;
  const std::vector<std::uint32_t> first = computed.of(usual);
  std::vector<std::vector<std::uint32_t>> others;
  for (const View& view : other_views()) others.push_back(computed.of(view));
  std::size_t at = 0;
  for (ConstantField field : constant_fields(header, constants)) {
    const std::size_t begin = at;
    at += std::size_t(field.count);
    const auto part = [&](const std::vector<std::uint32_t>& words) {
      return trimmed({words.begin() + long(begin), words.begin() + long(at)});
    };
    if (std::all_of(others.begin(), others.end(), [&](const auto& words) { return part(words) == part(first); })) {
      result.settings.push_back({field, part(first)});
      continue;
    }
    const auto value = [&](const View& view) { return value_of(field, computed.of(view)[begin]); };
    const bool has_more = std::any_of(others.begin(), others.end(), [&](const std::vector<std::uint32_t>& words) {
      return std::any_of(words.begin() + long(begin) + 1, words.begin() + long(at),
                         [&](std::uint32_t word) { return word != 0 && word != words[begin]; });
    });
    const bool is_taken = std::any_of(result.frame.begin(), result.frame.end(),
                                      [&](const FrameField& other) { return other.field.name == field.name; });
    field.count = 1;
    field.is_array = false;
    result.frame.push_back(
        {field, has_more ? "" : formula_of(effect, field, value), is_taken ? "layer_" + field.name : field.name});
  }
  check_equal(at * 4, effect.constants_size, effect.name);
  return result;
}

}  // namespace umbrage
