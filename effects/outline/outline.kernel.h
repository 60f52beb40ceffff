// Lines drawn over the lit picture, in mode `robust`. A steep line is known by where it passes each row, a flat one by
// where it passes each column, and by its direction there. So a pixel looks along its own row and column, both ways,
// and its cover is that of the piece that covers it most: how far its centre lies inside the line's width, counted from
// half a pixel outside, so that edges are antialiased. A line lies on the nearer surface: it reaches its whole width to
// that side, and half a pixel's antialiasing to the other. A pixel does not look beyond the end of a surface, so that a
// line never reaches around a corner onto what lies behind. Where lines end they are round, so that corners close.
IN_REAL(depth)
IN_VECTOR(normal)
IN_REAL(object_id)
IN_REAL(outline_steep_pen)
IN_REAL(outline_flat_pen)
IN_REAL(outline_join_pen)
IN_REAL(outline_around)
IN_REAL(outline_near)
INOUT_COLOR(lit)
OUT_REAL(outline)
#include "effects/outline/outline_piece.kernel.h"
#include "effects/outline/outline_stroke.kernel.h"

CONST float kLeastFacing = 0.01f;  // as in outline_find
CONST float kFar = 1e4f;           // pixels: no line
CONST float kRim = 0.8f;           // of the side: a rim's line lies wholly on one
CONST float kMostShare = 0.35f;    // of what is thin that a line on either side may cover
CONST float kBegins = 0.5f;        // pixels between two lines from which on they are narrower
CONST float kFading = 3.0f;        // a line less sure than a third fades, too
CONST float kSideEnds = 0.4f;      // a surface ends at a crossing that lies more than this on one side

// Whether a piece's line lies so much on one side; one of a crease that leans to it ends no surface.
FN Bool lies_on_one(Real v, float most) { return abs(side_of(v)) > most && !leans(v); }

FN Real unit_clamp(Real v) { return clamp(v, Real(0.0f), Real(1.0f)); }

// The cosine of a line's lean.
FN Real cosine_of(Real slope) { return rsqrt(mad(slope, slope, Real(1.0f))); }

// How dark a line is drawn that is so sure.
FN Real darkness_of(Real sure) { return unit_clamp(sure * kFading) * min(sure * C.width_px, Real(1.0f)); }

// A piece of line as a pixel meets it whose row (column) it crosses i pixels on: how far inside the line's width the
// pixel's centre lies, counted from half a pixel outside, from its side on the nearer surface and from the other; and
// how far it is from the crossing, above 0 on the nearer surface.
FN Vec3 met(Real v, int i) {
  Real width = drawn_width(linked_of(v), C.width_px);
  Real side = side_of(v);
  Real off = (place_of(v) + Real(float(i))) * cosine_of(slope_of(v));
  off = select(side < 0.0f, -off, off);
  Real wide = mad(abs(side), width * 0.5f, width * 0.5f + 0.5f);  // onto the nearer side
  Real narrow = width + 1.0f - wide;                              // onto the other
  return Vec3(wide - off, narrow + off, off);
}

// What the lines that this pixel sees in one of four directions, along its row (lying 0) or column (1), backward
// (towards -1) or forward (1), cover of it, 1 and more for all; below 0 by how many pixels they just do not.
FN Real seen_cover(int lying, int towards, int sight) {
  Real covered = Real(-1.0f);
  Real open = Real(1.0f);
  for (int k = 0; k < sight; ++k) {
    int i = towards < 0 ? -1 - k : k;
    Real v = abs(lying == 0 ? near_outline_steep_pen(i, 0) : near_outline_flat_pen(0, i));
    Bool here = v > 0.0f;
    if (!some(here)) continue;
    Vec3 line = met(v, i);
    Real inside = min(line.x, line.y);
    Real cover = select(inside > 0.0f, inside * darkness_of(linked_of(v)), inside);
    Bool drawn = here && linked_of(v) > 0.0f;
    covered = select(drawn && open > 0.0f, max(covered, cover), covered);
    open = select(here && lies_on_one(v, kSideEnds), Real(0.0f), open);
  }
  return covered;
}

