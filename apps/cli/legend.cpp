#include "apps/cli/legend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <numeric>

#include "apps/cli/page.h"
#include "core/color.h"
#include "core/printable.h"

namespace umbrage::cli {
namespace {

constexpr float kFontFraction = 0.024f, kMinFont = 11.0f;  // of the shorter side; pixels
constexpr float kDigitHeight = 0.73f;                      // of digits, as a fraction of the font size
constexpr float kMaxFontFraction = 1.0f / 14.0f;           // of the shorter side, so that legends do not meet
constexpr float kMinShrink = 0.5f;                         // of the letters of a long title
constexpr float kBarSpace = 9.0f;                          // free space for a colour bar, in sizes of the font
constexpr float kAxesSpace = 7.5f, kScaleSpace = 3.5f;     // likewise for axes and a scale bar
constexpr int kBarColors = 512;                            // max number of colours of a continuous bar

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

DrawnText text_of(const Page& page, float x, float y, std::string text, TextAnchor anchor = TextAnchor::kStart) {
  return {.x = x, .y = y, .size = page.font, .anchor = anchor, .color = page.ink, .text = std::move(text)};
}

DrawnPath rectangle(float x, float y, float width, float height) {
  return {
      .x = x, .y = y, .segments = {{x + width, y}, {x + width, y + height}, {x, y + height}, {x, y}}, .closed = true};
}

constexpr double kMaxPlain = 1e6, kMinPlain = 1e-3;  // numbers outside are written with a power of ten

/// Returns 10 with a superscript exponent.
std::string power_text(int exponent) {
  static constexpr const char* kDigits[] = {"\u2070", "\u00b9", "\u00b2", "\u00b3", "\u2074",
                                            "\u2075", "\u2076", "\u2077", "\u2078", "\u2079"};
  std::string text = exponent < 0 ? "10\u207b" : "10";
  for (const char digit : std::to_string(std::abs(exponent))) text += kDigits[digit - '0'];
  return text;
}

int exponent_of(double size) { return int(std::floor(std::log10(size) + 1e-9)); }

/// Returns a number with this number of decimals and a true minus sign.
std::string plain_text(double value, int decimals) {
  const std::string digits = fmt::format("{:.{}f}", std::abs(value), decimals);
  return value < 0.0 && digits.find_first_not_of("0.") != std::string::npos ? "\u2212" + digits : digits;
}

/// Returns a number of a logarithmic scale: with at most three digits, as a power of ten if `scientific`.
std::string log_text(double value, bool scientific) {
  if (value == 0.0) return "0";
  const int exponent = exponent_of(std::abs(value));
  const std::string sign = value < 0.0 ? "\u2212" : "";
  const double unit = std::pow(10.0, exponent - 2);
  if (!scientific) return sign + fmt::format("{:.10g}", std::round(std::abs(value) / unit) * unit);
  const double mantissa = std::abs(value) / std::pow(10.0, exponent);
  const std::string power = power_text(exponent);
  return sign + (std::abs(mantissa - 1.0) < 1e-3 ? power : fmt::format("{:.3g}\u00d7{}", mantissa, power));
}

/// Returns the multiples of `step` in a range.
std::vector<double> multiples(double low, double high, double step) {
  std::vector<double> all;
  // Ends that are floats may miss a multiple by rounding.
  const double rounding = 2e-7 * std::max(std::abs(low), std::abs(high));
  const double slack = std::min(std::max(1e-6 * step, rounding), 0.1 * step);
  for (double k = std::ceil((low - slack) / step); k * step <= high + slack; ++k) all.push_back(k * step);
  return all;
}

/// Returns round numbers in a range, at most `max_count`.
std::vector<double> round_numbers(double low, double high, int max_count) {
  double step = round_length((high - low) / double(max_count));
  for (;;) {
    std::vector<double> all = multiples(low, high, step);
    if (int(all.size()) <= max_count) return all;
    step = round_length(2.5 * step * (1.0 + 1e-9));
  }
}

/// Returns powers of ten from low to high, both above 0, at most `max_count`: with their double and fivefold if they
/// are few, and round numbers within a decade.
std::vector<double> powers(double low, double high, int max_count) {
  const int first = int(std::ceil(std::log10(low) - 1e-6)), last = int(std::floor(std::log10(high) + 1e-6));
  const int decades = last - first + 1, count = std::max(max_count, 1);
  if (decades < 2) return round_numbers(low, high, count);
  const int stride = (decades + count - 1) / count;
  std::vector<double> all;
  for (int e = last; e >= first; e -= stride) all.push_back(std::pow(10.0, e));
  if (3 * decades <= count + 2)
    for (int e = first - 1; e <= last; ++e)
      for (const double value : {2.0 * std::pow(10.0, e), 5.0 * std::pow(10.0, e)})
        if (value >= low && value <= high) all.push_back(value);
  std::sort(all.begin(), all.end());
  return all;
}

std::vector<double> symlog_ticks(const ValueColors& values, int max_count) {
  std::vector<double> all;
  const double t = values.linear_threshold, low = values.low, high = values.high;
  const auto add = [&](double from, double to, double sign) {
    if (to > from)
      for (const double v : powers(from, to, max_count / 2)) all.push_back(sign * v);
  };
  add(std::max(t, -high), -low, -1.0);
  if (low <= 0.0 && high >= 0.0) all.push_back(0.0);
  add(std::max(t, low), high, 1.0);
  std::sort(all.begin(), all.end());
  return all;
}

/// Returns the limits of the bands, or each n-th of them if they are more than `max_count`.
std::vector<double> band_limits(const ValueColors& values, int max_count) {
  const int count = values.bands, stride = (count + max_count) / max_count;
  std::vector<double> all;
  for (int k = 0; k <= count; k += stride)
    all.push_back(k == count ? double(values.high) : double(value_on_scale(values, float(k) / float(count))));
  return all;
}

/// Returns the number of decimals that tell evenly spaced numbers apart, and show them exactly if three digits of their
/// distance suffice.
int decimals_of(const std::vector<double>& numbers) {
  if (numbers.size() < 2)
    return numbers.empty() || numbers[0] == 0.0 ? 0 : std::max(0, 2 - exponent_of(std::abs(numbers[0])));
  const int first = -exponent_of(numbers[1] - numbers[0]);
  for (int decimals = first; decimals < first + 3; ++decimals) {
    const double unit = std::pow(10.0, -decimals);
    if (std::all_of(numbers.begin(), numbers.end(),
                    [&](double v) { return std::abs(v / unit - std::round(v / unit)) < 1e-3; }))
      return std::max(decimals, 0);
  }
  return std::max(first + 2, 0);
}

/// Adds the colours of the bar, the low ones at the bottom.
void add_colors(const ValueColors& values, float x, float y, float width, float height, DrawnLayer& layer) {
  for (int k = 0; k < values.bands; ++k) {
    const auto count = float(values.bands);
    DrawnPath band = rectangle(x, y + height * (count - 1.0f - float(k)) / count, width, height / count);
    band.fill = values.at((float(k) + 0.5f) / count);
    layer.shapes.emplace_back(std::move(band));
  }
  if (values.bands > 0) return;
  DrawnImage image{.x = x, .y = y, .width = width, .height = height, .columns = 1, .rows = kBarColors, .rgba = {}};
  for (int row = 0; row < kBarColors; ++row) {
    for (const float value : values.at(1.0f - (float(row) + 0.5f) / float(kBarColors)))
      image.rgba.push_back(std::uint8_t(std::lround(255.0f * value)));
    image.rgba.push_back(255);
  }
  layer.shapes.emplace_back(std::move(image));
}

/// The font is installed. Errors: kUsage for a title that is too long.
Result<DrawnLayer> color_bar(const LegendSettings& settings, const ValueColors& values, const Page& page) {
  constexpr float kHeight = 0.56f, kTop = 0.14f;  // of the picture
  DrawnLayer layer{.name = "color-bar", .object = -1, .opacity = 1.0f, .shapes = {}};
  const float height = kHeight * page.height, width = 1.3f * page.font, tick = 0.35f * page.font;
  const Ticks ticks = ticks_of(values, std::clamp(int(height / (1.8f * page.font)), 4, 11));
  const auto width_of = [&](const std::string& text) { return *text_width(text, page.font); };
  float labels = width_of(ticks.factor);
  for (const Tick& each : ticks.all) labels = std::max(labels, width_of(each.label));
  constexpr const char* kMissing = "no value";
  if (values.missing_count > 0) labels = std::max(labels, width_of(kMissing) - 0.4f * page.font);
  const std::string title = printable(settings.title.empty() ? values.name : settings.title);
  const float title_width = width_of(title);
  const float right = page.width - page.margin(), top = std::max(kTop * page.height, 3.0f * page.font);
  const float labels_x = right - labels, x = labels_x - 0.4f * page.font - tick - width;
  add_colors(values, x, top, width, height, layer);
  DrawnPath frame = rectangle(x, top, width, height);
  frame.stroke = page.ink, frame.width = page.line();
  layer.shapes.emplace_back(std::move(frame));
  for (const Tick& each : ticks.all) {
    const float y = top + float(1.0 - each.place) * height;
    layer.shapes.emplace_back(line_of(page, x + width, y, x + width + tick, y));
    layer.shapes.emplace_back(text_of(page, labels_x, y + 0.5f * kDigitHeight * page.font, each.label));
  }
  if (!ticks.factor.empty()) layer.shapes.emplace_back(text_of(page, labels_x, top - 0.6f * page.font, ticks.factor));
  // A short title begins at the bar; a long one ends at the right margin, in smaller letters if it is longer than the
  // picture is wide.
  const float shrink = std::min(1.0f, (page.width - 2.0f * page.margin()) / title_width);
  if (shrink < kMinShrink)
    return field_error("--color-bar-title", title, "{} '{}' does not fit into the picture: give a shorter one");
  DrawnText heading = text_of(page, std::min(x, right - shrink * title_width),
                              top - (ticks.factor.empty() ? 0.9f : 1.9f) * page.font, title);
  heading.size *= shrink;
  layer.shapes.emplace_back(std::move(heading));
  if (values.missing_count > 0) {
    DrawnPath swatch = rectangle(x, top + height + 0.8f * page.font, width, page.font);
    swatch.fill = values.missing, swatch.stroke = page.ink, swatch.width = page.line();
    layer.shapes.emplace_back(std::move(swatch));
    layer.shapes.emplace_back(
        text_of(page, x + width + tick, top + height + (1.3f + 0.5f * kDigitHeight) * page.font, kMissing));
  }
  return layer;
}

Result<DrawnLayer> scale_bar(const LegendSettings& settings, const Scene& scene, const Camera& camera,
                             const Page& page) {
  constexpr float kMaxFraction = 0.22f;  // of the picture's width
  double per_pixel = double(camera.right - camera.left) / double(page.width);
  if (camera.projection == Projection::kPerspective) {
    const float depth = -(camera.view_from_world * glm::vec4(scene.center(), 1.0f)).z;
    if (!(depth > 0.0f))
      return field_error("--scale-bar", true,
                         "{0} needs the centre of the model in front of the camera: give --camera-orthographic");
    per_pixel *= double(depth);
  }
  const double length = round_length(double(kMaxFraction * page.width) * per_pixel);
  const float pixels = float(length / per_pixel), right = page.width - page.margin(), left = right - pixels;
  const float y = page.height - page.margin() - 0.35f * page.font, end = 0.35f * page.font;
  DrawnLayer layer{.name = "scale-bar", .object = -1, .opacity = 1.0f, .shapes = {}};
  DrawnPath bar = line_of(page, left, y, right, y);
  bar.width = 2.0f * page.line();
  layer.shapes.emplace_back(std::move(bar));
  for (const float x : {left, right}) layer.shapes.emplace_back(line_of(page, x, y - end, x, y + end));
  const std::string label = log_text(length, length >= kMaxPlain || length < kMinPlain);
  layer.shapes.emplace_back(text_of(page, 0.5f * (left + right), y - 0.7f * page.font,
                                    settings.length_unit.empty() ? label : label + " " + settings.length_unit,
                                    TextAnchor::kMiddle));
  return layer;
}

/// Draws the axes in the lower left corner, the farthest first.
DrawnLayer axes(const Camera& camera, const Page& page) {
  constexpr float kLength = 2.6f, kHead = 0.75f, kHeadWidth = 0.28f, kLabel = 0.75f;  // of the font size
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
      DrawnPath dot{.x = x0, .y = y0, .segments = {{x0, y0}}, .stroke = color, .width = 4.0f * page.line()};
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
    layer.shapes.emplace_back(text_of(page, tip_x + kLabel * page.font * ux, tip_y + (kLabel * uy + 0.27f) * page.font,
                                      kNames[axis], TextAnchor::kMiddle));
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

float font_size_for(const LegendSettings& settings, float side) {
  return std::min(settings.font_size > 0.0f ? settings.font_size : std::max(kMinFont, kFontFraction * side),
                  kMaxFontFraction * side);
}

glm::vec2 legend_space(const LegendSettings& settings, int width, int height) {
  const float font = font_size_for(settings, float(std::min(width, height)));
  const float right = settings.color_bar ? kBarSpace * font / float(width) : 0.0f;
  const float bottom = settings.axes ? kAxesSpace : settings.scale_bar ? kScaleSpace : 0.0f;
  return {std::min(right, 0.5f), std::min(bottom * font / float(height), 0.5f)};
}

double round_length(double max) {
  const double power = std::pow(10.0, std::floor(std::log10(max)));
  for (const double factor : {5.0, 2.0})
    if (factor * power <= max * (1.0 + 1e-9)) return factor * power;
  return power;
}

Ticks ticks_of(const ValueColors& values, int max_count) {
  const bool linear = values.scale == ValueColors::Scale::kLinear;
  const std::vector<double> at = values.bands > 0 ? band_limits(values, max_count)
                                 : linear         ? round_numbers(values.low, values.high, max_count)
                                 : values.scale == ValueColors::Scale::kLog ? powers(values.low, values.high, max_count)
                                                                            : symlog_ticks(values, max_count);
  double max = 0.0, min = std::numeric_limits<double>::infinity();
  for (const double v : at)
    if (v != 0.0) max = std::max(max, std::abs(v)), min = std::min(min, std::abs(v));
  Ticks ticks;
  const bool scientific = max >= kMaxPlain || (max > 0.0 && (linear ? max : min) < kMinPlain);
  const int exponent = linear && scientific ? exponent_of(max) : 0;
  if (exponent != 0) ticks.factor = "\u00d7" + power_text(exponent);
  std::vector<double> shown = at;
  for (double& v : shown) v /= std::pow(10.0, exponent);
  const int decimals = decimals_of(shown);
  for (std::size_t k = 0; k < at.size(); ++k)
    ticks.all.push_back({double(std::clamp(position_on_scale(values, float(at[k])), 0.0f, 1.0f)),
                         linear ? plain_text(shown[k], decimals) : log_text(at[k], scientific)});
  return ticks;
}

Result<std::vector<DrawnLayer>> legends_of(const LegendSettings& settings, const Scene& scene, const Camera& camera,
                                           int width, int height) {
  const float side = float(std::min(width, height));
  const Page page{float(width), float(height), font_size_for(settings, side), settings.ink};
  std::vector<DrawnLayer> layers;
  if (auto font = text_width("", 1.0f); !font && settings.any()) return font.error();
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
