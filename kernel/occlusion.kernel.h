// The common part of kernels that store only occlusion, in the kernel dialect. They include it after their planes
// `depth` and `ao`, and after visibility_at(px, py, depth), which returns the visibility of the surface at a pixel, 1
// if unoccluded. Where there is no surface its depth is 1, and its result is ignored.
FN void store_visibility(Int px, Int py) {
  Real depth = near_depth(0, 0);
  Bool surface = is_surface(depth);
  if (!some(surface)) {
    store_ao(Real(1.0f));
    return;
  }
  store_ao(select(surface, visibility_at(px, py, select(surface, depth, Real(1.0f))), Real(1.0f)));
}
