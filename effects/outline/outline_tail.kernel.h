// What the passes that tell what is to be dropped and those that drop it know of it: see outline_tails. Places are
// those of crossings, so that what is a tail does not depend on the line's width. The text before has steep_at(x, y)
// and flat_at(x, y), as outline_end.kernel.h asks.
#include "effects/outline/outline_end.kernel.h"

CONST int kTail = 6;                // rows, per pixel of stride, of a tail,
CONST int kTailMore = 4;            // and more, of what is between two,
CONST int kMostTail = 16;           // and at most
CONST float kSpurRows = 1.5f;       // rows, per pixel of stride, between the ends of a spur,
CONST int kLongSpurRows = 2;        // rows, per pixel of stride, of one that is within one object and leads nowhere,
CONST int kLongSpurMore = 2;        // and more
CONST int kLeastStray = 4;          // rows beyond which what leads nowhere may be a stray,
CONST int kStrayRows = 2;           // and up to which: times those of what is between two tails, less these, lest its
CONST int kStrayLess = 2;           // middle, where it leans, be too far from both ends where those are kMostTail
CONST int kLongStray = 7;           // times C.bevel, half of it: rows of a stray that nothing is joined to
CONST int kBurrRows = 2;            // rows, per pixel of stride, of a burr,
CONST int kBurrMore = 4;            // and more
CONST float kWhole = 12.5f;         // sure_of from which on a line is not faint
CONST float kAlongside = 2.0f;      // pixels beside a line, per pixel of stride,
CONST float kAlongsideMore = 1.4f;  // and more, up to which another one runs along
CONST float kOther = 0.9f;          // and from which on, or else it is the same

// outline_tails, outline_strays: 0, or the sum of these, of ends of this pixel's steep piece; times kOfFlat of its flat
// one.
CONST float kPassedBefore = 1.0f;  // the line ends above (to the left), and is a tail
CONST float kPassedAfter = 2.0f;   // below (to the right)
CONST float kLostBefore = 4.0f;    // times how many rows are to be dropped of the line that ends above, and
CONST float kLostAfter = 128.0f;   // below:
CONST float kMostLost = 31.0f;     // so many at most
CONST float kOfFlat = 4096.0f;

// Whether one line can stand for another: what may be dropped for being faint does not stand for what is sure.
FN Bool stands_for(Real piece, Real other) {
  Real sure = sure_of(piece);
  return sure > kWhole || sure >= sure_of(other);
}

FN float alongside() { return kAlongside * float(C.stride) + kAlongsideMore; }
FN int short_tail_rows() { return C.stride * kTail < kMostTail ? C.stride * kTail : kMostTail; }
FN int tail_rows() { return short_tail_rows() + kTailMore < kMostTail ? short_tail_rows() + kTailMore : kMostTail; }
FN int short_spur_rows() { return int(kSpurRows * float(C.stride)); }
FN int burr_rows() {
  return C.stride * kBurrRows + kBurrMore < kMostTail ? C.stride * kBurrRows + kBurrMore : kMostTail - 1;
}
FN int stray_rows() { return kStrayRows * tail_rows() - (tail_rows() < kMostTail ? 0 : kStrayLess); }
FN int long_stray_rows() {
  int most = 2 * int(kMostLost) - 1;  // both ends tell of all
  int rows = kLongStray * C.bevel / 2 < most ? kLongStray * C.bevel / 2 : most;
  return rows > stray_rows() ? rows : stray_rows();
}
FN int spur_rows() { return C.stride * kLongSpurRows + kLongSpurMore; }

// The way on from the last place along a line that began in a piece of a kind: 1 if it would go on in the next row
// (column) of its last piece's kind, -1 in the one before.
FN Real towards_at(Along last, Bool steep, Real towards) {
  return select(same(last.steep, steep), towards, select(last.slope * towards < 0.0f, Real(-1.0f), Real(1.0f)));
}
