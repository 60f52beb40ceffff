// Where lines run: for each pixel, whether an edge passes between it and its right and its lower neighbour, exactly
// where, and on whose side the line lies.
//
// All tests compare planes. The nearness c of a surface (1/z in perspective, -z in orthographic views) is affine in the
// picture for any plane, so a plane seen at however low an angle predicts its neighbours exactly and is no edge. An
// edge is
//   a jump    the nearer pixel lies in front of what the farther side predicts, and the farther one behind what the
//             nearer side predicts, by more than `depth` pixel sizes. A side predicts with the milder of its last two
//             pixels' planes, since the last one before a rim is so steep that it explains anything, and with the
//             measured slope, since interpolated normals of coarse meshes are not their surface's
//             A jump that falls on two pixels, one of them halfway down, is told by both steps. Of two with a steep
//             side of a few pixels between them the nearer one is clear, if it is the larger, and the other one faint
//             Of a slit of one pixel between two surfaces that just touch the nearer rim alone is clear
//   a crease  normals that turn by the crease angle within five steps, most strongly here, and hardly before and after:
//             a sharp edge or a bevelled one; noise, roughness and round things are none. In high pictures the same
//             within five strides, so that what is an edge is one at any resolution; wider bevels between flat sides
//             lie where the normal is halfway between theirs. A soft one with a rim near on either side is the round
//             front of a bar. Of the two edges of a fold, with a steep side of a few pixels between them, the nearer
//             one is clear and the one at its foot faint
//   an id     another object or material
// A crease lies where its two planes meet, to a fraction of a pixel; a jump lies halfway until outline_refine.
// Most pixels have no edge: each kind asks first for what it cannot be without.
//
// The planes hold crossings as outline_crossing.kernel.h has them. How clear a line is in the mean decides later.
IN_REAL(depth)
IN_VECTOR(normal)
IN_REAL(object_id)
IN_REAL(material_id)
OUT_REAL(outline_right)
OUT_REAL(outline_below)
#include "effects/outline/outline_crossing.kernel.h"

CONST float kLeastSide = 2.0f / 32.0f;  // of what is no crease
CONST float kDeep = 2.0f;               // a jump within one object is clear from so many times `depth` on
CONST float kDeeper = 3.0f;             // times a jump, of the next one, that it is part of
CONST float kLarger = 1.1f;             // times a jump, of one that is not as large but for rounding
CONST float kStandsOut = 2.0f;          // times the steps beside it, of a jump that stands for a smaller one
CONST float kSure = 0.9f;               // share of a threshold that tells without rounding that it is not reached
CONST float kLeastFacing = 0.01f;       // cosine to the eye below which a plane's slope is not trusted further
CONST float kNoSlope = 1e30f;           // of normals that do not face the eye, which interpolation makes at rims
CONST float kMostSteepening = 4.0f;     // of a slope from one step to the next: 2.4 on a ball's last pixel
CONST float kFirstStep = 0.3f;          // share of a jump in two steps, from which on it is at the first
CONST float kLeastRamp = 2.0f;          // of such a jump, times `depth`
CONST float kPlainRamp = 2.25f;         // and in high pictures where normals do not turn, there as clear as one of
CONST float kPlainGrows = 2.0f;         // `depth` in one step, and so many times as fast clearer
CONST float kSteepest = 10.0f;          // depth, in pixel sizes, of a step on a surface that still tells its shape

// How clear a jump is at most at the foot of a side that has no room for two lines: outline_link does not draw a line
// that is no clearer anywhere.
CONST float kAtFoot = 3.0f / kClearest;

// Squared shares of the turn of normals: from which share of the crease angle on a crease is faint; what the steps
// three off may turn (round things have 1/5: 0.04), and those beside a sharp edge.
CONST float kBend = 0.1f;  // beside a jump in two steps
CONST float kFaintTurn = 0.5f;
CONST float kSteady = 0.026f;
CONST float kTurnRange = 0.4f;  // share of the threshold within which a crease becomes clear
CONST float kSharp = 0.1f;
CONST float kMostStep = 0.35f;   // of a wide bevel's turn, in one step: or else it is several edges
CONST float kTie = 1.001f;       // what is as strong as its neighbours is a peak, lest rounding choose;
CONST float kAsStrong = 1.03f;   // and where strides are longer than a pixel, what is nearly so
CONST float kBevel = 0.25f;      // of the turn within five steps, what lies beyond, up to which a bevel is an edge
CONST float kRound = 0.6f;       // and from which on it is a round thing, which has 0.8
CONST float kNarrow = 0.3f;      // how clear a soft crease beside a rim is at most: not enough where all of it is
CONST float kHidden = 0.45f;     // and one of which another object hides a part: outline_refine tells them apart
CONST float kTurnsAway = 1.5f;   // squared, from a side's normal to where it has ended: 75 degrees
CONST float kSoftClear = 0.9f;   // how clear a soft crease is at most in high pictures, where outline_refine asks more
CONST float kInPlace = 0.8f;     // and at least, to be drawn there, where another object hides a part of its bevel
CONST float kTooWide = 0.8f;     // of a wide bevel's turn, squared, at most within five strides
CONST float kStraying = 0.03f;   // and how far its normals may be, squared, from the way between its sides'
CONST float kFlatSides = 0.02f;  // of a wide bevel's turn, what its two sides turn, up to which it is clear,
CONST float kBentSides = 0.06f;  // and from which on it is none
CONST float kSeenFlat = 0.06f;  // how far the unit normals turn of the side that is seen where the other one is hidden,
CONST float kWider = 0.1f;      // and of the crease's squared chord, how far such a bevel turns beyond a narrow one
CONST float kLast = 16.0f;      // squared, times a side's last step, for what it turns beyond
CONST int kRoom = 2;            // strides, and so many pixels: how wide a fold's side is that has no room for two lines
CONST int kFootRoom = 2;        // pixels more, within which the crease at its foot is less clear the nearer it is
CONST float kTopFades = 0.5f;   // per pixel less than kRoom that the side is wide: how clear its top is
CONST float kFootFades = 0.33f;  // per pixel less than both, how faint its foot: all of it where the top begins to fade
CONST int kAtTop = 2;            // pixels from its top, within which a jump and the crease there are one
CONST float kTurnsOver = 2.0f;   // times the crease's squared chord, how far normals turn at a top that has a line
CONST int kTurnWithin = 2;       // pixels to either side of it, seen from the foot
CONST float kLeastSteep = 2.0f;  // pixel sizes per pixel, of such a side
CONST float kLevelOff = 1.0f / 3.0f;  // of its slope, at its end,
CONST float kSetsOut = 0.25f;         // and at least at its beginning
CONST float kMostOfIt = 0.7f;         // of its depth, in one step: or else that is a rim
// What a turn that takes five steps counts: 45 degrees as 30.
CONST float kSoft = 0.45f;
// Weights of a step's turn and of those one and two steps off. Two like steps up to four apart are one peak in their
// middle, farther ones are two.
CONST float kWeight0 = 9.0f;
CONST float kWeight1 = 8.5f;
CONST float kWeight2 = 7.0f;

