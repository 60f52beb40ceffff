// The one line that several flakes of it stand for. Where triangles of a scanned mesh hide each other, or a soft fold
// is a rim here and a crease there, a line is found in short strokes that overlap and lie a pixel or three aside from
// each other. An eye sees one line through them, a parabola near each piece: the one that all pieces of about the same
// way and the same side fit best, the nearer ones more. outline_even moves pieces to it.
//
// A piece is moved only where its own line ends near by and pieces of others are near, too, the more the nearer: a line
// that goes on stays where it was found.
//
// outline_steep_fit, outline_flat_fit: 0 for what stays, or as outline_shift.kernel.h has it.
IN_REAL(outline_steep_linked)
IN_REAL(outline_flat_linked)
IN_REAL(outline_steep_ends)
IN_REAL(outline_flat_ends)
OUT_REAL(outline_steep_fit)
OUT_REAL(outline_flat_fit)
FN Real steep_at(Int x, Int y) { return load_outline_steep_linked(x, y); }
FN Real flat_at(Int x, Int y) { return load_outline_flat_linked(x, y); }
#include "effects/outline/outline_end.kernel.h"
#include "effects/outline/outline_shift.kernel.h"

CONST float kFlakes = 1.0f;         // pixels beside a line up to which flakes of it lie: these,
CONST float kFlakesStride = 0.75f;  // so many more per pixel of stride and one,
CONST float kFlakesWidth = 1.0f;    // at most the line's width and this;
CONST float kFlakesAlong = 0.3f;    // and so many more per pixel along it, where it turns
CONST float kOwnWay = 1.0f;         // how much a piece's own slope counts beside its line's, in pixels
CONST float kOneWay = 0.82f;        // cosine between two ways, from which on they are of one line
CONST float kOneWayMore = 0.08f;    // wholly if it is so much more;
CONST float kOneSide = -0.3f;       // and of two sides
CONST float kOneSideMore = 0.3f;    // likewise
CONST float kStiff = 0.25f;         // how much a parabola is rather straight where pieces are on one side,
CONST float kStiffBoth = 0.02f;     // and where they are on both:
CONST float kUneven = 3.0f;         // the mean of their places, of 1 at the last row, is this part of 1
CONST float kLevel = 0.03f;         // and a line rather goes the piece's way
CONST float kOthers = 0.25f;        // share of the pieces around that are other lines', from which on a piece is moved
CONST float kMostLeft = 0.5f;       // of those pixels, in the mean, that pieces are left aside of what fits them
CONST float kOfRims = 0.25f;        // share of them that are of rims, likewise: edges that meet in a vertex are creases
CONST int kTimes = 2;               // times that it is fitted, from where it passed the time before
CONST float kLeastFit = 0.02f;      // pixels: what is moved less stays

// Pixels beside a line up to which flakes of it lie.
FN float flakes_within() {
  float most = kFlakes + kFlakesStride * float(C.stride + 1);
  return most < C.width_px + kFlakesWidth ? most : C.width_px + kFlakesWidth;
}

// The sums of a weighted fit of e = a + b s + c s^2.
struct Sums {
  Real w, s, s2, s3, s4, e, es, es2, e2;
};

FN Sums summed(Sums sums, Real w, Real s, Real e) {
  Real ws = w * s;
  Real ws2 = ws * s;
  return Sums(sums.w + w, sums.s + ws, sums.s2 + ws2, mad(ws2, s, sums.s3), mad(ws2 * s, s, sums.s4), mad(w, e, sums.e),
              mad(ws, e, sums.es), mad(ws2, e, sums.es2), mad(w * e, e, sums.e2));
}

// How near a piece is to where its line ends, as a share of how much it counts.
FN Real share_of(Real ends) { return min(ends + ends, Real(1.0f)); }

