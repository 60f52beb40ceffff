// From the edges of a picture to lines, and from lines to what they cover of each pixel.
#pragma once
#include "core/lines.h"
#include "effects/outline/outline.h"
#include "kernel/host_frame.h"

namespace umbrage {

/// Traces lines through edges. Inputs: outline_edge_right, outline_edge_below, depth, object_id. The same at any number
/// of threads; the time is about linear in the number of edges, at a given height of the picture.
Lines trace_lines(const HostFrame& frame, const OutlineConstants& constants);

/// What lines cover of each pixel, times `opacity`: by the distance of its centre from the nearest part of a line,
/// antialiased over a pixel. A line thinner than a pixel is as wide as one and as much lighter.
void draw_lines(const Lines& lines, float opacity, const HostPlane& cover);

/// The host step of effect `outline`.
void run_host_outline(const HostFrame& frame);

}  // namespace umbrage
