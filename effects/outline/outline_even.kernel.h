// Pieces moved to where outline_fit found their line, into the pixels that they lie between there. Of several that come
// to one place one stays, as sure as the surest of them, and what goes on there in both neighbouring rows is no end.
//
// Planes: pieces of line as outline_piece.kernel.h has them.
IN_REAL(outline_steep_linked)
IN_REAL(outline_flat_linked)
IN_REAL(outline_steep_fit)
IN_REAL(outline_flat_fit)
OUT_REAL(outline_steep_even)
OUT_REAL(outline_flat_even)
#include "effects/outline/outline_piece.kernel.h"
#include "effects/outline/outline_shift.kernel.h"

CONST float kDouble = 1.3f;  // pixels between two lines that run side by side, up to which they are one
CONST float kGoesOn = 1.1f;  // pixels beside where the next is expected: more is another line

FN Real piece_from(int lying, int i, int row) {
  return lying == 0 ? near_outline_steep_linked(i, row) : near_outline_flat_linked(row, i);
}
FN Real fit_from(int lying, int i, int row) {
  return lying == 0 ? near_outline_steep_fit(i, row) : near_outline_flat_fit(row, i);
}
FN Bool inside_at(int lying, int i, int row) { return lying == 0 ? near_inside(i, row) : near_inside(row, i); }

// Whether a line goes on in a row (column) beside this one, near a place: as pieces are moved, or as they were.
FN Bool goes_on_in(int lying, int row, Bool asked, Real place, bool moved) {
  Bool found = asked && !asked;
  for (int i = -kOutlineComes - 2; i <= kOutlineComes + 2; ++i) {
    Real piece = piece_from(lying, i, row);
    Bool here = asked && is_piece(piece) && inside_at(lying, i, row);
    if (!some(here)) continue;
    Real there = place_of(piece);
    if (moved) {
      Real fit = fit_from(lying, i, row);
      there = select(is_fitted(fit), fit_place(fit), there);
    }
    there = there + Real(float(i));
    found = found || (here && abs(there - place) < kGoesOn);
  }
  return found;
}

FN Real evened(int lying) {
  Real own = piece_from(lying, 0, 0);
  Uint any = Uint(0u);
  for (int i = -kOutlineComes; i <= kOutlineComes; ++i) any = any | bits_of(fit_from(lying, i, 0));
  any = any | bits_of(fit_from(lying, 0, -1)) | bits_of(fit_from(lying, 0, 1)) | bits_of(fit_from(lying, -1, -1)) |
        bits_of(fit_from(lying, 1, -1)) | bits_of(fit_from(lying, -1, 1)) | bits_of(fit_from(lying, 1, 1));
  Bool moves = !(to_signed(any) == Int(0));
  if (!some(moves)) return own;
  Real found = select(is_piece(own) && is_fitted(fit_from(lying, 0, 0)), Real(0.0f), own);
  Real sure = select(is_piece(found), sure_of(found), Real(0.0f));
  Real was_place = place_of(found);  // of the one that stays, before
  Real was_slope = slope_of(found);
  Bool was_end = found < 0.0f;
  Real least = select(is_piece(found), Real(0.0f), Real(1e3f));  // how far the one that stays has come
  for (int i = -kOutlineComes; i <= kOutlineComes; ++i) {
    Real fit = fit_from(lying, i, 0);
    Bool here = moves && is_fitted(fit) && inside_at(lying, i, 0);
    if (!some(here)) continue;
    Real piece = piece_from(lying, i, 0);
    Real place = fit_place(fit) + Real(float(i));
    here = here && place >= 0.0f && place < 1.0f;
    Real far = abs(fit_place(fit) - place_of(piece));
    Bool better = here && far < least;
    sure = select(here, max(sure, sure_of(piece)), sure);
    Real moved = packed_piece(place, fit_slope(fit), level_of(piece), sure_of(piece));
    moved = select(leans(piece), leaning(moved), moved);
    found = select(better, moved, found);
    was_place = select(better, place_of(piece) + Real(float(i)), was_place);
    was_slope = select(better, slope_of(piece), was_slope);
    was_end = (better && piece < 0.0f) || (!better && was_end);
    least = select(better, far, least);
  }
  Bool on = moves && is_piece(found);
  if (!some(on)) return found;
  Real place = place_of(found);
  Real slope = slope_of(found);
  // Of flakes that still run side by side the one stays, row by row, that was moved less.
  Bool double_line = on && !on;
  for (int i = -kOutlineComes - 1; i <= kOutlineComes + 1; ++i) {
    Bool look = on && least > 0.0f && !double_line && inside_at(lying, i, 0);
    if (!some(look)) continue;
    Real piece = piece_from(lying, i, 0);
    look = look && is_piece(piece);
    if (!some(look)) continue;
    Real fit = fit_from(lying, i, 0);
    Real other = select(is_fitted(fit), fit_place(fit), place_of(piece));
    Real far = abs(other - place_of(piece));
    Real apart = other + Real(float(i)) - place;
    double_line = double_line || (look && abs(apart) < kDouble && (far < least || (far == least && apart < 0.0f)));
  }
  // What was no end is one now where it went on and does no more; what was one is none where it goes on to both sides.
  Bool before = goes_on_in(lying, -1, on, place - slope, true);
  Bool after = goes_on_in(lying, 1, on, place + slope, true);
  Bool parts = on && !was_end && !(before && after);
  if (some(parts)) {
    Bool left = goes_on_in(lying, -1, parts, was_place - was_slope, false) && !before;
    parts = parts && (left || (goes_on_in(lying, 1, parts, was_place + was_slope, false) && !after));
  }
  Bool ends = parts || (was_end && !(before && after));
  Real surest = packed_piece(place, slope, level_of(found), sure);
  surest = select(leans(found), leaning(surest), surest);
  surest = select(ends, -surest, surest);
  return select(on, select(double_line, Real(0.0f), surest), found);
}

FN void outline_even_pixel(Int px, Int py) {
  store_outline_steep_even(evened(0));
  store_outline_flat_even(evened(1));
}
