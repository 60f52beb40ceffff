// How wide a line is drawn, as by a pen: thinner with distance, thinner the less of a surface another part of it hides,
// and as wide, and as much on one side, as it is around. The text before has depth, object_id,
// material_id, outline_steep_trimmed and outline_flat_trimmed.

CONST int kPen = 3;            // rows to either side over which a line is even, and one more per pixel of stride
CONST float kPenAside = 1.1f;  // pixels beside a line's way, up to which a piece is of it
CONST float kLeastPen = 1.0f;  // of kSure: what is drawn does not vanish

// What lies on both sides of a crossing between pixel (i, j) and the next one, to the right (lying 0) or below.
struct Sides {
  Bool seen;     // neither is background
  Bool within;   // both are of one object and, if those are parted, of one material
  Real nearer;   // depth of the nearer surface,
  Real farther;  // and of the other one
};

FN Sides sides_of(int lying, int i, int j) {
  int i2 = lying == 0 ? i + 1 : i;
  int j2 = lying == 0 ? j : j + 1;
  Real depth1 = near_depth(i, j);
  Real depth2 = near_depth(i2, j2);
  Bool first = is_surface(depth1);
  Bool second = is_surface(depth2);
  Bool within = first && second && near_object_id(i, j) == near_object_id(i2, j2);
  if (C.materials != 0) within = within && near_material_id(i, j) == near_material_id(i2, j2);
  depth1 = select(first, depth1, select(second, depth2, Real(1.0f)));
  depth2 = select(second, depth2, depth1);
  return Sides(first && second, within, min(depth1, depth2), max(depth1, depth2));
}

// The share of its width that a line has there. Things become smaller in proportion to their distance; lines, at most,
// by its square root, or those that are far would be gone. A rim within one object becomes thinner the less what it
// hides lies behind it: that by which it does, in pixel sizes, is 0 where a fold begins.
FN Real pen_share(Sides sides, Real piece) {
  Real share = Real(1.0f);
  Real pixel = Real(F.ray_scale_x);
  if (F.orthographic == 0) {
    Real distant = sqrt(min(Real(C.recede_from) / max(sides.nearer, Real(1e-30f)), Real(1.0f)));
    share = mad(distant - 1.0f, Real(C.recede), share);
    pixel = pixel * sides.nearer;
  }
  Real jump = (sides.farther - sides.nearer) / max(pixel, Real(1e-30f));
  Real less = Real(C.inner * C.inner_px) / (jump + C.inner_px);
  return share * select(sides.within && abs(side_of(piece)) > kHasSide, Real(1.0f) - less, Real(1.0f));
}

// The same piece, as wide as it is drawn, and as its line is in the rows (columns) around it, unless it is a rim before
// the background, which lies wholly on one side anyway.
FN Real penned(int lying, Real piece) {
  Bool on = is_piece(piece);
  if (!some(on)) return piece;
  bool shares = C.recede > 0.0f || C.inner > 0.0f;
  Sides sides = sides_of(lying, 0, 0);
  Real width = sure_of(piece);
  if (shares) width = width * pen_share(sides, piece);
  Real level = level_of(piece);
  Bool even = on && sides.seen;
  if (some(even)) {
    Real place = place_of(piece);
    Real slope = slope_of(piece);
    Real levels = Real(0.0f);
    Real widths = Real(0.0f);
    Real count = Real(0.0f);
    int rows = kPen + C.stride;
    for (int j = -rows; j <= rows; ++j) {
      int most = (j < 0 ? -j : j) + 1;
      for (int i = -most; i <= most; ++i) {
        Real other = lying == 0 ? near_outline_steep_trimmed(i, j) : near_outline_flat_trimmed(j, i);
        Real off = place_of(other) + Real(float(i)) - mad(slope, Real(float(j)), place);
        Bool here = even && is_piece(other) && abs(off) < kPenAside;
        if (!some(here)) continue;
        Sides beside = sides_of(lying, lying == 0 ? i : j, lying == 0 ? j : i);
        here = here && beside.seen;
        Real counts = select(here, Real(float(rows + 2 - most)), Real(0.0f));
        Real wide = sure_of(other);
        if (shares) wide = wide * pen_share(beside, other);
        count = count + counts;
        levels = mad(level_of(other), counts, levels);
        widths = mad(wide, counts, widths);
      }
    }
    Real per = Real(1.0f) / max(count, Real(1.0f));
    width = select(even, widths * per, width);
    level = select(even, levels * per, level);
  }
  Uint sure = to_uint(to_int(max(width + kRounds, Real(kLeastPen))));
  Uint side = to_uint(to_int(level + kRounds));
  return select(on, real_of_bits((bits_of(piece) & Uint(0xf000ffffu)) | (side << 16) | (sure << 23)), piece);
}
