// What leads to ends that outline_tails or outline_strays tells of. The text before has that plane as told_at(x, y)
// and what outline_tail.kernel.h asks for.
#include "effects/outline/outline_tail.kernel.h"

// What leads from a piece, to one side, to an end that is told of.
struct Tail {
  Bool lost;    // it is of what is dropped: a spur, a burr, a hook, a stray or what goes on past a join
  Bool told;    // something of that line is
  Bool passed;  // another line goes on beside and past that end,
  Bool near;    // which is no more than a tail's rows away
  Bool last;    // what follows is lost
  Int rows;     // to that end
};

FN_RARE Tail tail_at(Bool asked, Int px, Int py, Real piece, Bool steep, int side, int most, bool over) {
  Real towards = Real(float(side));
  Along from = Along(asked, place_of(piece), slope_of(piece), px, py, steep, piece, Real(0.0f));
  Followed line = followed(from, px, py, steep, Int(side), towards, most, over);
  Along last = line.last;
  Real told = Real(0.0f);
  if (some(line.ends)) told = select(line.ends, told_at(last.x, last.y), told);
  told = select(last.steep, told - floor(told / kOfFlat) * kOfFlat, floor(told / kOfFlat));
  Bool back = towards_at(last, steep, towards) < 0.0f;
  Real lost = select(back, floor(told / kLostBefore), floor(told / kLostAfter));
  lost = lost - floor(lost / (kMostLost + 1.0f)) * (kMostLost + 1.0f);
  told = told - floor(told / kLostBefore) * kLostBefore;
  Bool before = told == kPassedBefore || told == kPassedBefore + kPassedAfter;
  Bool passed = (back && before) || (!back && told >= kPassedAfter);
  return Tail(to_real(line.rows) < lost, lost > 0.0f, passed, passed && line.rows <= Int(short_tail_rows()),
              lost > 0.0f && to_real(line.rows) == lost, line.rows);
}
