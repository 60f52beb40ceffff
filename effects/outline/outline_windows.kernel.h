// The windows within which creases are told, and the breaks between their pixels: outline_turns, outline_edges.

CONST float kWindowUnit = 32.0f;  // of a stored crease, above all strengths

// Half widths h: 0, 1, 2, 4, 6 and so on.
FN int wider(int h) { return h < 2 ? h + 1 : h + 2; }

// The break between the s-th pixel from this one, in steps of (i, j), and the one after.
FN Real break_beside(int s, int i, int j) {
  return i != 0 ? near_outline_break_right(s, 0) : near_outline_break_below(0, s);
}
