// A piece of line, in one number: where it passes, how it leans, on whose side it lies, how sure it is. outline_refine,
// outline_link, outline_even, outline_trim, outline_drop and outline_pen write such numbers, outline draws them.
//
// 0 is none; kOnlyEnds a place where a surface ends but no line is drawn; beyond is a piece, below 0 where a line ends.
// Its bits, from the lowest: 8 for t, -1/2 to 3/2 from this pixel to its neighbour; 8 for the slope, in pixels aside
// per row (column); 7 for the level, 0 to 64: on whose side, as outline_find has it; 5 for how sure, kSure and more for
// what is short and may be a speck; 1 for a crease that leans to the side of the rim that it goes on in. The bit of 2^1
// makes it a number that every machine keeps as it is.

CONST float kOnlyEnds = 2.0f;  // no bit set
CONST float kSure = 15.0f;
CONST float kSpeck = 16.0f;
CONST float kSteepest = 1.5f;  // slope
CONST float kSlopeSteps = 84.0f;
CONST float kRounds = 0.501f;  // to the next whole number, and what is half-way up on every machine
CONST float kPlaceSteps = 128.0f;

CONST float kHalfway = 1.0f / 1024.0f;  // what is half-way between pixels is on one side of that on every machine

FN Real bits_at(Real piece, int at, Uint bits) { return to_real(to_signed((bits_of(piece) >> at) & bits)); }

FN Real packed_piece(Real t, Real slope, Real level, Real sure) {
  Real place = clamp(floor(mad(t, Real(kPlaceSteps), Real(0.5f * kPlaceSteps + 0.5f))), Real(0.0f), Real(255.0f));
  Real lean = floor(mad(clamp(slope, Real(-kSteepest), Real(kSteepest)), Real(kSlopeSteps), Real(127.5f)));
  Uint bits = to_uint(to_int(place)) | (to_uint(to_int(lean)) << 8) | (to_uint(to_int(level)) << 16) |
              (to_uint(to_int(sure)) << 23) | Uint(0x40000000u);
  return real_of_bits(bits);
}

// Whether any of several numbers, of which these are all bits, is a piece.
FN Bool has_piece(Uint bits) { return !(to_signed(bits & Uint(0x3fffffffu)) == Int(0)); }
FN Bool is_piece(Real piece) { return abs(piece) > kOnlyEnds; }
FN Real place_of(Real piece) { return mad(bits_at(piece, 0, Uint(255u)), Real(1.0f / kPlaceSteps), Real(-0.5f)); }
FN Real slope_of(Real piece) { return (bits_at(piece, 8, Uint(255u)) - 127.0f) * Real(1.0f / kSlopeSteps); }
FN Real level_of(Real piece) { return bits_at(piece, 16, Uint(127u)); }
FN Bool maybe_speck(Real piece) { return bits_at(piece, 23, Uint(31u)) > kSure; }
FN Real sure_of(Real piece) {
  Real sure = bits_at(piece, 23, Uint(31u));
  return select(sure > kSure, sure - kSpeck, sure);
}
// The same piece, whether it may be a speck or not.
FN Real without_mark(Real piece) { return real_of_bits(bits_of(piece) & Uint(0xf7ffffffu)); }

// The same piece, of a crease that leans; and whether one does.
FN Real leaning(Real piece) { return real_of_bits(bits_of(piece) | Uint(0x10000000u)); }
FN Bool leans(Real piece) { return !(to_signed(bits_of(piece) & Uint(0x10000000u)) == Int(0)); }

// The same piece, so sure; and as sure as can be.
FN Real as_sure(Real piece, Real sure) {
  return real_of_bits((bits_of(piece) & Uint(0xf07fffffu)) | (to_uint(to_int(sure)) << 23));
}
FN Real without_doubt(Real piece) { return as_sure(piece, Real(kSure)); }

// Whether a pixel is in the picture.
FN Bool in_picture(Int x, Int y) { return x >= Int(0) && x < Int(F.width) && y >= Int(0) && y < Int(F.height); }
