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
//   a crease  normals that turn by the crease angle within three steps, most of it in this one, and hardly before and
//             after: a sharp edge or a bevelled one; noise, roughness and round things are none
//   an id     another object or material
// A crease lies where its two planes meet, to a fraction of a pixel; a jump lies halfway until outline_refine.
//
// The planes hold 0 for no edge, or 1 + 2 level + (t + 1/2) / 2: t in [-1/2, 3/2) from the pixel to its neighbour, 1/2
// where that is not known; level 0 to 64, of which 64 is a line wholly on this pixel's side (it is nearer), 0 wholly on
// the neighbour's, 32 in the middle. The same below 0 is faint: it counts where it goes on from a clear edge.
IN_REAL(depth)
IN_VECTOR(normal)
IN_REAL(object_id)
IN_REAL(material_id)
OUT_REAL(outline_right)
OUT_REAL(outline_below)

CONST float kLevels = 32.0f;  // of side, to either side of the middle
// Squared share of a crease's turn that its surroundings may turn by a step: 1/5.
CONST float kSteady = 0.04f;
// Squared share of the crease angle from which on a crease is faint.
CONST float kFaintTurn = 0.5f;
CONST float kDeep = 2.0f;  // a jump within one object is clear from so many times `depth` on
CONST float kSure = 0.9f;  // share of a threshold that tells without rounding that it is not reached
// Squared share of the crease angle that the step in the middle of a crease makes at least: a third, of a faint one.
CONST float kLeastPeak = 0.05f;
CONST float kLeastFacing = 0.01f;  // cosine to the eye below which a plane's slope is not trusted further

FN Bool is_surface(Real depth) { return is_finite(depth) && depth > 0.0f; }

// Nearness of a pixel, and how it changes by one pixel to the right (`rightwards` 1) or down (0) on its own plane.
FN Vec2 nearness(Int px, Int py, int i, int j, int rightwards) {
  Real depth = near_depth(i, j);
  Bool surface = is_surface(depth);
  depth = select(surface, max(depth, Real(1e-30f)), Real(1.0f));
  Vec3 n = near_normal(i, j);
  Real lean = rightwards != 0 ? n.x * Real(F.ray_scale_x) : n.y * Real(F.ray_scale_y);
  Real near = -depth;
  Real facing = max(n.z, Real(kLeastFacing));
  if (F.orthographic == 0) {
    near = Real(1.0f) / depth;
    facing = max(-dot(n, view_position(px + Int(i), py + Int(j), depth)), depth * kLeastFacing);
  }
  Real nowhere = F.orthographic != 0 ? Real(-1e30f) : Real(0.0f);
  return Vec2(select(surface, near, nowhere), select(surface, finite_or_zero(-lean / facing), Real(0.0f)));
}

FN Bool same_object(int i, int j, int k, int l) {
  return near_object_id(i, j) == near_object_id(k, l) && is_surface(near_depth(i, j)) && is_surface(near_depth(k, l));
}

FN Real square(Vec3 v) { return dot(v, v); }

FN Real milder(Real a, Real b) { return select(abs(a) < abs(b), a, b); }

// Window depth in [0, 1], for the paper.
FN Real window_depth(Real depth) {
  Real z = clamp(depth, Real(C.near_depth), Real(C.far_depth));
  Real window = (z - C.near_depth) / Real(C.far_depth - C.near_depth);
  if (F.orthographic == 0) window = window * Real(C.far_depth) / z;
  return select(is_surface(depth), window, Real(1.0f));
}

