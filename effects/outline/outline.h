// What a person sets of `outline`, and what its kernels read. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_OUTLINE_H
#define UMBRAGE_EFFECTS_OUTLINE_H
#include "core/length.h"

// One row of the table in outline.cpp per field.
struct OutlineParams {
  int mode;            // kOutlineRobust, kOutlinePaper
  Length width;        // pixels, or share of the picture's height
  float r, g, b;       // of the line, linear light of the finished picture
  float opacity;       // 0 to 1
  float depth;         // robust: a depth discontinuity is this many pixel sizes
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

// Edges between neighbouring pixels are whole numbers below 2^21, as outline_edges stores them:
//   bits 0-1    kind, the higher the surer, or 0 where there is none
//   bits 2-8    strength, in units of its threshold, times 31
//   bits 9-15   place, from the one pixel's centre to the other's, times 127
//   bits 16-20  how many pairs from this one to the one that it lies in, plus kOutlineMaxWindow
const int kOutlineCrease = 1, kOutlineDepth = 2, kOutlineId = 3;
const float kOutlineMinStrength = 0.5f;  // what is less is no edge
const float kOutlineMaxStrength = 4.0f;
const int kOutlineMaxWindow = 14;  // pixels, half a crease's widest window

struct OutlineConstants {
  float width_px;
  float r, g, b, opacity;
  float depth;         // pixel sizes of a depth discontinuity of strength 1
  float crease_chord;  // distance of unit normals that differ by the crease angle
  int convex, concave;
  int objects, materials;  // 0 or 1
  int max_window;          // pixels, half the widest window in which a crease is told
  float narrow;            // pixels, width of a window up to which it counts as narrow
  float coarser;           // by how much a crease counts less per pixel that half its window is wider
  float scale;             // the picture's height in units of the one that lengths in pixels are for
  float recede;            // share, of how much thinner lines can become with distance, that they do,
  float recede_from;       // and depth from which on
  float inner;             // share of its width that the line of a discontinuity within one object loses, half of it
  float inner_px;          // where that is as many pixel sizes
  float paper_depth, paper_normal;
  float near_depth, far_depth;  // paper: of window depth
};

#endif
