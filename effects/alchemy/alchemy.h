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
  float strength;  // sigma, if lengths are in radii
  float contrast;  // the exponent k
  float bias;      // beta, fraction of the depth
  float epsilon;   // in squared radii
};

const int kAlchemyMaxSamples = 256;

struct AlchemyConstants {
  int samples;
  float radius, radius2;  // scene units
  float radius_px;        // columns, at depth 1; at any depth in an orthographic picture
  float rows_per_column;  // rows in the width of a column, < 0: rows go down
  int scalable;           // 0 or 1
  float factor;           // factor of the sum over samples
  float contrast, bias;
  float epsilon;                         // scene units squared
  float points[2 * kAlchemyMaxSamples];  // x, y of each sample in the unit disc
};

#endif
