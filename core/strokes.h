// Strokes: the lines of a picture as curves with width.
#pragma once
#include <memory>
#include <vector>

namespace umbrage {

enum class StrokeKind {
  kOutline,     ///< border of an object against another one, another material or the background
  kFold,        ///< an object occludes part of itself
  kCrease,      ///< two faces meet at an angle
  kHatch,       ///< hatching along a surface
  kCrossHatch,  ///< hatching that crosses other hatching
  kHidden,      ///< an edge behind the visible surface
  kSection,     ///< border of a section's cap; only in drawings
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
  float dash = 0.0f, gap = 0.0f;  ///< lengths in pixels of a dashed line, which begins with a dash; 0: solid
  int beside = 0;                 ///< object_id on the other side at its middle; that of `object` if it is the same
};

struct Strokes {
  int width = 0, height = 0;  ///< of the picture, pixels
  std::vector<Stroke> strokes;
};

/// Lines on surfaces, world space, in a type private to the effect that made them: of a key frame of a sequence, or of
/// all frames between two of them.
using SurfaceLines = std::shared_ptr<const void>;

/// The lines of a frame between two key frames.
struct LinesBetween {
  SurfaceLines lines;  ///< of all frames between them
  float after = 0.0f;  ///< where the frame is: 0 at the first key frame, 1 at the second
};

}  // namespace umbrage
