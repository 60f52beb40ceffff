// Depth at 1/2 to 1/32 of the picture's width and height, for distant taps: a pixel of level l has one depth for
// 2^l x 2^l pixels. All levels are in one plane, one below the other, at its left border. Based on "prefilter depths"
// of [XeGTAO]: those of four depths that are close to the farthest are averaged, so that thin objects do not grow.
//
// Differs: for every level, the four depths are those of full-resolution pixels, symmetrical about the block's centre.
// On a plane their mean is never nearer than the centre, so that a plane does not occlude itself.
IN_REAL(depth)
OUT_REAL(bitmask_mips)

CONST float kAverageWithin = 0.1f;  // in radii

FN void bitmask_mips_pixel(Int px, Int py) {
  Int size = Int(2);
  Int top_row = Int(0);
  int start = 0;
  for (int level = 1; level <= C.mip_levels; ++level) {
    Bool in_level = py >= Int(start);
    size = select(in_level, Int(1 << level), size);
    top_row = select(in_level, Int(start), top_row);
    start += C.mip_rows >> (level - 1);
  }
  Bool used = py < Int(start);
  Real left = to_real(px) * to_real(size);
  Real top = to_real(py - top_row) * to_real(size);
  used = used && left + to_real(size) <= float(F.width) && top + to_real(size) <= float(F.height);
  if (!some(used)) {
    store_bitmask_mips(Real(0.0f));
    return;
  }
  left = select(used, left, Real(0.0f));
  top = select(used, top, Real(0.0f));
  Real near_end = select(used, floor(to_real(size) * 0.25f), Real(0.0f));
  Real far_end = select(used, to_real(size) - 1.0f - near_end, Real(0.0f));
  Real a = read_depth(place_of(left + near_end, top + near_end));
  Real b = read_depth(place_of(left + far_end, top + near_end));
  Real c = read_depth(place_of(left + near_end, top + far_end));
  Real d = read_depth(place_of(left + far_end, top + far_end));
  Real farthest = max(max(a, b), max(c, d));
  Real limit = farthest - Real(C.radius * kAverageWithin);
  Real sum = Real(0.0f);
  Real count = Real(0.0f);
  Bool counts = a >= limit;
  sum = sum + select(counts, a, Real(0.0f));
  count = count + select(counts, Real(1.0f), Real(0.0f));
  counts = b >= limit;
  sum = sum + select(counts, b, Real(0.0f));
  count = count + select(counts, Real(1.0f), Real(0.0f));
  counts = c >= limit;
  sum = sum + select(counts, c, Real(0.0f));
  count = count + select(counts, Real(1.0f), Real(0.0f));
  counts = d >= limit;
  sum = sum + select(counts, d, Real(0.0f));
  count = count + select(counts, Real(1.0f), Real(0.0f));
  Real mean = sum / max(count, Real(1.0f));
  store_bitmask_mips(select(used && is_surface(mean), mean, Real(0.0f)));  // 0: no surface
}
