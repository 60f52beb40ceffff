// Parameters and kernel constants of `hbao`. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_HBAO_H
#define UMBRAGE_EFFECTS_HBAO_H
#include "core/length.h"

// Each field has one row in the parameter table of hbao.cpp.
struct HbaoParams {
  int directions, steps;
  Length radius;     // scene units, or percent of the bounding-sphere radius
  float angle_bias;  // degrees
  int attenuation;   // 0 or 1
  float strength;
};

struct HbaoConstants {
  int directions, steps;
  float one_over_steps;
  float turn_cos, turn_sin;  // of the angle from one direction to the next
  float turn_fraction;       // that angle as a fraction of a full turn
  float radius, radius2;     // scene units
  float radius_px;           // columns, at depth 1; at any depth in an orthographic picture
  float rows_per_column;     // rows in the width of a column, < 0: rows go down
  float bias_cos, bias_sin;  // of the angle bias
  int attenuation;           // 0 or 1
  float factor;              // factor of the sum over directions
};

#endif
