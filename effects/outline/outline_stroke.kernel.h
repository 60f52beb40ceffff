// What outline_join, outline_rejoin and what reads their planes know of a piece: the stroke that is drawn along it, and
// the stroke that joins its end to another line's, or to a line that it points to.
//
// outline_join is 0 where there is no piece and kOnlyEnds where there is one, below 0 where a line ends; of an end that
// is joined it has these bits, from the lowest: 9 and 9 for how far the middle of the other end, or of that line, is to
// the right and down, in sevenths of a pixel; 4 for how sure that is; 1 for whether it is the steep piece that ends
// here; 1, which tells that it is joined; 1, which tells that it is to what may be farther off than C.gather.

CONST int kSteepBit = 22;
CONST int kJoinedBit = 23;
CONST int kFarBit = 24;
CONST int kLineBit = 30;         // of kOnlyEnds
CONST float kApart = 256.0f;     // of no distance
CONST float kApartSteps = 7.0f;  // per pixel: 36 of them fit

// On whose side a line lies: 1 wholly on the first pixel's, -1 on the other's.
FN Real side_of(Real piece) { return mad(level_of(piece), Real(1.0f / 32.0f), Real(-1.0f)); }

// How sure a piece is, 0 to 1: outline_link leaves no speck.
FN Real linked_of(Real piece) { return bits_at(piece, 23, Uint(31u)) * Real(1.0f / kSure); }

// How wide a line is drawn that is so sure: one of less than a pixel is as wide as one and as much lighter, or else
// pixels that it meets in their middle would be darker than pairs that it passes between.
FN Real drawn_width(Real sure, float width) { return max(sure * width, Real(1.0f)); }

// The middle of a piece's stroke where it crosses its row (column), from the pixel's centre; of width 0, its crossing.
FN Vec2 middle_of(Real piece, Bool steep, float width) {
  Real slope = slope_of(piece);
  Real shrink = Real(1.0f) / sqrt(mad(slope, slope, Real(1.0f)));
  Real wide = width > 0.0f ? drawn_width(linked_of(piece), width) : Real(0.0f);
  Real aside = side_of(piece) * wide * (shrink * -0.5f);
  Real across = place_of(piece) + aside;
  Real along = -slope * aside;
  return Vec2(select(steep, across, along), select(steep, along, across));
}

FN Real packed_join(Vec2 apart, Real sure, Bool steep, Bool far) {
  Uint right = to_uint(to_int(floor(mad(apart.x, Real(kApartSteps), Real(kApart + 0.5f)))));
  Uint down = to_uint(to_int(floor(mad(apart.y, Real(kApartSteps), Real(kApart + 0.5f)))));
  Uint kind = to_uint(select(steep, Int(3), Int(2)));
  Uint bits = right | (down << 9) | (to_uint(to_int(sure * kSure + 0.5f)) << 18) | (kind << kSteepBit);
  bits = bits | (to_uint(select(far, Int(1), Int(0))) << kFarBit);
  return real_of_bits(bits | (Uint(1u) << kLineBit));
}

// Whether any of several numbers, of which these are all bits, is that of a piece, or of a joined end.
FN Bool has_line(Uint bits) { return !(to_signed((bits >> kLineBit) & Uint(1u)) == Int(0)); }
FN Bool has_join(Uint bits) { return !(to_signed((bits >> kJoinedBit) & Uint(1u)) == Int(0)); }
FN Bool has_far_join(Uint bits) { return !(to_signed((bits >> kFarBit) & Uint(1u)) == Int(0)); }
FN Bool joined_steep(Real join) { return !(to_signed((bits_of(join) >> kSteepBit) & Uint(1u)) == Int(0)); }
FN Vec2 joined_apart(Real join) {
  return Vec2((bits_at(join, 0, Uint(511u)) - kApart) * Real(1.0f / kApartSteps),
              (bits_at(join, 9, Uint(511u)) - kApart) * Real(1.0f / kApartSteps));
}
FN Real joined_sure(Real join) { return bits_at(join, 18, Uint(15u)) * Real(1.0f / kSure); }

// The same joined end, where what it is joined to is so sure.
FN Real with_sure(Real join, Real sure) {
  return real_of_bits((bits_of(join) & Uint(0xffc3ffffu)) | (to_uint(to_int(sure * kSure + 0.5f)) << 18));
}
