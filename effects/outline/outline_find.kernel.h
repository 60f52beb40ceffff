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
//   a crease  normals that turn by the crease angle within five steps, most strongly here, and hardly before and after:
//             a sharp edge or a bevelled one; noise, roughness and round things are none
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
CONST float kSure = 0.9f;               // share of a threshold that tells without rounding that it is not reached
CONST float kLeastFacing = 0.01f;       // cosine to the eye below which a plane's slope is not trusted further
CONST float kNoSlope = 1e30f;           // of normals that do not face the eye, which interpolation makes at rims
CONST float kSteepest = 10.0f;          // depth, in pixel sizes, of a step on a surface that still tells its shape

// Squared shares of the turn of normals: from which share of the crease angle on a crease is faint; what the steps
// three off may turn (round things have 1/5: 0.04), and those beside a sharp edge.
CONST float kFaintTurn = 0.5f;
CONST float kSteady = 0.026f;
CONST float kTurnRange = 0.4f;  // share of the threshold within which a crease becomes clear
CONST float kSharp = 0.1f;
// What a turn that takes five steps counts: 45 degrees as 30.
CONST float kSoft = 0.45f;
// Weights of a step's turn and of those one and two steps off. Two like steps up to four apart are one peak in their
// middle, farther ones are two.
CONST float kWeight0 = 9.0f;
CONST float kWeight1 = 8.5f;
CONST float kWeight2 = 7.0f;

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

FN Bool same_object(int i, int j, int k, int l) {
  return near_object_id(i, j) == near_object_id(k, l) && is_surface(near_depth(i, j)) && is_surface(near_depth(k, l));
}

// Whether a surface goes on from pixel (i, j) to the next one: not to another object, and not far behind.
FN Bool goes_on(int i, int j, int k, int l) {
  Real depth1 = near_depth(i, j);
  Real depth2 = near_depth(k, l);
  Real bound = Real(F.ray_scale_x * kSteepest);
  if (F.orthographic == 0) bound = bound * min(depth1, depth2);
  return abs(depth1 - depth2) < bound && near_object_id(i, j) == near_object_id(k, l);
}

FN Real square(Vec3 v) { return dot(v, v); }

// How much normals turn about the step from n2 to n3, squared: the weighted sum of the turns of five steps.
FN Real smooth_turn(Vec3 n0, Vec3 n1, Vec3 n2, Vec3 n3, Vec3 n4, Vec3 n5) {
  return square((n5 - n0) * Real(kWeight2) + (n4 - n1) * Real(kWeight1 - kWeight2) +
                (n3 - n2) * Real(kWeight0 - kWeight1));
}

FN Real milder(Real a, Real b) { return select(abs(a) < abs(b), a, b); }

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
  Real slope1 = select(before, milder(plane0.y, plane1.y), select(plane1.y < kNoSlope, plane1.y, Real(0.0f)));
  Real of_neighbour = step - slope1;
  of_neighbour = select(before, milder(of_neighbour, step - (plane1.x - plane0.x)), of_neighbour);
  Real slope2 = select(after, milder(plane2.y, plane3.y), select(plane2.y < kNoSlope, plane2.y, Real(0.0f)));
  Real of_pixel = slope2 - step;
  of_pixel = select(after, milder(of_pixel, (plane3.x - plane2.x) - step), of_pixel);
  Real gap = select(step < 0.0f, max(min(of_pixel, -of_neighbour), Real(0.0f)), Real(0.0f));
  gap = select(step > 0.0f, -max(min(of_neighbour, -of_pixel), Real(0.0f)), gap);
  return gap / max(pixel, Real(1e-30f));
}

// Whether the surface of pixel (k, l) is at most two pixels wide, seen from there by steps of (i, j), and what follows
// lies behind: the last turn of a fold.
FN Bool ends_soon(int k, int l, int i, int j) {
  Real depth = near_depth(k, l);
  Bool first = !goes_on(k, l, k + i, l + j) && !(near_depth(k + i, l + j) < depth);
  Bool second = !goes_on(k + i, l + j, k + 2 * i, l + 2 * j) && !(near_depth(k + 2 * i, l + 2 * j) < depth);
  return first || second;
}

