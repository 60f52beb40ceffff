// What outline_fit tells outline_even of a piece that is to be moved: 11 bits for its place, from its pixel, 8 for its
// slope, as outline_piece.kernel.h has it, and the bit of 2^1.

CONST int kFitRows = 6;            // rows (columns) to either side, and
CONST int kFitStride = 3;          // more per pixel of stride, that a line is fitted to,
CONST int kMostFitRows = 16;       // and at most
CONST float kMostFit = 5.0f;       // pixels that a piece is moved, at most
CONST float kFitSteps = 128.0f;    // of a place, per pixel
CONST float kFitMiddle = 1024.0f;  // of place 0

FN int fit_rows() {
  return kFitRows + kFitStride * C.stride < kMostFitRows ? kFitRows + kFitStride * C.stride : kMostFitRows;
}

FN float fit_far() { return float(fit_rows()) + 0.5f; }

// How much what is so far along a line counts: 1 here, nothing at fit_far().
FN Real counted(Real along) {
  Real share = along * Real(1.0f / fit_far());
  Real left = max(Real(1.0f) - share * share, Real(0.0f));
  return left * left;
}

FN Real packed_fit(Real place, Real slope) {
  Real steps = clamp(floor(mad(place, Real(kFitSteps), Real(kFitMiddle + 0.5f))), Real(0.0f), Real(2047.0f));
  Real lean = floor(mad(slope, Real(kSlopeSteps), Real(127.5f)));
  return real_of_bits(to_uint(to_int(steps)) | (to_uint(to_int(lean)) << 11) | Uint(0x40000000u));
}
FN Bool is_fitted(Real fit) { return fit > 0.0f; }
FN Real fit_place(Real fit) { return (bits_at(fit, 0, Uint(2047u)) - kFitMiddle) * Real(1.0f / kFitSteps); }
FN Real fit_slope(Real fit) { return (bits_at(fit, 11, Uint(255u)) - 127.0f) * Real(1.0f / kSlopeSteps); }
