// Writes by how much the occlusion of a surface point differs in another frame: noise, and what occluders that moved
// have changed. kSteadyUnknown where the point is not there.
IN_REAL(depth)
IN_REAL(ao)
IN_REAL(other_ao)
IN_VECTOR(there)
OUT_REAL(steady_change)
#include "kernel/surface.kernel.h"

FN void steady_change_pixel(Int px, Int py) {
  Vec3 there = near_there(0, 0);
  Bool visible = is_surface(near_depth(0, 0)) && there.z > 0.0f && there.x > -0.5f && there.y > -0.5f &&
                 there.x < float(F.width) - 0.5f && there.y < float(F.height) - 0.5f;
  Real x = select(visible, there.x + 0.5f, Real(0.0f));
  Real y = select(visible, there.y + 0.5f, Real(0.0f));
  Real change = clean_ao(load_other_ao(to_int(floor(x)), to_int(floor(y)))) - clean_ao(near_ao(0, 0));
  store_steady_change(select(visible, change, Real(kSteadyUnknown)));
}