// Whether a jump within an object is the inner side of such a turn: the outer one has the line, and a surface that
// narrow has room for no more.
FN Bool sliver(int i, int j, Real gap) {
  return (gap > 0.0f && ends_soon(0, 0, -i, -j)) || (gap < 0.0f && ends_soon(i, j, i, j));
}

// The crease between pixel (0, 0) and (i, j): below 0 for none, or how clear it is, to 1; and t.
FN Vec2 crease_between(Int px, Int py, int i, int j) {
  // Normals from four pixels before to four after, as long as they are of one surface, and squared chords between them,
  // which stand for angles.
  Bool before1 = goes_on(0, 0, -i, -j);
  Bool before2 = before1 && goes_on(-i, -j, -2 * i, -2 * j);
  Bool after1 = goes_on(i, j, 2 * i, 2 * j);
  Bool after2 = after1 && goes_on(2 * i, 2 * j, 3 * i, 3 * j);
  Vec3 a0 = near_normal(0, 0);
  Vec3 b0 = near_normal(i, j);
  Vec3 a1 = select(before1, near_normal(-i, -j), a0);
  Vec3 b1 = select(after1, near_normal(2 * i, 2 * j), b0);
  Vec3 a2 = select(before2, near_normal(-2 * i, -2 * j), a1);
  Vec3 b2 = select(after2, near_normal(3 * i, 3 * j), b1);
  Real here = square(b0 - a0);
  Real turn = max(max(here, square(b1 - a1)), square(b2 - a2) * kSoft);
  Bool peak = same_object(0, 0, i, j) && turn > Real(C.crease_chord * kFaintTurn);
  if (!some(peak)) return Vec2(Real(-1.0f), Real(0.5f));
  // The crease is at the peak of the smoothed turn: steps that make a bevel are one.
  Bool before3 = before2 && goes_on(-2 * i, -2 * j, -3 * i, -3 * j);
  Bool after3 = after2 && goes_on(3 * i, 3 * j, 4 * i, 4 * j);
  Vec3 a3 = select(before3, near_normal(-3 * i, -3 * j), a2);
  Vec3 b3 = select(after3, near_normal(4 * i, 4 * j), b2);
  Real strength = smooth_turn(a2, a1, a0, b0, b1, b2);
  peak = peak && strength >= smooth_turn(a3, a2, a1, a0, b0, b1) && strength > smooth_turn(a1, a0, b0, b1, b2, b3);
  if (!some(peak)) return Vec2(Real(-1.0f), Real(0.5f));
  Bool before4 = before3 && goes_on(-3 * i, -3 * j, -4 * i, -4 * j);
  Bool after4 = after3 && goes_on(4 * i, 4 * j, 5 * i, 5 * j);
  Vec3 a4 = select(before4, near_normal(-4 * i, -4 * j), a3);
  Vec3 b4 = select(after4, near_normal(5 * i, 5 * j), b3);
  peak = peak && strength >= smooth_turn(a4, a3, a2, a1, a0, b0) && strength > smooth_turn(a0, b0, b1, b2, b3, b4);
  if (!some(peak)) return Vec2(Real(-1.0f), Real(0.5f));
  Real turn_a1 = square(a0 - a1);
  Real turn_b1 = square(b1 - b0);
  Real turn_a2 = square(a1 - a2);
  Real turn_b2 = square(b2 - b1);
  Real turn_a3 = square(a2 - a3);
  Real turn_b3 = square(b3 - b2);
  Bool sharp = max(turn_a1, turn_b1) < here * kSharp;
  Real steady = Real(1.5f) - max(turn_a3, turn_b3) / max(turn * kSteady, Real(1e-20f));
  steady = select(sharp, Real(1.0f), select(before3 && after3, steady, Real(0.0f)));
  Real clear = (turn - Real(C.crease_chord)) / Real(C.crease_chord * kTurnRange) + 0.5f;
  clear = clamp(min(clear, steady), Real(0.0f), Real(1.0f));
  if (C.convex == 0 || C.concave == 0) {
    Real depth1 = select(peak, near_depth(0, 0), Real(1.0f));
    Real depth2 = select(peak, near_depth(i, j), Real(1.0f));
    Vec3 apart = view_position(px + Int(i), py + Int(j), depth2) - view_position(px, py, depth1);
    Bool convex = dot(b2 - a2, apart) > 0.0f;
    if (C.convex == 0) peak = peak && !convex;
    if (C.concave == 0) peak = peak && convex;
  }

  // It lies where the planes before and after it meet, or else in the middle of the turn.
  Real weight1 = sqrt(turn_b1) - sqrt(turn_a1);
  Real weight2 = sqrt(turn_b2) - sqrt(turn_a2);
  Real weight = sqrt(here) + sqrt(turn_b1) + sqrt(turn_a1) + sqrt(turn_b2) + sqrt(turn_a2);
  Real t = Real(0.5f) + (weight1 + weight2 + weight2) / max(weight, Real(1e-20f));
  Bool plain = max(max(turn_a2, turn_b2), max(turn_a3, turn_b3)) < turn * kSteady;
  if (some(plain && peak)) {
    Vec2 plane_a = nearness(px, py, -i, -j, i);
    Vec2 plane_b = nearness(px, py, 2 * i, 2 * j, i);
    Real bend = plane_a.y - plane_b.y;
    plain = plain && abs(bend) > 1e-30f && plane_a.y < kNoSlope && plane_b.y < kNoSlope;
    Real meet = (plane_b.x - plane_b.y - plane_b.y - plane_a.x - plane_a.y) / select(plain, bend, Real(1.0f));
    t = select(plain && meet > -0.5f && meet < 1.5f, meet, t);
  }
  return Vec2(select(peak, clear, Real(-1.0f)), t);
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
FN Bool may_turn(int i, int j) {
  Real turn = max(square(near_normal(2 * i, 2 * j) - near_normal(-i, -j)),
                  square(near_normal(3 * i, 3 * j) - near_normal(-2 * i, -2 * j)) * kSoft);
  return turn > Real(C.crease_chord * kFaintTurn) && near_inside(i, j) &&
         (is_finite(near_depth(0, 0)) || is_finite(near_depth(i, j)));
}

// The edge between pixel (0, 0) and (i, j), of which is known whether it may be a jump or a crease.
FN Real edge(Int px, Int py, int i, int j, Bool parted, Bool turned) {
  Real depth1 = near_depth(0, 0);
  Real depth2 = near_depth(i, j);
  Real id1 = near_object_id(0, 0);
  Real id2 = near_object_id(i, j);
  Real code = Real(0.0f);
  Real clear = Real(0.0f);
  if (some(turned)) {
    Vec2 crease = crease_between(px, py, i, j);
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
    apart = select(both && !other && sliver(i, j, gap), Real(0.0f), apart);
    code = select(any, level + level + 1.5f, code);
    clear = select(any, max(clear, apart), clear);
  }
  Real coded = mad(floor(clear * kClearest + 0.5f), Real(kStep), code);
  return select(code > 0.0f, select(clear < 0.5f, -coded, coded), Real(0.0f));
}

FN void outline_find_pixel(Int px, Int py) {
  Bool surface = is_finite(near_depth(0, 0));
  Bool beside = surface || is_finite(near_depth(1, 0)) || is_finite(near_depth(0, 1));
  Real right = Real(0.0f);
  Real below = Real(0.0f);
  if (some(beside)) {
    Bool parted_right = may_part(1, 0);
    Bool turned_right = may_turn(1, 0);
    Bool parted_below = may_part(0, 1);
    Bool turned_below = may_turn(0, 1);
    if (some(parted_right || turned_right)) right = edge(px, py, 1, 0, parted_right, turned_right);
    if (some(parted_below || turned_below)) below = edge(px, py, 0, 1, parted_below, turned_below);
  }
  store_outline_right(right);
  store_outline_below(below);
}
