// Marks the pixels that get more than one sample: those at edges, and those beside pixels at which surfaces meet, since
// a thin object may lie between the points that the first sample shows.
IN_REAL(resample_edge)
OUT_REAL(marks)

FN void resample_widen_pixel(Int px, Int py) {
  Real widest = Real(0.0f);
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) widest = max(widest, near_resample_edge(i, j));
  store_marks(select(near_resample_edge(0, 0) > 0.0f || widest > 1.0f, Real(1.0f), Real(0.0f)));
}
