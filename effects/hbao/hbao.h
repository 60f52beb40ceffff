// What a person sets of `hbao`, and what its kernel reads. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_HBAO_H
#define UMBRAGE_EFFECTS_HBAO_H
#include "core/length.h"

// One row of the table in hbao.cpp per field.
struct HbaoParams {
  int directions, steps;
  Length radius;     // scene units or share of the scene's radius
  float angle_bias;  // degrees
  int attenuation;   // 0 or 1
  float strength;
};

struct HbaoConstants {
  int directions, steps;
  float one_over_steps;
  float turn_cos, turn_sin;      // of the angle from one direction to the next
  float turn_share;              // that angle as a share of a whole turn
  float radius, radius2, reach;  // scene units; columns that it is wide at depth 1, or at any without perspective
  float rows;                    // rows that one column's width is, below 0
  float bias_cos, bias_sin;
  int attenuation;  // 0 or 1
  float factor;     // of the sum over directions
};

#endif
