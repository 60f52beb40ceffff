// User parameters of `hatching` and the constants of its kernels. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_HATCHING_H
#define UMBRAGE_EFFECTS_HATCHING_H
#include "core/length.h"

// Values of HatchingParams::direction, strokes and parts.
const int kHatchingCurvature = 0, kHatchingFixed = 1;
const int kHatchingShade = 0, kHatchingLight = 1;
const int kHatchingAll = 0, kHatchingTone = 1, kHatchingLines = 2;

// One row of the table in hatching.cpp per field.
struct HatchingParams {
  Length spacing;                   // between dense lines: pixels, or percent of the picture's height
  Length width;                     // of a line where not all lines are drawn, likewise
  float exposure;                   // stops; 0: light of 1 leaves the paper blank
  float contrast;                   // exponent of the light as a display shows it
  float material;                   // how much darker the tone of dark materials is
  float cross;                      // ink from which on a second set of lines crosses the first; 1: none
  int direction;                    // kHatchingCurvature or kHatchingFixed
  float tilt_deg;                   // of the fixed direction
  Length smoothness;                // radius over which directions are averaged: pixels, or percent of the height
  int strokes;                      // kHatchingShade: lines draw what is dark; kHatchingLight: what is light
  float paper_r, paper_g, paper_b;  // of the surfaces, display values
  int parts;                        // kHatchingAll; kHatchingTone or -Lines: for averaged pictures
};

struct HatchingConstants {
  float spacing_px, width_px;
  float gain, contrast, material;
  float cross;
  int curvature;                 // 0 or 1: lines follow the max curvature where it is distinct
  float axis_x, axis_y, axis_z;  // fixed direction, unit, view space: lines lie in planes across it
  float curvature_unit;          // curvature that is distinct, times the size of a pixel
  float detail_px;               // radius of curvature of details that are too small for lines of their own
  int thin_px;                   // max length of ways through thin parts
  float inverse_thin;            // 1 / thin_px
  float tap_px;                  // distance between the taps of the filter
  int strokes;
  float paper_r, paper_g, paper_b;  // linear light
};

// Bits of hatching_break: the surface ends between this pixel and the next one to the right, or below.
const int kHatchingBreakRight = 1, kHatchingBreakBelow = 2;

#endif
