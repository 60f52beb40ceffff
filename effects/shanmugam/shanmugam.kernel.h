// Near occlusion by the pixels around, as discs or spheres; far occlusion by a few coarse occluders of the scene. Based
// on [Shanmugam and Arikan 2007].
IN_REAL(depth)
IN_VECTOR(normal)
OUT_REAL(ao)

#include "kernel/angles.kernel.h"
#include "effects/shanmugam/shanmugam_near.kernel.h"
#include "effects/shanmugam/shanmugam_far.kernel.h"

FN Real visibility_at(Int px, Int py, Real depth) {
  Vec3 position = view_position(px, py, depth);
  Vec3 normal = unit_normal(near_normal(0, 0), position);
  Real visibility = Real(1.0f);
  if (C.samples > 0) visibility = 1.0f - near_occlusion(px, py, depth, position, normal);
  if (C.occluders > 0) visibility = visibility * far_visibility(position, normal);
  return visibility;
}

#include "kernel/occlusion.kernel.h"

FN void shanmugam_pixel(Int px, Int py) { store_visibility(px, py); }
