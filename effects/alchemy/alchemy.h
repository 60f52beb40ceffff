// What a person sets of `alchemy`, and what its kernel reads. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_ALCHEMY_H
#define UMBRAGE_EFFECTS_ALCHEMY_H
#include "core/length.h"

// One row of the table in alchemy.cpp per field.
struct AlchemyParams {
  int samples;
  int turns;
  Length radius;   // scene units or share of the scene's radius
  int formula;     // 0 alchemy, 1 scalable
  float strength;  // sigma, times the radius
  float contrast;  // the power k
  float bias;      // beta: share of the depth
  float epsilon;   // share of the radius's square
};

const int kAlchemyMostSamples = 256;

struct AlchemyConstants {
  int samples;
  float radius, radius2;  // scene units
  float reach;            // columns that the radius is wide at depth 1, or at any in an orthographic picture
  float rows;             // rows that one column's width is, below 0
  int scalable;           // 0 or 1
  float factor;           // of the sum
  float contrast, bias;
  float epsilon;                          // scene units squared
  float points[2 * kAlchemyMostSamples];  // x, y of each sample in the unit disc
};

#endif
