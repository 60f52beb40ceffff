// Depth at a half to a 32nd of the picture's width and height, for taps far away: level l holds at (x, y) one depth for
// 2^l x 2^l pixels. All levels lie in one plane below each other, at its left border. Based on XeGTAO's "prefilter
// depths" [XeGTAO]: of four depths the farthest counts, and what is close to it is averaged, so that thin things do not
// grow.
//
// Differs: four of the block's pixels, symmetrical about its centre, are read at every level. On a plane their mean is
// never nearer than the centre, and so nothing there occludes.
IN_REAL(depth)
OUT_REAL(bitmask_mips)

CONST float kAverageWithin = 0.1f;  // of the radius

FN void bitmask_mips_pixel(Int px, Int py) {
  Int size = Int(2);
  Int row = Int(0);
  int start = 0;
  for (int level = 1; level <= C.mip_levels; ++level) {
    Bool here = py >= Int(start);
    size = select(here, Int(1 << level), size);
    row = select(here, Int(start), row);
    start += C.mip_rows >> (level - 1);
  }
  Bool used = py < Int(start);
  Real left = to_real(px) * to_real(size);
  Real top = to_real(py - row) * to_real(size);
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
  Bool takes = a >= limit;
  sum = sum + select(takes, a, Real(0.0f));
  count = count + select(takes, Real(1.0f), Real(0.0f));
  takes = b >= limit;
  sum = sum + select(takes, b, Real(0.0f));
  count = count + select(takes, Real(1.0f), Real(0.0f));
  takes = c >= limit;
  sum = sum + select(takes, c, Real(0.0f));
  count = count + select(takes, Real(1.0f), Real(0.0f));
  takes = d >= limit;
  sum = sum + select(takes, d, Real(0.0f));
  count = count + select(takes, Real(1.0f), Real(0.0f));
  Real mean = sum / max(count, Real(1.0f));
  store_bitmask_mips(select(used && is_surface(mean), mean, Real(0.0f)));  // 0: no surface
}
