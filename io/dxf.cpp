#include "io/dxf.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

#include "core/printable.h"

namespace umbrage {
namespace {

constexpr double kMaxMagnitudeInDxf = 1e9;  // of numbers
constexpr int kWhite = 7;                   // colour number: black on a white background
constexpr int kVertexFollows = 1, kClosed = 1;

/// Returns the file's layer for a layer of a drawing, with only the characters that names may have.
std::string dxf_layer(std::string_view name) {
  if (name == "outline" || name == "fold" || name == "crease") return "visible";
  if (name == "cross-hatch") return "hatch";
  std::string out;
  for (const char c : name) out += std::isalnum(static_cast<unsigned char>(c)) || c == '-' ? c : '_';
  constexpr std::size_t kMaxName = 31;
  return out.empty() ? "0" : out.substr(0, kMaxName);
}

/// Returns text in ASCII, other characters as \\U+XXXX.
std::string dxf_string(std::string_view from) {
  const std::string text = printable(from);
  std::string out;
  for (std::size_t at = 0, length = 0; at < text.size(); at += length) {
    length = utf8_length(text, at);
    unsigned code = static_cast<unsigned char>(text[at]) & (0xffu >> (length > 1 ? length + 1 : 1));
    for (std::size_t k = 1; k < length; ++k) code = code << 6 | (static_cast<unsigned char>(text[at + k]) & 0x3f);
    out += code < 0x80 ? std::string(1, text[at]) : code > 0xffff ? "?" : fmt::format("\\U+{:04X}", code);
  }
  return out;
}

class DxfWriter {
 public:
  explicit DxfWriter(const Drawing& drawing) : height_(drawing.height), scale_(drawing.mm_per_unit) {}

  std::string text;
  bool is_finite = true;

  void code(int group, std::string_view value) { fmt::format_to(std::back_inserter(text), "{}\n{}\n", group, value); }
  void code(int group, int value) { code(group, fmt::format("{}", value)); }
  void code(int group, double value) {
    is_finite = is_finite && std::abs(value) <= kMaxMagnitudeInDxf;
    code(group, fmt::format("{:.9g}", value + 0.0));
  }
  /// Writes a point of the drawing as the groups 10 + k, 20 + k and 30 + k.
  void point(float x, float y, int k = 0) {
    code(10 + k, x * scale_), code(20 + k, (height_ - y) * scale_), code(30 + k, 0.0);
  }

  void add(const DrawnPath& path, const std::string& layer) {
    if (is_circle(path)) {
      begin("CIRCLE", layer, path);
      point(0.5f * (path.x + path.segments[0].x), 0.5f * (path.y + path.segments[0].y));
      code(40, path.segments[0].radius * scale_);
    } else if (path.segments.size() == 1 && path.segments[0].radius == 0.0f) {
      begin("LINE", layer, path);
      point(path.x, path.y), point(path.segments[0].x, path.segments[0].y, 1);
    } else if (!path.segments.empty()) {
      add_polyline(path, layer);
    }
    for (const DrawnPath& hole : path.holes) add(hole, layer);
  }

  void add(const DrawnText& t, const std::string& layer) {
    constexpr double kCapHeight = 0.729;  // of DejaVu Sans, in units of the font size
    code(0, "TEXT"), code(8, layer);
    point(t.x, t.y);
    code(40, t.size * kCapHeight * scale_);
    code(1, dxf_string(t.text));
    if (t.upwards) code(50, 90.0);
    code(72, int(t.anchor));
    if (t.anchor != TextAnchor::kStart) point(t.x, t.y, 1);
  }

  void add(const DrawnImage&, const std::string&) {}

 private:
  static bool is_circle(const DrawnPath& path) {
    if (!path.closed || path.segments.size() != 2) return false;
    const auto &a = path.segments[0], &b = path.segments[1];
    const float chord = std::hypot(a.x - path.x, a.y - path.y), tolerance = 1e-4f * a.radius;
    return a.radius > 0.0f && std::abs(a.radius - b.radius) <= tolerance && a.clockwise == b.clockwise &&
           std::abs(chord - 2.0f * a.radius) <= tolerance && std::hypot(b.x - path.x, b.y - path.y) <= tolerance;
  }

  void begin(std::string_view entity, const std::string& layer, const DrawnPath& path) {
    code(0, entity), code(8, layer);
    if (!path.dashes.empty()) code(6, "DASHED");
  }