FN Real square(Vec3 v) { return dot(v, v); }

// Nearness of a pixel, and how it changes by one pixel to the right (`rightwards` 1) or down (0) on its own plane.
FN Vec2 nearness(Int px, Int py, int i, int j, int rightwards) {
  Real depth = near_depth(i, j);
  Bool surface = is_surface(depth);
  depth = select(surface, max(depth, Real(1e-30f)), Real(1.0f));
  Vec3 n = near_normal(i, j);
  Real lean = rightwards != 0 ? n.x * Real(F.ray_scale_x) : n.y * Real(F.ray_scale_y);
  Real near = -depth;
  Real facing = finite_or_zero(n.z);
  if (F.orthographic == 0) facing = finite_or_zero(-dot(n, view_position(px + Int(i), py + Int(j), Real(1.0f))));
  Bool away = facing < kLeastFacing;
  facing = max(facing, Real(kLeastFacing));
  Real slope = -lean;
  if (F.orthographic == 0) {
    // One division for both.
    Real both = Real(1.0f) / (depth * facing);
    near = facing * both;
    slope = slope * both;
  }
  if (F.orthographic != 0) slope = slope / facing;
  slope = select(away, Real(kNoSlope), finite_or_zero(slope));
  Real nowhere = F.orthographic != 0 ? Real(-1e30f) : Real(0.0f);
  return Vec2(select(surface, near, nowhere), select(surface, slope, Real(0.0f)));
}

// The nearness alone, of a pixel that shows a surface.
FN Real nearness_of(int i, int j) {
  Real depth = near_depth(i, j);
  return F.orthographic != 0 ? Real(0.0f) - depth : Real(1.0f) / max(depth, Real(1e-30f));
}

FN Bool same_object(int i, int j, int k, int l) {
  return near_object_id(i, j) == near_object_id(k, l) && is_surface(near_depth(i, j)) && is_surface(near_depth(k, l));
}

// By how much one surface may lie behind another so many pixels beside that is at `depth`, and be near it.
FN Real near_behind(Real depth, int pixels) {
  Real bound = Real(F.ray_scale_x * kSteepest * float(pixels));
  return F.orthographic != 0 ? bound : bound * depth;
}

// Whether a surface goes on from pixel (i, j) to (k, l), so many pixels on: not to another object, and not far behind.
FN Bool goes_on(int i, int j, int k, int l, int pixels) {
  Real depth1 = near_depth(i, j);
  Real depth2 = near_depth(k, l);
  return abs(depth1 - depth2) < near_behind(min(depth1, depth2), pixels) &&
         near_object_id(i, j) == near_object_id(k, l);
}

// How much normals turn about the step from n2 to n3, squared: the weighted sum of the turns of five steps.
FN Real smooth_turn(Vec3 n0, Vec3 n1, Vec3 n2, Vec3 n3, Vec3 n4, Vec3 n5) {
  return square((n5 - n0) * Real(kWeight2) + (n4 - n1) * Real(kWeight1 - kWeight2) +
                (n3 - n2) * Real(kWeight0 - kWeight1));
}

FN Real milder(Real a, Real b) { return select(abs(a) < abs(b), a, b); }

// The slope with which a side predicts the other: the milder of the planes of its last pixel and, if `known`, of the
// one before, but not many times steeper than the surface is between them.
FN Real predicted_slope(Bool known, Vec2 last, Vec2 before, Real measured, Real pixel) {
  Real most = mad(abs(measured), Real(kMostSteepening), pixel);
  Real both = clamp(milder(before.y, last.y), -most, most);
  return select(known, both, select(last.y < kNoSlope, last.y, Real(0.0f)));
}

// What a step of nearness is beyond what either side predicts; below 0 for a step upwards.
FN Real agreed_gap(Real step, Real of_pixel, Real of_neighbour) {
  Real gap = select(step < 0.0f, max(min(-of_pixel, -of_neighbour), Real(0.0f)), Real(0.0f));
  return select(step > 0.0f, -max(min(of_pixel, of_neighbour), Real(0.0f)), gap);
}

// How large a jump in two steps counts. Where normals do not turn a smooth thing's mesh has a flaw; in high pictures
// such a jump counts in part, and for no more than the two fall: between two jumps a strip that is level does not.
FN Real counted_ramp(Real ramp, Bool turns, Real down, Real pixel) {
  if (C.stride == 1) return select(turns, ramp, Real(0.0f));
  Real one = pixel * C.depth;
  Real part = mad(min(abs(ramp), abs(down)), Real(kPlainGrows), one * Real(1.0f - kPlainRamp * kPlainGrows));
  part = min(max(part, Real(0.0f)), abs(ramp));
  return select(turns, ramp, select(ramp < 0.0f, -part, part));
}

