// User parameters of `outline` and the constants of its kernels. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_OUTLINE_H
#define UMBRAGE_EFFECTS_OUTLINE_H
#include "core/length.h"

// One row of the table in outline.cpp per field.
struct OutlineParams {
  int mode;            // kOutlineRobust, kOutlinePaper
  Length width;        // pixels, or percent of the picture's height
  float r, g, b;       // colour of the line, linear light of the finished picture
  float opacity;       // 0 to 1
  float depth;         // robust: threshold of a depth discontinuity, in pixel sizes
  float crease_deg;    // robust: minimum angle between faces at which an edge is drawn
  int convex;          // robust: 0 or 1
  int concave;         // robust: 0 or 1
  int ids;             // robust: 0 none, 1 objects, 2 materials, 3 both
  float recede;        // robust: 0 to 1, how much thinner lines become with distance
  float inner;         // robust: 0 to 1, how much thinner lines within an object are where its depth step is small
  float paper_depth;   // paper: threshold of window depth, times (1 - depth)
  float paper_normal;  // paper: threshold of the dot product of normals
};

// Values of OutlineParams::mode and ids.
const int kOutlineRobust = 0, kOutlinePaper = 1;
const int kOutlineObjects = 1, kOutlineMaterials = 2;
const float kOutlineMaxWidth = 16.0f;  // pixels

// Edges between neighbouring pixels are integers below 2^21, as outline_edges stores them:
//   bits 0-1    kind, the higher the more reliable; 0: no edge
//   bits 2-8    strength, in units of its threshold, times 31
//   bits 9-15   position between the centres of the two pixels, 0 to 1, times 127
//   bits 16-20  offset in pixels from this pair to the pair that the edge is in, plus kOutlineMaxWindow
const int kOutlineCrease = 1, kOutlineDepth = 2, kOutlineId = 3;
const float kOutlineMinStrength = 0.5f;  // weaker ones are no edges
const float kOutlineMaxStrength = 4.0f;
const int kOutlineMaxWindow = 14;  // pixels, half of a crease's max window

struct OutlineConstants {
  float width_px;
  float r, g, b, opacity;
  float depth;         // pixel sizes of a depth discontinuity of strength 1
  float crease_chord;  // distance between unit normals that differ by the crease angle
  int convex, concave;
  int objects, materials;  // 0 or 1
  int max_window;          // pixels, half of the max window in which creases are detected
  float narrow;            // pixels, max width of a window that counts as narrow
  float coarser;           // fraction by which a crease's strength falls per pixel of half its window
  float scale;             // the picture's height, relative to the height for which lengths in pixels are given
  float recede;            // 0 to 1: fraction of the max thinning with distance that is applied
  float recede_from;       // depth from which on lines become thinner
  float inner;             // fraction of its width that the line of a discontinuity within one object loses, half of it
  float inner_px;          // where the depth step is this many pixel sizes
  float paper_depth, paper_normal;
  float near_depth, far_depth;  // paper: planes of window depth
};

#endif
