// Crossings moved to the pixels that they lie between. outline_find finds a crease where normals turn most, and then
// where its planes meet, which may lie beyond either of the two pixels: rows of one line would then be told by columns
// that are two apart, and no longer be taken for one line.
//
// Planes of crossings as outline_crossing.kernel.h has them; t is in [0, 1) now, but at the picture's border, where
// there is no pixel to move to. Of two crossings at one place the clearer one stays; a faint crease beside a clear
// crossing is but that one's shadow, and one beside a clear rim, on its nearer side, is covered by that one's line. In
// high pictures one crease may be found by several pixels of a stride, which place it up to two pixels apart: one
// stays, at the mean of these, or else its line would be drawn double, or its halves be taken to stand for each other.
IN_REAL(outline_right)
IN_REAL(outline_below)
OUT_REAL(outline_right_settled)
OUT_REAL(outline_below_settled)
#include "effects/outline/outline_crossing.kernel.h"

CONST float kPixel = 0.5f;   // of t in its code
CONST float kFirst = 0.25f;  // code of t = 0
CONST float kRim = 32.0f;    // of a code, from the middle, half-way to one side: more is a rim
CONST float kNoPlace = 2.0f;
CONST float kLeastPlace = -0.5f;  // of what its code has
CONST float kMostPlace = 1.49f;
CONST float kOneCrease = 1.5f;  // pixels between two places of one crease

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

// What adds to the mean of the places of one crease: that of one so many pixels on, and 1, if it is near enough.
FN Vec2 share_of(Real place, Real other, float pixels) {
  Real there = crease_place(other) + pixels;
  Bool near = other > 0.0f && there < kNoPlace + pixels && abs(there - place) < kOneCrease;
  return Vec2(select(near, there, Real(0.0f)), select(near, Real(1.0f), Real(0.0f)));
}

// A clear crease at the mean of the places where it is found by pixels up to two beside.
FN Real evened(Real before2, Real before, Real v, Real after, Real after2) {
  Real place = crease_place(v);
  Vec2 sum = Vec2(place, Real(1.0f)) + share_of(place, before2, -2.0f) + share_of(place, before, -1.0f) +
             share_of(place, after, 1.0f) + share_of(place, after2, 2.0f);
  Real mean = clamp(sum.x / sum.y, Real(kLeastPlace), Real(kMostPlace));
  return select(v > 0.0f && place < kNoPlace, mad(mean - place, Real(kPixel), v), v);
}

// v, or nothing if it is a clear crease and one beside it, `before` or `after`, knows its place better: one that places
// it in its own pixel and is clearer, or as clear and the first, or where v lies.
FN Real known_here(Real v, Real before, Real after) {
  Real place = crease_place(v);
  Real place_before = crease_place(before);
  Real place_after = crease_place(after);
  Bool by_before = place_before >= 0.0f && place_before < 1.0f && clear_of(before) >= clear_of(v);
  Bool by_after = place_after >= 0.0f && place_after < 1.0f && place < 1.0f;
  by_after = by_after && (clear_of(after) > clear_of(v) || (place < 0.0f && clear_of(after) == clear_of(v)));
  return select(v > 0.0f && place < kNoPlace && (by_before || by_after), Real(0.0f), v);
}

// Whether a crease goes on in the row (column) so many after this one, at most a pixel beside.
FN Bool crease_in(int lying, int row) {
  Bool found = Real(0.0f) > 1.0f;
  for (int k = -1; k <= 1; ++k) {
    Real v = lying == 0 ? near_outline_right(k, row) : near_outline_below(row, k);
    found = found || floor(code_of(v)) == Real(kMiddle);
  }
  return found;
}

// v, or nothing if it is of a crease that runs along beside a clear rim, `before` or `after`, on its nearer side.
FN Real apart_from_rims(int lying, Real v, Real before, Real after) {
  Bool covered = floor(code_of(v)) == Real(kMiddle) && ((before > 0.0f && code_of(before) < kMiddle - kRim) ||
                                                        (after > 0.0f && code_of(after) > kMiddle + kRim));
  if (some(covered)) covered = covered && crease_in(lying, -1) && crease_in(lying, 1);
  return select(covered, Real(0.0f), v);
}

// The crossings at the pixel so many after this one, of its row (lying 0) or column (1); 0 outside the picture.
FN Real crossing_at(int lying, int k) {
  Bool inside = lying == 0 ? near_inside(k, 0) : near_inside(0, k);
  return select(inside, lying == 0 ? near_outline_right(k, 0) : near_outline_below(0, k), Real(0.0f));
}

FN Real settled(int lying) {
  Real here = crossing_at(lying, 0);
  Real before = crossing_at(lying, -1);
  Real after = crossing_at(lying, 1);
  if (!some(!(to_signed(bits_of(here) | bits_of(before) | bits_of(after)) == Int(0)))) return here;
  if (C.stride > 1) {
    Real before4 = crossing_at(lying, -4);
    Real before3 = crossing_at(lying, -3);
    Real before2 = crossing_at(lying, -2);
    Real after2 = crossing_at(lying, 2);
    Real after3 = crossing_at(lying, 3);
    Real after4 = crossing_at(lying, 4);
    Real even_before2 = evened(before4, before3, before2, before, here);
    Real even_before = evened(before3, before2, before, here, after);
    Real even = evened(before2, before, here, after, after2);
    Real even_after = evened(before, here, after, after2, after3);
    Real even_after2 = evened(here, after, after2, after3, after4);
    before = known_here(even_before, even_before2, even);
    here = known_here(even, even_before, even_after);
    after = known_here(even_after, even, even_after2);
  }
  Bool inside = lying == 0 ? near_inside(-1, 0) : near_inside(0, -1);
  return apart_from_rims(lying, clearer(here_alone(here, inside), before, after), before, after);
}

FN void outline_settle_pixel(Int px, Int py) {
  store_outline_right_settled(settled(0));
  store_outline_below_settled(settled(1));
}