// How far, in pixel sizes, this pixel lies in front of its neighbour (i, j), the right or the lower one; below 0 if the
// neighbour is in front. 0 where one surface goes on.
FN Real jump_between(Int px, Int py, int i, int j) {
  Vec2 plane0 = nearness(px, py, -i, -j, i);
  Vec2 plane1 = nearness(px, py, 0, 0, i);
  Vec2 plane2 = nearness(px, py, i, j, i);
  Vec2 plane3 = nearness(px, py, 2 * i, 2 * j, i);
  Bool before = same_object(0, 0, -i, -j) && near_inside(-i, -j);
  Bool after = same_object(i, j, 2 * i, 2 * j) && near_inside(2 * i, 2 * j);
  Real pixel = Real(F.ray_scale_x);
  if (F.orthographic == 0) pixel = pixel * min(plane1.x, plane2.x);
  // What each side says of the other: below 0 it lies behind.
  Real step = plane2.x - plane1.x;
  Real step0 = plane1.x - plane0.x;
  Real step2 = plane3.x - plane2.x;
  Real slope1 = predicted_slope(before, plane1, plane0, step0, pixel);
  Real slope2 = predicted_slope(after, plane2, plane3, step2, pixel);
  Real of_neighbour = step - slope1;
  of_neighbour = select(before, milder(of_neighbour, step - step0), of_neighbour);
  Real of_pixel = slope2 - step;
  of_pixel = select(after, milder(of_pixel, step2 - step), of_pixel);
  Real gap = agreed_gap(step, of_neighbour, -of_pixel);
  // A pixel in the middle of a jump, halfway down, parts it into two steps: it is at the first, unless that is small.
  // Normals turn there, or else it counts less.
  Real least = pixel * (C.depth * kLeastRamp);
  Vec3 n1 = near_normal(0, 0);
  Vec3 n2 = near_normal(i, j);
  Real turn = square(n2 - n1);
  Real faint = Real(C.crease_chord * kBend);
  Real down = step + step2;
  Real ramp = agreed_gap(down, down - select(before, step0, slope1) * 2.0f,
                         down - (nearness_of(3 * i, 3 * j) - plane3.x) * 2.0f);
  Bool two = after && step * step2 > 0.0f && abs(ramp) > least && same_object(2 * i, 2 * j, 3 * i, 3 * j) &&
             near_inside(3 * i, 3 * j);
  Bool turns = max(turn, square(near_normal(2 * i, 2 * j) - n2)) > faint;
  ramp = counted_ramp(ramp, turns, down, pixel);
  Bool first = abs(step) >= abs(down) * kFirstStep;
  gap = select(two && first && abs(ramp) > abs(gap), ramp, gap);
  down = step0 + step;
  ramp = agreed_gap(down, down - (plane0.x - nearness_of(-2 * i, -2 * j)) * 2.0f,
                    down - select(after, step2, slope2) * 2.0f);
  two = before && step0 * step > 0.0f && abs(ramp) > least && same_object(-i, -j, -2 * i, -2 * j) &&
        near_inside(-2 * i, -2 * j);
  turns = max(turn, square(n1 - near_normal(-i, -j))) > faint;
  ramp = counted_ramp(ramp, turns, down, pixel);
  first = abs(step0) >= abs(down) * kFirstStep;
  gap = select(two && !first && abs(ramp) > abs(gap), ramp, gap);
  return gap / max(pixel, Real(1e-30f));
}

// Whether another object hides what would follow on pixel (k, l), steps of (i, j) of so many pixels on: one that stands
// on it, or lies in front.
FN Bool hidden_from(int k, int l, int i, int j, int pixels) {
  Real depth = near_depth(k, l);
  Real other = near_depth(k + i, l + j);
  return other > 0.0f && other - depth < near_behind(depth, pixels) &&
         !(near_object_id(k + i, l + j) == near_object_id(k, l));
}

// Whether the surface of pixel (k, l) is at most two pixels wide, seen from there by steps of (i, j), and what follows
// lies behind: the last turn of a fold.
FN Bool ends_soon(int k, int l, int i, int j) {
  Real depth = near_depth(k, l);
  Bool first = !goes_on(k, l, k + i, l + j, 1) && !(near_depth(k + i, l + j) < depth);
  Bool second = !goes_on(k + i, l + j, k + 2 * i, l + 2 * j, 1) && !(near_depth(k + 2 * i, l + 2 * j) < depth);
  return first || second;
}

// Whether the surface behind a jump, that of pixel (k, l), seen from there by steps of (i, j), is at most two pixels
// wide and then falls off much deeper: a side that is seen at a low angle.
FN Bool falls_soon(int k, int l, int i, int j) {
  Real depth = near_depth(k, l);
  Real deeper = (depth - near_depth(k - i, l - j)) * Real(kDeeper);
  Real depth1 = near_depth(k + i, l + j);
  return depth1 - depth > deeper || near_depth(k + 2 * i, l + 2 * j) - depth1 > deeper;
}

// Whether the nearer surface of a jump by `drop`, that of pixel (k, l), has no room for lines at both its ends: seen
// from there by steps of (i, j) it rises steeply for a few pixels and ends behind a larger jump, which has the line. In
// a row of such sides each is asked alone, so that of ever smaller ones the first has a line.
FN Bool fell_before(int k, int l, int i, int j, Real drop) {
  Real depth = near_depth(k, l);
  Real pixel = Real(F.ray_scale_x);
  if (F.orthographic == 0) pixel = pixel * depth;
  Real least = max(drop * kLarger, pixel * kSteepest);
  Bool on = depth > 0.0f;
  Bool found = on && !on;
  Real before = Real(0.0f);
  for (int m = 1; m <= kRoom * C.stride + kRoom; ++m) {
    if (!some(on)) continue;
    Real next = near_depth(k + m * i, l + m * j);
    Real step = depth - next;
    Real beyond = next - near_depth(k + (m + 1) * i, l + (m + 1) * j);
    found = found || (on && step > least && step > max(before, beyond) * kStandsOut &&
                      near_object_id(k + m * i, l + m * j) == near_object_id(k, l));
    on = on && step < least && step > pixel * kLeastSteep;
    depth = next;
    before = step;
  }
  return found;
}

// Whether a jump within an object is the inner side of such a turn or such a side: the outer one has the line, and a
// surface that narrow has room for no more.
FN Bool sliver(int i, int j, Real gap) {
  return (gap > 0.0f && (ends_soon(0, 0, -i, -j) || falls_soon(i, j, i, j))) ||
         (gap < 0.0f && (ends_soon(i, j, i, j) || falls_soon(0, 0, -i, -j)));
}

// Whether it lies at the foot of a side that has no room for lines at both its ends.
FN Bool at_foot(int i, int j, Real gap) {
  Real drop = abs(near_depth(i, j) - near_depth(0, 0));
  return (gap > 0.0f && fell_before(0, 0, -i, -j, drop)) || (gap < 0.0f && fell_before(i, j, i, j, drop));
}

