// All bits of outline_strays as far as kOutlineStraysNear along each pixel's row, so that outline_drop passes over the
// rest.
IN_REAL(outline_strays)
OUT_REAL(outline_strays_row)

FN void outline_strays_row_pixel(Int px, Int py) {
  Uint any = bits_of(near_outline_strays(0, 0));
  for (int i = 1; i <= kOutlineStraysNear; ++i)
    any = any | bits_of(near_outline_strays(-i, 0)) | bits_of(near_outline_strays(i, 0));
  store_outline_strays_row(real_of_bits(any));
}
