// Half the width of the filter that softens a shadow, per block of 4 x 4 pixels: a fraction of the radius of the
// penumbra there, so that no penumbra becomes much wider [Mehta et al. 2012]. A narrow penumbra also limits the filters
// of the blocks around it, so that they do not reach it.
IN_REAL(penumbra)
OUT_REAL(soften_reach)

FN void soften_reach_pixel(Int px, Int py) {
  Real reach = Real(kSoftenMax);
  for (int j = -kSoftenReachBlocks; j <= kSoftenReachBlocks; ++j)
    for (int i = -kSoftenReachBlocks; i <= kSoftenReachBlocks; ++i) {
      int right = i < 0 ? -i : i;
      int down = j < 0 ? -j : j;
      int distance_px = kSoftenBlock * (right < down ? down : right);
      // The taps, every fourth pixel, must not lie where the first filter has spread an edge beyond its block.
      float limit = float(distance_px - kSoftenBlock) - kSoftenMin;
      reach = min(reach, max(near_penumbra(i, j) * kSoftenFraction, Real(limit)));
    }
  store_soften_reach(max(reach, Real(kSoftenMin)));
}
