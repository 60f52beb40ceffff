// What lies along each pixel's row as far as lines and joined strokes may reach: all bits of outline_join, so that
// `outline` passes over the rest.
IN_REAL(outline_join)
OUT_REAL(outline_around)

FN Real bits_around(int around) {
  Uint any = Uint(0u);
  for (int i = -around; i <= around; ++i) any = any | bits_of(near_outline_join(i, 0));
  return real_of_bits(any);
}

FN void outline_gather_pixel(Int px, Int py) {
  store_outline_around(C.around == kOutlineUsualAround ? bits_around(kOutlineUsualAround) : bits_around(C.around));
}
