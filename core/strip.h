// Strips: a picture that is too large for memory is drawn in strips of full-width rows, one after the other.
//
// The frame of a strip contains the rows of the strip, and a margin above and below for dispatches that read
// neighbours. Each dispatch states how many rows it reads above and below a pixel, and runs only on rows for which all
// its inputs are valid: the valid rows shrink from dispatch to dispatch. The margin must be large enough that the rows
// of the strip remain: see needs_of_strips in program/program.h. The result is bitwise identical to that of a picture
// drawn whole.
//
// A dispatch that reads any row gets planes of the whole picture, which are gathered from the strips first: each strip
// adds its rows and stops before this dispatch, unfinished. Once all strips have added their rows, each strip is drawn
// again, starting with its capture. The outputs of a host step are planes of the whole picture too; the first strip
// computes them for all strips.
#pragma once
#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <tuple>

#include "core/image.h"

namespace umbrage {

/// Rows of a picture: [begin, end).
struct Rows {
  int begin = 0, end = 0;

  int count() const { return end - begin; }
  bool contains(const Rows& other) const { return begin <= other.begin && other.end <= end; }
  bool operator==(const Rows&) const = default;
};

/// Planes of the whole picture, gathered from its strips.
struct WholePlanes {
  struct Entry {
    Plane plane;
    bool complete = false;  ///< all strips have added their rows, or a host step wrote it
  };
  /// Key: downsampling factor of the picture, plane name, version. The version is the number of the dispatch of the
  /// frame that wrote the plane, 0 for the capture: later dispatches may write another plane of the same name.
  std::map<std::tuple<int, std::string, int>, Entry> planes;
};

/// How far an effect, or a look, got on a frame. On a frame of a whole picture it is always finished; on a strip other
/// strips may have to run first.
struct RunState {
  bool finished = true;
};

/// The part of a picture in the frame of a strip.
struct Strip {
  Rows rows;       ///< rows of the strip in the picture, guard band included; begin is a multiple of 4
  int margin = 0;  ///< further rows above and below, cropped to the picture
  std::shared_ptr<WholePlanes> wholes;

  bool operator==(const Strip&) const = default;
};

/// Returns the rows that the frame of a strip contains, margin included. The first one is a multiple of 4. `height`:
/// height of the picture.
inline Rows rows_with_margin(const Strip& strip, int height) {
  constexpr int kMultiple = 4;
  return {std::max(0, strip.rows.begin - strip.margin) / kMultiple * kMultiple,
          std::min(height, strip.rows.end + strip.margin)};
}

}  // namespace umbrage