// The same for pixels between two lines: also how far the first line is, if it is the rim of the surface that the pixel
// is on, and that one's slope. There the cover is that of the line alone, not antialiased at the rim.
FN Vec3 seen(int lying, int towards, int sight) {
  Real covered = Real(0.0f);
  Real distance = Real(kFar);
  Real lean = Real(0.0f);
  Real open = Real(1.0f);
  for (int k = 0; k < sight; ++k) {
    int i = towards < 0 ? -1 - k : k;
    Real v = abs(lying == 0 ? near_outline_steep_pen(i, 0) : near_outline_flat_pen(0, i));
    Bool here = v > 0.0f;
    if (!some(here)) continue;
    Vec3 line = met(v, i);
    Real sure = linked_of(v);
    Bool rim = lies_on_one(v, kRim) && line.z > 0.0f;
    Real cover = select(rim, line.x, min(line.x, line.y)) * darkness_of(sure);
    covered = max(covered, cover * open);
    Bool first = sure > 0.0f && distance == Real(kFar);
    lean = select(first, slope_of(v), lean);
    distance = select(first, select(rim, line.z, Real(kFar + 1.0f)), distance);
    open = select(here && lies_on_one(v, kSideEnds), Real(0.0f), open);
  }
  return Vec3(covered, distance, lean);
}

// By how much the lines on both sides of a thin thing, if they run alongside, are to be narrower there, so that its
// colour shows.
FN Real too_wide(Vec3 backward, Vec3 forward) {
  Real thickness = backward.y + forward.y;
  if (!some(thickness < kFar)) return Real(0.0f);
  Real alongside = unit_clamp(Real(1.5f) - abs(backward.z - forward.z) * 5.0f);
  Real reach = max(backward.x + backward.y, forward.x + forward.y) - 0.5f;  // of a line onto this side
  return select(thickness < kFar, alongside * max(mad(thickness, Real(-kMostShare), reach), Real(0.0f)), Real(0.0f));
}

// What lines in a direction cover, less `spare`; at the rim itself, antialiased.
FN Real cover_of(Vec3 direction, Real spare) {
  Real covered = direction.x - spare;
  return select(direction.y < kFar, min(covered, direction.y + 0.5f), covered);
}

// What the round end of a line covers. (across, along): where the crossing's first pixel lies, from this one, across
// the line's main direction and along it. v: the piece. depth1, depth2: of the two pixels that it lies between;
// object1, object2: theirs. predicted: this pixel's plane's nearness at the crossing. A line does not reach onto
// another object, also where that touches its own and so lies hardly behind.
FN Real end_cover(Real v, Real across, Real along, Real depth1, Real depth2, Real object1, Real object2,
                  Real predicted) {
  Real side = side_of(v);
  across = across + place_of(v);
  Real slope = slope_of(v);
  Real shrink = cosine_of(slope);
  Real sure = linked_of(v);
  Real width = drawn_width(sure, C.width_px);
  // The sign is the numerator's, which rounds alike on every machine: the two sides of a line are not alike.
  Real off = mad(-along, slope, across) * shrink;       // towards the first pixel's side
  Real past = abs(mad(across, slope, along)) * shrink;  // along the line
  past = max(past - Real(0.5f) / max(shrink, Real(0.1f)), Real(0.0f));
  off = select(side < 0.0f, -off, off);
  Real nearer = select(side < 0.0f, depth2, depth1);
  Bool other = !(near_object_id(0, 0) == select(side < 0.0f, object2, object1)) && Int(C.objects) > Int(0);
  side = abs(side);
  Real distance = sqrt(mad(off, off, past * past));
  Real wide = mad(side, width * 0.5f, width * 0.5f);  // onto the nearer side
  Real narrow = width - wide;                         // onto the other
  Real allowed = Real(C.depth * F.ray_scale_x) * (abs(across) + abs(along) + 1.0f);
  Bool behind = predicted < -nearer - allowed;
  if (F.orthographic == 0) behind = predicted * nearer < Real(1.0f) - allowed;
  Real inner = min(unit_clamp(wide + 0.5f - distance), unit_clamp(off + narrow + 0.5f));
  Real outer = unit_clamp(narrow + 0.5f - distance);
  Real cover = select(off > 0.0f, inner, outer) * darkness_of(sure);
  return select((behind || other) && (off > 0.0f || !lies_on_one(v, kSideEnds)), Real(0.0f), cover);
}

