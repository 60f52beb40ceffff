// Sums `box_indirect` along columns and divides by the count.
// `indirect` is 0 where no pixel counts.
IN_COLOR(box_indirect)
IN_REAL(box_count)
OUT_COLOR(indirect)

FN void box_indirect_down_pixel(Int px, Int py) {
  Vec3 sum = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  Real count = Real(0.0f);
  for (int j = C.first; j <= C.last; ++j) {
    Real weight = select(near_inside(0, j), Real(1.0f), Real(0.0f));
    sum = sum + near_box_indirect(0, j) * weight;
    count = mad(near_box_count(0, j), weight, count);
  }
  store_indirect(sum * (Real(1.0f) / max(count, Real(1.0f))));
}
