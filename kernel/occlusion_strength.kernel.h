// Strength of occlusion, for the effects that apply `ao`.

// Returns `ao` with 1 - ao multiplied by `factor`, not below 0 unless it was.
FN Real stronger_ao(Real ao, float factor) {
  return max(mad(ao - 1.0f, Real(factor), Real(1.0f)), min(ao, Real(0.0f)));
}
