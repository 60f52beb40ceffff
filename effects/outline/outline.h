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

struct OutlineConstants {
  float r, g, b, opacity;
  float paper_depth, paper_normal;
  float near_depth, far_depth;  // paper: of window depth
};

#endif
