// Converts view depth to linearised depth D in [0, 1], quantised to steps of 2^-24. Based on [Chamberlin 2011],
// equation (1).
//
// The plane stores the number of steps, since a float represents every integer up to 2^24. So sums over a window are
// exact, in any order. Differs: the paper averages floats.
IN_REAL(depth)
OUT_REAL(unsharp_depth)

CONST float kFarthest = 16777215.0f;  // D = 1 less one step, so that the sum of 256 samples is below 2^32
CONST float kNoSurface = -1.0f;       // marks background that windows ignore

FN void linearize_pixel(Int px, Int py) {
  Real depth = near_depth(0, 0);
  Real n = Real(C.near_depth);
  Real f = Real(C.far_depth);
  Real z = clamp(depth, n, f);  // clipped by near and far plane
  // Equation (1), for window depth Z = F (z - N) / (z (F - N)), gives z/F if Z is scaled to [-1, 1], as the equation
  // requires, and 2z/(z + F) if Z is in [0, 1], as the listing uses it. `extent`, which is 0 at N and 1 at F, is ours.
  Real d = z / f;
  if (C.linearization == kUnsharpListing) d = (z + z) / (z + f);
  if (C.linearization == kUnsharpExtent) d = (z - n) / (f - n);
  d = clamp(floor(d * kUnsharpSteps + 0.5f), Real(0.0f), Real(kFarthest));
  Real background = C.ignore_background != 0 ? Real(kNoSurface) : Real(kFarthest);
  // NaN is background too.
  store_unsharp_depth(select(is_finite(depth), d, background));
}
