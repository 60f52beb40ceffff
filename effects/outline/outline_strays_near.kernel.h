// What outline_strays_row tells of rows, of as many rows around: all bits of outline_strays in a square.
IN_REAL(outline_strays_row)
OUT_REAL(outline_strays_near)

FN void outline_strays_near_pixel(Int px, Int py) {
  Uint any = bits_of(near_outline_strays_row(0, 0));
  for (int j = 1; j <= kOutlineStraysNear; ++j)
    any = any | bits_of(near_outline_strays_row(0, -j)) | bits_of(near_outline_strays_row(0, j));
  store_outline_strays_near(real_of_bits(any));
}
