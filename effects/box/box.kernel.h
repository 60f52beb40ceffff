// Shared by the dispatches of `box`: which pixels count in the mean over a square window. Based on [Colliander and
// Törnquist 2015], "Blur Pass".
//
// One dispatch sums values and counts along rows, the next sums these along columns and divides once, so that the
// result is the mean of all counted pixels in the window.
CONST float kMaxMagnitude = 1e15f;  // the sum of 225 values of this size is finite

// Returns 1 if the pixel (i, j) to the right and below counts; 0 if it is outside the picture, or background and C.skip
// is set.
FN Real count_of(int i, int j, Real depth) {
  Bool is_counted = near_inside(i, j);
  if (C.skip != 0) is_counted = is_counted && is_surface(depth);
  return select(is_counted, Real(1.0f), Real(0.0f));
}
