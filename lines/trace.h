// The steps that turn a graph of pixel edges into lines: they find chains of edges, join them at junctions, keep their
// clear parts, bridge gaps, smooth them and connect their ends. Each step changes the tracing in place and may be
// omitted; the order below is the intended one. All results are bitwise identical at any number of threads. All steps
// take time about linear in the number of edges and do not fail. Positions and lengths are in pixels of the graph's
// picture.
#pragma once
#include <functional>

#include "lines/chains.h"

namespace umbrage {

/// The size of a pixel at a depth, in units of depth.
struct PixelSize {
  float scale = 1.0f;  // at any depth, or with perspective at depth 1
  bool perspective = false;

  float at(float depth) const { return perspective ? scale * depth : scale; }
};

/// Thresholds of the mean strength of a chain: hysteresis.
struct Clarity {
  float faint;  // a chain is cut where the mean falls below this
  float clear;  // a part is kept if its maximum of the mean exceeds this
  float full;   // a part has weight 1 if its maximum of the mean is at least this
  int around;   // points to either side in the mean
};

/// Finds the chains from junction to junction of all edges of the graph. Sets position, strength, kind and edge of
/// their points.
void find_chains(Tracing& t);

/// Joins ends that continue each other at a junction, the straightest and most similar first; similarity is that of
/// kinds and strengths. Two ends that alone have the highest kind are joined at any angle.
void join_at_junctions(Tracing& t);

/// Cuts chains where they are faint and drops the parts that are clear nowhere.
void keep_clear_parts(Tracing& t, const Clarity& clarity);

/// Joins free ends that face each other within `reach` pixels. A free end also joins the side of another chain that it
/// faces, within half of `reach` and half of its own length. Ends are not joined if the depths of the points differ too
/// steeply. If the depths are unknown (all 0), `pixel.perspective` must be false.
void bridge_gaps(Tracing& t, float reach, const PixelSize& pixel);

/// Drops chains of at most `min_px` pixels, which depends on the number of free ends (0: any length is kept), and
/// repeats this for the chains whose ends it frees. Chains that are hardly longer get less weight.
void drop_short(Tracing& t, const std::function<float(const Chain& chain, int free_ends)>& min_px);

/// Moves points to parabolas fitted to their neighbours: straight parts become straight, round parts round, and corners
/// stay.
void smooth_chains(Tracing& t);

/// Extends ends to the lines that they meet or beyond the picture's border, and repeats the first point of closed
/// chains as the last.
void meet(Tracing& t);

}  // namespace umbrage
