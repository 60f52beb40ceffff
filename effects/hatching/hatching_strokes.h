// The host step of effect `hatching`: evenly spaced lines along directions, as wide as the ink that each place needs.
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "core/strokes.h"
#include "effects/hatching/hatching.h"
#include "kernel/host_frame.h"

namespace umbrage {

/// Where lines can run, and how much ink each pixel needs. All planes have width x height pixels.
struct HatchingField {
  int width = 0, height = 0;
  HostPlane x, y;    ///< direction as (cos 2a, sin 2a), a from right to down; 0: none
  HostPlane breaks;  ///< kHatchingBreak...
  float spacing_px = 6.0f;
};

/// A line of a set, before it has a width.
struct HatchingLine {
  /// Lines of rank 0 start 4 spacings apart; those of ranks 0 and 1 together 2, and all of them 1.
  int rank = 0;
  bool free_start = false, free_end = false;  ///< it ends beside another line, not where the surface ends
  struct Point {
    float x, y;  ///< pixels
  };
  std::vector<Point> points;
  // At each point:
  std::vector<float> room;   ///< width of the strip to the middle between it and the lines beside it, pixels
  std::vector<float> level;  ///< `rank`, or more where lines of lower rank are nearer than that rank permits
  // Of a line between key frames, else empty:
  std::vector<float> next_level;  ///< of the line that it becomes
  std::vector<float> weight;      ///< factor of its width
  float gone = 0.0f;              ///< 0: it is as at its key frame, 1: it has become that of the other one
};
inline constexpr int kHatchingRanks = 3;
using HatchingSets = std::array<std::vector<HatchingLine>, 2>;
using HatchingSeeds = std::array<std::vector<HatchingLine::Point>, kHatchingRanks>;

/// Returns lines that are evenly spaced over all surfaces [Jobard and Lefer 1997], the wide ranks first. `seeds`:
/// points in pixels from which lines start where there are none yet, in order.
std::vector<HatchingLine> trace_hatching(const HatchingField& field, const HatchingSeeds& seeds);

/// Returns the width in pixels of a line of that level where the fraction `ink` of the area is to be covered, by lines
/// of `width_px` that are wider only where all ranks together need it.
float hatching_width(float level, float ink, float spacing_px, float width_px);

/// Returns the lines of both sets of a picture, the second of which crosses the first, from the inputs of the host step
/// that do not depend on light.
HatchingSets traced_sets(const HostFrame& frame);

/// Implement KeySteps.
SurfaceLines hatching_key(const HostFrame& frame);
SurfaceLines hatching_join(const SurfaceLines& first, const SurfaceLines& second);
/// Returns the visible parts of the lines of a frame between two key frames, `frame.info.lines_between`; nothing if
/// these do not show two thirds of its surfaces, or much smaller or larger.
std::optional<HatchingSets> lines_between_keys(const HostFrame& frame);

/// Returns the lines of a picture from the inputs of the host step, with widths.
Strokes hatching_lines(const HostFrame& frame);

}  // namespace umbrage
