// Crossings moved to the pixels that they lie between. outline_find finds a crease where normals turn most, and then
// where its planes meet, which may lie beyond either of the two pixels: rows of one line would then be told by columns
// that are two apart, and no longer be taken for one line.
//
// Planes of crossings as outline_crossing.kernel.h has them; t is in [0, 1) now, but at the picture's border, where
// there is no pixel to move to. Of two crossings at one place the clearer one stays, and a faint crease beside a clear
// crossing is but that one's shadow. In high pictures one crease may be found by several pixels of a stride, which
// place it up to two pixels apart: one of them stays, or else its line would be drawn double, or its halves be taken to
// stand for each other.
IN_REAL(outline_right)
IN_REAL(outline_below)
OUT_REAL(outline_right_settled)
OUT_REAL(outline_below_settled)
#include "effects/outline/outline_crossing.kernel.h"

CONST float kPixel = 0.5f;   // of t in its code
CONST float kFirst = 0.25f;  // code of t = 0
CONST float kNoPlace = 2.0f;

// The crossing from one of its neighbours, if it lies here and is clearer than v; else v.
FN Real clearer(Real v, Real before, Real after) {
  Real a = abs(before);
  Real b = abs(after);
  Bool from_before = a - floor(a) >= kFirst + kPixel;
  Bool from_after = b > 0.0f && b - floor(b) < kFirst;
  Real moved = select(before < 0.0f, before + kPixel, before - kPixel);
  Bool better = from_before && (v == Real(0.0f) || clear_of(before) > clear_of(v));
  v = select(better, moved, v);
  moved = select(after < 0.0f, after - kPixel, after + kPixel);
  better = from_after && (v == Real(0.0f) || clear_of(after) > clear_of(v));
  v = select(better, moved, v);
  Bool shadow = v < 0.0f && floor(code_of(v)) == Real(kMiddle) && (before > 0.0f || after > 0.0f);
  return select(shadow, Real(0.0f), v);
}

// v, or nothing if it lies in another place, that of the pixel before, if there is one, or of the one after.
FN Real here_alone(Real v, Bool before) {
  Real a = abs(v);
  Real share = a - floor(a);
  return select((share >= kFirst || !before) && share < kFirst + kPixel, v, Real(0.0f));
}

// t of a crease; kNoPlace for what is none.
FN Real crease_place(Real v) {
  Real code = code_of(v);
  Real side = floor(code);
  return select(side == Real(kMiddle), (code - side - kFirst) * Real(1.0f / kPixel), Real(kNoPlace));
}

// v, or nothing if it is a clear crease and one beside it, `before` or `after`, knows its place better: one that places
// it in its own pixel and is clearer, or as clear and the first.
FN Real known_here(Real v, Real before, Real after) {
  Real place = crease_place(v);
  Real place_before = crease_place(before);
  Real place_after = crease_place(after);
  Bool by_before = place_before >= 0.0f && place_before < 1.0f && place >= 0.0f;
  Bool by_after = place_after >= 0.0f && place_after < 1.0f && place < 1.0f;
  by_before = by_before && clear_of(before) >= clear_of(v);
  by_after = by_after && (clear_of(after) > clear_of(v) || (place < 0.0f && clear_of(after) == clear_of(v)));
  return select(v > 0.0f && place < kNoPlace && (by_before || by_after), Real(0.0f), v);
}

FN void outline_settle_pixel(Int px, Int py) {
  Real right = near_outline_right(0, 0);
  Real below = near_outline_below(0, 0);
  Real left1 = near_outline_right(-1, 0);
  Real right1 = near_outline_right(1, 0);
  Real above1 = near_outline_below(0, -1);
  Real below1 = near_outline_below(0, 1);
  left1 = select(near_inside(-1, 0), left1, Real(0.0f));
  right1 = select(near_inside(1, 0), right1, Real(0.0f));
  above1 = select(near_inside(0, -1), above1, Real(0.0f));
  below1 = select(near_inside(0, 1), below1, Real(0.0f));
  Uint any = bits_of(right) | bits_of(below) | bits_of(left1) | bits_of(right1) | bits_of(above1) | bits_of(below1);
  if (some(!(to_signed(any) == Int(0)))) {
    if (C.stride > 1) {
      Real left2 = select(near_inside(-2, 0), near_outline_right(-2, 0), Real(0.0f));
      Real above2 = select(near_inside(0, -2), near_outline_below(0, -2), Real(0.0f));
      Real left = known_here(left1, left2, right);
      Real here = known_here(right, left1, right1);
      right1 = known_here(right1, right, select(near_inside(2, 0), near_outline_right(2, 0), Real(0.0f)));
      left1 = left;
      right = here;
      Real above = known_here(above1, above2, below);
      here = known_here(below, above1, below1);
      below1 = known_here(below1, below, select(near_inside(0, 2), near_outline_below(0, 2), Real(0.0f)));
      above1 = above;
      below = here;
    }
    right = clearer(here_alone(right, near_inside(-1, 0)), left1, right1);
    below = clearer(here_alone(below, near_inside(0, -1)), above1, below1);
  }
  store_outline_right_settled(right);
  store_outline_below_settled(below);
}
