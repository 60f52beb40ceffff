// Where lines and their ends are, spread along rows as far as they may reach: outline passes over what has none around.
// 0 for nothing, 1 for a line, 2 where one ends.
IN_REAL(outline_steep_linked)
IN_REAL(outline_flat_linked)
OUT_REAL(outline_ends)

FN void outline_ends_pixel(Int px, Int py) {
  Real least = Real(0.0f);
  Real most = Real(0.0f);
  for (int i = -C.sight; i <= C.sight; ++i) {
    Real steep = near_outline_steep_linked(i, 0);
    Real lower = near_outline_flat_linked(i, 0);
    least = min(least, min(steep, lower));
    most = max(most, max(steep, lower));
  }
  store_outline_ends(select(least < 0.0f, Real(2.0f), select(most > 0.0f, Real(1.0f), Real(0.0f))));
}
