// Second dispatch of `antialias`: reconstructs the line that an edge of stair steps stands for. Based on
// [Reshetov 2009]; the search along edges as in [Jimenez et al. 2012].
//
// An edge is followed along the border of the pixels in both directions, to where it stops or another edge crosses it.
// If one turns off to one side there, the line starts half a pixel to that side. It goes straight to the border in the
// middle between the two ends, and from there to the other end. So the pixels beside the border are covered in part by
// the colour of the other side.
//
// `antialias_from_above` is the fraction of this pixel that the colour of the one above covers, `antialias_to_above`
// the fraction of the pixel above that the colour of this one covers. `..._left`: the same to the left.
//
// Differs: areas are computed, not looked up, and weighted by the strengths of the edges; where edges turn off to both
// sides, the line ends at the border; no diagonal patterns.
IN_REAL(antialias_edge_left)
IN_REAL(antialias_edge_above)
OUT_REAL(antialias_from_left)
OUT_REAL(antialias_to_left)
OUT_REAL(antialias_from_above)
OUT_REAL(antialias_to_above)

struct End {
  Real distance;  // pixels between this one and the last of the edge
  Real height;    // of the line at the end: 0.5 on this pixel's side of the border, -0.5 on the other, or 0
};

// Returns the strength of an edge of the pixel (i, j) to the right and below, `upright`: of its left border.
FN Real edge_of(bool upright, int i, int j) {
  return upright ? near_antialias_edge_left(i, j) : near_antialias_edge_above(i, j);
}

// Follows the border above this pixel, or to its left if `upright`, in one direction: step -1 or 1.
FN End end_of(bool upright, int step) {
  End end = End(Real(0.0f), Real(0.0f));
  Real remaining = Real(1.0f);  // the part of the edge that has not ended yet
  for (int k = 0; k < C.search; ++k) {
    if (!some(remaining > 0.0f)) continue;
    // Edges that cross the end of pixel k, on this side of the border and on the other.
    int at = step * k + (step > 0 ? 1 : 0);
    Real here = edge_of(!upright, upright ? 0 : at, upright ? at : 0);
    Real there = edge_of(!upright, upright ? -1 : at, upright ? at : -1);
    end.height = mad(remaining * 0.5f, here - there, end.height);
    remaining = remaining * (1.0f - max(here, there));
    int next = step * (k + 1);
    Real beyond = edge_of(upright, upright ? 0 : next, upright ? next : 0);
    Bool inside = near_inside(upright ? 0 : next, upright ? next : 0);
    remaining = min(remaining, select(inside, beyond, Real(0.0f)));
    end.distance = end.distance + remaining;
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

FN Areas covered(Real strength, bool upright) {
  Real none = Real(0.0f);
  Areas areas = Areas(none, none);
  if (!some(strength > 0.0f)) return areas;
  End before = end_of(upright, -1);
  End after = end_of(upright, 1);
  Real half_length = (before.distance + after.distance + 1.0f) * Real(0.5f);
  Real first = area_of(before, half_length) * strength;
  Real second = area_of(after, half_length) * strength;
  areas.from = max(first, none) + max(second, none);
  areas.to = max(-first, none) + max(-second, none);
  return areas;
}

FN void antialias_search_pixel(Int px, Int py) {
  Areas left = covered(near_antialias_edge_left(0, 0), true);
  Areas above = covered(near_antialias_edge_above(0, 0), false);
  store_antialias_from_left(left.from);
  store_antialias_to_left(left.to);
  store_antialias_from_above(above.from);
  store_antialias_to_above(above.to);
}
