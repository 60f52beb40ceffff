// Where ends of lines are, spread along rows as far as they may reach: outline passes over rows without.
IN_REAL(outline_steep_linked)
IN_REAL(outline_flat_linked)
OUT_REAL(outline_ends)

FN void outline_ends_pixel(Int px, Int py) {
  Real least = Real(0.0f);
  for (int i = -C.reach; i <= C.reach; ++i)
    least = min(least, min(near_outline_steep_linked(i, 0), near_outline_flat_linked(i, 0)));
  store_outline_ends(-least);
}
