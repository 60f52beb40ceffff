#include "apps/cli/legend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec4.hpp>
#include <numeric>

#include "apps/cli/page.h"
#include "core/color.h"
#include "scene/value_colors.h"

namespace umbrage::cli {
namespace {

constexpr float kFontShare = 0.024f, kMinFont = 11.0f;  // of the shorter side; pixels
constexpr float kDigitHeight = 0.73f;                   // of digits, as a fraction of the font size
constexpr int kBarColors = 512;                         // max number of colours of a continuous bar

/// Positions in a picture follow from the size of its font.
struct Page {
  float width, height, font;
  DrawnColor ink;

  float margin() const { return 1.2f * font; }
  float line() const { return std::max(1.0f, font / 12.0f); }
};

DrawnPath line_of(const Page& page, float x0, float y0, float x1, float y1) {
  return {.x = x0, .y = y0, .segments = {{x1, y1}}, .stroke = page.ink, .width = page.line(), .round = false};
}

DrawnPath rectangle(float x, float y, float width, float height) {
  return {
      .x = x, .y = y, .segments = {{x + width, y}, {x + width, y + height}, {x, y + height}, {x, y}}, .closed = true};
}

/// Returns a number with a superscript exponent if it is very large or small.
std::string label_of(double value, double step) {
  constexpr double kMaxPlain = 1e5, kMinPlain = 1e-3;
  if (value == 0.0) return "0";
  const double size = std::abs(value);
  const std::string sign = value < 0.0 ? "\u2212" : "";
  if (size < kMaxPlain && step >= kMinPlain) {
    const int decimals = std::clamp(int(std::ceil(-std::log10(step) - 1e-9)), 0, 6);
    return sign + fmt::format("{:.{}f}", size, decimals);
  }
  const int exponent = int(std::floor(std::log10(size) + 1e-9));
  const double mantissa = size / std::pow(10.0, exponent);
  static constexpr const char* kDigits[] = {"\u2070", "\u00b9", "\u00b2", "\u00b3", "\u2074",
                                            "\u2075", "\u2076", "\u2077", "\u2078", "\u2079"};
  std::string power = exponent < 0 ? "\u207b" : "";
  for (const char digit : std::to_string(std::abs(exponent))) power += kDigits[digit - '0'];
  const std::string ten = "10" + power;
  return sign + (std::abs(mantissa - 1.0) < 1e-6 ? ten : fmt::format("{:.4g}\u00d7{}", mantissa, ten));
}

/// Returns the multiples of `step` in a range.
std::vector<double> multiples(double low, double high, double step) {
  std::vector<double> all;
  const double slack = 1e-6 * step;
  for (double k = std::ceil((low - slack) / step); k * step <= high + slack; ++k) all.push_back(k * step);
  return all;
}

/// Returns powers of ten from low to high, both above 0, at most about `count`; with their halves and fifths if they
/// are few.
std::vector<double> powers(double low, double high, int count) {
  std::vector<double> all;
  const double first = std::floor(std::log10(low)), last = std::ceil(std::log10(high));
  const double stride = std::max(1.0, std::ceil((last - first) / std::max(count, 1)));
  const bool few = std::log10(high / low) < 0.5 * count / 1.5;
  for (double e = std::ceil(first / stride) * stride; e <= last; e += stride)
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double value = factor * std::pow(10.0, e);
      if ((factor == 1.0 || few) && value >= low * (1.0 - 1e-6) && value <= high * (1.0 + 1e-6)) all.push_back(value);
    }
  return all;
}

std::vector<double> symlog_ticks(const ValueColors& values, int count) {
  std::vector<double> all;
  const double t = values.linear_threshold, low = values.low, high = values.high;
  if (low < -t) {
    const auto below = powers(std::max(t, -std::min(high, -t)), -low, count / 2);
    for (auto v = below.rbegin(); v != below.rend(); ++v) all.push_back(-*v);
  }
  if (low <= 0.0 && high >= 0.0) all.push_back(0.0);
  if (high > t)
    for (const double v : powers(std::max(t, double(low)), high, count / 2)) all.push_back(v);
  return all;
}

/// Adds the colours of the bar, the low ones at the bottom.
void add_colors(const ValueColors& values, float x, float y, float width, float height, DrawnLayer& layer) {
  const std::size_t count = values.colors.size();
  if (values.bands) {
    for (std::size_t k = 0; k < count; ++k) {
      const float top = height * float(count - 1 - k) / float(count);
      DrawnPath band = rectangle(x, y + top, width, height / float(count));
      band.fill = values.colors[k];
      layer.shapes.emplace_back(std::move(band));
    }
    return;
  }
  DrawnImage image{.x = x, .y = y, .width = width, .height = height, .columns = 1, .rows = kBarColors, .rgba = {}};
  for (int row = 0; row < kBarColors; ++row) {
    const float at = (1.0f - (float(row) + 0.5f) / float(kBarColors)) * float(count - 1);
    const std::size_t k = std::min(std::size_t(at), count - 1), next = std::min(k + 1, count - 1);
    for (std::size_t c = 0; c < 3; ++c) {
      const float value = std::lerp(values.colors[k][c], values.colors[next][c], at - float(k));
      image.rgba.push_back(std::uint8_t(std::lround(255.0f * std::clamp(value, 0.0f, 1.0f))));
    }
    image.rgba.push_back(255);
  }
  layer.shapes.emplace_back(std::move(image));
}

Result<DrawnLayer> color_bar(const LegendSettings& settings, const ValueColors& values, const Page& page) {
  constexpr float kHeight = 0.56f, kTop = 0.14f;  // of the picture
  DrawnLayer layer{.name = "color-bar", .object = -1, .opacity = 1.0f, .shapes = {}};
  const float height = kHeight * page.height, width = 1.3f * page.font, tick = 0.35f * page.font;
  const auto ticks = ticks_of(values, std::clamp(int(height / (2.4f * page.font)), 3, 9));
  float labels = 0.0f;
  for (const Tick& each : ticks) {
    const auto wide = text_width(each.label, page.font);
    if (!wide) return wide.error();
    labels = std::max(labels, *wide);
  }
  constexpr const char* kMissing = "no value";
  const float swatch_label = width + tick;  // from the bar's left side
  if (values.missing_count > 0) {
    const auto wide = text_width(kMissing, page.font);
    if (!wide) return wide.error();
    labels = std::max(labels, *wide - 0.4f * page.font);
  }
  const std::string title = settings.title.empty() ? values.name : settings.title;
  const auto title_width = text_width(title, page.font);
  if (!title_width) return title_width.error();
  const float right = page.width - page.margin(), top = std::max(kTop * page.height, 3.0f * page.font);
  const float labels_x = right - labels, x = labels_x - 0.4f * page.font - tick - width;
  add_colors(values, x, top, width, height, layer);
  DrawnPath frame = rectangle(x, top, width, height);
  frame.stroke = page.ink, frame.width = page.line();
  layer.shapes.emplace_back(std::move(frame));
  for (const Tick& each : ticks) {
    const float y = top + float(1.0 - each.place) * height;
    layer.shapes.emplace_back(line_of(page, x + width, y, x + width + tick, y));
    layer.shapes.emplace_back(DrawnText{.x = labels_x,
                                        .y = y + 0.5f * kDigitHeight * page.font,
                                        .size = page.font,
                                        .color = page.ink,
                                        .text = each.label});
  }
  // A short title begins at the bar; a long one ends at the right margin.
  layer.shapes.emplace_back(DrawnText{.x = std::max(page.margin(), std::min(x, right - *title_width)),
                                      .y = top - 0.9f * page.font,
                                      .size = page.font,
                                      .color = page.ink,
                                      .text = title});
  if (values.missing_count > 0) {
    DrawnPath swatch = rectangle(x, top + height + 0.8f * page.font, width, page.font);
    swatch.fill = values.missing, swatch.stroke = page.ink, swatch.width = page.line();
    layer.shapes.emplace_back(std::move(swatch));
    layer.shapes.emplace_back(DrawnText{.x = x + swatch_label,
                                        .y = top + height + (1.3f + 0.5f * kDigitHeight) * page.font,
                                        .size = page.font,
                                        .color = page.ink,
                                        .text = kMissing});
  }
  return layer;
}

Result<DrawnLayer> scale_bar(const LegendSettings& settings, const Scene& scene, const Camera& camera,
                             const Page& page) {
  constexpr float kMaxShare = 0.22f;  // of the picture's width
  double per_pixel = double(camera.right - camera.left) / double(page.width);
  if (camera.projection == Projection::kPerspective) {
    const float depth = -(camera.view_from_world * glm::vec4(scene.center(), 1.0f)).z;
    if (!(depth > 0.0f))
      return field_error("--scale-bar", true,
                         "{0} needs the centre of the model in front of the camera: give --camera-orthographic");
    per_pixel *= double(depth);
  }
  const double length = round_length(double(kMaxShare * page.width) * per_pixel);
  const float pixels = float(length / per_pixel), right = page.width - page.margin(), left = right - pixels;
  const float y = page.height - page.margin() - 0.35f * page.font, end = 0.35f * page.font;
  DrawnLayer layer{.name = "scale-bar", .object = -1, .opacity = 1.0f, .shapes = {}};
  DrawnPath bar = line_of(page, left, y, right, y);
  bar.width = 2.0f * page.line();
  layer.shapes.emplace_back(std::move(bar));
  for (const float x : {left, right}) layer.shapes.emplace_back(line_of(page, x, y - end, x, y + end));
  const std::string label = label_of(length, length);
  layer.shapes.emplace_back(
      DrawnText{.x = 0.5f * (left + right),
                .y = y - 0.7f * page.font,
                .size = page.font,
                .anchor = TextAnchor::kMiddle,
                .color = page.ink,
                .text = settings.length_unit.empty() ? label : label + " " + settings.length_unit});
  return layer;
}

/// Draws the axes in the lower left corner, the farthest first.
DrawnLayer axes(const Camera& camera, const Page& page) {
  constexpr float kLength = 3.2f, kHead = 0.75f, kHeadWidth = 0.28f, kLabel = 0.75f;  // of the font size
  constexpr DrawnColor kColors[] = {{0.84f, 0.19f, 0.15f}, {0.12f, 0.6f, 0.2f}, {0.2f, 0.42f, 0.9f}};
  constexpr const char* kNames[] = {"x", "y", "z"};
  const glm::mat3 rotation(camera.view_from_world);
  const float reach = (kLength + kLabel + 0.5f) * page.font;
  const float x0 = page.margin() + reach, y0 = page.height - page.margin() - reach;
  DrawnLayer layer{.name = "axes", .object = -1, .opacity = 1.0f, .shapes = {}};
  std::array<int, 3> order = {0, 1, 2};
  std::sort(order.begin(), order.end(), [&](int a, int b) { return rotation[a].z < rotation[b].z; });
  for (const int axis : order) {
    const glm::vec3 v = glm::normalize(rotation[axis]);
    const float dx = v.x, dy = -v.y, seen = std::hypot(dx, dy), length = kLength * page.font;
    const DrawnColor color = kColors[axis];
    if (seen < 0.02f) {  // it points at the camera or away from it
      DrawnPath dot{.x = x0, .y = y0, .segments = {}, .stroke = color, .width = 4.0f * page.line()};
      layer.shapes.emplace_back(std::move(dot));
      continue;
    }
    const float ux = dx / seen, uy = dy / seen, head = std::min(kHead * page.font, 0.7f * seen * length);
    const float tip_x = x0 + length * dx, tip_y = y0 + length * dy;
    const float base_x = tip_x - head * ux, base_y = tip_y - head * uy, half = kHeadWidth * page.font;
    DrawnPath shaft = line_of(page, x0, y0, base_x, base_y);
    shaft.stroke = color, shaft.width = 1.8f * page.line(), shaft.round = true;
    layer.shapes.emplace_back(std::move(shaft));
    layer.shapes.emplace_back(DrawnPath{.x = tip_x,
                                        .y = tip_y,
                                        .segments = {{base_x - half * uy, base_y + half * ux},
                                                     {base_x + half * uy, base_y - half * ux},
                                                     {tip_x, tip_y}},
                                        .closed = true,
                                        .fill = color});
    layer.shapes.emplace_back(DrawnText{.x = tip_x + kLabel * page.font * ux,
                                        .y = tip_y + kLabel * page.font * uy + 0.27f * page.font,
                                        .size = page.font,
                                        .anchor = TextAnchor::kMiddle,
                                        .color = page.ink,
                                        .text = kNames[axis]});
  }
  return layer;
}

}  // namespace

