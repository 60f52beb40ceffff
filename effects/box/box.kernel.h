// Shared by the dispatches of `box`: which pixels count in the mean over a square window. Based on [Colliander and
// Törnquist 2015], "Blur Pass".
//
// Both dispatches add up values and counts, so that the mean is that of all counted pixels of the window.
CONST float kMaxSize = 1e15f;  // a sum of 225 values stays finite

// Returns 1 for a pixel that counts, 0 for one outside the picture or (if C.skip) on the background.
FN Real counts(int i, int j, Real depth) {
  Bool there = near_inside(i, j);
  if (C.skip != 0) there = there && is_surface(depth);
  return select(there, Real(1.0f), Real(0.0f));
}
