// Stores the result of kernels whose only output is `ao`, in the kernel dialect. A kernel includes this file after it
// has declared the planes `depth` and `ao` and defined visibility_at(px, py, depth), which returns the visibility of
// the surface at a pixel. Lanes without a surface pass depth 1, and their result is ignored.
FN void store_visibility(Int px, Int py) {
  Real depth = near_depth(0, 0);
  Bool surface = is_surface(depth);
  if (!some(surface)) {
    store_ao(Real(1.0f));
    return;
  }
  store_ao(select(surface, visibility_at(px, py, select(surface, depth, Real(1.0f))), Real(1.0f)));
}
