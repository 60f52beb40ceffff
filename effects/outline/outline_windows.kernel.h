// Code that outline_turns and outline_edges share: how creases are stored, and the breaks in a row or column.

// A crease is stored as its strength plus this times the half width of its window; above all strengths.
CONST float kWindowUnit = 32.0f;

// Returns the break between the pixel s steps of (i, j) from this one and the next pixel in that direction.
FN Real break_beside(int s, int i, int j) {
  return i != 0 ? near_outline_break_right(s, 0) : near_outline_break_below(0, s);
}
