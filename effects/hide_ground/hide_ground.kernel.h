// Removes the shadow-catching ground from the geometry planes: its pixels become background (depth infinity, ids -1).
INOUT_REAL(depth)
INOUT_REAL(object_id)
INOUT_REAL(material_id)

FN void hide_ground_pixel(Int px, Int py) {
  Real depth = own_depth();
  Real object = own_object_id();
  Real material = own_material_id();
  Bool ground = is_surface(depth) && object == Real(C.object) && Real(C.object) >= 0.0f;
  store_object_id(select(ground, Real(-1.0f), finite_or_zero(object)));
  store_material_id(select(ground, Real(-1.0f), finite_or_zero(material)));
  store_depth(select(is_surface(depth) && !ground, depth, real_of_bits(Uint(0x7f800000u))));
}
