// User parameters of `outline` and the constants of its kernels. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_OUTLINE_H
#define UMBRAGE_EFFECTS_OUTLINE_H
#include "core/length.h"

// One row of the table in outline.cpp per field.
struct OutlineParams {
  int mode;            // kOutlineRobust or kOutlinePaper
  Length width;        // pixels, or percent of the picture's height
  float r, g, b;       // colour of the line in the finished picture, linear light
  float opacity;       // 0 to 1
  float depth;         // robust: threshold of a depth discontinuity, in pixel sizes
  float crease_deg;    // robust: min angle between the normals of two faces at which an edge is drawn
  int convex;          // robust: 0 or 1: draw convex edges
  int concave;         // robust: 0 or 1: draw concave edges
  int ids;             // robust: sum of kOutlineObjects and kOutlineMaterials
  float recede;        // robust: 0 to 1, how much thinner lines become with distance
  float inner;         // robust: 0 to 1, how much thinner lines within an object become where the depth step is small
  float paper_depth;   // paper: threshold of window depth, times (1 - depth)
  float paper_normal;  // paper: threshold of the dot product of normals
};

// Values of OutlineParams::mode and ids.
const int kOutlineRobust = 0, kOutlinePaper = 1;
const int kOutlineObjects = 1, kOutlineMaterials = 2;
const float kOutlineMaxWidth = 16.0f;  // pixels

// outline_edges stores an edge between two neighbouring pixels as an integer below 2^21:
//   bits 0-1    kind, higher kinds are more reliable; 0: no edge
//   bits 2-8    strength in units of its threshold, times 31
//   bits 9-15   position between the centres of the pair of pixels that it crosses, 0 to 1, times 127
//   bits 16-20  offset in pixels from this pair of pixels to that pair, plus kOutlineMaxWindow
const int kOutlineCrease = 1, kOutlineDepth = 2, kOutlineId = 3;
const float kOutlineMinStrength = 0.5f;  // weaker edges are ignored
const float kOutlineMaxStrength = 4.0f;
const int kOutlineMaxWindow = 14;  // max half width of the window in which a crease is detected, pixels

struct OutlineConstants {
  float width_px;
  float r, g, b, opacity;
  float depth;         // size of a depth discontinuity of strength 1, in pixel sizes
  float crease_chord;  // distance between unit normals that differ by the crease angle
  int convex, concave;
  int objects, materials;  // 0 or 1
  int max_window;          // max half width of the window in which creases are detected, pixels
  float narrow;            // max width of a narrow window, pixels
  float window_penalty;    // fraction by which a crease's strength is reduced per pixel of its window's half width
  float scale;             // height of the picture / height for which lengths of strokes are given
  float recede;            // 0 to 1: fraction of the max thinning with distance that is applied
  float recede_from;       // depth from which on lines become thinner
  // The line of a discontinuity within one object loses the fraction inner * inner_px / (step + inner_px) of its width,
  // where `step` is the depth step in pixel sizes.
  float inner, inner_px;
  float paper_depth, paper_normal;
  float near_depth, far_depth;  // paper: near and far plane of window depth
};

#endif