// Whether the surface beside a crease, seen from pixel (k, l) by steps of (i, j), is a steep one that soon levels off,
// such as the side of a fold: above 0, up to 1 the narrower it is, if it falls away from the crease, below 0, down to
// -1, if the crease is at its foot. It is asked only where that changes a crease that is so `clear`.
FN_RARE Real steep_side(int k, int l, int i, int j, Bool peak, Real clear) {
  int room = kRoom * C.stride + kRoom;
  Real depth = near_depth(k, l);
  Real pixel = Real(F.ray_scale_x);
  if (F.orthographic == 0) pixel = pixel * depth;
  Real last = near_depth(k + i, l + j);
  Real next = near_depth(k + 2 * i, l + 2 * j);
  Real first = last - depth;
  Real step = abs(first);
  Real after = abs(next - last);
  Real least = select(first < 0.0f, max(step, after), step);
  Real largest = step;
  Real before = step;
  Bool on = peak && is_surface(depth) && least > pixel * (kLeastSteep * kSetsOut) &&
            select(first < 0.0f, clear - kNarrow, Real(1.0f) - clear) > 0.0f;  // or else it changes nothing
  Bool jumps = on && !on;
  Real answer = Real(0.0f);
  for (int m = 1; m <= room + kFootRoom; ++m) {
    if (!some(on)) continue;
    Real second = near_depth(k + (m + 2) * i, l + (m + 2) * j);
    Real beyond = abs(second - next);
    Real fall = last - depth;
    Real slope = abs(fall) * Real(1.0f / float(m));
    Real level = slope * kLevelOff;
    largest = max(largest, step);
    // A jump further down has its own line.
    if (m > kAtTop) jumps = jumps || step - max(before, after) > pixel * C.depth;
    // Where it ends it does not rise again at once: it is no groove.
    Bool ends = after < level;
    Bool side = on && ends && beyond < level && slope > pixel * kLeastSteep &&
                abs(fall) > pixel * (C.depth * kLeastRamp) && least > slope * kSetsOut &&
                largest < abs(fall) * kMostOfIt;
    if (some(side)) {
      side =
          side && same_object(k, l, k + (m + 1) * i, l + (m + 1) * j) && near_inside(k + (m + 2) * i, l + (m + 2) * j);
      Real top = clamp(Real(float(room + 1 - m) * kTopFades), Real(0.0f), Real(1.0f));
      Real foot = clamp(Real(float(room + 1 + kFootRoom - m) * kFootFades), Real(0.0f), Real(1.0f));
      // A rounded top has no line to stand for both.
      int forward = C.stride < kTurnWithin ? C.stride : kTurnWithin;
      int back = m < forward ? m : forward;
      Vec3 over = near_normal(k + (m + forward) * i, l + (m + forward) * j);
      Real turn = square(over - near_normal(k + (m - back) * i, l + (m - back) * j));
      foot = select(turn > Real(C.crease_chord * kTurnsOver), foot, Real(0.0f));
      answer = select(side, select(fall > 0.0f, select(jumps, Real(0.0f), top), -foot), answer);
    }
    on = on && !ends;
    if (m > 1) on = on && slope > pixel * (kLeastSteep * kSetsOut);
    last = next;
    next = second;
    before = step;
    step = after;
    after = beyond;
  }
  return answer;
}

// Whether what lies behind pixel (0, 0) or (i, j), the nearer one, is seen through a slit: one pixel wide, no more
// than kOutlineSlitRows long to either side, and with another rim of the same object that is nearer, and has the line.
// Of two as near the one that comes after. Two surfaces that just touch have a row of such slits, as pixels fall on it.
FN_RARE Bool is_slit(Bool asked, Int px, Int py, int i, int j, Real side) {
  Bool first = side > 0.0f;
  Real id = select(first, near_object_id(0, 0), near_object_id(i, j));
  Real rim = select(first, near_depth(0, 0), near_depth(i, j));
  Real behind = select(first, near_depth(i, j), near_depth(0, 0));
  Real other = select(first, near_depth(2 * i, 2 * j), near_depth(-i, -j));
  Real other_id = select(first, near_object_id(2 * i, 2 * j), near_object_id(-i, -j));
  Real deep = Real(F.ray_scale_x * C.depth);
  if (F.orthographic == 0) deep = deep * rim;
  Bool slit = asked && id == other_id && is_surface(other) && is_surface(behind) && behind - rim > deep &&
              (other < rim || (first && other == rim));
  if (!some(slit)) return slit;
  Real halfway = (rim + behind) * Real(0.5f);
  for (int towards = -1; towards <= 1; towards += 2) {
    Int aside = select(first, Int(1), Int(0));
    Bool on = slit;
    for (int k = 1; k <= kOutlineSlitRows; ++k) {
      if (!some(on)) continue;
      Int next = aside;
      Real wide = Real(0.0f);
      for (int drift = -1; drift <= 1; ++drift) {
        Int across = aside + Int(drift);
        Bool here = on && load_depth(px + Int(j * k * towards) + across * Int(i),
                                     py + Int(i * k * towards) + across * Int(j)) > halfway;
        next = select(here, across, next);
        wide = select(here, wide + 1.0f, wide);
      }
      // Where another object hides it, it may go on.
      Bool closed = on && !(wide > 0.0f);
      slit = slit && !(wide > 1.0f);
      if (some(closed))
        slit = slit && (!closed || load_object_id(px + Int(j * k * towards) + aside * Int(i),
                                                  py + Int(i * k * towards) + aside * Int(j)) == id);
      on = on && slit && !closed;
      aside = next;
    }
    slit = slit && !on;
  }
  return slit;
}

// The mean normal of `stride` pixels from (k, l) on in steps of (i, j), of those that are of one surface: in high
// pictures single ones would tell of a bevel what the pixels happen to hit.
FN Vec3 mean_normal(int k, int l, int i, int j, int stride) {
  Vec3 first = near_normal(k, l);
  if (stride == 1) return first;
  Vec3 sum = first;
  for (int m = 1; m < stride; ++m)
    sum = sum + select(goes_on(k, l, k + m * i, l + m * j, m), near_normal(k + m * i, l + m * j), first);
  return sum * Real(1.0f / float(stride));
}

// Whether a crease's side, seen from pixel (k, l) by steps of (i, j), ends at a rim before there is room for lines at
// both. normal: of the side.
FN Bool ends_within(Bool asked, int k, int l, int i, int j, Vec3 normal) {
  Bool ends = asked && !asked;
  for (int m = 1; m <= C.bar; ++m) {
    Bool look = asked && !ends;
    if (!some(look)) continue;
    ends = ends || (look && (!goes_on(k + (m - 1) * i, l + (m - 1) * j, k + m * i, l + m * j, 1) ||
                             square(near_normal(k + m * i, l + m * j) - normal) > kTurnsAway));
  }
  return ends;
}

// How clear a crease is by its squared chord, beyond 0 and 1 too.
FN Real turned_enough(Real turn) { return (turn - Real(C.crease_chord)) / Real(C.crease_chord * kTurnRange) + 0.5f; }

// Whether a crease between pixel (0, 0) and (i, j), if it is asked for, is convex or concave as it is to be. turn: how
// the normal changes.
FN Bool is_drawn(Bool asked, Int px, Int py, int i, int j, Vec3 turn) {
  Real depth1 = select(asked, near_depth(0, 0), Real(1.0f));
  Real depth2 = select(asked, near_depth(i, j), Real(1.0f));
  Vec3 apart = view_position(px + Int(i), py + Int(j), depth2) - view_position(px, py, depth1);
  Bool convex = dot(turn, apart) > 0.0f;
  if (C.convex == 0) asked = asked && !convex;
  if (C.concave == 0) asked = asked && convex;
  return asked;
}