// The edge between pixel (0, 0) and (i, j), which is the right or the lower one. c and g: nearness, and its slope along
// the step, of the pixel before, the pixel, its neighbour and the one after.
FN Real edge(Int px, Int py, int i, int j) {
  Vec2 plane0 = nearness(px, py, -i, -j, i);
  Vec2 plane1 = nearness(px, py, 0, 0, i);
  Vec2 plane2 = nearness(px, py, i, j, i);
  Vec2 plane3 = nearness(px, py, i + i, j + j, i);
  Real c0 = plane0.x;
  Real c1 = plane1.x;
  Real c2 = plane2.x;
  Real c3 = plane3.x;
  Real g0 = plane0.y;
  Real g1 = plane1.y;
  Real g2 = plane2.y;
  Real g3 = plane3.y;
  Real depth1 = near_depth(0, 0);
  Real depth2 = near_depth(i, j);
  Bool surface1 = is_surface(depth1);
  Bool surface2 = is_surface(depth2);
  Bool both = surface1 && surface2;
  Bool before = same_object(0, 0, -i, -j) && near_inside(-i, -j);
  Bool after = same_object(i, j, i + i, j + j) && near_inside(i + i, j + j);
  Real pixel = Real(F.ray_scale_x);
  if (F.orthographic == 0) pixel = pixel * min(c1, c2);

  // What each side says of the other: below 0 it lies behind.
  Real step = c2 - c1;
  Real of_neighbour = step - select(before, milder(g0, g1), g1);
  of_neighbour = select(before, milder(of_neighbour, step - (c1 - c0)), of_neighbour);
  Real of_pixel = select(after, milder(g2, g3), g2) - step;
  of_pixel = select(after, milder(of_pixel, (c3 - c2) - step), of_pixel);
  Real pixel_before = select(step < 0.0f, min(of_pixel, -of_neighbour), Real(0.0f));      // this one stands out
  Real neighbour_before = select(step > 0.0f, min(of_neighbour, -of_pixel), Real(0.0f));  // or the other
  Real gap = max(pixel_before, neighbour_before) / max(pixel, Real(1e-30f));
  Bool jump = both && gap > Real(C.depth);

  Bool other = (!(near_object_id(0, 0) == near_object_id(i, j)) && Int(C.objects) > Int(0)) ||
               (!(near_material_id(0, 0) == near_material_id(i, j)) && Int(C.materials) > Int(0));
  other = other && both;

  Vec3 n1 = near_normal(0, 0);
  Vec3 n2 = near_normal(i, j);
  Vec3 n0 = select(before, near_normal(-i, -j), n1);
  Vec3 n3 = select(after, near_normal(i + i, j + j), n2);
  Vec3 first = select(before && same_object(-i, -j, -i - i, -j - j), near_normal(-i - i, -j - j), n0);
  Vec3 last = select(after && same_object(i + i, j + j, i + i + i, j + j + j), near_normal(i + i + i, j + j + j), n3);
  // Squared chords stand for angles.
  Real turn = square(n3 - n0);
  Real here = square(n2 - n1);
  Real turn_before = square(n1 - n0);
  Real turn_after = square(n3 - n2);
  Real outer_before = square(n0 - first);
  Real outer_after = square(last - n3);
  Real outer = min(outer_before, outer_after);
  Bool peak = both && here >= turn_before && here > turn_after;
  Bool clear = peak && turn > Real(C.crease_chord) && outer < turn * kSteady;
  Bool crease = peak && turn > Real(C.crease_chord) * kFaintTurn;
  Real d1 = select(surface1, depth1, Real(1.0f));
  Real d2 = select(surface2, depth2, Real(1.0f));
  Vec3 apart = view_position(px + Int(i), py + Int(j), d2) - view_position(px, py, d1);
  Bool convex = dot(n2 - n1, apart) > 0.0f;
  crease = crease && ((convex && Int(C.convex) > Int(0)) || (!convex && Int(C.concave) > Int(0)));

  // A crease lies where the planes before and after it meet, or else where most of the turn is made.
  Real bend = g0 - g3;
  Real t = (c3 - g3 - g3 - c0 - g0) / select(abs(bend) > 1e-30f, bend, Real(1.0f));
  Bool plain = max(outer_before, outer_after) < turn * kSteady && abs(bend) > 1e-30f;
  Real weight_before = sqrt(turn_before);
  Real weight_after = sqrt(turn_after);
  Real weight = sqrt(here) + weight_before + weight_after;
  Real middle = Real(0.5f) + (weight_after - weight_before) / max(weight, Real(1e-20f));
  t = select(plain && t > -0.5f && t < 1.5f, t, middle);
  t = select(crease && !jump && !other, t, Real(0.5f));
  t = clamp(t, Real(-0.5f), Real(1.499f));

  Real side = clamp(gap / max(Real(C.depth), Real(1e-3f)), Real(0.0f), Real(1.0f));
  side = select(neighbour_before > pixel_before, -side, side);
  side = select(both, side, select(surface1, Real(1.0f), Real(-1.0f)));
  t = select(both, t, Real(0.5f));
  Real level = floor(side * kLevels + (kLevels + 0.5f));
  Bool rim = (surface1 && !surface2) || (surface2 && !surface1);
  Bool any = jump || other || crease || rim;
  Real code = level + level + 1.0f + (t + 0.5f) * 0.5f;
  Bool deep = both && gap > Real(C.depth) * kDeep;
  code = select(deep || other || rim || clear, code, -code);
  return select(any && near_inside(i, j), code, Real(0.0f));
}

// Whether there may be an edge between pixel (0, 0) and (i, j): no edge fails this, few other pixels pass, and it takes
// no division. The nearness of a plane is affine: where the pixel, the one before and the neighbour are of one object
// and on one line, there is no jump. That is compared after multiplication by the three depths; a depth that is none
// makes it false.
FN Bool may_part(int i, int j) {
  Real depth0 = near_depth(-i, -j);
  Real depth1 = near_depth(0, 0);
  Real depth2 = near_depth(i, j);
  Real id = near_object_id(0, 0);
  Real bend = depth0 - (depth1 + depth1) + depth2;
  Real bound = Real(F.ray_scale_x * C.depth * kSure);
  if (F.orthographic == 0) {
    bend = mad(depth0, depth1 - depth2 - depth2, depth1 * depth2);
    bound = bound * depth0 * min(depth1, depth2);
  }
  Bool plain = abs(bend) < bound && near_object_id(-i, -j) == id;
  plain = plain && square(near_normal(i, j) - near_normal(0, 0)) < Real(C.crease_chord * kLeastPeak);
  if (C.objects > 0) plain = plain && near_object_id(i, j) == id;
  if (C.materials > 0) plain = plain && near_material_id(i, j) == near_material_id(0, 0);
  return !plain && (is_finite(depth1) || is_finite(depth2));
}

FN void outline_find_pixel(Int px, Int py) {
  Real right = Real(0.0f);
  Real below = Real(0.0f);
  if (C.mode == kOutlinePaper) {
    right = window_depth(near_depth(0, 0));
  } else {
    Bool part_right = may_part(1, 0);
    Bool part_below = may_part(0, 1);
    if (some(part_right)) right = select(part_right, edge(px, py, 1, 0), Real(0.0f));
    if (some(part_below)) below = select(part_below, edge(px, py, 0, 1), Real(0.0f));
  }
  store_outline_right(right);
  store_outline_below(below);
}