// This pixel's nearness, and how it changes by one pixel to the right and down on its own plane.
FN Vec3 nearness(Int px, Int py) {
  Real depth = near_depth(0, 0);
  Bool surface = is_surface(depth);
  depth = select(surface, max(depth, Real(1e-30f)), Real(1.0f));
  Vec3 n = near_normal(0, 0);
  Real near = -depth;
  Real facing = max(n.z, Real(kLeastFacing));
  if (F.orthographic == 0) {
    near = Real(1.0f) / depth;
    facing = max(-dot(n, view_position(px, py, depth)), depth * kLeastFacing);
  }
  Real per_facing = Real(-1.0f) / facing;
  Real nowhere = F.orthographic != 0 ? Real(-1e30f) : Real(0.0f);
  return Vec3(select(surface, near, nowhere),
              select(surface, finite_or_zero(n.x * Real(F.ray_scale_x) * per_facing), Real(0.0f)),
              select(surface, finite_or_zero(n.y * Real(F.ray_scale_y) * per_facing), Real(0.0f)));
}

// What ends of lines in row j cover.
FN Real ends_cover(int j, Vec3 own) {
  Real covered = Real(0.0f);
  Real fj = Real(float(j));
  for (int i = -C.reach; i <= C.reach; ++i) {
    Real fi = Real(float(i));
    // What lies beyond the picture's border reads as its last column.
    Real v = -near_outline_steep_pen(i, j);
    if (some(v > 0.0f)) v = select(near_inside(i, j), v, Real(0.0f));
    if (some(v > 0.0f)) {
      Real predicted = own.x + mad(own.y, fi + place_of(v), own.z * fj);
      Real cover = end_cover(v, fi, fj, near_depth(i, j), near_depth(i + 1, j), near_object_id(i, j),
                             near_object_id(i + 1, j), predicted);
      covered = select(v > 0.0f, max(covered, cover), covered);
    }
    v = -near_outline_flat_pen(i, j);
    if (some(v > 0.0f)) v = select(near_inside(i, j), v, Real(0.0f));
    if (some(v > 0.0f)) {
      Real predicted = own.x + mad(own.z, fj + place_of(v), own.y * fi);
      Real cover = end_cover(v, fj, fi, near_depth(i, j), near_depth(i, j + 1), near_object_id(i, j),
                             near_object_id(i, j + 1), predicted);
      covered = select(v > 0.0f, max(covered, cover), covered);
    }
  }
  return covered;
}

// `covered`, or what ends of lines cover, less `spare`. ends: whether any are around.
FN Real ends_or(Real covered, Real spare, Bool ends, Int px, Int py) {
  if (!some(ends && covered < 1.0f)) return covered;
  Vec3 own = nearness(px, py);
  for (int j = -C.reach; j <= C.reach; ++j)
    if (some(near_outline_around(0, j) < 0.0f && covered < 1.0f)) covered = max(covered, ends_cover(j, own) - spare);
  return covered;
}

// How far two such covers are of both sides: lines that just do not reach each other begin to be narrower, as far as
// this pixel sees both.
FN Real of_both(Real a, Real b) {
  return select(max(a, b) > 0.0f, unit_clamp(mad(min(a, b), Real(1.0f / kBegins), Real(1.0f))), Real(0.0f));
}

// The cover of pixels that have lines on both sides, along their row and their column so far; of others it is
// `covered`.
FN Real between_lines(Real covered, Real across, Real along, Bool ends, Int px, Int py, int sight) {
  Vec3 left = seen(0, -1, sight);
  Vec3 right = seen(0, 1, sight);
  Vec3 up = seen(1, -1, sight);
  Vec3 down = seen(1, 1, sight);
  Bool between = max(across, along) > 0.0f;
  Real spare = max(too_wide(left, right) * across, too_wide(up, down) * along);
  Real less = max(max(cover_of(left, spare), cover_of(right, spare)), max(cover_of(up, spare), cover_of(down, spare)));
  return ends_or(unit_clamp(select(between, less, covered)), spare, ends, px, py);
}

