// Islets: crumbs of lines that lie together and apart from all others. The text before has object_id, outline_join,
// outline_steep_trimmed, outline_flat_trimmed, and told_near(i, j): whether a piece there has an end that is told of.
// All of it is told in cells of C.islet_cell pixels in either direction, from this pixel on.

CONST int kIsletSweeps = 3;  // down and up over what is around, to find all of it

LIST_UINT(there, 31)  // of each row of cells those that have pieces, and those of them that are part of the islet:
LIST_UINT(part, 31)   // islet_window() to either side and this pixel's own

// An islet and a gap beyond: at most 15.
FN int islet_window() { return C.islet + C.islet_gap; }

FN Bool has_piece_near(int i, int j) {
  return has_piece(bits_of(near_outline_steep_trimmed(i, j)) | bits_of(near_outline_flat_trimmed(i, j)));
}

FN Bool has_piece_in_cell(int m, int k) {
  Bool found = has_piece_near(m * C.islet_cell, k * C.islet_cell);
  for (int j = 0; j < C.islet_cell; ++j)
    for (int i = 0; i < C.islet_cell; ++i)
      if (i + j > 0) found = found || has_piece_near(m * C.islet_cell + i, k * C.islet_cell + j);
  return found;
}

// Finds more of row k: what is near its parts and those of the rows around, up to C.islet_gap cells.
FN void grow_row(int k) {
  int gap = C.islet_gap;
  int first = k < gap ? 0 : k - gap;
  int last = k + gap > 2 * islet_window() ? 2 * islet_window() : k + gap;
  Uint near = Uint(0u);
  for (int m = first; m <= last; ++m) near = near | kept_part(m);
  Uint wide = near;
  for (int m = 1; m <= gap; ++m) wide = wide | (near << m) | (near >> m);
  keep_part(k, wide & kept_there(k));
}

FN Bool has_bit(Uint row, int m) { return !(to_signed((row >> m) & Uint(1u)) == Int(0)); }

// Whether this pixel's piece is of an islet: all pieces that lead to it in steps of no more than a gap are
// together less wide and high than C.islet, within one object, and joined to nothing else. Each of them sees the same,
// to a cell, since the window reaches so far and a gap beyond.
FN_RARE Bool is_islet(Bool asked) {
  int window = islet_window();
  int cells = 2 * window + 1;
  for (int k = 0; k < cells; ++k) {
    Uint bits = Uint(0u);
    for (int m = 0; m < cells; ++m)
      bits = bits | select(has_piece_in_cell(m - window, k - window), Uint(1u << m), Uint(0u));
    keep_there(k, bits);
    keep_part(k, Uint(0u));
  }
  keep_part(window, Uint(1u << window));
  for (int sweep = 0; sweep < kIsletSweeps; ++sweep) {
    for (int k = 0; k < cells; ++k) grow_row(k);
    for (int k = cells - 1; k >= 0; --k) grow_row(k);
  }
  // Its extent: rows, and the bits of all of them.
  Uint columns = Uint(0u);
  Real top = Real(float(cells));
  Real bottom = Real(0.0f);
  for (int k = 0; k < cells; ++k) {
    Bool here = !(to_signed(kept_part(k)) == Int(0));
    columns = columns | kept_part(k);
    top = select(here, min(top, Real(float(k))), top);
    bottom = select(here, Real(float(k)), bottom);
  }
  Real left = Real(float(cells));
  Real right = Real(0.0f);
  for (int m = 0; m < cells; ++m) {
    Bool here = has_bit(columns, m);
    left = select(here, min(left, Real(float(m))), left);
    right = select(here, Real(float(m)), right);
  }
  Real most = Real(float(C.islet));
  Bool islet = asked && right - left < most && bottom - top < most;
  Bool told = asked && !asked;
  Real own = near_object_id(0, 0);
  int size = C.islet_cell;
  Real scale = Real(1.0f / float(size));
  for (int k = 0; k < cells * size; ++k)
    for (int m = 0; m < cells * size; ++m) {
      if (!some(islet)) continue;
      int i = m - window * size;
      int j = k - window * size;
      Bool here = has_bit(kept_part(k / size), m / size);
      told = told || (here && told_near(i, j));
      Bool within = near_object_id(i, j) == own && near_object_id(i + 1, j) == own && near_object_id(i, j + 1) == own;
      // What joins one of its parts ends at another one, and what joins another line does not.
      Real join = near_outline_join(i, j);
      Vec2 to = (joined_apart(join) + Vec2(Real(float(m) + 0.5f), Real(float(k) + 0.5f))) * scale;
      Bool leads = to.x >= left && to.x <= right + 1.0f && to.y >= top && to.y <= bottom + 1.0f;
      Bool joins = has_join(bits_of(join)) && !same(here, leads);
      islet = islet && (within || !here) && !joins;
    }
  return islet && told;
}
