// Sums `ao` along rows. A value that is not finite, or exceeds kMaxMagnitude, counts as 1 (unoccluded).
IN_REAL(ao)
IN_REAL(depth)
OUT_REAL(box_ao)
OUT_REAL(box_count)
#include "effects/box/box.kernel.h"

FN void box_ao_across_pixel(Int px, Int py) {
  Real sum = Real(0.0f);
  Real count = Real(0.0f);
  for (int i = C.first; i <= C.last; ++i) {
    Real weight = count_of(i, 0, near_depth(i, 0));
    Real ao = near_ao(i, 0);
    ao = select(abs(ao) <= kMaxMagnitude, ao, Real(1.0f));
    sum = mad(ao, weight, sum);
    count = count + weight;
  }
  store_box_ao(sum);
  store_box_count(count);
}
