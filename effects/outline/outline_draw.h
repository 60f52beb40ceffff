// Traces lines through the edges of a picture, and computes the fraction of each pixel that lines cover.
#pragma once
#include "core/lines.h"
#include "effects/outline/outline.h"
#include "kernel/host_frame.h"

namespace umbrage {

/// Traces lines through edges. Inputs: outline_edge_right, outline_edge_below, depth, object_id. The result does not
/// depend on the number of threads; the time is about linear in the number of edges, for a given height of the picture.
Lines trace_lines(const HostFrame& frame, const OutlineConstants& constants);

/// Writes the fraction of each pixel that lines cover, times `opacity`: from the distance of the pixel's centre to the
/// nearest part of a line, antialiased over a pixel. A line thinner than a pixel is drawn a pixel wide and
/// proportionally lighter.
void draw_lines(const Lines& lines, float opacity, const HostPlane& cover);

/// The host step of effect `outline`.
void run_host_outline(const HostFrame& frame);

}  // namespace umbrage