// What the strokes cover that join ends of lines in row j, near a column, to others: all, or those that may be far.
// Those between two ends are drawn from both, lest one be too far.
FN Real joins_cover(int middle, int j, bool far) {
  Real covered = Real(0.0f);
  for (int i = middle - C.gather; i <= middle + C.gather; ++i) {
    Real join = near_outline_join_pen(i, j);
    Bool here = far ? has_far_join(bits_of(join)) : has_join(bits_of(join));
    if (some(here)) here = here && near_inside(i, j);
    if (!some(here)) continue;
    Bool steep = joined_steep(join);
    Real piece = select(steep, near_outline_steep_pen(i, j), near_outline_flat_pen(i, j));
    Vec2 from = middle_of(piece, steep, C.width_px) + Vec2(Real(float(i)), Real(float(j)));
    Vec2 apart = joined_apart(join);
    Real share = unit_clamp(-dot(from, apart) / max(dot(apart, apart), Real(1e-6f)));
    Real sure = mad(joined_sure(join) - linked_of(piece), share, linked_of(piece));
    Vec2 off = from + apart * share;
    Real cover = unit_clamp(mad(drawn_width(sure, C.width_px), Real(0.5f), Real(0.5f)) - sqrt(dot(off, off)));
    covered = select(here, max(covered, cover * darkness_of(sure)), covered);
  }
  return covered;
}

// `covered`, or what joins of lines cover. near, far: the bits of what is around, and of what is farther off.
FN Real joins_or(Real covered, Uint near, Uint far) {
  if (some(has_join(near) && covered < 1.0f))
    for (int j = -C.gather; j <= C.gather; ++j)
      if (some(has_join(bits_of(near_outline_around(0, j))) && covered < 1.0f))
        covered = max(covered, joins_cover(0, j, false));
  if (some(has_far_join(far) && covered < 1.0f))
    for (int j = -C.around; j <= C.around; ++j)
      for (int i = -C.apart; i <= C.apart; i += C.apart)
        if (some(has_far_join(bits_of(near_outline_around(i, j))) && covered < 1.0f))
          covered = max(covered, joins_cover(i, j, true));
  return covered;
}

// What lines cover of a pixel with such bits around.
FN Real lines_cover(Uint any, Int px, Int py, int sight) {
  Bool ends = to_signed(any) < Int(0);
  Real left = Real(-1.0f);
  Real right = Real(-1.0f);
  if (some(has_line(bits_of(near_outline_around(0, 0))))) {
    left = seen_cover(0, -1, sight);
    right = seen_cover(0, 1, sight);
  }
  Real up = seen_cover(1, -1, sight);
  Real down = seen_cover(1, 1, sight);
  Real covered = max(max(max(left, right), max(up, down)), Real(0.0f));
  Real across = of_both(left, right);
  Real along = of_both(up, down);
  if (!some(max(across, along) > 0.0f)) return ends_or(unit_clamp(covered), Real(0.0f), ends, px, py);
  return between_lines(covered, across, along, ends, px, py, sight);
}

FN Real robust_cover(Int px, Int py, int sight) {
  // Nine squares without a gap between them are all that is around.
  Uint near = bits_of(near_outline_near(0, 0));
  Uint far = near;
  for (int j = -C.apart; j <= C.apart; j += C.apart)
    far = far | bits_of(near_outline_near(-C.apart, j)) | bits_of(near_outline_near(0, j)) |
          bits_of(near_outline_near(C.apart, j));
  Real covered = Real(0.0f);
  if (some(has_line(near))) {
    Uint any = Uint(0u);
    for (int j = -sight; j <= sight; ++j) any = any | bits_of(near_outline_around(0, j));
    if (some(has_line(any))) covered = lines_cover(any, px, py, sight);
  }
  return joins_or(covered, near, far);
}

FN void outline_pixel(Int px, Int py) {
  Real covered =
      C.sight == kOutlineUsualSight ? robust_cover(px, py, kOutlineUsualSight) : robust_cover(px, py, C.sight);
  covered = covered * C.opacity;
  store_outline(covered);
  Vec3 line = Vec3(Real(C.r), Real(C.g), Real(C.b));
  Bool surface = is_surface(near_depth(0, 0));
  Vec3 lit = own_lit();
  // Where there is nothing to change nothing is written.
  Bool fine = surface && is_finite(lit.x + lit.y + lit.z) && !(covered > 0.0f);
  if (!some(!fine)) return;
  lit = finite_or_zero(lit);
  lit = select(covered > 0.0f, mixed_for_the_eye(lit, line, covered), lit);
  store_lit(select(surface, lit, line * covered));  // `output` mixes the rest
}
