// What a person sets of `outline`, and what its kernels read. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_OUTLINE_H
#define UMBRAGE_EFFECTS_OUTLINE_H
#include "core/length.h"

// One row of the table in outline.cpp per field.
struct OutlineParams {
  int mode;            // kOutlineRobust, kOutlinePaper
  Length width;        // pixels, or share of the picture's height
  float r, g, b;       // of the line, linear
  float opacity;       // 0 to 1
  float depth;         // robust: a jump is this many pixel sizes behind the surface's plane
  float crease_deg;    // robust: angle between faces from which on an edge is drawn
  int convex;          // robust: 0 or 1
  int concave;         // robust: 0 or 1
  int ids;             // robust: 0 none, 1 objects, 2 materials, 3 both
  float recede;        // robust: 0 to 1, how much lines become thinner with distance
  float inner;         // robust: 0 to 1, how much lines become thinner where an object hardly hides itself
  float paper_depth;   // paper: threshold of window depth, times 1 less the depth
  float paper_normal;  // paper: threshold of the normals' dot product
};

// Values of OutlineParams::mode and ids.
const int kOutlineRobust = 0, kOutlinePaper = 1;
const int kOutlineObjects = 1, kOutlineMaterials = 2;
const float kOutlineWidest = 16.0f;  // pixels
// OutlineConstants::sight of lines of the initial width. Loops of that many steps are written out, which makes them
// twice as fast.
const int kOutlineUsualSight = 4;
const int kOutlineComes = 6;        // pixels aside from which outline_even moves a piece, at most
const int kOutlineStraysNear = 10;  // pixels around, within which outline_strays_near tells whether there are any
const int kOutlineSlitRows = 28;  // rows (columns) within which outline_find asks whether a slit closes, to either side

struct OutlineConstants {
  int mode;
  float width_px;
  int reach;   // pixels from a line's end to the farthest pixel that it touches
  int sight;   // pixels in a row or column that a pixel looks for lines, to either side
  int join;    // pixels between two ends of lines that are joined
  int onward;  // pixels from the end of a crease to a line that it goes on to
  int around;  // pixels in a row or column that a pixel looks for any of these
  int gather;  // pixels to either side of which the passes before tell whether there are any,
  int apart;   // and pixels apart of which that is asked, for all that are around
  float r, g, b, opacity;
  int stride;        // pixels between the normals that creases are told by
  int small;         // pixels in both directions that what stands alone must be larger than
  int islet_cell;    // pixels, in both directions, of the cells in which crumbs are told,
  int islet;         // cells that crumbs within one object must take up in either direction to be drawn,
  int islet_gap;     // and cells between them, up to which they lie together
  int bar;           // pixels from a soft crease to the rims beside it, at most, that have lines in its stead
  int bevel;         // pixels from a wide bevel's crease to the sides that it lies between, at most
  float bevel_step;  // squared share of its turn in a step, at least
  float depth;
  float crease_chord;  // squared distance of unit normals that differ by the crease angle
  int convex, concave;
  int objects, materials;  // 0 or 1
  float recede;            // share, of how much thinner lines can become with distance, that they do,
  float recede_from;       // and depth from which on
  float inner;             // share of its width that the line of a jump within one object loses, half of it where that
  float inner_px;          // is as many pixel sizes
  float paper_depth, paper_normal;
  float near_depth, far_depth;  // paper: of window depth
};

#endif
