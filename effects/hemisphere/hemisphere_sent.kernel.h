// Writes what each pixel of every layer emits and its normal, packed for the pixels that look it up. It emits its
// direct and its ambient light. The visibility of ambient light is an assumed constant in the first round; later rounds
// take it for the first layer from the round before, and add the reflected light of that round. Based on [Colliander
// and Törnquist 2015], "Discussion", which leaves the bounce of ambient light open.
IN_LAYERS_VECTOR(normal)
IN_LAYERS_COLOR(direct)
IN_LAYERS_COLOR(ambient)
IN_COLOR(albedo)
IN_COLOR(indirect)
IN_REAL(ao)
OUT_LAYERS_REAL(hemisphere_facing)
OUT_LAYERS_REAL(hemisphere_sum)
OUT_LAYERS_REAL(hemisphere_shares)

#include "effects/hemisphere/hemisphere_packed.kernel.h"

CONST float kMaxSent = 1e15f;  // the sum of 256 such values is finite
FN Real bounded(Real v) { return clamp(finite_or_zero(v), Real(0.0f), Real(kMaxSent)); }

FN void store_sent(int layer, Vec3 sent, Bool faces) {
  sent =
      select(faces, Vec3(bounded(sent.x), bounded(sent.y), bounded(sent.z)), Vec3(Real(0.0f), Real(0.0f), Real(0.0f)));
  store_hemisphere_sum_of(layer, light_sum(sent));
  store_hemisphere_shares_of(layer, light_shares(sent));
}

FN Vec3 sent_at_first(int layer) {
  return near_direct_of(layer, 0, 0) + near_ambient_of(layer, 0, 0) * Real(C.assumed_visibility * C.ambient_bounce);
}

FN void hemisphere_sent_pixel(Int px, Int py) {
  for (int i = 0; i < C.layer_count; ++i) {
    int layer = C.layer[i];
    if (F.round > 0 && layer > 0) continue;
    Vec3 normal = near_normal_of(layer, 0, 0);
    Real squared = dot(normal, normal);
    Bool faces = squared > 1e-20f && squared < 1e20f;  // the normal is usable
    Vec3 sent = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
    if (some(faces)) sent = sent_at_first(layer);
    if (F.round == 0) {
      store_hemisphere_facing_of(layer, packed_normal(select(faces, normal, Vec3(Real(0.0f), Real(0.0f), Real(1.0f)))));
    } else {
      sent = near_direct(0, 0) + near_albedo(0, 0) * near_indirect(0, 0) +
             near_ambient(0, 0) * (near_ao(0, 0) * Real(C.ambient_bounce));
    }
    store_sent(layer, sent, faces);
    if (C.back[i] >= 0 && F.round == 0) {
      store_sent(C.back[i], sent_at_first(C.back[i]), faces);
      store_hemisphere_facing_of(C.back[i], Real(0.0f));  // opposite to the front's: never read
    }
  }
}
