// Islets: crumbs of lines that lie together and apart from all others. The text before has object_id, outline_join and
// has_piece_near(i, j).

CONST int kIsletRows = 31;   // of bits: C.islet is 15 at most
CONST int kIsletGap = 2;     // pixels, and
CONST int kIsletSweeps = 3;  // down and up over what is around, to find all of it

LIST_UINT(there, 31)  // of each row the pixels that have pieces, and those of them that are part of the islet
LIST_UINT(part, 31)

// Finds more of row k: what is near its parts and those of the rows around.
FN void grow_row(int k, int gap) {
  int last = 2 * C.islet;
  Uint near = Uint(0u);
  for (int m = k < gap ? 0 : k - gap; m <= (k + gap > last ? last : k + gap); ++m) near = near | kept_part(m);
  Uint wide = near;
  for (int m = 1; m <= gap; ++m) wide = wide | (near << m) | (near >> m);
  keep_part(k, wide & kept_there(k));
}

// Whether this pixel's piece is of an islet: all pieces that lead to it in steps of no more than a gap are less than
// C.islet pixels away, within one object, and joined to nothing farther off.
FN_RARE Bool is_islet(Bool asked) {
  int last = 2 * C.islet;
  int gap = kIsletGap + C.stride;
  for (int k = 0; k <= last; ++k) {
    Uint bits = Uint(0u);
    for (int m = 0; m <= last; ++m)
      bits = bits | select(has_piece_near(m - C.islet, k - C.islet), Uint(1u << m), Uint(0u));
    keep_there(k, bits);
    keep_part(k, Uint(0u));
  }
  keep_part(C.islet, Uint(1u << C.islet));
  Bool islet = asked;
  Uint shores = Uint((1u << last) | 1u);
  for (int sweep = 0; sweep < kIsletSweeps; ++sweep) {
    if (!some(islet)) continue;
    for (int k = 0; k <= last; ++k) grow_row(k, gap);
    for (int k = last; k >= 0; --k) grow_row(k, gap);
    Uint reached = kept_part(0) | kept_part(last);
    for (int k = 0; k <= last; ++k) reached = reached | (kept_part(k) & shores);
    islet = islet && to_signed(reached) == Int(0);
  }
  Real own = near_object_id(0, 0);
  for (int k = 0; k <= last; ++k)
    for (int m = 0; m <= last; ++m) {
      if (!some(islet)) continue;
      int i = m - C.islet;
      int j = k - C.islet;
      Bool here = !(to_signed((kept_part(k) >> m) & Uint(1u)) == Int(0));
      Bool within = near_object_id(i, j) == own && near_object_id(i + 1, j) == own && near_object_id(i, j + 1) == own;
      // It is joined to nothing else.
      Real join = near_outline_join(i, j);
      Vec2 to = joined_apart(join) + Vec2(Real(float(i)), Real(float(j)));
      within = within && !(has_join(bits_of(join)) && max(abs(to.x), abs(to.y)) > Real(float(C.islet)));
      islet = islet && (within || !here);
    }
  return islet;
}
