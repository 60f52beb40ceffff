// Writes lines as SVG paths: a line of varying width is split into paths of constant width.
#include "io/svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "io/format.h"

namespace umbrage {
namespace {

constexpr float kTolerance = 0.05f;       // pixels: max deviation of a path's width from the width of the line
constexpr float kMaxFraction = 0.02f;     // max deviation of wide lines, as a fraction of the width
constexpr float kMinRun = 2.0f;           // pixels: min length of a path
constexpr float kMaxOverlap = 0.25f;      // pixels: overlap of a path with the next, so that no gap is visible
constexpr float kOverlapFraction = 0.1f;  // overlap of thin lines, as a fraction of the width: limits the darker area
constexpr int kMaxParts = 64;             // max number of parts of a segment of varying width
constexpr float kMinWidth = 0.005f;       // pixels: a smaller width would be written as 0

constexpr float kMaxMagnitude = 1e9f;  // pixels: limit of coordinates and widths

float tolerance_of(float width) { return std::max(kTolerance, kMaxFraction * width); }

std::string_view name_of(StrokeKind kind) {
  switch (kind) {
    case StrokeKind::kOutline:
      return "outline";
    case StrokeKind::kFold:
      return "fold";
    case StrokeKind::kHatch:
      return "hatch";
    case StrokeKind::kCrossHatch:
      return "cross-hatch";
    case StrokeKind::kHidden:
      return "hidden";
    case StrokeKind::kCrease:
      break;
  }
  return "crease";
}

/// Clamps to [0, 1]; NaN becomes 0.
float clamp_to_unit(float v) { return std::fmin(std::fmax(v, 0.0f), 1.0f); }

/// Returns the colour as "#rrggbb".
std::string hex_of(const std::array<float, 3>& color) {
  std::string text = "#";
  for (const float v : color) text += fmt::format("{:02x}", int(std::lround(255.0f * clamp_to_unit(v))));
  return text;
}

/// Rounds to two decimals, without a minus sign before 0.
double rounded(float v) { return std::round(double(v) * 100.0) / 100.0 + 0.0; }

/// A point of a line, or an intermediate point of a segment.
struct Knot {
  StrokePoint at;
  bool corner;  ///< true for a point of the line, where its direction may change
};

/// Returns the line's points and at least one intermediate point per segment, more where the width changes.
std::vector<Knot> knots_of(const Stroke& stroke) {
  std::vector<Knot> knots = {{stroke.points[0], true}};
  for (std::size_t k = 1; k < stroke.points.size(); ++k) {
    const StrokePoint &a = stroke.points[k - 1], &b = stroke.points[k];
    const float step = tolerance_of(std::min(a.width, b.width));
    const int parts = int(std::clamp(std::ceil(std::abs(b.width - a.width) / step), 2.0f, float(kMaxParts)));
    for (int i = 1; i < parts; ++i) {
      const float f = float(i) / float(parts);
      knots.push_back({{a.x + f * (b.x - a.x), a.y + f * (b.y - a.y), a.width + f * (b.width - a.width)}, false});
    }
    knots.push_back({b, true});
  }
  return knots;
}

float distance(const StrokePoint& a, const StrokePoint& b) { return std::hypot(b.x - a.x, b.y - a.y); }

/// A part of a line with nearly constant width: knots `first` to `last`, inclusive.
struct Run {
  std::size_t first, last;
  float width;
};

/// Splits a line into as few runs as its width permits. They meet at intermediate points, where the line is straight.
std::vector<Run> runs_of(const std::vector<Knot>& knots) {
  std::vector<Run> runs;
  for (std::size_t first = 0;;) {
    Run run{first, first, knots[first].at.width};
    float min = run.width, max = min, length = 0.0f;
    for (std::size_t k = first + 1; k < knots.size(); ++k) {
      const float width = knots[k].at.width;
      length += distance(knots[k - 1].at, knots[k].at);
      min = std::min(min, width), max = std::max(max, width);
      if (run.last > first && length > kMinRun && max - min > 2.0f * tolerance_of(0.5f * (min + max))) break;
      if (!knots[k].corner || k + 1 == knots.size()) run.last = k, run.width = 0.5f * (min + max);
    }
    runs.push_back(run);
    if (run.last + 1 >= knots.size()) return runs;
    first = run.last;
  }
}

/// Returns an intermediate point moved along its segment by `along` pixels.
StrokePoint moved(const std::vector<Knot>& knots, std::size_t k, float along) {
  const StrokePoint &a = knots[k - 1].at, &b = knots[k + 1].at;
  const float length = distance(a, b), f = length > 0.0f ? along / length : 0.0f;
  return {knots[k].at.x + f * (b.x - a.x), knots[k].at.y + f * (b.y - a.y), knots[k].at.width};
}

void add_path(const std::vector<StrokePoint>& points, float width, bool round, bool closed, std::string& out) {
  if (width < kMinWidth) return;
  auto to = std::back_inserter(out);
  fmt::format_to(to, "<path {}stroke-width=\"{:.2f}\" d=\"M{:.2f} {:.2f}", round ? "" : "stroke-linecap=\"butt\" ",
                 width, rounded(points[0].x), rounded(points[0].y));
  // A single point becomes a dot.
  const std::size_t begin = std::min<std::size_t>(1, points.size() - 1), end = points.size() - (closed ? 1 : 0);
  for (std::size_t k = begin; k < end; ++k)
    fmt::format_to(to, "{}{:.2f} {:.2f}", k == begin ? 'L' : ' ', rounded(points[k].x), rounded(points[k].y));
  out += closed ? "Z\"/>\n" : "\"/>\n";
}

/// Appends the paths of a line. Adjacent paths overlap only as much as is needed to hide the seam, because an
/// antialiased border that is drawn twice is darker. For the same reason paths inside the line have butt caps; only the
/// ends of the line have round caps.
void add_stroke(const Stroke& stroke, std::string& out) {
  if (stroke.points.empty()) return;
  const std::vector<Knot> knots = knots_of(stroke);
  const std::vector<Run> runs = runs_of(knots);
  for (const Run& run : runs) {
    const bool starts = run.first == 0, ends = run.last + 1 == knots.size();
    const float overlap = std::min(kMaxOverlap, kOverlapFraction * run.width);
    std::vector<StrokePoint> points = {starts ? knots[0].at : moved(knots, run.first, -overlap)};
    for (std::size_t k = run.first + 1; k < run.last; ++k)
      if (knots[k].corner) points.push_back(knots[k].at);
    if (run.last > run.first) points.push_back(ends ? knots[run.last].at : moved(knots, run.last, overlap));
    const bool round = starts || (ends && !stroke.closed);
    add_path(points, run.width, round, stroke.closed && starts && ends && points.size() > 2, out);
  }
}

/// Checks that all numbers can be written. Errors: kUsage.
Result<void> check_strokes(const Strokes& strokes) {
  for (std::size_t k = 0; k < strokes.strokes.size(); ++k)
    for (const StrokePoint& p : strokes.strokes[k].points)
      if (!(std::abs(p.x) <= kMaxMagnitude && std::abs(p.y) <= kMaxMagnitude && p.width >= 0.0f &&
            p.width <= kMaxMagnitude))
        return usage_error(
            "stroke {} has a point at {}, {} of width {}: coordinates and widths must be at most {:g}, and widths at "
            "least 0",
            k, p.x, p.y, p.width, kMaxMagnitude);
  return {};
}

}  // namespace

bool is_svg(const std::filesystem::path& file) { return lowercase_extension(file) == "svg"; }

Result<std::string> svg_text(const Strokes& strokes, const SvgStyle& style) {
  if (auto status = check_strokes(strokes); !status) return status.error();
  std::map<std::pair<StrokeKind, int>, std::string> groups;
  for (const Stroke& stroke : strokes.strokes) add_stroke(stroke, groups[{stroke.kind, stroke.object}]);
  std::string text = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}px\" height=\"{1}px\" viewBox=\"0 0 {0} {1}\">\n",
      strokes.width, strokes.height);
  if (style.background)
    text += fmt::format("<rect width=\"{}\" height=\"{}\" fill=\"{}\"/>\n", strokes.width, strokes.height,
                        hex_of(*style.background));
  text += fmt::format(
      "<g id=\"lines\" fill=\"none\" stroke=\"{}\" stroke-linecap=\"round\" stroke-linejoin=\"round\" "
      "opacity=\"{:.3g}\">\n",
      hex_of(style.color), clamp_to_unit(style.opacity));
  for (const auto& [key, paths] : groups) {
    if (paths.empty()) continue;
    const auto& [kind, object] = key;
    text +=
        fmt::format("<g id=\"{0}-{1}\" class=\"{0}\" data-object=\"{1}\">\n{2}</g>\n", name_of(kind), object, paths);
  }
  return text + "</g>\n</svg>\n";
}

Result<void> write_svg(const std::filesystem::path& file, const Strokes& strokes, const SvgStyle& style) {
  const auto text = svg_text(strokes, style);
  return text ? write_text(file, *text) : text.error();
}

}  // namespace umbrage
