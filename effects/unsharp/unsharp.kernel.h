// Computes an unsharp mask of the depth buffer from the difference between a pixel's depth and the mean depth in the
// window around it. Based on [Chamberlin 2011], section 3 and its fragment shader; Gaussian window: [Luft 2006].
//
// Depth is an integer number of steps of 2^-24 (linearize.kernel.h), so that tuned variants are bitwise identical.
// Differs: the window is k x k for odd k too, where the listing loops over k - 1; and the listing's border check admits
// one column and one row too many, at x = width and y = height, where it reads copies of the last ones.
IN_REAL(depth)
IN_REAL(unsharp_depth)
OUT_REAL(ao)

CONST float kNoSample = -1.0f;
// A sum is split into two words, one of the samples' upper 12 bits and one of their lower 12 bits: the sum of 1023 x
// 1023 numbers below 4096 fits into 32 bits.
CONST int kLowBits = 12;
CONST int kLowMask = 4095;

// Returns `ao`, which is 1 - strength (D - mean) [Chamberlin 2011, listing, where strength is 20]. `count` is the
// number of the window's samples, and `excess` their sum minus `count` times the centre's depth.
FN Real ao_from_excess(Real excess, Real count) {
  Real ao = excess * (Real(C.scale) / count) + 1.0f;
  return C.keep_white_edge != 0 ? ao : min(ao, Real(1.0f));
}

// Returns the excess as one rounded number. `upper` is excess / 4096, rounded down, and `lower` the remainder.
FN Real excess_of(Real upper, Real lower) { return mad(upper, Real(4096.0f), lower); }

// Returns the excess from the exact sum of a window's samples: the words `high` and `low`.
FN Real excess_from_sum(Uint high, Uint low, Uint count, Uint centre) {
  // Computes sum - count * centre. Carries are propagated in both, so that the lower words have 12 bits.
  Uint own_low = count * (centre & Uint(kLowMask));
  Uint own_high = count * (centre >> kLowBits) + (own_low >> kLowBits);
  Uint sum_high = high + (low >> kLowBits);
  Uint sum_low = low & Uint(kLowMask);
  own_low = own_low & Uint(kLowMask);
  Bool borrow = sum_low < own_low;
  own_high = own_high + select(borrow, Uint(1u), Uint(0u));
  sum_low = sum_low + select(borrow, Uint(kLowMask + 1), Uint(0u));
  Real upper = select(sum_high < own_high, -to_real(own_high - sum_high), to_real(sum_high - own_high));
  return excess_of(upper, to_real(sum_low - own_low));
}

// Returns a sample of the window. Outside the picture it depends on the border mode; for `skip` it is kNoSample, which
// never counts.
FN Real window_sample(Int px, Int py, int i, int j) {
  if (C.border == kUnsharpBorderRepeat) {
    Int x = px + Int(i);
    Int y = py + Int(j);
    // A window is up to 1023 wide: a narrow picture repeats more than once.
    Int columns = to_int(floor((to_real(x) + 0.5f) / Real(float(F.width))));
    Int rows = to_int(floor((to_real(y) + 0.5f) / Real(float(F.height))));
    return load_unsharp_depth(x - columns * Int(F.width), y - rows * Int(F.height));
  }
  Real tap = near_unsharp_depth(i, j);
  if (C.border == kUnsharpBorderClamp) return tap;
  return select(near_inside(i, j), tap, Real(C.border == kUnsharpBorderZero ? C.border_depth : kNoSample));
}

// Returns whether a sample counts: it exists, and differs from the centre by less than the threshold.
FN Bool counts(Real tap, Real centre) { return tap >= 0.0f && abs(tap - centre) < Real(C.threshold); }

// Returns `ao` for a box window.
FN Real box_ao(Int px, Int py, Real centre) {
  Uint high = Uint(0u);
  Uint low = Uint(0u);
  Int count = Int(0);
  for (int j = C.first_row; j <= C.last_row; ++j) {
    for (int i = C.first_column; i <= C.last_column; ++i) {
      Real tap = window_sample(px, py, i, j);
      Bool belongs = counts(tap, centre);
      Uint steps = to_uint(to_int(select(belongs, tap, Real(0.0f))));
      high = high + (steps >> kLowBits);
      low = low + (steps & Uint(kLowMask));
      count = count + select(belongs, Int(1), Int(0));
    }
  }
  Uint samples = to_uint(max(count, Int(1)));
  Real excess = excess_from_sum(high, low, samples, to_uint(to_int(max(centre, Real(0.0f)))));
  return ao_from_excess(excess, to_real(samples));
}

// Returns `ao` for a window whose samples are weighted by a Gaussian of their distance [Luft 2006].
FN Real gaussian_ao(Int px, Int py, Real centre) {
  Real excess = Real(0.0f);
  Real weights = Real(0.0f);
  for (int j = C.first_row; j <= C.last_row; ++j) {
    float row_weight = C.weights[j < 0 ? -j : j];
    for (int i = C.first_column; i <= C.last_column; ++i) {
      Real tap = window_sample(px, py, i, j);
      Real weight = select(counts(tap, centre), Real(row_weight * C.weights[i < 0 ? -i : i]), Real(0.0f));
      excess = mad(weight, tap - centre, excess);
      weights = weights + weight;
    }
  }
  // The sum of weights is not 0, since the pixel itself counts.
  return ao_from_excess(excess, max(weights, Real(1e-20f)));
}

FN void unsharp_pixel(Int px, Int py) {
  Bool surface = is_finite(near_depth(0, 0));
  if (!some(surface)) {
    store_ao(Real(1.0f));
    return;
  }
  Real centre = near_unsharp_depth(0, 0);
  Real ao = C.gaussian != 0 ? gaussian_ao(px, py, centre) : box_ao(px, py, centre);
  store_ao(select(surface, ao, Real(1.0f)));
}
