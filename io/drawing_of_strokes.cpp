#include "io/drawing_of_strokes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "io/curve_fit.h"
#include "io/line_ends.h"
#include "io/stroke_outline.h"

namespace umbrage {
namespace {

constexpr double kFitTolerance = 0.1;        // pixels
constexpr double kMinCornerCosine = 0.9;     // of 26 degrees: lines that turn more are divided
constexpr double kMinStraightCosine = 0.99;  // of 8 degrees, the same between straight lines longer than kMinStraight
constexpr double kMinStraight = 20.0;        // pixels
constexpr double kMinDivided = 8.0;          // pixels: min length of both sides of a corner where a line is divided
constexpr double kCovered = 20.0;            // pixels: length of the end of a line that others cover
constexpr float kMaxNarrower = 2.0f;         // pixels by which it may be narrower there
constexpr float kMinWidth = 0.005f;          // pixels: thinner lines are left out
constexpr float kMaxMagnitude = 1e9f;        // pixels: limit of coordinates and widths

std::string_view layer_name(StrokeKind kind) {
  constexpr std::string_view kNames[] = {"outline", "fold", "crease", "hatch", "cross-hatch", "hidden", "section"};
  return kNames[std::min(std::size_t(kind), std::size(kNames) - 1)];
}

/// Returns the kind of a line in drawings: at caps of sections, what is between two strips of one is hatching.
StrokeKind drawn_kind(const Stroke& stroke, const std::map<int, int>& caps) {
  const auto here = caps.find(stroke.object), there = caps.find(stroke.beside);
  if (stroke.kind == StrokeKind::kHidden || (here == caps.end() && there == caps.end())) return stroke.kind;
  const bool is_one_cap = here != caps.end() && there != caps.end() && here->second == there->second;
  return is_one_cap && here != there ? StrokeKind::kHatch : StrokeKind::kSection;
}

/// Returns the widths along a piece, from the samples that it was fitted to.
std::vector<float> widths_of(const CurveFit& fit, const CurvePiece& piece) {
  std::vector<float> widths;
  for (std::size_t k = piece.first; k <= piece.last; ++k) widths.push_back(float(fit.samples[k].width));
  return widths;
}

/// Returns whether the width of most of a stroke is constant: near corners and junctions lines are narrower.
bool is_even(const CurveFit& fit) {
  std::vector<float> widths;
  for (const CurveSample& sample : fit.samples) widths.push_back(float(sample.width));
  std::sort(widths.begin(), widths.end());
  const float low = widths[widths.size() / 5], high = widths[widths.size() - 1 - widths.size() / 5];
  return high - low <= 2.0f * width_tolerance(0.5f * (low + high));
}

/// Appends a stroke's lines: one, or several that meet at its corners.
void add_lines_of(const Stroke& stroke, const LineStyle& style, std::vector<Line>& lines) {
  const CurveFit fit = fit_curve(stroke, kFitTolerance, !is_hatching(stroke.kind));
  const std::size_t count = fit.pieces.size();
  if (count == 0) return;
  const bool is_divided = !is_hatching(stroke.kind) && (!style.varies || is_even(fit));
  const auto divides = [&](const CurvePiece& a, const CurvePiece& b) {
    const double length = std::min(a.length(), b.length()), cosine = glm::dot(a.direction_at(1), b.direction_at(0));
    const bool is_straight = a.curve.radius == 0.0 && b.curve.radius == 0.0 && length > kMinStraight;
    return is_divided && length > kMinDivided && cosine < (is_straight ? kMinStraightCosine : kMinCornerCosine);
  };
  const bool is_loop = stroke.closed && glm::distance(fit.pieces.front().from, fit.pieces.back().to) < 1e-9;
  std::size_t start = 0;  // of a loop: after a corner, if it has one
  for (std::size_t k = 0; is_loop && k < count; ++k)
    if (divides(fit.pieces[(k + count - 1) % count], fit.pieces[k])) start = std::exchange(k, count);
  const std::size_t first_line = lines.size();
  for (std::size_t k = 0; k < count; ++k) {
    const CurvePiece& piece = fit.pieces[(start + k) % count];
    if (k == 0 || divides(fit.pieces[(start + k - 1) % count], piece)) lines.push_back({.stroke = &stroke});
    lines.back().pieces.push_back({piece, widths_of(fit, piece)});
  }
  const bool has_corner = is_loop && divides(fit.pieces[(start + count - 1) % count], fit.pieces[start]);
  lines.back().closed = is_loop && !has_corner && lines.size() == first_line + 1;
}

/// Returns the dashes of a line of this length: they are stretched so that an open line begins and ends with one.
std::vector<float> stretched_dashes(const Stroke& stroke, double length, bool closed) {
  if (!(stroke.dash > 0.0f && stroke.gap > 0.0f)) return {};
  const double period = stroke.dash + stroke.gap, missing = closed ? 0.0 : stroke.gap;
  const double count = std::max(std::round((length + missing) / period), 1.0);
  const double stretch = length / (count * period - missing);
  if (count == 1.0 && !closed) return {};
  return {float(stroke.dash * stretch), float(stroke.gap * stretch)};
}

/// The widths of a line but for its ends at others, where lines are narrower but cover each other: their range, and
/// their mean by length.
struct Widths {
  float min = INFINITY, max = 0.0f, mean = 0.0f;
  float end_min = INFINITY;  ///< at the ends
};

Widths widths_of(const Line& line) {
  constexpr double kMinLength = 3.0 * kCovered;
  double length = 0.0, along = 0.0, sum = 0.0, summed = 0.0;
  for (const auto& [piece, widths] : line.pieces) length += piece.length();
  const double first = line.joined[0] && length > kMinLength ? kCovered : 0.0;
  const double last = length - (line.joined[1] && length > kMinLength ? kCovered : 0.0);
  Widths all;
  for (const auto& [piece, widths] : line.pieces) {
    const double step = piece.length() / double(widths.size());
    for (const float width : widths) {
      along += step;
      all.end_min = std::min(all.end_min, width);
      if (along < first || along - step > last) continue;
      all.min = std::min(all.min, width), all.max = std::max(all.max, width);
      sum += step * width, summed += step;
    }
  }
  all.mean = summed > 0.0 ? float(sum / summed) : all.max;
  return all;
}

DrawnPath path_of(const Line& line, const LineStyle& style) {
  const Widths widths = widths_of(line);
  double length = 0.0;
  for (const SpinePiece& each : line.pieces) length += each.piece.length();
  const auto dashes = stretched_dashes(*line.stroke, length, line.closed);
  const bool varies = widths.max - widths.min > 2.0f * width_tolerance(widths.mean);
  if (style.varies && dashes.empty() && (varies || widths.end_min < widths.min - kMaxNarrower)) {
    DrawnPath area = stroke_outline(line.pieces, line.closed);
    area.fill = style.color;
    return area;
  }
  DrawnPath path = path_of(line.pieces);
  path.closed = line.closed;
  path.stroke = style.color;
  path.width = widths.mean;
  path.dashes = dashes;
  return path;
}

/// Checks that all numbers can be drawn. Errors: kUsage.
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

/// Returns the ends of a straight line in 1/50 pixels, in order: an edge that was traced twice is one line. Returns
/// nothing for other lines.
std::optional<std::array<long, 4>> ends_of(const Line& line) {
  const CurvePiece& piece = line.pieces[0].piece;
  if (line.pieces.size() != 1 || piece.curve.radius > 0.0) return {};
  const auto rounded = [](double v) { return std::lround(50.0 * v); };
  std::array<long, 4> ends = {rounded(piece.from.x), rounded(piece.from.y), rounded(piece.to.x), rounded(piece.to.y)};
  if (std::pair(ends[0], ends[1]) > std::pair(ends[2], ends[3])) ends = {ends[2], ends[3], ends[0], ends[1]};
  return ends;
}

/// Returns a dot for a stroke without length.
DrawnPath dot_of(const StrokePoint& p, const LineStyle& style) {
  return {.x = p.x, .y = p.y, .segments = {{.x = p.x, .y = p.y}}, .stroke = style.color, .width = p.width};
}

}  // namespace

Result<Drawing> drawing_of(const Strokes& strokes, const LineStyle& style) {
  if (auto status = check_strokes(strokes); !status) return status.error();
  std::map<std::pair<StrokeKind, int>, std::vector<DrawnShape>> layers;
  std::vector<Line> lines;
  const auto layer_of = [&](const Stroke& stroke) -> std::vector<DrawnShape>& {
    return layers[{drawn_kind(stroke, style.caps), stroke.object}];
  };
  for (const Stroke& stroke : strokes.strokes) {
    const auto width = [](const StrokePoint& a, const StrokePoint& b) { return a.width < b.width; };
    const auto widest = std::max_element(stroke.points.begin(), stroke.points.end(), width);
    if (widest == stroke.points.end() || widest->width < kMinWidth) continue;
    const std::size_t before = lines.size();
    add_lines_of(stroke, style, lines);
    if (lines.size() == before) layer_of(stroke).push_back(dot_of(*widest, style));
  }
  join_ends(lines);
  std::set<std::array<long, 4>> straight;
  for (const Line& line : lines)
    if (const auto ends = ends_of(line); !ends || straight.insert(*ends).second)
      layer_of(*line.stroke).push_back(path_of(line, style));
  Drawing drawing{.width = float(strokes.width), .height = float(strokes.height), .background = style.background};
  for (auto& [key, shapes] : layers)
    drawing.layers.push_back({std::string(layer_name(key.first)), key.second, style.opacity, std::move(shapes)});
  return drawing;
}

}  // namespace umbrage
