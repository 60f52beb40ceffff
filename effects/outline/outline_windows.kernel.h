// The windows in which creases are detected, and the breaks between their pixels. For outline_turns and outline_edges.

CONST float kWindowUnit = 32.0f;  // of a stored crease; above all strengths

// Returns the break between the s-th pixel from this one, in steps of (i, j), and the next pixel.
FN Real break_beside(int s, int i, int j) {
  return i != 0 ? near_outline_break_right(s, 0) : near_outline_break_below(0, s);
}
