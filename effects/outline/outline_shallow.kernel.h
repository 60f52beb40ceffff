// How deep jumps may be at ends of lines that others stand for, or that are joined.

CONST float kShallow = 24.0f;  // pixel sizes, per pixel of stride

// Whether the two surfaces of a piece are not far from each other: a line that ends on a surface ends where its jump is
// little, and others end behind something.
FN Bool is_shallow(Int X, Int Y, Bool steep) {
  Real depth1 = load_depth(X, Y);
  Real depth2 = load_depth(X + select(steep, Int(1), Int(0)), Y + select(steep, Int(0), Int(1)));
  Real pixel = Real(F.ray_scale_x * kShallow * float(C.stride));
  if (F.orthographic == 0) pixel = pixel * min(depth1, depth2);
  return abs(depth1 - depth2) < pixel;
}
