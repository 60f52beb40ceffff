// Fourth dispatch of `antialias`: copies `beauty`, which the last dispatch overwrites.
IN_COLOR(beauty)
IN_ALPHA(beauty)
OUT_COLOR(antialias_beauty)
OUT_ALPHA(antialias_beauty)

FN void antialias_copy_pixel(Int px, Int py) {
  store_antialias_beauty(near_beauty(0, 0));
  store_antialias_beauty_alpha(near_beauty_a(0, 0));
}
