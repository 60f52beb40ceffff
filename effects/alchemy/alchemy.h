// Parameters and kernel constants of `alchemy`. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_ALCHEMY_H
#define UMBRAGE_EFFECTS_ALCHEMY_H
#include "core/length.h"

// Each field has one row in the parameter table of alchemy.cpp.
struct AlchemyParams {
  int samples;
  int turns;
  Length radius;   // scene units, or percent of the bounding-sphere radius
  int formula;     // 0 alchemy, 1 scalable
  float strength;  // sigma, for lengths in radii
  float contrast;  // the exponent k
  float bias;      // beta, fraction of the depth
  float epsilon;   // in squared radii
};

const int kAlchemyMaxSamples = 256;

struct AlchemyConstants {
  int samples;
  float radius, radius2;  // scene units
  float reach;            // radius in columns at depth 1; at any depth in an orthographic picture
  float rows;             // rows per column width, < 0
  int scalable;           // 0 or 1
  float factor;           // factor of the sum
  float contrast, bias;
  float epsilon;                         // scene units squared
  float points[2 * kAlchemyMaxSamples];  // x, y of each sample in the unit disc
};

#endif