// The crease between pixel (0, 0) and (i, j): below 0 for none, or how clear it is, to 1; and t. partly: whether it may
// be of a wide bevel of which another object hides a part: what is seen of one side alone would draw it there.
FN Vec2 crease_between(Int px, Int py, int i, int j, int stride, Bool partly) {
  // Means of normals up to five strides before and after, as long as they are of one surface, and squared chords
  // between them, which stand for angles.
  int si = stride * i;
  int sj = stride * j;
  Bool before1 = goes_on(0, 0, -si, -sj, stride);
  Bool before2 = before1 && goes_on(-si, -sj, -2 * si, -2 * sj, stride);
  Bool after1 = goes_on(i, j, i + si, j + sj, stride);
  Bool after2 = after1 && goes_on(i + si, j + sj, i + 2 * si, j + 2 * sj, stride);
  Vec3 a0 = mean_normal(0, 0, -i, -j, stride);
  Vec3 b0 = mean_normal(i, j, i, j, stride);
  Vec3 a1 = select(before1, mean_normal(-si, -sj, -i, -j, stride), a0);
  Vec3 b1 = select(after1, mean_normal(i + si, j + sj, i, j, stride), b0);
  Vec3 a2 = select(before2, mean_normal(-2 * si, -2 * sj, -i, -j, stride), a1);
  Vec3 b2 = select(after2, mean_normal(i + 2 * si, j + 2 * sj, i, j, stride), b1);
  Real here = square(b0 - a0);
  Real turn = max(max(here, square(b1 - a1)), square(b2 - a2) * kSoft);
  Bool peak = same_object(0, 0, i, j) && turn > Real(C.crease_chord * kFaintTurn);
  if (!some(peak)) return Vec2(Real(-1.0f), Real(0.5f));
  // The crease is at the peak of the smoothed turn: steps that make a bevel are one.
  Bool before3 = before2 && goes_on(-2 * si, -2 * sj, -3 * si, -3 * sj, stride);
  Bool after3 = after2 && goes_on(i + 2 * si, j + 2 * sj, i + 3 * si, j + 3 * sj, stride);
  Vec3 a3 = select(before3, mean_normal(-3 * si, -3 * sj, -i, -j, stride), a2);
  Vec3 b3 = select(after3, mean_normal(i + 3 * si, j + 3 * sj, i, j, stride), b2);
  Real strength = smooth_turn(a2, a1, a0, b0, b1, b2) * (stride == 1 ? kTie : kAsStrong);
  peak = peak && strength >= smooth_turn(a3, a2, a1, a0, b0, b1) && strength > smooth_turn(a1, a0, b0, b1, b2, b3);
  if (!some(peak)) return Vec2(Real(-1.0f), Real(0.5f));
  Bool before4 = before3 && goes_on(-3 * si, -3 * sj, -4 * si, -4 * sj, stride);
  Bool after4 = after3 && goes_on(i + 3 * si, j + 3 * sj, i + 4 * si, j + 4 * sj, stride);
  Vec3 a4 = select(before4, mean_normal(-4 * si, -4 * sj, -i, -j, stride), a3);
  Vec3 b4 = select(after4, mean_normal(i + 4 * si, j + 4 * sj, i, j, stride), b3);
  peak = peak && strength >= smooth_turn(a4, a3, a2, a1, a0, b0) && strength > smooth_turn(a0, b0, b1, b2, b3, b4);
  if (!some(peak)) return Vec2(Real(-1.0f), Real(0.5f));
  Bool sharp = max(square(a0 - a1), square(b1 - b0)) < here * kSharp;
  Real inside = sqrt(square(b2 - a2));
  // A side that ends after three steps is judged by the last of them: before a rim it turns the more the rounder it is.
  Real outside_a = sqrt(select(before3, square(a2 - a4), square(a1 - a2) * kLast));
  Real outside_b = sqrt(select(after3, square(b4 - b2), square(b2 - b1) * kLast));
  // One that another object hides goes on behind that one: it is as round as the other side.
  Bool hidden_a = (before1 && hidden_from(-si, -sj, -si, -sj, stride)) ||
                  (before2 && hidden_from(-2 * si, -2 * sj, -si, -sj, stride));
  Bool hidden_b = (after1 && hidden_from(i + si, j + sj, si, sj, stride)) ||
                  (after2 && hidden_from(i + 2 * si, j + 2 * sj, si, sj, stride));
  Real outside = select(hidden_a, outside_b, outside_a);
  outside_b = select(hidden_b, outside_a, outside_b);
  outside_a = outside;
  if (stride > 1) {
    hidden_a = hidden_a || (before3 && hidden_from(-3 * si, -3 * sj, -si, -sj, stride));
    hidden_b = hidden_b || (after3 && hidden_from(i + 3 * si, j + 3 * sj, si, sj, stride));
  }
  Real steady = (Real(kRound) - (outside_a + outside_b) / max(inside, Real(1e-20f))) * Real(1.0f / (kRound - kBevel));
  // Between a crease and a rim so near is hardly room for two lines: it is drawn where it is clear elsewhere.
  // The soft ones of high pictures need the four strides that they are judged by.
  Bool roomy_a = stride > 1 ? before4 : before3;
  Bool roomy_b = stride > 1 ? after4 : after3;
  Bool hides = (roomy_a || hidden_a) && (roomy_b || hidden_b);
  steady = select(roomy_a && roomy_b, steady, min(steady, select(hides, Real(kHidden), Real(kNarrow))));
  steady = select((before2 || hidden_a) && (after2 || hidden_b) && (before3 || after3), steady, Real(0.0f));
  Bool soft = peak && !sharp && steady > kNarrow;
  if (some(soft)) {
    // Also along the other axis, if the crease is seen there, too: the way across a leaning bar may be shorter.
    Bool bar = soft && ends_within(soft, 0, 0, -i, -j, a2) && ends_within(soft, i, j, i, j, b2);
    Bool rest = soft && !bar;
    if (some(rest)) {
      Vec3 before = near_normal(-2 * sj, -2 * si);
      Vec3 after = near_normal(2 * sj, 2 * si);
      rest = rest && square(after - before) > Real(C.crease_chord * kFaintTurn) &&
             goes_on(0, 0, -2 * sj, -2 * si, 2 * stride) && goes_on(0, 0, 2 * sj, 2 * si, 2 * stride);
      bar = bar || (ends_within(rest, 0, 0, -j, -i, before) && ends_within(rest, 0, 0, j, i, after));
    }
    soft = soft && bar;
  }
  steady = select(soft, min(steady, Real(kNarrow)), steady);
  if (C.stride > 1) steady = min(steady, Real(kSoftClear));
  steady = select(sharp, Real(1.0f), steady);
  Real clear = clamp(min(turned_enough(turn), steady), Real(0.0f), Real(1.0f));
  // The two edges of a fold's narrow side are one line, at the nearer one.
  Real side_a = steep_side(0, 0, -i, -j, peak, clear);
  Real side_b = steep_side(i, j, i, j, peak, clear);
  Real top = max(select(after3, side_a, Real(0.0f)), select(before3, side_b, Real(0.0f)));
  top = top * clamp((turn - Real(C.crease_chord)) * Real(1.0f / (C.crease_chord * (kTurnsOver - 1.0f))), Real(0.0f),
                    Real(1.0f));  // or else it is round
  Real foot = min(side_a, side_b);
  if (C.convex == 0) foot = Real(0.0f);  // where the top is not drawn
  clear = select(foot < 0.0f, select(top > 0.0f, clear, min(clear, mad(foot, Real(1.0f - kNarrow), Real(1.0f)))),
                 max(clear, top));
  if (C.convex == 0 || C.concave == 0) peak = peak && is_drawn(peak, px, py, i, j, b2 - a2);

  // It lies where the planes before and after it meet, or else in the middle of the turn, which is counted pixel by
  // pixel: of what is sharp, within the window, lest its neighbours count.
  Real t = Real(0.5f);
  Real plain_turn = max(max(square(a1 - a2), square(b2 - b1)), max(square(a2 - a3), square(b3 - b2)));
  Bool plain = plain_turn < turn * kSteady;
  if (stride > 1) plain = plain && !plain;  // of a wide bevel the middle counts
  if (stride == 1 && some(plain && peak)) {
    Vec2 plane_a = nearness(px, py, -i, -j, i);
    Vec2 plane_b = nearness(px, py, 2 * i, 2 * j, i);
    Real bend = plane_a.y - plane_b.y;
    plain = plain && abs(bend) > 1e-30f && plane_a.y < kNoSlope && plane_b.y < kNoSlope;
    Real meet = (plane_b.x - plane_b.y - plane_b.y - plane_a.x - plane_a.y) / select(plain, bend, Real(1.0f));
    plain = plain && meet > -0.5f && meet < 1.5f;
    t = select(plain, meet, t);
  }
  if (some(!plain && peak)) {
    Vec3 a = near_normal(0, 0);
    Vec3 b = near_normal(i, j);
    Real weight = sqrt(square(b - a));
    Real moment = Real(0.0f);
    Bool before = peak;
    Bool after = peak;
    Real most = weight;
    for (int k = 1; k <= 4 * stride; ++k) {
      before = before && goes_on(-(k - 1) * i, -(k - 1) * j, -k * i, -k * j, 1);
      after = after && goes_on(k * i, k * j, (k + 1) * i, (k + 1) * j, 1);
      before = before && (after || !partly);
      after = after && (before || !partly);
      Vec3 next_a = select(before, near_normal(-k * i, -k * j), a);
      Vec3 next_b = select(after, near_normal((k + 1) * i, (k + 1) * j), b);
      Real turn_a = sqrt(square(next_a - a));
      Real turn_b = sqrt(square(next_b - b));
      if (k > 2 * stride) {
        turn_a = select(sharp, Real(0.0f), turn_a);
        turn_b = select(sharp, Real(0.0f), turn_b);
      }
      weight = weight + turn_a + turn_b;
      if (k <= 2 * stride) most = max(most, max(turn_a, turn_b));
      moment = mad(turn_b - turn_a, Real(float(k)), moment);
      a = next_a;
      b = next_b;
    }
    t = select(plain, t, Real(0.5f) + moment / max(weight, Real(1e-20f)));
    // Of several as strong ones those count that are next to the middle; outline_settle makes them one.
    if (stride > 1) peak = peak && t > -0.5f && t < 1.5f && most < inside * kMostStep;
  }
  return Vec2(select(peak, clear, Real(-1.0f)), t);
}

