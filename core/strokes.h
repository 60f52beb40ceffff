// Strokes: the lines of a picture as curves with width.
#pragma once
#include <vector>

namespace umbrage {

enum class StrokeKind {
  kOutline,     ///< border of an object against another one, another material or the background
  kFold,        ///< an object occludes part of itself
  kCrease,      ///< two faces meet at an angle
  kHatch,       ///< hatching along a surface
  kCrossHatch,  ///< hatching that crosses other hatching
  kHidden,      ///< a dash of an edge behind the visible surface
};

struct StrokePoint {
  float x, y;   ///< pixels from the picture's upper left corner; the first pixel's centre lies at (0.5, 0.5)
  float width;  ///< pixels
};

/// A polyline with round ends and joins, whose width changes linearly from point to point.
struct Stroke {
  StrokeKind kind = StrokeKind::kOutline;  ///< kind of most of it
  int object = 0;                          ///< object_id of the nearer surface at its middle
  bool closed = false;                     ///< the last point equals the first
  std::vector<StrokePoint> points;
};

struct Strokes {
  int width = 0, height = 0;  ///< of the picture, pixels
  std::vector<Stroke> strokes;
};

}  // namespace umbrage
