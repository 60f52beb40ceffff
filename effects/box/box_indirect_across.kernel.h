// Sums `indirect` along rows. Values that are not finite, or beyond kMaxSize, count as 0.
IN_COLOR(indirect)
IN_REAL(depth)
OUT_COLOR(box_indirect)
OUT_REAL(box_count)
#include "effects/box/box.kernel.h"

FN Real clean(Real v) { return select(abs(v) <= kMaxSize, v, Real(0.0f)); }

FN void box_indirect_across_pixel(Int px, Int py) {
  Vec3 sum = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
  Real count = Real(0.0f);
  for (int i = C.first; i <= C.last; ++i) {
    Real one = counts(i, 0, near_depth(i, 0));
    Vec3 light = near_indirect(i, 0);
    sum = sum + Vec3(clean(light.x), clean(light.y), clean(light.z)) * one;
    count = count + one;
  }
  store_box_indirect(sum);
  store_box_count(count);
}
