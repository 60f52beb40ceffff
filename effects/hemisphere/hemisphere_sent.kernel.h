// Writes the outgoing light and the normal of each pixel in every layer, packed for the pixels that read them. The
// light is the direct plus the ambient light. In the first round, the visibility of ambient light is an assumed
// constant. In later rounds, that of the first layer is `ao` of the previous round, whose reflected light is added.
// Based on [Colliander and Törnquist 2015], "Discussion", which leaves the bounce of ambient light open.
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

CONST float kMaxOutgoing = 1e15f;  // the sum of 256 such values is finite
FN Real bounded(Real v) { return clamp(finite_or_zero(v), Real(0.0f), Real(kMaxOutgoing)); }

// Stores the outgoing light of a pixel in a layer: 0 where `has_normal` is false.
FN void store_outgoing_light(int layer, Vec3 light, Bool has_normal) {
  light = select(has_normal, Vec3(bounded(light.x), bounded(light.y), bounded(light.z)),
                 Vec3(Real(0.0f), Real(0.0f), Real(0.0f)));
  store_hemisphere_sum_of(layer, light_sum(light));
  store_hemisphere_shares_of(layer, light_fractions(light));
}

// Returns the outgoing light of a pixel in a layer in the first round.
FN Vec3 first_round_light(int layer) {
  return near_direct_of(layer, 0, 0) + near_ambient_of(layer, 0, 0) * Real(C.assumed_visibility * C.ambient_bounce);
}

FN void hemisphere_sent_pixel(Int px, Int py) {
  for (int i = 0; i < C.layer_count; ++i) {
    int layer = C.layer[i];
    if (F.round > 0 && layer > 0) continue;
    Vec3 normal = near_normal_of(layer, 0, 0);
    Real squared = dot(normal, normal);
    Bool has_normal = squared > 1e-20f && squared < 1e20f;  // whether the normal is usable
    Vec3 light = Vec3(Real(0.0f), Real(0.0f), Real(0.0f));
    if (some(has_normal)) light = first_round_light(layer);
    store_hemisphere_facing_of(layer,
                               packed_normal(select(has_normal, normal, Vec3(Real(0.0f), Real(0.0f), Real(1.0f)))));
    if (F.round > 0) {
      light = near_direct(0, 0) + near_albedo(0, 0) * near_indirect(0, 0) +
              near_ambient(0, 0) * (near_ao(0, 0) * Real(C.ambient_bounce));
    }
    store_outgoing_light(layer, light, has_normal);
    if (C.back[i] >= 0 && F.round == 0) {
      store_outgoing_light(C.back[i], first_round_light(C.back[i]), has_normal);
      store_hemisphere_facing_of(C.back[i], Real(0.0f));  // never read: the opposite of the front's normal
    }
  }
}
