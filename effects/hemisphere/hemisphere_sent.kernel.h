// What each pixel of the first layer sends on: its direct light and its ambient light. How much of the ambient light
// gets there is a guess in the first round; after that it is known from the round before, and so is the light that has
// bounced. Based on [Colliander and Törnquist 2015], "Discussion", which leaves the bounce of ambient light open.
IN_COLOR(direct)
IN_COLOR(ambient)
IN_COLOR(albedo)
IN_COLOR(indirect)
IN_REAL(ao)
OUT_COLOR(hemisphere_sent)

CONST float kMostSent = 1e15f;  // a sum of 256 of them is finite
FN Real bounded(Real v) { return clamp(finite_or_zero(v), Real(0.0f), Real(kMostSent)); }

FN void hemisphere_sent_pixel(Int px, Int py) {
  Vec3 sent = near_direct(0, 0);
  Real open = Real(C.openness);
  if (F.round > 0) {
    open = near_ao(0, 0);
    sent = sent + near_albedo(0, 0) * near_indirect(0, 0);
  }
  sent = sent + near_ambient(0, 0) * (open * Real(C.ambient_bounce));
  store_hemisphere_sent(Vec3(bounded(sent.x), bounded(sent.y), bounded(sent.z)));
}
