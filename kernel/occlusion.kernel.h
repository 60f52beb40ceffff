// What kernels that store occlusion alone do at each pixel, in the dialect. They include it after their planes `depth`
// and `ao`, and after open_at(px, py, depth): how open the surface is that a pixel shows, 1 where nothing occludes it.
// It is given the depth 1 where there is no surface, and what it returns there is not used.
FN void store_open(Int px, Int py) {
  Real depth = near_depth(0, 0);
  Bool surface = is_surface(depth);
  if (!some(surface)) {
    store_ao(Real(1.0f));
    return;
  }
  store_ao(select(surface, open_at(px, py, select(surface, depth, Real(1.0f))), Real(1.0f)));
}
