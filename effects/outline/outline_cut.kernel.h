// Where a nearer object hides a part of the bevel that a crease may be in the middle of: what is left of that seems to
// have its middle elsewhere. The text before has depth, object_id and what outline_end.kernel.h has.

// Whether that is so at a piece within an object.
FN_RARE Bool is_cut(Bool asked, Int px, Int py, Bool steep) {
  Real depth = load_depth(px, py);
  Real object = load_object_id(px, py);
  Bool found = asked && !asked;
  Bool within =
      asked && load_object_id(px + select(steep, Int(1), Int(0)), py + select(steep, Int(0), Int(1))) == object;
  for (int m = -C.bevel; m <= C.bevel; ++m) {
    Bool look = within && !found;
    if (!some(look)) continue;
    Int x = px + select(steep, Int(m), Int(0));
    Int y = py + select(steep, Int(0), Int(m));
    look = look && in_picture(x, y);
    found = found || (look && !(load_object_id(x, y) == object) && load_depth(x, y) < depth);
  }
  return found;
}
