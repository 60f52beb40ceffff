// Half of the width of the filter that softens a shadow, by block of 4 x 4 pixels: a fraction of the radius of the
// penumbra there, so that no penumbra becomes much wider [Mehta et al. 2012]. A narrower penumbra also limits the
// blocks around it, as far as their filters would reach it.
IN_REAL(penumbra)
OUT_REAL(soften_reach)

// At its ends a penumbra deviates by 0.12 of this to the power of 1.5.
CONST float kShare = 0.2f;

FN void soften_reach_pixel(Int px, Int py) {
  Real reach = Real(kSoftenMax);
  for (int j = -kSoftenReachBlocks; j <= kSoftenReachBlocks; ++j)
    for (int i = -kSoftenReachBlocks; i <= kSoftenReachBlocks; ++i) {
      int right = i < 0 ? -i : i;
      int down = j < 0 ? -j : j;
      int away = kSoftenBlock * (right < down ? down : right);
      // The taps, every fourth pixel, must not lie where the first filter has spread an edge beyond its block.
      float ends_before = float(away - kSoftenBlock) - kSoftenMin;
      reach = min(reach, max(near_penumbra(i, j) * kShare, Real(ends_before)));
    }
  store_soften_reach(max(reach, Real(kSoftenMin)));
}
