// User parameters of `unsharp` and the constants of its kernels. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_UNSHARP_H
#define UMBRAGE_EFFECTS_UNSHARP_H
#include "core/length.h"

// One row of the table in unsharp.cpp per field.
struct UnsharpParams {
  Length kernel;    // side of the window, pixels or percent of the picture's height
  float threshold;  // min difference of linearised depth at which a sample does not count; 0: all samples count
  int border;       // kUnsharpBorder...
  float strength;
  int linearization;            // kUnsharpLinear, kUnsharpListing or kUnsharpExtent
  float near_depth, far_depth;  // scene units; 0: automatic
  int background;               // 0: on the far plane, 1: ignored
  int white_edge;               // 0 or 1: keep values of `ao` above 1
  int window;                   // 0: box, 1: Gaussian
};

const float kUnsharpSteps = 16777216.0f;  // 2^24: steps of quantised depth from 0 to 1, all exact as floats
// Values of UnsharpParams::border and linearization.
const int kUnsharpBorderSkip = 0, kUnsharpBorderZero = 1, kUnsharpBorderClamp = 2, kUnsharpBorderRepeat = 3;
const int kUnsharpLinear = 0, kUnsharpListing = 1, kUnsharpExtent = 2;
const int kUnsharpMaxKernel = 1023;
const int kUnsharpWeights = 512;  // a window of 1023 extends 511 pixels from its centre

struct UnsharpConstants {
  int first_column, last_column;  // the window, relative to its pixel, inclusive
  int first_row, last_row;
  int border;         // as in UnsharpParams
  int gaussian;       // 1: the sample at offset (i, j) has the weight weights[|i|] * weights[|j|]; 0: all weights are 1
  int linearization;  // as in UnsharpParams
  int ignore_background;  // 0 or 1
  int keep_white_edge;    // 0 or 1
  float near_depth, far_depth;
  float threshold;     // in steps of quantised depth; above any difference if all samples count
  float border_depth;  // border mode zero: quantised depth of samples outside the picture
  float scale;         // strength / kUnsharpSteps
  float weights[kUnsharpWeights];
};

#endif
