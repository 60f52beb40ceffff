// Writes drawings as SVG. Layers of one opacity share a group; it has the attributes that most paths have.
#include "io/svg.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <set>
#include <utility>

#include "core/base64.h"
#include "io/format.h"

namespace umbrage {
namespace {

constexpr float kMaxMagnitudeInSvg = 1e9f;          // of numbers
constexpr DrawnColor kSvgInk = {0.0f, 0.0f, 0.0f};  // of lines without a colour

/// Clamps to [0, 1]; NaN becomes 0.
float clamp_to_unit(float v) { return std::fmin(std::fmax(v, 0.0f), 1.0f); }

/// Returns the colour as "#rrggbb".
std::string hex_of(const DrawnColor& color) {
  std::string text = "#";
  for (const float v : color) text += fmt::format("{:02x}", int(std::lround(255.0f * clamp_to_unit(v))));
  return text;
}

/// Writes a file's elements, and notes numbers that cannot be written.
class SvgWriter {
 public:
  std::string text;
  bool is_finite = true;

  void add(const DrawnLayer& layer, const DrawnColor& ink) {
    std::string id = xml(layer.name);
    if (layer.object >= 0) id += fmt::format("-{}", layer.object);
    for (int copy = 2; !ids_.insert(id).second; ++copy) id = fmt::format("{}-copy{}", id, copy);
    write("<g id=\"{}\" class=\"{}\"", id, xml(layer.name));
    if (layer.object >= 0) write(" data-object=\"{}\"", layer.object);
    text += ">\n";
    for (const DrawnShape& shape : layer.shapes) std::visit([&](const auto& each) { add(each, ink); }, shape);
    text += "</g>\n";
  }

  Result<void> status = {};

 private:
  template <class... Values>
  void write(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(text), format, std::forward<Values>(values)...);
  }

  /// Returns a number with two decimals at most, without a minus sign before 0.
  std::string number(float v) {
    is_finite = is_finite && std::abs(v) <= kMaxMagnitudeInSvg;
    return fmt::format("{:.12g}", std::round(double(v) * 100.0) / 100.0 + 0.0);
  }
  /// Returns a number above 0 with four digits.
  std::string length(float v) {
    is_finite = is_finite && v >= 0.0f && v <= kMaxMagnitudeInSvg;
    return fmt::format("{:.4g}", v);
  }

  /// Returns text as the content of an element or attribute, without control characters.
  static std::string xml(const std::string& from) {
    std::string out;
    for (const char c : from) {
      if (c == '&')
        out += "&amp;";
      else if (c == '<')
        out += "&lt;";
      else if (c == '"')
        out += "&quot;";
      else if (static_cast<unsigned char>(c) >= 32)
        out += c;
    }
    return out;
  }

  void add_outline(const DrawnPath& path) {
    write("M{} {}", number(path.x), number(path.y));
    char last = 'M';
    for (std::size_t k = 0; k < path.segments.size(); ++k) {
      const DrawnSegment& s = path.segments[k];
      const bool is_last = k + 1 == path.segments.size();
      if (s.radius == 0.0f && path.closed && is_last && k > 1) break;  // Z draws it
      const char command = s.radius > 0.0f ? 'A' : 'L';
      text += command == last ? ' ' : command;
      last = command;
      if (s.radius > 0.0f) write("{0} {0} 0 {1:d} {2:d} ", number(s.radius), s.large_arc, s.clockwise);
      write("{} {}", number(s.x), number(s.y));
    }
    if (path.closed) text += 'Z';
  }

  void add(const DrawnPath& path, const DrawnColor& ink) {
    text += "<path ";
    if (path.fill) write("fill=\"{}\" ", hex_of(*path.fill));
    if (!path.stroke) text += "stroke=\"none\" ";
    if (path.stroke) {
      if (*path.stroke != ink) write("stroke=\"{}\" ", hex_of(*path.stroke));
      write("stroke-width=\"{}\" ", length(path.width));
      if (!path.round) text += "stroke-linecap=\"butt\" ";
    }
    for (std::size_t k = 0; k < path.dashes.size(); ++k)
      write("{}{}", k == 0 ? "stroke-dasharray=\"" : " ", length(path.dashes[k]));
    if (!path.dashes.empty()) text += "\" ";
    text += "d=\"";
    add_outline(path);
    for (const DrawnPath& hole : path.holes) add_outline(hole);
    text += "\"/>\n";
  }

