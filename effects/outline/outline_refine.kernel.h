// The crossings of outline_find joined into smooth lines. A rim is known only to lie between two pixels; where it
// passes follows from how it steps from row to row: the mean of its places in as many rows above as below lies on the
// line, to about one part in the number of rows. So is its side. Sharp creases were found exactly and only get their
// direction.
//
// Crossings of one kind (to the right) make lines that are steeper than 45 degrees, those of the other (below) flat
// ones. A crossing that has no neighbour in the next row on either side is a step of a line of the other kind and is
// dropped where that line is there.
//
// A faint crease stays where it goes on from a clear edge within the same rows.
//
// Planes, for crossings to the right and below: 0, or 1 + 2 level + (t + 1/2) / 2 as in outline_find; and the line's slope, in
// pixels to the right (down) for each row down (column to the right). outline_busy is above 0 where a crossing of the
// same row is near enough that its line may reach this column: outline passes over rows without.
IN_REAL(outline_right)
IN_REAL(outline_below)
OUT_REAL(outline_steep)
OUT_REAL(outline_steep_slope)
OUT_REAL(outline_flat)
OUT_REAL(outline_flat_slope)
OUT_REAL(outline_busy)

CONST int kRows = 3;  // on each side: the place is then known to about a seventh of a pixel
CONST float kSteepest = 1.5f;
CONST float kSteepHere = 1.05f;  // from here on the other kind of crossing knows the line better
CONST float kMiddle = 65.0f;    // side of a line that is nobody's
CONST float kMostTurn = 97.0f;  // of side, as 1 + 2 level: three quarters of the whole range

FN Real crossing_at(int lying, Int X, Int Y) {
  Bool inside = X >= Int(0) && Y >= Int(0) && X < Int(F.width) && Y < Int(F.height);
  if (lying == 0) return select(inside, load_outline_right(X, Y), Real(0.0f));
  return select(inside, load_outline_below(X, Y), Real(0.0f));
}

// t from its code.
FN Real place_of(Real fraction) { return fraction + fraction - 0.5f; }

// The crossing in row `row` (column, for flat lines) at most one pixel beside `offset` that has about the same side:
// its offset; its side as 1 + 2 level, below 0 if it is faint, or 0 if there is none; where it lies.
FN Vec3 follow(int lying, Int px, Int py, int row, Real offset, Bool alive, Real side) {
  Vec3 found = Vec3(offset, Real(0.0f), offset);
  for (int k = 0; k < 3; ++k) {
    Real beside = offset + (k == 0 ? 0.0f : (k == 1 ? 1.0f : -1.0f));
    Int X = lying == 0 ? px + to_int(beside) : px + Int(row);
    Int Y = lying == 0 ? py + Int(row) : py + to_int(beside);
    Real signed_v = crossing_at(lying, X, Y);
    Real v = abs(signed_v);
    Real whole = floor(v);
    // A line does not change from one surface's side to the other's from one row to the next.
    Bool take = alive && v > 0.0f && abs(whole - side) < kMostTurn && found.y == Real(0.0f);
    Real kind = select(signed_v > 0.0f, whole, -whole);
    found = select(take, Vec3(beside, kind, beside + place_of(v - whole)), found);
  }
  return found;
}

FN Vec2 refined(int lying, Int px, Int py, Real signed_v, Real w0, Real w1, Real w2, Real w3) {
  Real v = abs(signed_v);
  Real side = floor(v);
  Real t = place_of(v - side);
  Bool clear = signed_v > 0.0f;
  Bool exact = !(t == Real(0.5f));
  Bool up_alive = v > 0.0f;
  Bool down_alive = v > 0.0f;
  Vec3 up = Vec3(Real(0.0f), Real(0.0f), t);
  Vec3 down = up;
  Real places = Real(0.0f);  // sum over pairs of rows
  Real sides = Real(0.0f);
  Real pairs = Real(0.0f);
  Real moments = Real(0.0f);  // for the slope
  Real squares = Real(0.0f);
  Real one_sided = Real(0.0f);
  Real length = Real(0.0f);  // rows in which the line goes on
  Bool joined = up_alive && !up_alive;
  Bool both = up_alive;
  for (int k = 1; k <= kRows; ++k) {
    up = follow(lying, px, py, -k, up.x, up_alive, side);
    down = follow(lying, px, py, k, down.x, down_alive, side);
    up_alive = abs(up.y) > 0.5f;
    down_alive = abs(down.y) > 0.5f;
    length = length + select(up_alive, Real(1.0f), Real(0.0f)) + select(down_alive, Real(1.0f), Real(0.0f));
    clear = clear || up.y > 0.5f || down.y > 0.5f;
    if (k == 1) {
      joined = up_alive || down_alive;
      one_sided = select(up_alive, t - up.z, select(down_alive, down.z - t, Real(0.0f)));
    }
    // Rows count in pairs, lest the mean be drawn to one side.
    both = both && up_alive && down_alive;
    sides = sides + select(both, abs(up.y) + abs(down.y), Real(0.0f));
    places = places + select(both, up.z + down.z, Real(0.0f));
    pairs = pairs + select(both, Real(1.0f), Real(0.0f));
    moments = moments + select(both, (down.z - up.z) * Real(float(k)), Real(0.0f));
    squares = squares + select(both, Real(float(2 * k * k)), Real(0.0f));
  }
  Real mean = (places + t) / (pairs + pairs + 1.0f);
  Real level = floor(((sides + side) / (pairs + pairs + 1.0f) - 1.0f) * 0.5f + 0.5f);
  Real slope = select(squares > 0.0f, moments / max(squares, Real(1.0f)), one_sided);
  Real place = clamp(select(exact, t, mean), Real(-0.5f), Real(1.499f));
  // A step of a line of the other kind has its next ones a pixel or more aside, and soon none.
  Bool aside = (!joined || abs(slope) > 0.75f) && pairs < 1.5f;
  aside = aside || abs(slope) > kSteepHere;
  Bool step = aside && (abs(w0) + abs(w1) + abs(w2) + abs(w3) > 0.0f);
  Bool speck = side == Real(kMiddle) && length < 1.5f;  // of a crease
  Bool keep = v > 0.0f && clear && !step && !speck;
  return Vec2(select(keep, level + level + 1.0f + (place + 0.5f) * 0.5f, Real(0.0f)),
              select(keep, clamp(slope, Real(-kSteepest), Real(kSteepest)), Real(0.0f)));
}

FN void outline_refine_pixel(Int px, Int py) {
  Real busy = Real(0.0f);
  for (int i = -C.reach; i <= C.reach; ++i)
    busy = max(busy, max(abs(near_outline_right(i, 0)), abs(near_outline_below(i, 0))));
  store_outline_busy(busy);
  Real right = near_outline_right(0, 0);
  Real below = near_outline_below(0, 0);
  Vec2 none = Vec2(Real(0.0f), Real(0.0f));
  Vec2 steep = none;
  Vec2 lower = none;
  if (some(abs(right) > 0.0f))
    steep = refined(0, px, py, right, below, near_outline_below(1, 0), near_outline_below(0, -1),
                    near_outline_below(1, -1));
  if (some(abs(below) > 0.0f))
    lower = refined(1, px, py, below, right, near_outline_right(0, 1), near_outline_right(-1, 0),
                    near_outline_right(-1, 1));
  store_outline_steep(steep.x);
  store_outline_steep_slope(steep.y);
  store_outline_flat(lower.x);
  store_outline_flat_slope(lower.y);
}
