// What the passes of `box` share: which pixels count in the mean over a square window. Based on [Colliander and
// Törnquist 2015], "Blur Pass".
//
// Both passes add up values and how many there were, so that the mean is that of the whole window where pixels are left
// out of it.
CONST float kMaxSize = 1e15f;  // sums of 225 stay finite

// 1 for a pixel that counts and 0 for one that does not: outside the picture, or background.
FN Real counts(int i, int j, Real depth) {
  Bool there = near_inside(i, j);
  if (C.skip != 0) there = there && is_surface(depth);
  return select(there, Real(1.0f), Real(0.0f));
}
