// Bands: a picture that is too large to be held at once is drawn some rows at a time.
//
// A band's frame holds its own rows and some more above and below, for passes that read their neighbours. Every pass
// says how far it reads, and runs on those rows alone for which it has all that it reads: the band shrinks from pass to
// pass, and what remains is the same to the bit as in a picture that is drawn whole. Passes that read anywhere get
// planes of the whole picture. These are gathered from the bands first: a band ends at such a pass, unfinished, after
// it has given its rows, and is drawn anew, from its capture on, when all bands have given theirs. What a host step
// makes of such planes is whole, too, made by the first band for all.
#pragma once
#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <tuple>

#include "core/image.h"

namespace umbrage {

/// Rows of a picture, from `begin` to before `end`.
struct Rows {
  int begin = 0, end = 0;

  int count() const { return end - begin; }
  bool contains(const Rows& other) const { return begin <= other.begin && other.end <= end; }
  bool operator==(const Rows&) const = default;
};

/// Planes of the whole picture, gathered from its bands.
struct WholePlanes {
  struct Entry {
    Plane plane;
    bool complete = false;  ///< all bands have given their rows, or it was made whole
  };
  /// By the reduction of the picture, the name, and which pass of a frame wrote it, 0 for the capture: names are
  /// written over.
  std::map<std::tuple<int, std::string, int>, Entry> planes;
};

/// How far an effect, or a look, came on a frame. Of a whole picture it is always finished.
struct Progression {
  bool finished = true;
  int missing_rows = 0;  ///< not finished: the margin is too small by so many; 0: other bands have to get here first
};

/// What a frame holds of a picture that is drawn in bands.
struct Band {
  Rows rows;       ///< of the whole picture, its guard band included; the first is a multiple of 4
  int margin = 0;  ///< rows above and below besides, as far as there are any
  std::shared_ptr<WholePlanes> wholes;

  bool operator==(const Band&) const = default;
};

/// The rows that such a frame holds, of a picture of that height. The first is a multiple of 4.
inline Rows held_rows(const Band& band, int height) {
  constexpr int kMultiple = 4;
  return {std::max(0, band.rows.begin - band.margin) / kMultiple * kMultiple,
          std::min(height, band.rows.end + band.margin)};
}

}  // namespace umbrage
