// Lines seen over a longer way: how sure each piece of line is, and where it passes. A bevel or a fold is clear in some
// rows and faint in others, as pixels fall on it, so what decides is how much of the line is clear, before and after. A
// line that fades tapers, as a pen's does, and a row of dashes becomes one thin line or none.
//
// From each piece the line is followed in hops, each from where the one before arrived and in the direction that the
// line has there. A rim that leans little, whose place steps once in many rows, is straightened by the same way.
//
// Planes: those of outline_refine, with how sure a line is: kSureSteps for what is to be drawn whole, 0 for nothing.
IN_REAL(outline_steep)
IN_REAL(outline_steep_lean)
IN_REAL(outline_flat)
IN_REAL(outline_flat_lean)
OUT_REAL(outline_steep_linked)
OUT_REAL(outline_steep_linked_lean)
OUT_REAL(outline_flat_linked)
OUT_REAL(outline_flat_linked_lean)

CONST int kHop = 7;                 // rows: a piece of outline_refine knows three to either side; the first is three
CONST int kHops = 4;                // to either side
CONST float kAstray = 1.1f;         // pixels beside where it is expected, at which a piece is another line's
CONST float kMostTurn = 97.0f;      // of side, as 1 + 2 level
CONST float kMostTurnFaint = 9.0f;  // from a rim to a crease, if either is faint
CONST float kDiagonal = 0.8f;       // slope from which on a line is made of pieces of both kinds
CONST float kMiddle = 65.0f;        // side of a crease
CONST float kLeastPieces = 3.0f;    // of a crease that is drawn whole; with one it is a speck
CONST float kStraight = 1.05f;      // pixels of bend: what the steps of a straight rim may look like
CONST float kLeastClear = 0.42f;    // share of a line that is clear, below which it is not drawn,
CONST float kWholeClear = 0.75f;    // and from which on it is drawn whole
CONST float kSureSteps = 15.0f;
CONST float kSpeck = 16.0f;
CONST float kWholeSide = 64.0f;  // from the middle
CONST float kUpright = 0.99f;    // cosine of the lean: seven rows to a step
CONST float kClear = 7.0f;       // half of it
CONST float kSides = 256.0f;     // more than any side, 1 + 2 level
CONST float kOnlyEnds = 0.5f;    // as in outline_refine
CONST float kSteepest = 1.5f;

// What outline_refine says of a piece: the cosine of its lean, whether it is a crease too short to be trusted, and how
// clear it is.
FN Real steps_of(Real lean) { return floor(abs(lean) * 0.5f); }
FN Real cosine_of(Real lean) { return abs(lean) - (steps_of(lean) + steps_of(lean)); }
FN Bool maybe_speck(Real lean) { return steps_of(lean) > kSureSteps; }
FN Real sure_of(Real lean) {
  Real steps = steps_of(lean);
  return select(steps > kSureSteps, steps - Real(kSpeck), steps);
}
FN Real slope_of(Real lean) {
  Real cosine = max(cosine_of(lean), Real(0.1f));
  Real slope = sqrt(max(mad(-cosine, cosine, Real(1.0f)), Real(0.0f))) / cosine;
  return select(lean < 0.0f, -slope, slope);
}

// A piece in row `row`, `rows` after the one before: where it lies beside the first, its slope, and of two that are
// packed into one, how much of it is clear and its side: kSides times the former and the latter; below 0 for none.
FN Vec3 hop(int lying, Int px, Int py, int row, int rows, Vec3 from, Real side) {
  Real slope = from.y;
  Real expected = mad(slope, Real(float(rows)), from.x);
  Real first = floor(expected);
  Bool crease = side == Real(kMiddle);
  Bool alive = from.z >= 0.0f;
  Vec3 best = Vec3(expected, slope, Real(-1.0f));
  Real nearest = Real(kAstray);
  Real beside = select(expected - first < 0.5f, Real(-1.0f), Real(1.0f));
  for (int k = 0; k <= 1; ++k) {
    Int column = to_int(k == 0 ? first : first + beside);
    Int X = lying == 0 ? px + column : px + Int(row);
    Int Y = lying == 0 ? py + Int(row) : py + column;
    Bool here = alive && X >= Int(0) && X < Int(F.width) && Y >= Int(0) && Y < Int(F.height);
    if (!some(here)) continue;
    Real v = abs(lying == 0 ? load_outline_steep(X, Y) : load_outline_flat(X, Y));
    Real other = floor(v);
    here = here && v >= 1.0f && abs(other - side) < kMostTurn;
    if (!some(here)) continue;
    Real lean = lying == 0 ? load_outline_steep_lean(X, Y) : load_outline_flat_lean(X, Y);
    Real fraction = v - floor(v);
    Real place = to_real(column) + (fraction + fraction - 0.5f);
    Real away = abs(place - expected);
    Bool mixed = crease || other == Real(kMiddle);
    Bool clear = sure_of(lean) > kClear && from.z >= kSides * kClear;
    here = here && (!mixed || clear || abs(other - side) < kMostTurnFaint) && away < nearest;
    nearest = select(here, away, nearest);
    best =
        select(here, Vec3(place, slope_of(lean), mad(sure_of(lean), Real(kSides), select(mixed, side, other))), best);
  }
  return best;
}

