// Second dispatch of `antialias`: reconstructs the line that an edge of stair steps stands for. Based on
// [Reshetov 2009]; the search along edges as in [Jimenez et al. 2012].
//
// An edge is followed along the border of the pixels in both directions, to where it stops or another edge crosses it.
// If one turns off to one side there, the line starts half a pixel to that side. It goes straight to the border in the
// middle between the two ends, and from there to the other end. So the pixels beside the border are covered in part by
// the colour of the other side.
//
// `antialias_from_above` is the fraction of this pixel that the colour of the one above covers, `antialias_to_above` the
// fraction of the pixel above that the colour of this one covers. `..._left`: the same to the left.
//
// Differs: areas are computed, not looked up; edges across which two other edges leave, one to each side, count as ends
// without a turn; no diagonal patterns.
IN_REAL(antialias_edges)
OUT_REAL(antialias_from_left)
OUT_REAL(antialias_to_left)
OUT_REAL(antialias_from_above)
OUT_REAL(antialias_to_above)

FN Bool is_left_edge(Real edges) { return edges == Real(1.0f) || edges == Real(3.0f); }
FN Bool is_above_edge(Real edges) { return edges >= Real(2.0f); }

struct End {
  Real distance;  // pixels between this one and the last of the edge
  Real height;    // of the line at the end: 0.5 on this pixel's side of the border, -0.5 on the other, or 0
};

// Returns the flag of an edge along the border that is followed, or across it: `upright` selects the border to the
// left.
FN Bool along_of(Real edges, bool upright) {
  if (upright) return is_left_edge(edges);
  return is_above_edge(edges);
}

// Follows the border above this pixel, or to its left if `upright`, in one direction: step -1 or 1.
FN End end_of(Bool enabled, bool upright, int step) {
  End end = End(Real(0.0f), Real(0.0f));
  Bool searching = enabled;
  for (int k = 0; k <= C.search; ++k) {
    if (!some(searching)) continue;
    // Pixels on both sides of the border, behind the edge that crosses it.
    int at = step * k + (step > 0 ? 1 : 0);
    Real own = upright ? near_antialias_edges(0, at) : near_antialias_edges(at, 0);
    Real other = upright ? near_antialias_edges(-1, at) : near_antialias_edges(at, -1);
    Bool turns_here = along_of(own, !upright);
    Bool turns_there = along_of(other, !upright);
    int next = step * (k + 1);
    Real beyond = upright ? near_antialias_edges(0, next) : near_antialias_edges(next, 0);
    Bool inside = upright ? near_inside(0, next) : near_inside(next, 0);
    Bool ends = searching && (turns_here || turns_there || !along_of(beyond, upright) || !inside);
    Real height = select(turns_here, Real(0.5f), Real(0.0f)) - select(turns_there, Real(0.5f), Real(0.0f));
    end.height = select(ends, height, end.height);
    end.distance = select(searching, Real(float(k)), end.distance);
    searching = searching && !ends;
  }
  return end;
}

// Returns the area between border and line in this pixel's row or column, of the half of the line at this end, whose
// length is `half_length`. Negative on the other side of the border.
FN Real area_of(End end, Real half_length) {
  Real begin = min(end.distance, half_length);
  Real stop = min(end.distance + 1.0f, half_length);
  // The integral of height * (1 - t / half_length).
  return end.height * (stop - begin) * (1.0f - (begin + stop) * Real(0.5f) / half_length);
}

struct Areas {
  Real from, to;  // covered on this pixel's side of the border, and on the other
};

FN Areas covered(Bool enabled, bool upright) {
  Real none = Real(0.0f);
  Areas areas = Areas(none, none);
  if (!some(enabled)) return areas;
  End before = end_of(enabled, upright, -1);
  End after = end_of(enabled, upright, 1);
  Real half_length = (before.distance + after.distance + 1.0f) * Real(0.5f);
  Real first = area_of(before, half_length);
  Real second = area_of(after, half_length);
  areas.from = select(enabled, max(first, none) + max(second, none), none);
  areas.to = select(enabled, max(-first, none) + max(-second, none), none);
  return areas;
}

FN void antialias_search_pixel(Int px, Int py) {
  Real edges = near_antialias_edges(0, 0);
  Areas left = covered(is_left_edge(edges), true);
  Areas above = covered(is_above_edge(edges), false);
  store_antialias_from_left(left.from);
  store_antialias_to_left(left.to);
  store_antialias_from_above(above.from);
  store_antialias_to_above(above.to);
}