  void add_polyline(const DrawnPath& path, const std::string& layer) {
    begin("POLYLINE", layer, path);
    code(66, kVertexFollows), point(0.0f, height_), code(70, path.closed ? kClosed : 0);
    float x = path.x, y = path.y;
    for (const DrawnSegment& s : path.segments) {
      vertex(x, y, bulge_of(x, y, s), layer);
      x = s.x, y = s.y;
    }
    // A closed polyline goes back to its first vertex by itself.
    if (!path.closed || std::hypot(x - path.x, y - path.y) > 1e-4f) vertex(x, y, 0.0, layer);
    code(0, "SEQEND"), code(8, layer);
  }

  /// Returns the tangent of a quarter of an arc's angle, positive if it runs counter-clockwise.
  static double bulge_of(float x, float y, const DrawnSegment& s) {
    if (s.radius == 0.0f) return 0.0;
    const double half = std::asin(std::min(1.0, 0.5 * std::hypot(s.x - x, s.y - y) / s.radius));  // half the angle
    const double bulge = std::tan(0.5 * (s.large_arc ? M_PI - half : half));
    return s.clockwise ? -bulge : bulge;
  }

  void vertex(float x, float y, double bulge, const std::string& layer) {
    code(0, "VERTEX"), code(8, layer), point(x, y);
    if (bulge != 0.0) code(42, bulge);
  }

  float height_;
  double scale_;
};

/// Returns the dashes of the drawing's first dashed path: the pattern of the line type DASHED.
std::pair<float, float> dashes_of(const Drawing& drawing) {
  for (const DrawnLayer& layer : drawing.layers)
    for (const DrawnShape& shape : layer.shapes)
      if (const auto* path = std::get_if<DrawnPath>(&shape); path && path->dashes.size() >= 2)
        return {path->dashes[0], path->dashes[1]};
  return {9.0f, 6.0f};
}

void add_header(const Drawing& drawing, DxfWriter& out) {
  out.code(0, "SECTION"), out.code(2, "HEADER");
  out.code(9, "$ACADVER"), out.code(1, "AC1009");
  out.code(9, "$EXTMIN"), out.point(0.0f, drawing.height);
  out.code(9, "$EXTMAX"), out.point(drawing.width, 0.0f);
  out.code(9, "$LTSCALE"), out.code(40, 1.0);
  out.code(0, "ENDSEC");
}

void add_tables(const Drawing& drawing, const std::set<std::string>& layers, DxfWriter& out) {
  const auto [dash, gap] = dashes_of(drawing);
  const double scale = drawing.mm_per_unit;
  out.code(0, "SECTION"), out.code(2, "TABLES");
  out.code(0, "TABLE"), out.code(2, "LTYPE"), out.code(70, 2);
  const auto line_type = [&](const char* name, const char* shown, const std::vector<double>& pattern) {
    double length = 0.0;
    for (const double each : pattern) length += std::abs(each);
    out.code(0, "LTYPE"), out.code(2, name), out.code(70, 0), out.code(3, shown), out.code(72, int('A'));
    out.code(73, int(pattern.size())), out.code(40, length);
    for (const double each : pattern) out.code(49, each);
  };
  line_type("CONTINUOUS", "Solid line", {});
  line_type("DASHED", "__ __ __ __", {dash * scale, -gap * scale});
  out.code(0, "ENDTAB");
  out.code(0, "TABLE"), out.code(2, "LAYER"), out.code(70, int(layers.size()));
  for (const std::string& layer : layers) {
    out.code(0, "LAYER"), out.code(2, layer), out.code(70, 0), out.code(62, kWhite);
    out.code(6, layer == "hidden" ? "DASHED" : "CONTINUOUS");
  }
  out.code(0, "ENDTAB"), out.code(0, "ENDSEC");
}

}  // namespace

Result<std::string> dxf_text(const Drawing& drawing) {
  DxfWriter out(drawing);
  std::set<std::string> layers = {"0", "visible", "hidden", "section", "hatch"};
  for (const DrawnLayer& layer : drawing.layers) layers.insert(dxf_layer(layer.name));
  add_header(drawing, out);
  add_tables(drawing, layers, out);
  out.code(0, "SECTION"), out.code(2, "ENTITIES");
  for (const DrawnLayer& layer : drawing.layers)
    for (const DrawnShape& shape : layer.shapes)
      std::visit([&](const auto& each) { out.add(each, dxf_layer(layer.name)); }, shape);
  out.code(0, "ENDSEC"), out.code(0, "EOF");
  if (!out.is_finite)
    return usage_error("the drawing has a number that a .dxf file cannot hold: they must be finite and at most {:g}",
                       kMaxMagnitudeInDxf);
  return out.text;
}

}  // namespace umbrage
