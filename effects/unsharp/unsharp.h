// User parameters of `unsharp` and the constants of its kernels. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_UNSHARP_H
#define UMBRAGE_EFFECTS_UNSHARP_H
#include "core/length.h"

// One row of the table in unsharp.cpp per field.
struct UnsharpParams {
  Length kernel;    // side of the window, pixels or percent of the picture's height
  float threshold;  // max difference of linearised depth; 0: none
  int border;       // kUnsharpBorder...
  float strength;
  int linearization;            // kUnsharpLinear, kUnsharpListing, kUnsharpExtent
  float near_depth, far_depth;  // scene units; 0: automatic
  int background;               // 0 far plane, 1 ignored
  int white_edge;               // 0 or 1
  int window;                   // 0 box, 1 gaussian
};

const float kUnsharpSteps = 16777216.0f;  // 2^24: depth is an integer number of steps, all of which a float represents
// Values of UnsharpParams::border and linearization.
const int kUnsharpBorderSkip = 0, kUnsharpBorderZero = 1, kUnsharpBorderClamp = 2, kUnsharpBorderRepeat = 3;
const int kUnsharpLinear = 0, kUnsharpListing = 1, kUnsharpExtent = 2;
const int kUnsharpMaxKernel = 1023;
const int kUnsharpWeights = 512;  // a window of 1023 reaches 511 pixels from its centre

struct UnsharpConstants {
  int first_column, last_column;  // the window, in pixels relative to its pixel; inclusive
  int first_row, last_row;
  int border;             // as in UnsharpParams
  int gaussian;           // 0 or 1: samples have the weight weights[|i|] * weights[|j|]
  int linearization;      // as in UnsharpParams
  int ignore_background;  // 0 or 1
  int keep_white_edge;    // 0 or 1
  float near_depth, far_depth;
  float threshold;     // of quantised depth; greater than any difference if there is none
  float border_depth;  // quantised depth of a sample outside, in border mode zero
  float scale;         // strength divided by the number of steps
  float weights[kUnsharpWeights];
};

#endif
