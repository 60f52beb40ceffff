#include "io/curve_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>

namespace umbrage {
namespace {

using glm::dvec2;

constexpr double kPi = std::numbers::pi;
constexpr double kMaxSamples = 20000.0;  // per stroke
constexpr double kRms = 0.17;           // max distance of the samples of a piece on the root mean square, in tolerances
constexpr double kLongLine = 30.0;      // pixels: at a longer line tracing is corrected more
constexpr double kLongTolerance = 4.0;  // tolerances within which long lines and circles are one
constexpr double kCornerSine = 0.3;     // of 17 degrees: pieces that turn more meet at a corner
constexpr double kLongCornerSine = 0.14;    // of 8 degrees, the same between long lines
constexpr double kMinForward = -0.6;        // cosine of 127 degrees, the max turn of a rounded corner
constexpr double kCornerExtent = 10.0;      // pixels: shorter pieces between two others may be a rounded corner
constexpr double kLongCornerExtent = 30.0;  // pixels, the same between long lines
constexpr std::size_t kCornerPieces = 8;    // max number of them
constexpr double kHook = 20.0;              // pixels: max length of pieces where a line was joined to another
constexpr double kCornerReach = 2.5;        // pixels: max distance of a corner from the sample where pieces meet
constexpr double kMinSharpness = 4.0;       // min ratio of the curvatures of a rounded corner and of its sides
constexpr double kRounding = 0.3;           // pixels: max distance of a sharp corner from the one that tracing rounded
constexpr double kLongRounding = 1.0;       // pixels, the same between long lines
constexpr double kHookOffset = 1.5;         // pixels: max distance from a long line of the hook at its end
constexpr std::size_t kTrim = 3;            // samples at a corner that may be rounded
constexpr std::size_t kMinTrimmed = 12;     // samples: min length of a piece that is not fitted to them
constexpr double kMaxBack = 0.5;            // pixels that samples may run back along their curve
constexpr double kMinGain = 1.15;           // min ratio of the lengths of an arc and of a line in its place
constexpr double kMinArc = 3.0;             // pixels by which an arc must be longer, too
constexpr double kMaxRadius = 1e5;          // pixels

double cross(dvec2 a, dvec2 b) { return a.x * b.y - a.y * b.x; }
dvec2 left_of(dvec2 d) { return {-d.y, d.x}; }

using Samples = std::vector<CurveSample>;

Samples samples_of(const Stroke& stroke) {
  Samples all;
  double length = 0.0;
  const auto at = [&](std::size_t k) { return dvec2(stroke.points[k].x, stroke.points[k].y); };
  for (std::size_t k = 1; k < stroke.points.size(); ++k) length += glm::distance(at(k), at(k - 1));
  const double step = std::max(1.0, length / kMaxSamples);
  all.push_back({at(0), stroke.points[0].width});
  for (std::size_t k = 1; k < stroke.points.size(); ++k) {
    const double distance = glm::distance(at(k), at(k - 1));
    if (!(distance > 1e-6)) continue;
    const int parts = int(std::ceil(distance / step));
    for (int i = 1; i <= parts; ++i) {
      const double f = double(i) / parts, a = stroke.points[k - 1].width, b = stroke.points[k].width;
      all.push_back({at(k - 1) + f * (at(k) - at(k - 1)), a + f * (b - a)});
    }
  }
  return all;
}

dvec2 mean_of(const Samples& s, std::size_t first, std::size_t last) {
  dvec2 sum(0.0);
  for (std::size_t k = first; k <= last; ++k) sum += s[k].at;
  return sum / double(last - first + 1);
}

/// Samples, inclusive.
struct FitRange {
  std::size_t first, last;
};

/// Returns the line with the smallest squared distances to samples.
FittedCurve line_through(const Samples& s, FitRange range) {
  const auto [first, last] = range;
  FittedCurve line{.center = mean_of(s, first, last)};
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (std::size_t k = first; k <= last; ++k) {
    const dvec2 d = s[k].at - line.center;
    xx += d.x * d.x, xy += d.x * d.y, yy += d.y * d.y;
  }
  const double angle = 0.5 * std::atan2(2.0 * xy, xx - yy);
  line.along = {std::cos(angle), std::sin(angle)};
  if (glm::dot(line.along, s[last].at - s[first].at) < 0.0) line.along = -line.along;
  return line;
}

/// Returns the circle with the smallest squared distances to samples: an algebraic fit, improved by Gauss-Newton steps.
/// Returns nothing where they are straight.
std::optional<FittedCurve> circle_through(const Samples& s, FitRange range) {
  const auto [first, last] = range;
  if (last - first < 3) return {};
  const dvec2 mean = mean_of(s, first, last);
  const auto count = double(last - first + 1);
  double xx = 0.0, xy = 0.0, yy = 0.0, xz = 0.0, yz = 0.0, zz = 0.0;
  for (std::size_t k = first; k <= last; ++k) {
    const dvec2 d = s[k].at - mean;
    const double z = glm::dot(d, d);
    xx += d.x * d.x, xy += d.x * d.y, yy += d.y * d.y, xz += d.x * z, yz += d.y * z, zz += z;
  }
  double det = xx * yy - xy * xy;
  if (!(det > 1e-9 * zz * zz)) return {};
  FittedCurve c{.center = dvec2(yy * xz - xy * yz, xx * yz - xy * xz) / (2.0 * det)};
  const auto radius = [&] {
    double sum = 0.0;
    for (std::size_t k = first; k <= last; ++k) sum += glm::distance(s[k].at - mean, c.center);
    return sum / count;
  };
  c.radius = radius();
  for (int step = 0; step < 4; ++step) {
    dvec2 normal_mean(0.0);
    for (std::size_t k = first; k <= last; ++k) normal_mean += glm::normalize(s[k].at - mean - c.center);
    normal_mean /= count;
    double a = 0.0, b = 0.0, d = 0.0, u = 0.0, v = 0.0;
    for (std::size_t k = first; k <= last; ++k) {
      const dvec2 to = s[k].at - mean - c.center;
      const dvec2 j = glm::normalize(to) - normal_mean;
      const double off = glm::length(to) - c.radius;
      a += j.x * j.x, b += j.x * j.y, d += j.y * j.y, u += j.x * off, v += j.y * off;
    }
    det = a * d - b * b;
    if (!(det > 1e-14 * (a + d) * (a + d))) break;
    c.center += dvec2(d * u - b * v, a * v - b * u) / det;
    c.radius = radius();
  }
  c.center += mean;
  if (!(c.radius < kMaxRadius)) return {};
  double turn = 0.0;
  for (std::size_t k = first; k < last; ++k) turn += cross(s[k].at - c.center, s[k + 1].at - c.center);
  c.turns_right = turn > 0.0;
  return c;
}

/// Returns whether samples are near a curve and run along it in one direction, a circle at most once.
bool fits_samples(const FittedCurve& c, const Samples& s, FitRange range, double tolerance) {
  constexpr std::size_t kNoise = 2;  // samples: shorter waves are noise, longer ones are bends that the curve lacks
  std::array<double, kNoise> recent{};
  double squares = 0.0, forward = 0.0, back = 0.0, sum = 0.0;
  for (std::size_t k = range.first; k <= range.last; ++k) {
    const double off = c.distance(s[k].at);
    if (!(std::abs(off) <= tolerance)) return false;
    const std::size_t count = k - range.first;
    sum += off - recent[count % kNoise];
    recent[count % kNoise] = off;
    squares += std::pow(sum / double(std::min(count + 1, kNoise)), 2.0);
    if (k == range.first) continue;
    const double step = glm::dot(s[k].at - s[k - 1].at, c.direction(0.5 * (s[k].at + s[k - 1].at)));
    (step < 0.0 ? back : forward) += std::abs(step);
  }
  return squares <= std::pow(kRms * tolerance, 2.0) * double(range.last - range.first + 1) &&
         back <= std::min(0.02 * forward, kMaxBack) && (c.radius == 0.0 || forward < 2.0 * kPi * c.radius + 1.0);
}

/// Returns the line, or else the circle if `or_arc`, that samples are near.
std::optional<FittedCurve> curve_through(const Samples& s, FitRange range, double tolerance, bool or_arc) {
  std::optional<FittedCurve> curve = line_through(s, range);
  if (or_arc && !fits_samples(*curve, s, range, tolerance)) curve = circle_through(s, range);
  return curve && fits_samples(*curve, s, range, tolerance) ? curve : std::nullopt;
}

/// Returns the last sample up to which a line from `first` fits, or a line or an arc; at least the next one.
std::size_t longest(const Samples& s, std::size_t first, std::size_t end, double tolerance, bool or_arc) {
  const auto good = [&](std::size_t last) { return curve_through(s, {first, last}, tolerance, or_arc).has_value(); };
  std::size_t last = first + 1, step = 4;
  for (; last + step <= end && good(last + step); step *= 2) last += step;
  for (; step > 0; step /= 2)
    if (last + step <= end && good(last + step)) last += step;
  return last;
}

/// Returns the curve of samples: a line, or an arc where that is longer. Sets `last`.
FittedCurve next_curve(const Samples& s, std::size_t first, std::size_t end, double tolerance, std::size_t& last) {
  const std::size_t line_end = longest(s, first, end, tolerance, false);
  const std::size_t arc_end = line_end < end ? longest(s, first, end, tolerance, true) : line_end;
  const auto line_length = double(line_end - first), arc_length = double(arc_end - first);
  last = line_end;
  if (arc_length > kMinGain * line_length && arc_length > line_length + kMinArc)
    if (const auto circle = circle_through(s, {first, arc_end})) {
      last = arc_end;
      return *circle;
    }
  return line_through(s, {first, last});
}

std::vector<CurvePiece> greedy_pieces(const Samples& s, double tolerance) {
  std::vector<CurvePiece> pieces;
  for (std::size_t first = 0; first + 1 < s.size();) {
    CurvePiece& piece = pieces.emplace_back(CurvePiece{.first = first});
    piece.curve = next_curve(s, first, s.size() - 1, tolerance, piece.last);
    first = piece.last;
  }
  return pieces;
}

/// Returns the sine of the angle between two pieces at a sample.
double turn_at(const CurvePiece& a, const CurvePiece& b, dvec2 near) {
  const dvec2 from = a.curve.direction(near), to = b.curve.direction(near);
  const double sine = std::abs(cross(from, to));
  return glm::dot(from, to) < 0.0 ? 1.0 : sine;
}

double extent(const Samples& s, const CurvePiece& piece) {
  double length = 0.0;
  for (std::size_t k = piece.first; k < piece.last; ++k) length += glm::distance(s[k].at, s[k + 1].at);
  return length;
}

/// Moves the sample where two pieces meet to where their curves are equally near.
void move_break(const Samples& s, CurvePiece& a, CurvePiece& b) {
  constexpr std::size_t kReach = 12;  // samples
  const std::size_t from = std::max(a.first + 1, a.last - std::min(a.last, kReach));
  const std::size_t to = std::min(b.last - 1, b.first + kReach);
  // Where a line turns back both are equally near everywhere.
  const dvec2 here = s[a.last].at;
  if (from > to || glm::dot(a.curve.direction(here), b.curve.direction(here)) < kMinForward) return;
  double cost = 0.0, best = 0.0;
  std::size_t at = from;
  for (std::size_t k = from + 1; k <= to; ++k) {
    const double of_a = a.curve.distance(s[k].at), of_b = b.curve.distance(s[k].at);
    cost += of_a * of_a - of_b * of_b;
    if (cost < best + 1e-9) best = cost, at = k;  // the break is a sample of both
  }
  a.last = b.first = at;
}

/// Fits a piece again to its samples but those of rounded corners at its start and end: a line if that is good enough.
void fit_again(const Samples& s, CurvePiece& piece, bool corner_before, bool corner_after, double tolerance) {
  FitRange range{piece.first, piece.last};
  if (range.last - range.first >= kMinTrimmed)
    range = {range.first + (corner_before ? kTrim : 0), range.last - (corner_after ? kTrim : 0)};
  const FittedCurve line = line_through(s, range);
  if (piece.curve.radius == 0.0 || fits_samples(line, s, range, 0.5 * tolerance)) {
    piece.curve = line;
  } else if (const auto circle = circle_through(s, range)) {
    piece.curve = *circle;
  }
}

bool is_long_line(const Samples& s, const CurvePiece& piece) {
  return piece.curve.radius == 0.0 && extent(s, piece) > kLongLine;
}

/// Merges neighbours that one line, or one arc if either is one, fits. If `sharpens`, long lines have a larger
/// tolerance.
void merge_pieces(const Samples& s, std::vector<CurvePiece>& pieces, bool sharpens, double tolerance) {
  for (std::size_t k = 0; k + 1 < pieces.size();) {
    CurvePiece &a = pieces[k], &b = pieces[k + 1];
    const FitRange both{a.first, b.last};
    auto curve = curve_through(s, both, tolerance, a.curve.radius > 0.0 || b.curve.radius > 0.0);
    if (!curve && sharpens && (is_long_line(s, a) || is_long_line(s, b)))
      curve = curve_through(s, both, kLongTolerance * tolerance, false);
    if (!curve) {
      ++k;
      continue;
    }
    a.curve = *curve, a.last = b.last;
    pieces.erase(pieces.begin() + std::ptrdiff_t(k) + 1);
  }
}

/// Returns whether the pieces between two others are a corner between these that tracing has rounded.
bool is_rounded_corner(const Samples& s, const CurvePiece& a, const CurvePiece& b) {
  const dvec2 near = s[(a.last + b.first) / 2].at;
  const bool is_long = is_long_line(s, a) && is_long_line(s, b);
  const double length = extent(s, {.first = a.last, .last = b.first}), shorter = std::min(extent(s, a), extent(s, b));
  if (length > (is_long ? std::min(kLongCornerExtent, shorter / 3.0) : std::min(kCornerExtent, shorter / 1.5)))
    return false;
  const double forward = glm::dot(a.curve.direction(near), b.curve.direction(near));
  if (turn_at(a, b, near) < (is_long ? kLongCornerSine : kCornerSine) || forward < kMinForward) return false;
  const double bend = std::acos(std::clamp(forward, -1.0, 1.0)) / std::max(length, 1.0);  // as a rounded corner
  for (const CurvePiece* side : {&a, &b})
    if (side->curve.radius > 0.0 && side->curve.radius * bend < kMinSharpness) return false;
  const FittedCurve both[] = {a.curve, b.curve};
  const dvec2 corner = meeting_point(both, near, kCornerReach);
  // A rounded corner is shorter than a sharp one, and does not turn back.
  constexpr double kSlack = 0.5;  // pixels
  const dvec2 to = corner - s[a.last].at, from = s[b.first].at - corner;
  if (length > glm::length(to) + glm::length(from) + kSlack || glm::dot(to, a.curve.direction(near)) < -kSlack ||
      glm::dot(from, b.curve.direction(near)) < -kSlack)
    return false;
  double nearest = kCornerReach, off = 0.0;
  for (std::size_t k = a.last; k <= b.first; ++k) {
    nearest = std::min(nearest, glm::distance(s[k].at, corner));
    off = std::max(off, std::min(std::abs(a.curve.distance(s[k].at)), std::abs(b.curve.distance(s[k].at))));
  }
  return std::max(nearest, off) < (is_long ? kLongRounding : kRounding);
}

/// Removes short pieces that are rounded corners.
void sharpen_corners(const Samples& s, std::vector<CurvePiece>& pieces) {
  for (std::size_t k = 1; k + 1 < pieces.size(); ++k)
    for (std::size_t n = 1; n <= kCornerPieces && k + n < pieces.size(); ++n) {
      CurvePiece &a = pieces[k - 1], &b = pieces[k + n];
      if (!is_rounded_corner(s, a, b)) continue;
      a.last = b.first = (a.last + b.first) / 2;
      pieces.erase(pieces.begin() + std::ptrdiff_t(k), pieces.begin() + std::ptrdiff_t(k + n));
      break;
    }
}

/// Removes short pieces at one end of an open polyline, beside a long line: there it was joined to another one.
void remove_hook(const Samples& s, std::vector<CurvePiece>& pieces, bool at_start) {
  const std::size_t last = s.size() - 1;
  for (std::size_t n = 1; n <= kCornerPieces && n < pieces.size(); ++n) {
    CurvePiece& line = at_start ? pieces[n] : pieces[pieces.size() - 1 - n];
    const CurvePiece hook = at_start ? CurvePiece{.last = line.first} : CurvePiece{.first = line.last, .last = last};
    double off = 0.0;
    for (std::size_t k = hook.first; k <= hook.last; ++k) off = std::max(off, std::abs(line.curve.distance(s[k].at)));
    if (!is_long_line(s, line) || extent(s, hook) > std::min(kHook, extent(s, line) / 3.0) || off > kHookOffset)
      continue;
    (at_start ? line.first : line.last) = at_start ? 0 : last;
    const auto begin = at_start ? pieces.begin() : pieces.end() - std::ptrdiff_t(n);
    pieces.erase(begin, begin + std::ptrdiff_t(n));
    return;
  }
}

/// Makes a sample the first of a closed polyline.
void rotate_samples(Samples& s, std::size_t by) {
  s.pop_back();
  std::rotate(s.begin(), s.begin() + std::ptrdiff_t(by), s.end());
  s.push_back(s.front());
}

/// Returns the pieces of a polyline, with sharp corners but at its ends.
std::vector<CurvePiece> open_pieces(const Samples& s, bool sharpens, double tolerance) {
  std::vector<CurvePiece> pieces = greedy_pieces(s, tolerance);
  merge_pieces(s, pieces, sharpens, tolerance);
  if (!sharpens) return pieces;
  for (CurvePiece& piece : pieces)  // long arcs that are nearly lines, too
    if (extent(s, piece) > kLongLine)
      piece.curve =
          curve_through(s, {piece.first, piece.last}, kLongTolerance * tolerance, false).value_or(piece.curve);
  sharpen_corners(s, pieces);
  return pieces;
}

/// Returns the pieces of a closed polyline, whose start it moves to a corner beside the longest piece. Returns no
/// pieces if it has no corners.
std::vector<CurvePiece> closed_pieces(Samples& s, bool sharpens, double tolerance) {
  std::vector<CurvePiece> pieces = greedy_pieces(s, tolerance);
  const auto shorter = [](const auto& a, const auto& b) { return a.last - a.first < b.last - b.first; };
  const auto longest_piece = std::max_element(pieces.begin(), pieces.end(), shorter);
  rotate_samples(s, longest_piece->first);
  // Twice around, so that all corners lie between whole pieces: from the end of the first one to where it ends again.
  const std::size_t count = s.size() - 1;
  Samples twice = s;
  twice.insert(twice.end(), s.begin() + 1, s.end());
  pieces = open_pieces(twice, sharpens, tolerance);
  const std::size_t by = pieces[0].last;
  if (by >= count) return {};
  pieces.erase(pieces.begin());
  while (pieces.back().first >= count + by) pieces.pop_back();
  pieces.back().last = count + by;
  rotate_samples(s, by);
  for (CurvePiece& piece : pieces) piece.first -= by, piece.last -= by;
  return pieces;
}

/// Returns where two pieces meet: not far from the samples, nor before the end of one, as acute corners may be.
dvec2 joint_of(const Samples& s, const CurvePiece& a, const CurvePiece& b) {
  const FittedCurve both[] = {a.curve, b.curve};
  const dvec2 near = s[a.last].at, joint = meeting_point(both, near, kCornerReach);
  constexpr std::size_t kBeside = 3;  // samples
  double nearest = glm::distance(near, joint);
  for (std::size_t k = 1; k <= kBeside; ++k)
    for (const std::size_t i : {a.last - std::min(a.last, k), std::min(b.first + k, s.size() - 1)})
      nearest = std::min(nearest, glm::distance(s[i].at, joint));
  const bool cuts = glm::dot(joint - near, a.curve.direction(near)) < -kLongRounding ||
                    glm::dot(joint - near, b.curve.direction(near)) > kLongRounding;
  return nearest <= kLongRounding && !cuts ? joint : meeting_point(both, near, 0.0);
}

/// Fits all pieces again with their final samples, and computes their ends.
void join_pieces(const Samples& s, std::vector<CurvePiece>& pieces, bool closed, bool sharpens, double tolerance) {
  const std::size_t count = pieces.size(), joints = closed && count > 1 ? count : count - 1;
  for (std::size_t k = 0; k + 1 < count; ++k) move_break(s, pieces[k], pieces[k + 1]);
  std::vector<bool> is_corner(count + 1, false);  // before each piece
  for (std::size_t k = 1; k <= joints; ++k)
    is_corner[k] = sharpens && turn_at(pieces[k - 1], pieces[k % count], s[pieces[k - 1].last].at) > kCornerSine;
  is_corner[0] = is_corner[count];
  for (std::size_t k = 0; k < count; ++k) fit_again(s, pieces[k], is_corner[k], is_corner[k + 1], tolerance);
  pieces.front().from = meeting_point({&pieces.front().curve, 1}, s.front().at, kCornerReach);
  pieces.back().to = meeting_point({&pieces.back().curve, 1}, s.back().at, kCornerReach);
  for (std::size_t k = 0; k < joints; ++k) {
    CurvePiece &a = pieces[k], &b = pieces[(k + 1) % count];
    a.to = b.from = joint_of(s, a, b);
  }
  for (CurvePiece& piece : pieces)  // a short arc whose ends have changed places would go all the way round
    if (piece.curve.radius > 0.0 && piece.length() > 1.5 * extent(s, piece) + 1.0) piece.make_straight();
}

/// Returns the two halves of a circle, if the samples are one. If `sharpens`, the tolerance is larger.
std::vector<CurvePiece> circle_pieces(const Samples& s, bool sharpens, double tolerance) {
  const std::size_t last = s.size() - 1, half = last / 2;
  const auto circle = circle_through(s, {0, last});
  if (!circle || !fits_samples(*circle, s, {0, last}, sharpens ? kLongTolerance * tolerance : tolerance)) return {};
  const dvec2 from = meeting_point({&*circle, 1}, s[0].at, kCornerReach), to = 2.0 * circle->center - from;
  return {{*circle, 0, half, from, to}, {*circle, half, last, to, from}};
}

}  // namespace

double FittedCurve::distance(dvec2 p) const {
  return radius == 0.0 ? cross(along, p - center) : glm::distance(p, center) - radius;
}

dvec2 FittedCurve::normal(dvec2 p) const {
  if (radius == 0.0) return left_of(along);
  const double length = glm::distance(p, center);
  return length > 0.0 ? (p - center) / length : dvec2(1.0, 0.0);
}

dvec2 FittedCurve::direction(dvec2 p) const {
  if (radius == 0.0) return along;
  return turns_right ? left_of(normal(p)) : -left_of(normal(p));
}

void CurvePiece::make_straight() {
  const double length = glm::distance(from, to);
  curve = {.center = from, .along = length > 0.0 ? (to - from) / length : dvec2(1.0, 0.0)};
}

double CurvePiece::angle() const {
  if (curve.radius == 0.0) return 0.0;
  const dvec2 a = from - curve.center, b = to - curve.center;
  double angle = std::atan2(cross(a, b), glm::dot(a, b));
  if (curve.turns_right && angle < -1e-6) angle += 2.0 * kPi;
  if (!curve.turns_right && angle > 1e-6) angle -= 2.0 * kPi;
  return angle;
}

double CurvePiece::length() const {
  const double chord = glm::distance(from, to), half = 0.5 * std::abs(angle());
  return half < 1e-6 ? chord : chord * half / std::sin(half);
}

dvec2 CurvePiece::direction_at(int end) const {
  const double chord = glm::distance(from, to), turn = (end ? 0.5 : -0.5) * angle();
  const dvec2 d = chord > 0.0 ? (to - from) / chord : dvec2(1.0, 0.0);
  return d * std::cos(turn) + left_of(d) * std::sin(turn);
}

dvec2 CurvePiece::at(double fraction) const {
  const double whole = angle();
  if (std::abs(whole) < 1e-6) return from + fraction * (to - from);
  // The chord from the start is that of the fraction's angle; it turns by half of that from the start's direction.
  const double radius = glm::distance(from, to) / (2.0 * std::sin(0.5 * std::abs(whole)));
  const double turned = fraction * whole, chord = 2.0 * radius * std::sin(0.5 * std::abs(turned));
  const dvec2 d = direction_at(0);
  return from + chord * (d * std::cos(0.5 * turned) + left_of(d) * std::sin(0.5 * turned));
}

dvec2 meeting_point(std::span<const FittedCurve> curves, dvec2 near, double reach) {
  dvec2 mean(0.0);
  for (const FittedCurve& c : curves) mean += near - c.distance(near) * c.normal(near);
  mean /= double(curves.size());
  const double weight = 0.001 * double(curves.size());  // of `mean`: it decides where curves are nearly parallel
  dvec2 p = mean;
  for (int step = 0; step < 6; ++step) {
    double xx = weight, xy = 0.0, yy = weight, u = weight * (mean.x - p.x), v = weight * (mean.y - p.y);
    for (const FittedCurve& c : curves) {
      const dvec2 n = c.normal(p);
      const double off = c.distance(p);
      xx += n.x * n.x, xy += n.x * n.y, yy += n.y * n.y, u -= n.x * off, v -= n.y * off;
    }
    const double det = xx * yy - xy * xy;
    p += dvec2(yy * u - xy * v, xx * v - xy * u) / det;
  }
  return glm::distance(p, near) <= reach ? p : mean;
}

CurveFit fit_curve(const Stroke& stroke, double tolerance, bool sharpens) {
  CurveFit fit{samples_of(stroke), {}};
  Samples& s = fit.samples;
  std::vector<CurvePiece>& pieces = fit.pieces;
  if (s.size() < 2) return fit;
  const bool closed = stroke.closed && s.size() > 3;
  if (closed) pieces = circle_pieces(s, sharpens, tolerance);
  if (!pieces.empty()) return fit;
  pieces = closed ? closed_pieces(s, sharpens, tolerance) : std::vector<CurvePiece>();
  if (pieces.empty()) pieces = open_pieces(s, sharpens, tolerance);
  for (const bool at_start : {true, false})
    if (sharpens && !closed) remove_hook(s, pieces, at_start);
  join_pieces(s, pieces, closed, sharpens, tolerance);
  return fit;
}

}  // namespace umbrage
