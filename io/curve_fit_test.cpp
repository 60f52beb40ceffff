// Fits of lines and arcs to polylines, and the paths that strokes become.
#include "io/curve_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "io/drawing_of_strokes.h"
#include "support.h"

namespace umbrage {
namespace {

using Positions = std::vector<std::array<double, 2>>;
constexpr double kPi = std::numbers::pi;

Stroke stroke_of(const Positions& at, bool closed = false, float width = 2.0f) {
  Stroke stroke{.closed = closed};
  for (const auto& [x, y] : at) stroke.points.push_back({float(x), float(y), width});
  return stroke;
}

/// Returns points on an ellipse from one angle to another.
Positions ellipse(double a, double b, double from, double to) {
  Positions at;
  for (int k = 0; k <= 200; ++k) {
    const double angle = from + (to - from) * k / 200;
    at.push_back({100.0 + a * std::cos(angle), 100.0 + b * std::sin(angle)});
  }
  return at;
}

/// Returns the max distance of a fit's points from the samples' polyline, both ways.
double deviation_of(const CurveFit& fit) {
  std::vector<glm::dvec2> drawn;
  for (const CurvePiece& piece : fit.pieces)
    for (int k = 0; k <= 400; ++k) drawn.push_back(piece.at(k / 400.0));
  double max = 0.0;
  for (const CurveSample& sample : fit.samples) {
    double nearest = 1e9;
    for (const glm::dvec2 p : drawn) nearest = std::min(nearest, glm::distance(p, sample.at));
    max = std::max(max, nearest);
  }
  return max;
}

TEST(CurveFit, AStraightLineIsOnePiece) {
  Positions at;
  for (int k = 0; k <= 90; ++k) at.push_back({3.0 + 0.7 * k, 5.0 + 0.4 * k + (k % 2 ? 0.05 : -0.05)});
  const CurveFit fit = fit_curve(stroke_of(at), 0.1, true);
  ASSERT_EQ(fit.pieces.size(), 1u);
  EXPECT_EQ(fit.pieces[0].angle(), 0.0);
  EXPECT_NEAR(glm::distance(fit.pieces[0].from, {3.0, 5.0}), 0.0, 0.06);
  EXPECT_NEAR(glm::distance(fit.pieces[0].to, {66.0, 41.0}), 0.0, 0.06);
}

TEST(CurveFit, ACircleHasTwoHalvesAndAnArcOne) {
  for (const double radius : {4.0, 60.0, 400.0}) {
    const CurveFit circle = fit_curve(stroke_of(ellipse(radius, radius, 0.3, 0.3 + 2 * kPi), true), 0.1, true);
    ASSERT_EQ(circle.pieces.size(), 2u) << radius;
    for (const CurvePiece& piece : circle.pieces) {
      EXPECT_NEAR(piece.curve.radius, radius, 1e-3 * radius);
      EXPECT_NEAR(glm::distance(piece.curve.center, {100.0, 100.0}), 0.0, 0.05);
      EXPECT_NEAR(piece.length(), kPi * radius, 3e-3 * radius);
    }
  }
  const CurveFit back = fit_curve(stroke_of(ellipse(50.0, 50.0, 2.0, -1.5)), 0.1, true);
  ASSERT_EQ(back.pieces.size(), 1u);
  EXPECT_NEAR(back.pieces[0].angle(), -3.5, 0.01);
  EXPECT_NEAR(back.pieces[0].direction_at(0).x, std::sin(2.0), 0.01);
  EXPECT_NEAR(back.pieces[0].direction_at(1).y, -std::cos(-1.5), 0.01);
}

TEST(CurveFit, AnEllipseIsAFewArcsNearIt) {
  for (const bool closed : {false, true}) {
    const CurveFit fit = fit_curve(stroke_of(ellipse(180.0, 60.0, 0.0, closed ? 2 * kPi : 3.0), closed), 0.1, false);
    EXPECT_LE(fit.pieces.size(), closed ? 22u : 12u);
    EXPECT_LE(deviation_of(fit), 0.25);  // the tolerance, and the distance between the points that are compared
    for (std::size_t k = 1; k < fit.pieces.size(); ++k) EXPECT_EQ(fit.pieces[k].from, fit.pieces[k - 1].to);
    if (closed) {
      EXPECT_EQ(fit.pieces.front().from, fit.pieces.back().to);
    }
  }
}

TEST(CurveFit, CornersThatTracingRoundedAreSharp) {
  // A square, rounded by arcs of radius 1.2 as tracing does, from all starts: on sides, and in corners.
  const double corners[][2] = {{80, 20}, {80, 80}, {20, 80}, {20, 20}};
  for (std::size_t start = 0; start < 100; ++start) {
    Positions at;
    for (int c = 0; c < 4; ++c)
      for (int k = 0; k <= 6; ++k) {
        const double angle = (c - 1 + k / 6.0) * kPi / 2, x = corners[c][0], y = corners[c][1];
        at.push_back(
            {x + (x < 50 ? 1.2 : -1.2) + 1.2 * std::cos(angle), y + (y < 50 ? 1.2 : -1.2) + 1.2 * std::sin(angle)});
        if (k == 6)
          for (int i = 1; i < 19; ++i) {
            const auto& next = corners[(c + 1) % 4];
            at.push_back({x + (next[0] - x) * i / 19.0, y + (next[1] - y) * i / 19.0});
          }
      }
    std::rotate(at.begin(), at.begin() + std::ptrdiff_t(start), at.end());
    at.push_back(at.front());
    const CurveFit fit = fit_curve(stroke_of(at, true), 0.1, true);
    ASSERT_EQ(fit.pieces.size(), 4u) << start;
    for (const CurvePiece& piece : fit.pieces) {
      double nearest = 1e9;
      for (const auto& [x, y] : corners) nearest = std::min(nearest, glm::distance(piece.from, {x, y}));
      EXPECT_LT(nearest, 0.1) << start;
      EXPECT_NEAR(piece.length(), 60.0, 0.1) << start;
    }
    EXPECT_GT(fit_curve(stroke_of(at, true), 0.1, false).pieces.size(), 4u) << "the arcs remain";
  }
}

TEST(CurveFit, AnyPolylineIsFollowed) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    unsigned drawn = 0;
    const auto random = [&] { return double(test::hash(1000 * seed + drawn++) % 4096) / 4096.0; };
    const double bend = 3.0 * random();
    Positions at = {{100.0 * random(), 100.0 * random()}};
    double angle = 6.0 * random();
    const int count = 1 + int(60.0 * random());
    for (int i = 0; i < count; ++i) {
      angle += bend * (random() - 0.5);
      const double step = 8.0 * random() * random();
      at.push_back({at.back()[0] + step * std::cos(angle), at.back()[1] + step * std::sin(angle)});
    }
    const bool closed = seed % 3 == 0 && at.size() > 3;
    if (closed) at.push_back(at.front());
    for (const bool sharpens : {false, true}) {
      const CurveFit fit = fit_curve(stroke_of(at, closed), 0.1, sharpens);
      if (fit.pieces.empty()) continue;
      EXPECT_LE(deviation_of(fit), sharpens ? 1.3 : 1.0) << seed;
      for (std::size_t k = 1; k < fit.pieces.size(); ++k) EXPECT_EQ(fit.pieces[k].from, fit.pieces[k - 1].to) << seed;
    }
  }
}