// The piece of line at this pixel as its way on either side shows it: code and lean.
FN Vec2 linked(int lying, Int px, Int py, Real code, Real lean) {
  Real v = abs(code);
  Bool drawn = v >= 1.0f;
  Real side = floor(v);
  Real place = (v - side) + (v - side) - 0.5f;
  Vec3 up = Vec3(place, slope_of(lean), select(drawn, mad(sure_of(lean), Real(kSides), side), Real(-1.0f)));
  Vec3 down = up;
  Real slope = up.y;
  Real clear = sure_of(lean);
  Real sides = side;
  Real pieces = Real(1.0f);
  Real pairs = Real(0.0f);
  Real places = Real(0.0f);
  Real moments = Real(0.0f);
  Real squares = Real(0.0f);
  Bool straight = drawn;
  for (int k = 1; k <= kHops; ++k) {
    if (!some(up.z >= 0.0f || down.z >= 0.0f)) continue;
    int row = 3 + (k - 1) * kHop;
    int rows = k == 1 ? row : kHop;
    up = hop(lying, px, py, -row, -rows, up, side);
    down = hop(lying, px, py, row, rows, down, side);
    Real up_sure = floor(max(up.z, Real(0.0f)) * Real(1.0f / kSides));
    Real down_sure = floor(max(down.z, Real(0.0f)) * Real(1.0f / kSides));
    clear = clear + up_sure + down_sure;
    sides = sides + max(mad(up_sure, Real(-kSides), up.z), Real(0.0f)) +
            max(mad(down_sure, Real(-kSides), down.z), Real(0.0f));
    pieces = pieces + select(up.z >= 0.0f, Real(1.0f), Real(0.0f)) + select(down.z >= 0.0f, Real(1.0f), Real(0.0f));
    straight = straight && up.z >= 0.0f && down.z >= 0.0f && abs(up.x + down.x - place - place) < kStraight;
    Real counts = select(straight, Real(1.0f), Real(0.0f));
    pairs = pairs + counts;
    places = mad(counts, up.x + down.x, places);
    moments = mad(counts, (down.x - up.x) * Real(float(row)), moments);
    squares = squares + counts * Real(float(2 * row * row));
  }
  Real mean = (places + place) / (pairs + pairs + 1.0f);
  mean = clamp(mean, Real(-0.5f), Real(1.499f));
  slope = select(pairs > 0.5f, moments / max(squares, Real(1.0f)), slope);
  slope = clamp(slope, Real(-kSteepest), Real(kSteepest));
  Real share = clear / (pieces * kSureSteps);
  share = clamp((share - kLeastClear) * Real(1.0f / (kWholeClear - kLeastClear)), Real(0.0f), Real(1.0f));
  Real support = clamp((pieces - 1.0f) * Real(1.0f / (kLeastPieces - 1.0f)), Real(0.0f), Real(1.0f));
  share = select(maybe_speck(lean) && abs(slope) < kDiagonal, share * support, share);
  Real sure = floor(share * kSureSteps + 0.5f);
  Bool keep = drawn && sure > 0.5f;
  Real cosine = Real(1.0f) / sqrt(mad(slope, slope, Real(1.0f)));
  Real level = floor((sides / pieces - 1.0f) * 0.5f + 0.5f);
  Real found = level + level + 1.0f + (mean + 0.5f) * 0.5f;
  found = select(code < 0.0f, -found, found);
  Real leaning = cosine + sure + sure;
  return Vec2(select(keep, found, select(v > 0.0f, Real(kOnlyEnds), Real(0.0f))),
              select(keep, select(slope < 0.0f, -leaning, leaning), Real(0.0f)));
}

// Whether a piece of line cannot be told from itself: it is not wholly clear, or lies partly on either side, or is so
// nearly upright that its steps are far apart.
FN Bool unsure(Real code, Real lean) {
  Real side = floor(abs(code));
  Bool aside = abs(abs(side - kMiddle) - kWholeSide * 0.5f) < kWholeSide * 0.5f - 1.0f;
  return abs(code) >= 1.0f && (aside || maybe_speck(lean) || sure_of(lean) < kSureSteps || cosine_of(lean) > kUpright);
}

FN void outline_link_pixel(Int px, Int py) {
  Real code = near_outline_steep(0, 0);
  Real lean = near_outline_steep_lean(0, 0);
  Vec2 steep = Vec2(code, lean);
  Bool look = unsure(code, lean);
  if (some(look)) {
    Vec2 longer = linked(0, px, py, select(look, code, Real(0.0f)), lean);
    steep = Vec2(select(look, longer.x, code), select(look, longer.y, lean));
  }
  store_outline_steep_linked(steep.x);
  store_outline_steep_linked_lean(steep.y);
  code = near_outline_flat(0, 0);
  lean = near_outline_flat_lean(0, 0);
  Vec2 lower = Vec2(code, lean);
  look = unsure(code, lean);
  if (some(look)) {
    Vec2 longer = linked(1, px, py, select(look, code, Real(0.0f)), lean);
    lower = Vec2(select(look, longer.x, code), select(look, longer.y, lean));
  }
  store_outline_flat_linked(lower.x);
  store_outline_flat_linked_lean(lower.y);
}
