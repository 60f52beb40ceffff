// The host step of effect `hidden`: finds the edges of hidden surfaces and draws them as dashed lines.
#pragma once
#include <vector>

#include "chains/graph.h"
#include "core/strokes.h"
#include "effects/hidden/hidden.h"
#include "kernel/host_frame.h"

namespace umbrage {

/// Returns the edges of hidden surfaces. A surface of one pixel continues in its neighbour if any surface of that
/// pixel, on whichever layer, has a similar normal and lies on the same plane. A hidden surface that does not continue
/// has an edge there. Edges within two pixels of an edge of the visible surface are left out.
std::vector<Edge> hidden_edges(const HostFrame& frame, const HiddenConstants& constants);

/// Returns the hidden lines of a picture, dashed, from the inputs of the host step. The result does not depend on
/// the number of threads.
Strokes hidden_lines(const HostFrame& frame);

}  // namespace umbrage
