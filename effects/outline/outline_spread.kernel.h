// What outline_gather tells of rows, of all rows within as many pixels: nothing around is one number that is 0.
IN_REAL(outline_around)
OUT_REAL(outline_near)

FN void outline_spread_pixel(Int px, Int py) {
  Uint any = bits_of(near_outline_around(0, 0));
  for (int j = 1; j <= C.gather; ++j)
    any = any | bits_of(near_outline_around(0, -j)) | bits_of(near_outline_around(0, j));
  store_outline_near(real_of_bits(any));
}
