// Sums `box_ao` along columns and divides by the count. `ao` is 1 (unoccluded) where no pixel counts.
IN_REAL(box_ao)
IN_REAL(box_count)
OUT_REAL(ao)

FN void box_ao_down_pixel(Int px, Int py) {
  Real sum = Real(0.0f);
  Real count = Real(0.0f);
  for (int j = C.first; j <= C.last; ++j) {
    Real weight = select(near_inside(0, j), Real(1.0f), Real(0.0f));
    sum = mad(near_box_ao(0, j), weight, sum);
    count = mad(near_box_count(0, j), weight, count);
  }
  store_ao(select(count > 0.0f, sum / max(count, Real(1.0f)), Real(1.0f)));
}
