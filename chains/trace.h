// The steps that turn a graph of pixel edges into lines: they find chains of edges, join them at junctions, keep their
// clear parts, bridge gaps, drop short chains, smooth the others and connect their ends. Call them in the order of this
// header; each one changes the tracing in place, and all but the first are optional. Results are bitwise identical for
// any number of threads. The steps take time about linear in the number of edges and do not fail. Positions and lengths
// are in pixels of the graph's picture.
#pragma once
#include <functional>
#include <vector>

#include "chains/chains.h"
#include "core/strokes.h"

namespace umbrage {

/// The size of a pixel at a depth, in units of depth.
struct PixelSize {
  float scale = 1.0f;  // pixel size at depth 1; without perspective, at any depth
  bool perspective = false;

  float at(float depth) const { return perspective ? scale * depth : scale; }
};

/// Hysteresis thresholds for the mean strength of a chain, a moving average along it.
struct Clarity {
  float faint;  // a chain is cut where the mean falls below this
  float clear;  // a part is kept if the max of the mean in it exceeds this
  float full;   // a part has weight 1 if the max of the mean in it is at least this
  int around;   // number of points on either side that the mean includes
};

/// Divides all edges of the graph into chains from junction to junction. Sets position, strength, kind and edge of the
/// chains' points.
void find_chains(Tracing& t);

/// Joins ends that continue each other at a junction, starting with the pair that is straightest and most similar in
/// kind and strength. If exactly two ends have the highest kind, they are joined at any angle.
void join_at_junctions(Tracing& t);

/// Cuts chains where they are faint and drops the parts that are nowhere clear.
void keep_clear_parts(Tracing& t, const Clarity& clarity);

/// Joins free ends that face each other within `reach` pixels. A free end that faces the side of another chain is
/// joined to it, within half of `reach` and half of its own chain's length. Points are not joined if the depth between
/// them changes too steeply. If depths are unknown (all 0), `pixel.perspective` must be false.
void bridge_gaps(Tracing& t, float reach, const PixelSize& pixel);

/// Drops each chain whose length in pixels is at most min_px(chain, its number of free ends); where that is 0, any
/// length is kept. Repeats this, since dropped chains can leave ends of others free. Reduces the weight of chains that
/// are less than 1.5 times as long as their minimum.
void drop_short(Tracing& t, const std::function<float(const Chain& chain, int free_ends)>& min_px);

/// Moves points to parabolas fitted to their neighbours. This removes pixel steps from straight and round parts and
/// keeps corners.
void smooth_chains(Tracing& t);

/// Extends ends to the chains that they meet, or beyond the picture's border, and repeats the first point of each
/// closed chain as its last.
void connect_ends(Tracing& t);

/// Returns the polyline without those points whose removal moves it by less than 1/20 of a pixel and changes its width
/// by less than 1/10 of a pixel.
std::vector<StrokePoint> simplified(const std::vector<StrokePoint>& points);

/// Returns the dashes of a line, solid strokes; of a solid line the line itself. Dashes and gaps are scaled so that an
/// open line begins and ends with a dash.
std::vector<Stroke> dashes_of(const Stroke& line);
/// Returns lines with their dashes in place of dashed ones.
Strokes with_dashes(const Strokes& lines);

}  // namespace umbrage