FN Real fitted(Int px, Int py, Real piece, Real ends, int lying) {
  int around = fit_rows();
  Bool asked = ends > 0.0f;
  if (!some(asked)) return Real(0.0f);
  Bool steep = steep_of(lying);
  Vec2 at = middle_of(piece, steep, 0.0f);
  Vec2 way = lean_of(slope_of(piece), steep, Real(1.0f));
  Vec2 nearer = nearer_of(piece, steep);
  float far = fit_far();
  // Its own line, which is not to break where it begins to be moved.
  Real own = linked_of(piece) * share_of(ends);
  Real moved = share_of(ends);
  Vec2 goes = way * Real(kOwnWay);  // where that goes, the mean of its places
  for (int side = -1; side <= 1; side += 2) {
    Real towards = Real(float(side));
    Along last = Along(asked, place_of(piece), slope_of(piece), px, py, steep, piece, Real(kLeastSeen));
    for (int k = 1; k <= around; ++k) {
      if (!some(last.on)) continue;
      last = next_along(last, px, py, steep, Int(k * side), towards);
      Real near = Real(0.0f);
      if (some(last.on && last.steep)) near = select(last.steep, load_outline_steep_ends(last.x, last.y), near);
      if (some(last.on && !last.steep)) near = select(last.steep, near, load_outline_flat_ends(last.x, last.y));
      Vec2 apart = middle_at(last, px, py, 0.0f) - at;
      Real weight = counted(dot(way, apart)) * linked_of(last.piece) * share_of(near);
      own = own + select(last.on, weight, Real(0.0f));
      goes = chosen(last.on, goes + apart * (counted(Real(float(k))) * towards), goes);
      Bool stays = last.on && near == Real(0.0f);
      moved = select(stays, min(moved, Real(1.0f) - counted(Real(float(k)))), moved);
    }
  }
  way = goes * (Real(1.0f) / sqrt(max(dot(goes, goes), Real(1e-6f))));
  Real most = Real(flakes_within());
  Real zero = Real(0.0f);
  Vec2 through = at;
  Real others = zero;
  for (int round = 0; round < kTimes; ++round) {
    if (!some(asked)) continue;
    Real rims = zero;
    Sums sums = Sums(zero, zero, zero, zero, zero, zero, zero, zero, zero);
    for (int j = -around; j <= around; ++j)
      for (int i = -around; i <= around; ++i)
        for (int other = 0; other < 2; ++other) {
          Real near_end = other == 0 ? near_outline_steep_ends(i, j) : near_outline_flat_ends(i, j);
          Bool here = asked && near_end > 0.0f && near_inside(i, j);
          if (!some(here)) continue;
          Real there = other == 0 ? near_outline_steep_linked(i, j) : near_outline_flat_linked(i, j);
          Vec2 apart = apart_from(through, there, other, Int(i), Int(j), 0.0f);
          Real along = dot(way, apart);
          Real off = cross(way, apart);
          Vec2 lean = lean_of(slope_of(there), steep_of(other), Real(1.0f));
          Real like = (abs(dot(lean, way)) - kOneWay) * Real(1.0f / kOneWayMore);
          Real near = mad(abs(along), Real(kFlakesAlong), most) - abs(off);
          Real sided = (dot(nearer_of(there, steep_of(other)), nearer) - kOneSide) * Real(1.0f / kOneSideMore);
          Real share = clamp(like, zero, Real(1.0f)) * clamp(near, zero, Real(1.0f)) * clamp(sided, zero, Real(1.0f));
          Real weight = select(here, counted(along) * linked_of(there) * share_of(near_end) * share, zero);
          rims = select(is_crease(there), rims, rims + weight);
          sums = summed(sums, weight, along * Real(1.0f / far), off);
        }
    // The parabola, by Cramer's rule.
    Real w = sums.w;
    Real s2 = mad(w, Real(kLevel), sums.s2);
    Real uneven = sums.s / max(w, Real(1e-6f)) * Real(kUneven);
    Real s4 = mad(w, mad(Real(kStiff), min(uneven * uneven, Real(1.0f)), Real(kStiffBoth)), sums.s4);
    Real a11 = s2 * s4 - sums.s3 * sums.s3;
    Real a12 = sums.s2 * sums.s3 - sums.s * s4;
    Real a13 = sums.s * sums.s3 - s2 * sums.s2;
    Real whole = w * a11 + sums.s * a12 + sums.s2 * a13;
    Real a22 = w * s4 - sums.s2 * sums.s2;
    Real a23 = sums.s * sums.s2 - w * sums.s3;
    Real scale = Real(1.0f) / max(whole, Real(1e-9f));
    Real off = (sums.e * a11 + sums.es * a12 + sums.es2 * a13) * scale;
    Real lean = (sums.e * a12 + sums.es * a22 + sums.es2 * a23) * scale;
    Real bend = (sums.e * a13 + sums.es * a23 + sums.es2 * (w * s2 - sums.s * sums.s)) * scale;
    Real left = max(sums.e2 - off * sums.e - lean * sums.es - bend * sums.es2, zero) / max(w, Real(1e-6f));
    lean = lean * Real(1.0f / far);
    asked = asked && whole > 1e-9f && abs(off) < kMostFit;
    if (round == 0) {
      Real all = Real(1.0f) / max(w, Real(1e-6f));
      others = clamp((w - own) * all * Real(1.0f / kOthers), zero, Real(1.0f));
      others = others * clamp((Real(kMostLeft * kMostLeft) * most * most - left) *
                                  (Real(2.0f / (kMostLeft * kMostLeft)) / (most * most)),
                              zero, Real(1.0f));
      others = others * clamp(rims * all * Real(1.0f / kOfRims), zero, Real(1.0f));
    }
    Vec2 aside = Vec2(-way.y, way.x);
    through = chosen(asked, through + aside * off, through);
    Vec2 turned = way + aside * lean;
    way = chosen(asked, turned * (Real(1.0f) / sqrt(dot(turned, turned))), way);
  }
  // Where that crosses the piece's own row.
  Real across = select(steep, through.x - at.x, through.y - at.y);
  Real ahead = select(steep, through.y - at.y, through.x - at.x);
  Real down = select(steep, way.y, way.x);
  asked = asked && abs(down) > 0.5f;
  Real turned = select(steep, way.x, way.y) / select(asked, down, Real(1.0f));
  Real share = moved * others;
  Real aside = (across - ahead * turned) * share;
  asked = asked && abs(aside) > kLeastFit && abs(aside) < kMostFit;
  turned = mad(turned - slope_of(piece), share, slope_of(piece));
  turned = clamp(turned, Real(-kSteepest), Real(kSteepest));
  return select(asked, packed_fit(place_of(piece) + aside, turned), zero);
}

FN void outline_fit_pixel(Int px, Int py) {
  Real steep = near_outline_steep_ends(0, 0);
  Real lower = near_outline_flat_ends(0, 0);
  Real steep_fit = Real(0.0f);
  Real flat_fit = Real(0.0f);
  if (some(steep > 0.0f)) steep_fit = fitted(px, py, near_outline_steep_linked(0, 0), steep, 0);
  if (some(lower > 0.0f)) flat_fit = fitted(px, py, near_outline_flat_linked(0, 0), lower, 1);
  store_outline_steep_fit(steep_fit);
  store_outline_flat_fit(flat_fit);
}