// The same called: what the wide strides of high pictures ask, which need not be compiled into each of its places.
FN_RARE Vec2 crease_called(Int px, Int py, int i, int j, int stride, Bool partly) {
  return crease_between(px, py, i, j, stride, partly);
}

// What is known of a wide bevel between pixel (0, 0) and (i, j).
struct Bevel {
  Bool sure;    // they are of one, and of no other crease
  Bool partly;  // of one of which another object hides a part
  Bool middle;  // its middle is here,
  Real clear;   // so clear, to 1,
  Real t;       // and there
};

// One of the two sides of a wide bevel.
struct Side {
  Bool known;
  Bool hidden;  // in part
  Vec3 normal;
  Real bent;  // how far that turns within as many pixels as the bevel may be wide
};

// A side from pixel (k, l) on by steps of (i, j), of which the picture has so many pixels beyond the bevel.
FN Side side_from(Bool asked, int k, int l, int i, int j, Real seen_px) {
  int wide = C.bevel;
  Vec3 normal = near_normal(k + wide * i, l + wide * j);
  Vec3 far = near_normal(k + 2 * wide * i, l + 2 * wide * j);
  Bool known = asked && goes_on(k, l, k + wide * i, l + wide * j, wide) &&
               goes_on(k + wide * i, l + wide * j, k + 2 * wide * i, l + 2 * wide * j, wide);
  Real bent = sqrt(square(far - normal)) * (Real(float(wide)) / max(seen_px, Real(1.0f)));
  return Side(known, known && !known, normal, bent);
}

// The same where another object hides a part of it: the last pixels before that tell, if it is flat there.
FN_RARE Side side_seen(Bool asked, int k, int l, int i, int j, Side side) {
  int wide = C.bevel;
  int near = 2 * C.stride;
  Bool on = asked;
  Vec3 normal = near_normal(k, l);
  Real bent = Real(0.0f);
  Bool known = on && !on;
  for (int m = 1; m <= 2 * wide; ++m) {
    if (!some(on)) continue;
    Bool covered = on && hidden_from(k + (m - 1) * i, l + (m - 1) * j, i, j, 1) &&
                   near_depth(k + m * i, l + m * j) < near_depth(k + (m - 1) * i, l + (m - 1) * j);
    side.hidden = side.hidden || covered;
    if (m > near + 1) known = known || covered;
    on = on && !side.hidden && goes_on(k + (m - 1) * i, l + (m - 1) * j, k + m * i, l + m * j, 1);
    Vec3 next = near_normal(k + m * i, l + m * j);
    // Of what is beyond the bevel all is to be flat, and of what is not the last pixels.
    int back = m < near + 1 ? m : near + 1;
    Vec3 from = m <= wide ? near_normal(k + (m - back) * i, l + (m - back) * j) : normal;
    Real share = Real(float(wide) / float(m <= wide ? back : m - wide));
    bent = select(on, sqrt(square(next - from)) * share, bent);
    if (m <= wide) normal = select(on, next, normal);
  }
  side.known = side.known || known;
  side.normal = select(known, normal, side.normal);
  side.bent = select(known, bent, side.bent);
  return side;
}

