// Occlusion, and the light that occluders send. The first layer sends what pass hemisphere_sent wrote; others, for
// which occlusion is not known, their direct light and their ambient light times the same guess.
IN_LAYERS_REAL(depth)
IN_LAYERS_VECTOR(normal)
IN_LAYERS_COLOR(direct)
IN_LAYERS_COLOR(ambient)
IN_COLOR(hemisphere_sent)
OUT_REAL(ao)
OUT_COLOR(indirect)

CONST bool kGathersLight = true;
CONST float kMostSent = 1e15f;  // a sum of 256 of them is finite
FN Vec3 normal_of(int layer, Int x, Int y) { return load_normal_of(layer, x, y); }
FN Vec3 sent_of(int layer, Int x, Int y) {
  if (layer == 0) return load_hemisphere_sent(x, y);
  Vec3 sent = load_direct_of(layer, x, y);
  if (C.ambient_bounce > 0.0f) sent = sent + load_ambient_of(layer, x, y) * Real(C.ambient_bounce * C.openness);
  sent = finite_or_zero(sent);
  return Vec3(clamp(sent.x, Real(0.0f), Real(kMostSent)), clamp(sent.y, Real(0.0f), Real(kMostSent)),
              clamp(sent.z, Real(0.0f), Real(kMostSent)));
}
FN void store_light(Vec3 light) { store_indirect(light); }
#include "effects/hemisphere/hemisphere.kernel.h"

FN void hemisphere_bleeding_pixel(Int px, Int py) { gather(px, py); }
