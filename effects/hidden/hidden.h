// User parameters of `hidden` and the constants of its host step: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_HIDDEN_H
#define UMBRAGE_EFFECTS_HIDDEN_H
#include "core/length.h"

// One row of the table in hidden.cpp per field.
struct HiddenParams {
  int draw;          // 0 or 1
  Length width;      // of a line: pixels, or percent of the picture's height
  Length dash, gap;  // lengths along a line, likewise
  float depth;       // max distance between two pixels' tangent planes on one surface, pixel sizes
  float crease_deg;  // min angle between the normals of two faces at which there is an edge
  int layers;        // max number of hidden layers whose edges are drawn; 0: all
};

const int kHiddenMaxWindow = 14;  // max half width of a window, pixels

struct HiddenConstants {
  int captured;  // number of layers that follow each other along the rays of the first camera
  int drawn;     // edges of the layers 1 to drawn - 1 are drawn
  float width_px, dash_px, gap_px;
  float depth;         // pixel sizes
  float min_cosine;    // of the crease angle
  float crease_chord;  // distance between unit normals that differ by the crease angle
  int max_window;      // max half width of the window in which a crease is detected, pixels
  float narrow;        // max width of a narrow window, pixels
  float scale;         // height of the picture / height for which lengths in pixels are given
};

#endif