/// Returns the signed area of a path's outline, of lines and arcs.
double area_of(const DrawnPath& path) {
  double area = 0.0, x = path.x, y = path.y;
  for (const DrawnSegment& s : path.segments) {
    area += 0.5 * (x * s.y - s.x * y);
    if (s.radius > 0.0f) {
      const double half = std::asin(std::min(1.0, 0.5 * std::hypot(s.x - x, s.y - y) / s.radius));
      const double angle = 2.0 * (s.large_arc ? kPi - half : half);
      area += (s.clockwise ? 0.5 : -0.5) * s.radius * s.radius * (angle - std::sin(angle));
    }
    x = s.x, y = s.y;
  }
  for (const DrawnPath& hole : path.holes) area += area_of(hole);
  return area;
}

const DrawnPath& path_at(const Drawing& drawing, std::size_t layer, std::size_t shape) {
  return std::get<DrawnPath>(drawing.layers.at(layer).shapes.at(shape));
}

TEST(DrawingOfStrokes, AVaryingLineIsOneOutlineOfItsArea) {
  Stroke straight{.points = {{10, 10, 1}, {110, 10, 5}}};
  Stroke ring = stroke_of(ellipse(40.0, 40.0, 0.0, 2 * kPi), true);
  for (std::size_t k = 0; k < ring.points.size(); ++k)
    ring.points[k].width = float(3.0 + std::sin(0.0314159 * double(k)));
  const auto drawing = drawing_of({200, 200, {straight, ring}}, {});
  ASSERT_TRUE(drawing);
  const DrawnPath &area = path_at(*drawing, 0, 0), &loop = path_at(*drawing, 0, 1);
  EXPECT_FALSE(area.stroke);
  ASSERT_TRUE(area.fill);
  EXPECT_LE(area.segments.size(), 4u);
  EXPECT_NEAR(std::abs(area_of(area)), 300.0 + kPi * (0.125 + 3.125), 3.0);
  EXPECT_EQ(loop.holes.size(), 1u);
  EXPECT_NEAR(std::abs(area_of(loop)), 2 * kPi * 40.0 * 3.0, 8.0);
  const auto lines = drawing_of({200, 200, {straight, ring}}, {.varies = false});
  EXPECT_NEAR(path_at(*lines, 0, 0).width, 3.0, 0.1);
  EXPECT_EQ(path_at(*lines, 0, 1).segments.size(), 2u);
}

