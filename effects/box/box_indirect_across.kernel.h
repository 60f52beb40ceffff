// Sums `indirect` along rows. A value that is not finite, or exceeds kMaxMagnitude, counts as 0.
IN_COLOR(indirect)
IN_REAL(depth)
OUT_COLOR(box_indirect)
OUT_REAL(box_count)
#include "effects/box/box.kernel.h"

FN Real finite_light(Real v) { return select(abs(v) <= kMaxMagnitude, v, Real(0.0f)); }

FN void box_indirect_across_pixel(Int px, Int py) {
  Vec3 sum = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  Real count = Real(0.0f);
  for (int i = C.first; i <= C.last; ++i) {
    Real weight = count_of(i, 0, near_depth(i, 0));
    Vec3 light = near_indirect(i, 0);
    sum = sum + Vec3(finite_light(light.x), finite_light(light.y), finite_light(light.z)) * weight;
    count = count + weight;
  }
  store_box_indirect(sum);
  store_box_count(count);
}