// A bevel as boxes have, too wide for crease_between, between two sides that are flat for as far as it may be wide. Its
// crease is where the normal is halfway between theirs.
FN Bevel bevel_between(Int px, Int py, int i, int j) {
  int wide = C.bevel;
  Vec3 n0 = near_normal(0, 0);
  Vec3 n1 = near_normal(i, j);
  Real step = square(n1 - n0);
  Vec3 a = near_normal(-wide * i, -wide * j);
  Vec3 b = near_normal((wide + 1) * i, (wide + 1) * j);
  // Where another object hides a side what is behind it is not known yet.
  Real id = near_object_id(0, 0);
  Bool cut = step > Real(C.crease_chord * C.bevel_step);
  if (some(cut))
    cut = cut && !(near_object_id(-2 * wide * i, -2 * wide * j) == id &&
                   near_object_id((2 * wide + 1) * i, (2 * wide + 1) * j) == id);
  int near = 2 * C.stride;
  Vec3 turns_near = near_normal((near + 1) * i, (near + 1) * j) - near_normal(-near * i, -near * j);
  Real turn = square(b - a);
  Real least = Real(C.crease_chord * (1.0f - 0.5f * kTurnRange));
  // crease_between knows what turns within five strides.
  Bool on = turn > least && step < turn * (kMostStep * kMostStep) && square(turns_near) < turn * kTooWide;
  Bevel bevel = Bevel(on && !on, on && !on, on && !on, Real(0.0f), Real(0.5f));
  if (!some(on || cut)) return bevel;
  on = (on || cut) && same_object(0, 0, i, j);
  // At the picture's border a side may be cut off: what is left of it tells how it goes on.
  Real place = i != 0 ? to_real(px) : to_real(py);
  Real last = Real(float(i != 0 ? F.width - 2 : F.height - 2)) - place;
  Real before_px = min(place - float(wide), Real(float(wide)));
  Real after_px = min(last - float(wide), Real(float(wide)));
  on = on && min(before_px, after_px) >= 1.0f;
  Side before = side_from(on, 0, 0, -i, -j, before_px);
  Side after = side_from(on, i, j, i, j, after_px);
  // Of one of the two sides is to be seen that it is flat.
  cut = cut && on && ((before.known && before.bent < kSeenFlat) || (after.known && after.bent < kSeenFlat));
  if (some(cut)) {
    before = side_seen(cut && !before.known, 0, 0, -i, -j, before);
    after = side_seen(cut && !after.known, i, j, i, j, after);
  }
  if (some(cut)) {
    // Where too much of a side is hidden there is a bevel, but not where its middle is.
    Vec3 flat_side = select(before.hidden, after.normal, before.normal);
    Vec3 near_side =
        select(before.hidden, near_normal((near + 1) * i, (near + 1) * j), near_normal(-near * i, -near * j));
    Real rest = square(flat_side - near_side);
    Bool one = (before.hidden && after.known && !after.hidden && after.bent < kSeenFlat) ||
               (after.hidden && before.known && !before.hidden && before.bent < kSeenFlat);
    bevel.partly = cut && one && rest > Real(C.crease_chord * kWider);
  }
  on = on && before.known && after.known;
  if (!some(on)) return bevel;
  a = before.normal;
  b = after.normal;
  Vec3 across = b - a;
  turn = square(across);
  Bool turns = step > turn * Real(C.bevel_step);  // or else they are of a flat strip
  Real bent = (before.bent + after.bent) / sqrt(max(turn, Real(1e-20f)));
  on = on && bent < kBentSides && turn > least && square(turns_near) < turn * kTooWide;
  if (!some(on)) return bevel;
  // Nor are there several edges.
  Bool gone_a = cut && !cut;
  Bool gone_b = gone_a;
  for (int k = 1; k <= wide; ++k) {
    Real step_a = square(near_normal(-k * i, -k * j) - near_normal(i - k * i, j - k * j));
    Real step_b = square(near_normal(i + k * i, j + k * j) - near_normal(k * i, k * j));
    if (some(cut)) {
      gone_a = gone_a || (cut && !(near_object_id(-k * i, -k * j) == id));
      gone_b = gone_b || (cut && !(near_object_id(i + k * i, j + k * j) == id));
      step_a = select(gone_a, Real(0.0f), step_a);
      step_b = select(gone_b, Real(0.0f), step_b);
    }
    step = max(step, max(step_a, step_b));
  }
  on = on && step < turn * (kMostStep * kMostStep);
  Real flat_sides = (Real(kBentSides) - bent) * Real(1.0f / (kBentSides - kFlatSides));
  bevel.clear = clamp(min(flat_sides, turned_enough(turn)), Real(0.0f), Real(1.0f));
  bevel.sure = on && turns && bevel.clear == Real(1.0f);
  Vec3 halfway = (a + b) * Real(0.5f);
  Real off0 = dot(n0 - halfway, across);
  Real off1 = dot(n1 - halfway, across);
  // Where three sides meet the normal does not turn straight from one to the other.
  Vec3 apart = n0 - halfway * (Real(1.0f) / sqrt(max(dot(halfway, halfway), Real(1e-20f))));
  Real along = dot(apart, across);
  Bool straight = square(apart) * turn - along * along < turn * turn * kStraying;
  bevel.middle = on && straight && bevel.clear > 0.0f && !(off0 > 0.0f) && off1 > 0.0f;
  bevel.t = select(bevel.middle, off0 / select(bevel.middle, off0 - off1, Real(1.0f)), bevel.t);
  if (C.convex == 0 || C.concave == 0) bevel.middle = bevel.middle && is_drawn(bevel.middle, px, py, i, j, across);
  return bevel;
}

