// The host step of effect `outline`: traces lines through the edges of a picture and draws them.
#pragma once
#include "core/strokes.h"
#include "effects/outline/outline.h"
#include "kernel/host_frame.h"

namespace umbrage {

/// Returns the lines through the edges of a picture. Reads the inputs outline_edge_right, outline_edge_below, depth and
/// object_id of the host step. The result does not depend on the number of threads. For a given height of the picture,
/// the time is about linear in the number of edges.
Strokes trace_lines(const HostFrame& frame);

/// Writes to `cover` the fraction of each pixel that lines cover, times `opacity`. The fraction follows from the
/// distance of the pixel's centre to the nearest line and is antialiased over one pixel. A line thinner than a pixel is
/// drawn a pixel wide and proportionally lighter.
void draw_lines(const Strokes& lines, float opacity, const HostPlane& cover);

/// Draws lines, opaque and dashed as they are, over those of the input `outline` of a host step, to its output
/// `outline`.
void add_lines(const Strokes& lines, const HostFrame& frame);
/// A host step: draws the lines that `trace` returns so.
template <Strokes (*trace)(const HostFrame&)>
void add_traced(const HostFrame& frame) {
  add_lines(trace(frame), frame);
}

/// Runs the host step: traces the lines and writes the output `outline`.
void run_host_outline(const HostFrame& frame);

}  // namespace umbrage