DrawnColor ink_on(const DrawnColor& background) {
  constexpr float kMiddle = 0.18f;  // linear luminance at which black and white have about the same contrast
  const float luminance = 0.2126f * linear_from_srgb(background[0]) + 0.7152f * linear_from_srgb(background[1]) +
                          0.0722f * linear_from_srgb(background[2]);
  const float level = luminance > kMiddle ? 0.08f : 0.94f;
  return {level, level, level};
}

float default_font_size(float side) { return std::max(kMinFont, kFontShare * side); }

double round_length(double max) {
  const double power = std::pow(10.0, std::floor(std::log10(max)));
  for (const double factor : {5.0, 2.0})
    if (factor * power <= max * (1.0 + 1e-9)) return factor * power;
  return power;
}

std::vector<Tick> ticks_of(const ValueColors& values, int max_count) {
  const double low = values.low, high = values.high;
  std::vector<double> at;
  double step = 0.0;
  if (values.bands && int(values.colors.size()) <= max_count && values.scale == ValueColors::Scale::kLinear) {
    const double count = double(values.colors.size()), width = (high - low) / count;
    for (double k = 0.0; k <= count; ++k) at.push_back(low + k * width);
    // As many decimals as the limits need, at most three digits of their distance.
    for (step = std::pow(10.0, std::floor(std::log10(width))); step > 0.002 * width; step /= 10.0)
      if (std::all_of(at.begin(), at.end(), [&](double v) { return std::abs(v / step - std::round(v / step)) < 1e-4; }))
        break;
  } else if (values.scale == ValueColors::Scale::kLinear) {
    step = round_length((high - low) / double(max_count));
    at = multiples(low, high, step);
    while (int(at.size()) > max_count) {
      step = round_length(2.5 * step * (1.0 + 1e-9));
      at = multiples(low, high, step);
    }
  } else {
    at = values.scale == ValueColors::Scale::kLog ? powers(low, high, max_count) : symlog_ticks(values, max_count);
  }
  std::vector<Tick> ticks;
  for (const double v : at)
    ticks.push_back({double(position_on_scale(values, float(v))), label_of(v, step > 0.0 ? step : std::abs(v))});
  return ticks;
}

Result<std::vector<DrawnLayer>> legends_of(const LegendSettings& settings, const Scene& scene, const Camera& camera,
                                           int width, int height) {
  const float side = float(std::min(width, height));
  const float font = settings.font_size > 0.0f ? settings.font_size : default_font_size(side);
  const Page page{float(width), float(height), font, settings.ink};
  std::vector<DrawnLayer> layers;
  if (settings.color_bar) {
    if (!scene.value_colors)
      return field_error("--color-bar", true, "{0} shows the values of --color-by, which is not given");
    auto bar = color_bar(settings, *scene.value_colors, page);
    if (!bar) return bar.error();
    layers.push_back(std::move(*bar));
  }
  if (settings.scale_bar) {
    auto bar = scale_bar(settings, scene, camera, page);
    if (!bar) return bar.error();
    layers.push_back(std::move(*bar));
  }
  if (settings.axes) layers.push_back(axes(camera, page));
  return layers;
}

}  // namespace umbrage::cli