  void add(const DrawnText& t, const DrawnColor&) {
    constexpr const char* kAnchors[] = {"start", "middle", "end"};
    write(
        "<text x=\"{0}\" y=\"{1}\" font-family=\"{2}, sans-serif\" font-size=\"{3}\" text-anchor=\"{4}\" fill=\"{5}\" "
        "stroke=\"none\"",
        number(t.x), number(t.y), kFontFamily, length(t.size), kAnchors[int(t.anchor)], hex_of(t.color));
    if (t.upwards) write(" transform=\"rotate(-90 {} {})\"", number(t.x), number(t.y));
    write(">{}</text>\n", xml(t.text));
  }

  void add(const DrawnImage& image, const DrawnColor&) {
    if (image.columns < 1 || image.rows < 1) return;
    Image planes = picture(image.columns, image.rows, 4);
    for (int y = 0; y < image.rows; ++y)
      for (int x = 0; x < image.columns; ++x)
        for (std::size_t c = 0; c < 4; ++c)
          planes.planes[c].at(x, y) =
              float(image.rgba[(std::size_t(y) * std::size_t(image.columns) + std::size_t(x)) * 4 + c]) / 255.0f;
    const auto png = encode_png("picture in the .svg file", planes, {.small = true});
    if (!png) {
      status = png.error();
      return;
    }
    write(
        "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" "
        "href=\"data:image/png;base64,",
        number(image.x), number(image.y), number(image.width), number(image.height));
    text += base64(*png) + "\"/>\n";
  }

  std::set<std::string> ids_;
};

/// Returns the colour of the first line of a layer, if it has lines.
const DrawnColor* ink_of(const DrawnLayer& layer) {
  for (const DrawnShape& shape : layer.shapes)
    if (const auto* path = std::get_if<DrawnPath>(&shape); path && path->stroke) return &*path->stroke;
  return nullptr;
}

/// Returns the attribute of a width or height.
std::string size_text(float units, float mm_per_unit) {
  if (std::abs(mm_per_unit - kMmPerCssPixel) < 1e-6f) return fmt::format("{:g}px", units);
  return fmt::format("{:.6g}mm", units * mm_per_unit);
}

}  // namespace

Result<std::string> svg_text(const Drawing& drawing) {
  SvgWriter out;
  out.text = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {2:g} {3:g}\">\n",
      size_text(drawing.width, drawing.mm_per_unit), size_text(drawing.height, drawing.mm_per_unit), drawing.width,
      drawing.height);
  if (drawing.background)
    out.text += fmt::format("<rect width=\"{:g}\" height=\"{:g}\" fill=\"{}\"/>\n", drawing.width, drawing.height,
                            hex_of(*drawing.background));
  const auto& layers = drawing.layers;
  for (std::size_t first = 0, end = 0; first < layers.size(); first = end) {
    DrawnColor ink = kSvgInk;
    for (end = first; end < layers.size() && layers[end].opacity == layers[first].opacity; ++end)
      if (const DrawnColor* found = ink_of(layers[end]); found && ink == kSvgInk) ink = *found;
    out.text += fmt::format(
        "<g fill=\"none\" stroke=\"{}\" stroke-linecap=\"round\" stroke-linejoin=\"round\" opacity=\"{:.3g}\">\n",
        hex_of(ink), clamp_to_unit(layers[first].opacity));
    for (std::size_t k = first; k < end; ++k) out.add(layers[k], ink);
    out.text += "</g>\n";
  }
  if (!out.status) return out.status.error();
  if (!out.is_finite)
    return usage_error("the drawing has a number that a .svg file cannot hold: they must be finite and at most {:g}",
                       kMaxMagnitudeInSvg);
  return out.text + "</svg>\n";
}

}  // namespace umbrage
