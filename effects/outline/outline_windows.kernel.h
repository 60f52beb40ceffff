// The windows within which creases are told, and the breaks between their pixels: outline_turns, outline_edges.

CONST float kWindowUnit = 32.0f;  // of a stored crease, above all strengths

// The break between the s-th pixel from this one, in steps of (i, j), and the one after.
FN Real break_beside(int s, int i, int j) {
  return i != 0 ? near_outline_break_right(s, 0) : near_outline_break_below(0, s);
}
