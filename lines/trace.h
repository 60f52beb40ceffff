// The steps that make lines of a graph of pixels' sides: chains of edges, joined at junctions, kept where they are
// clear, linked over gaps, smoothed and led to what they meet. Each step changes the tracing in place and may be left
// out; the order below is the one they are made for. All are the same to the bit at any number of threads, take time
// about linear in the number of edges, and do not fail. Places and lengths are in pixels of the graph's picture.
#pragma once
#include <functional>

#include "lines/chains.h"

namespace umbrage {

/// How large a pixel is at a depth, in units of depth.
struct PixelSize {
  float scale = 1.0f;  // at any depth, or, in perspective, at depth 1
  bool perspective = false;

  float at(float depth) const { return perspective ? scale * depth : scale; }
};

/// What must be clear of a chain for it to stay: hysteresis of its mean strength.
struct Clarity {
  float faint;  // where it falls below, the chain ends;
  float clear;  // what is left must exceed this somewhere,
  float full;   // and has weight 1 from here on
  int around;   // points to either side, of that mean
};

/// Chains from junction to junction, of all edges of the graph. Points have place, strength, kind and edge.
void find_chains(Tracing& t);

/// Joins the ends that go on in each other at a junction, the straightest and likest first: kinds and strengths of
/// points count. Where two alone have the highest kind they are joined however they turn.
void join_at_junctions(Tracing& t);

/// Cuts chains where they are faint, and drops the parts that are nowhere clear.
void keep_clear_parts(Tracing& t, const Clarity& clarity);

/// Joins free ends that face each other within `reach` pixels, or that face a side of another chain, half as far and no
/// farther than half their own length. Depths of points count: what would step too steeply stays apart.
/// Where they are unknown, all 0, `pixel` is to be without perspective.
void bridge_gaps(Tracing& t, float reach, const PixelSize& pixel);

/// Drops chains that are no longer than `least_px` says, by how many of their ends are free, and those that this frees
/// in turn. What is hardly longer weighs less; of what need not be long it says 0.
void drop_short(Tracing& t, const std::function<float(const Chain& chain, int free_ends)>& least_px);

/// Moves points to the parabolas through their neighbours: what is straight becomes straight, what is round round, and
/// corners stay.
void smooth_chains(Tracing& t);

/// Leads ends to what they meet or beyond the picture's border, and repeats the first point of closed chains as the
/// last.
void meet(Tracing& t);

}  // namespace umbrage