// Whether there may be a jump, or another object or material, between pixel (0, 0) and (i, j), the right or the lower
// one.
FN Bool may_part(int i, int j) {
  Real depth1 = near_depth(0, 0);
  Real depth2 = near_depth(i, j);
  // The nearness of a plane is affine: where the pixel, the one before and the neighbour are of one object and on one
  // line, there is no jump. That is compared after multiplication by the three depths, to spare divisions; a depth that
  // is none makes it false.
  Real depth0 = near_depth(-i, -j);
  Real bend = depth0 - (depth1 + depth1) + depth2;
  Real bound = Real(F.ray_scale_x * C.depth * kSure);
  if (F.orthographic == 0) {
    bend = mad(depth0, depth1 - depth2 - depth2, depth1 * depth2);
    bound = bound * depth0 * min(depth1, depth2);
  }
  Real id = near_object_id(0, 0);
  Bool parted = !(abs(bend) < bound && near_object_id(-i, -j) == id && id == near_object_id(i, j));
  if (C.materials > 0) parted = parted || !(near_material_id(0, 0) == near_material_id(i, j));
  return parted && near_inside(i, j) && (is_finite(depth1) || is_finite(depth2));
}

// Whether there may be a crease: beyond one the surface has turned, or else it is a strip of one pixel.
FN Bool may_turn(int i, int j, int stride) {
  int si = stride * i;
  int sj = stride * j;
  Real turn = max(square(near_normal(i + si, j + sj) - near_normal(-si, -sj)),
                  square(near_normal(i + 2 * si, j + 2 * sj) - near_normal(-2 * si, -2 * sj)) * kSoft);
  return turn > Real(C.crease_chord * kFaintTurn) && near_inside(i, j) &&
         (is_finite(near_depth(0, 0)) || is_finite(near_depth(i, j)));
}

// The edge between pixel (0, 0) and (i, j), of which is known whether it may be a jump or a crease, and whether it is
// the middle of a wide bevel.
FN Real edge(Int px, Int py, int i, int j, int stride, Bool parted, Bool turned, Bevel bevel) {
  Real depth1 = near_depth(0, 0);
  Real depth2 = near_depth(i, j);
  Real id1 = near_object_id(0, 0);
  Real id2 = near_object_id(i, j);
  Real code = Real(0.0f);
  Real clear = Real(0.0f);
  turned = turned && !bevel.sure;
  if (some(turned || bevel.middle)) {
    Vec2 crease = Vec2(Real(-1.0f), Real(0.5f));
    if (some(turned)) crease = crease_between(px, py, i, j, 1, bevel.partly);
    if (stride > 1 && some(turned)) {
      Vec2 wide = crease_called(px, py, i, j, stride, bevel.partly);
      crease = Vec2(max(crease.x, wide.x), select(wide.x > crease.x, wide.y, crease.y));
    }
    // What is not clear of it is not where it seems to be.
    crease.x = select(bevel.partly && crease.x < kInPlace, Real(-1.0f), crease.x);
    Bool wider = bevel.middle && (!turned || bevel.clear > crease.x);
    crease = Vec2(select(wider, bevel.clear, crease.x), select(wider, bevel.t, crease.y));
    turned = turned || wider;
    code = Real(2.0f * kLevels + 1.0f) + (clamp(crease.y, Real(-0.5f), Real(1.499f)) + 0.5f) * 0.5f;
    turned = turned && crease.x >= 0.0f;
    code = select(turned, code, Real(0.0f));
    clear = select(turned, crease.x, Real(0.0f));
  }
  if (some(parted)) {
    Bool surface1 = is_surface(depth1);
    Bool surface2 = is_surface(depth2);
    Bool both = surface1 && surface2;
    Bool other = !(id1 == id2) && Int(C.objects) > Int(0);
    if (C.materials > 0) other = other || !(near_material_id(0, 0) == near_material_id(i, j));
    Real gap = Real(0.0f);
    if (some(both && parted)) gap = jump_between(px, py, i, j) * Real(1.0f / C.depth);
    Real side = clamp(gap, Real(-1.0f), Real(1.0f));
    side = select(both, side, select(surface1, Real(1.0f), Real(-1.0f)));
    side = select(abs(side) < kLeastSide, select(side < 0.0f, Real(-kLeastSide), Real(kLeastSide)), side);
    Real level = floor(side * kLevels + (kLevels + 0.5f));
    Real apart = (abs(gap) - 1.0f) * Real(0.5f / (kDeep - 1.0f));
    apart = select(other || !both, Real(1.0f), clamp(apart, Real(0.0f), Real(1.0f)));
    Bool any = (surface1 || surface2) && (!both || other || abs(gap) > 1.0f);
    any = any && parted;
    // As pixels fall on it, such a surface has that width in some rows alone: those are faint, and the mean decides.
    Bool narrow = both && !other && sliver(i, j, gap);
    Bool slit = any && both && !narrow;
    if (some(slit)) slit = is_slit(slit, px, py, i, j, side);
    apart = select(narrow || slit, Real(-1.0f), max(clear, apart));
    Bool foot = any && both && !other && !narrow;
    if (some(foot)) apart = select(foot && at_foot(i, j, gap), min(apart, Real(kAtFoot)), apart);
    code = select(any, level + level + 1.5f, code);
    clear = select(any, max(apart, Real(0.0f)), clear);
  }
  Real coded = mad(floor(clear * kClearest + 0.5f), Real(kStep), code);
  return select(code > 0.0f, select(clear < 0.5f, -coded, coded), Real(0.0f));
}

FN void found(Int px, Int py, int stride) {
  Bool surface = is_finite(near_depth(0, 0));
  Bool beside = surface || is_finite(near_depth(1, 0)) || is_finite(near_depth(0, 1));
  Real right = Real(0.0f);
  Real below = Real(0.0f);
  if (some(beside)) {
    Bool parted_right = may_part(1, 0);
    Bool turned_right = may_turn(1, 0, 1);
    if (stride > 1) turned_right = turned_right || may_turn(1, 0, stride);
    Bool parted_below = may_part(0, 1);
    Bool turned_below = may_turn(0, 1, 1);
    if (stride > 1) turned_below = turned_below || may_turn(0, 1, stride);
    Bevel bevel_right = bevel_between(px, py, 1, 0);
    Bevel bevel_below = bevel_between(px, py, 0, 1);
    Bool any_right = parted_right || turned_right || bevel_right.middle;
    Bool any_below = parted_below || turned_below || bevel_below.middle;
    if (some(any_right)) right = edge(px, py, 1, 0, stride, parted_right, turned_right, bevel_right);
    if (some(any_below)) below = edge(px, py, 0, 1, stride, parted_below, turned_below, bevel_below);
  }
  store_outline_right(right);
  store_outline_below(below);
}

FN void outline_find_pixel(Int px, Int py) {
  if (C.stride == 1)
    found(px, py, 1);
  else
    found(px, py, C.stride);
}