TEST(DrawingOfStrokes, LinesAreDividedAtCornersAndMeet) {
  // An L, and lines that end a pixel before and beside its corner.
  const std::vector<Stroke> strokes = {stroke_of({{10, 80}, {10, 20}, {90, 20}}), stroke_of({{60, 90}, {10.6, 20.9}}),
                                       stroke_of({{50, 80}, {50.1, 21.2}})};
  const auto drawing = drawing_of({100, 100, strokes}, {});
  ASSERT_TRUE(drawing);
  ASSERT_EQ(drawing->layers[0].shapes.size(), 4u);
  const DrawnSegment corner = path_at(*drawing, 0, 0).segments.at(0);
  EXPECT_NEAR(corner.x, 10.0, 0.15);
  EXPECT_NEAR(corner.y, 20.0, 0.15);
  EXPECT_EQ(path_at(*drawing, 0, 1).x, corner.x);
  EXPECT_EQ(path_at(*drawing, 0, 1).y, corner.y);
  EXPECT_EQ(path_at(*drawing, 0, 2).segments.at(0).x, corner.x);
  EXPECT_NEAR(path_at(*drawing, 0, 3).segments.at(0).y, 20.0, 0.15) << "reaches the side";
  std::vector<Stroke> hatching = {strokes[0]};
  hatching[0].kind = StrokeKind::kHatch;
  EXPECT_EQ(drawing_of({100, 100, hatching}, {})->layers[0].shapes.size(), 1u);
}

TEST(DrawingOfStrokes, DashesBeginAndEndALine) {
  Stroke hidden = stroke_of({{0, 10}, {100, 10}});
  hidden.kind = StrokeKind::kHidden, hidden.dash = 9.0f, hidden.gap = 6.0f;
  const auto drawing = drawing_of({100, 20, {hidden}}, {});
  const DrawnPath& path = path_at(*drawing, 0, 0);
  ASSERT_EQ(path.dashes.size(), 2u);
  EXPECT_NEAR(path.dashes[0] / path.dashes[1], 1.5, 1e-4);
  const double periods = (100.0 + path.dashes[1]) / (path.dashes[0] + path.dashes[1]);
  EXPECT_NEAR(periods, std::round(periods), 1e-3);
}

TEST(DrawingOfStrokes, WhatCannotBeDrawnIsRefused) {
  Stroke stroke = stroke_of({{0, 0}, {1, 1}});
  for (const float bad : {NAN, INFINITY, 2e9f}) {
    stroke.points[1].x = bad;
    EXPECT_FALSE(drawing_of({10, 10, {stroke}}, {}));
  }
  stroke.points[1] = {1.0f, 1.0f, -1.0f};
  EXPECT_FALSE(drawing_of({10, 10, {stroke}}, {}));
  stroke.points[1] = {1e9f, -1e9f, 1.0f};
  EXPECT_TRUE(drawing_of({10, 10, {stroke, Stroke(), stroke_of({{5, 5}, {5, 5}})}}, {}));
}

}  // namespace
}  // namespace umbrage
