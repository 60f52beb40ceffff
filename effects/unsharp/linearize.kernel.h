// Converts view depth to linearised depth D in [0, 1], quantised to steps of 2^-24. Based on [Chamberlin 2011],
// equation (1).
//
// A float represents every integer up to 2^24, so the plane stores the number of steps: sums are exact, and the order
// in which a window is summed does not matter. Differs: the paper averages floats.
IN_REAL(depth)
OUT_REAL(unsharp_depth)

CONST float kFarthest = 16777215.0f;  // D = 1 less one step, so that the sum of 256 samples is below 2^32
CONST float kNoSurface = -1.0f;       // background that does not count

FN void linearize_pixel(Int px, Int py) {
  Real depth = near_depth(0, 0);
  Real n = Real(C.near_depth);
  Real f = Real(C.far_depth);
  Real z = clamp(depth, n, f);  // clipped as by the planes of the frustum
  // Equation (1) with window depth Z = F (z - N) / (z (F - N)): z/F for Z stretched to [-1, 1], as the equation
  // requires; 2z/(z + F) for Z in [0, 1], as the listing uses it. `extent`, from near to far, is ours.
  Real d = z / f;
  if (C.linearization == kUnsharpListing) d = (z + z) / (z + f);
  if (C.linearization == kUnsharpExtent) d = (z - n) / (f - n);
  d = clamp(floor(d * kUnsharpSteps + 0.5f), Real(0.0f), Real(kFarthest));
  Real background = C.ignore_background != 0 ? Real(kNoSurface) : Real(kFarthest);
  // NaN is background too.
  store_unsharp_depth(select(is_finite(depth), d, background));
}
