// User parameters of `upsample` and the constants of its kernels. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_UPSAMPLE_H
#define UMBRAGE_EFFECTS_UPSAMPLE_H

// One row of the table in upsample.cpp per field.
struct UpsampleParams {
  int factor;      // kUpsampleHalf, kUpsampleQuarter
  int indirect;    // 0 or 1
  int leave;       // 0 or 1: leave pixels that no other fits to the technique
  float distance;  // pixels
  float angle;     // degrees
};

// Values of UpsampleParams::factor.
const int kUpsampleHalf = 0, kUpsampleQuarter = 1;

struct UpsampleConstants {
  int factor;      // 2 or 4
  int leave;       // 0 or 1
  float distance;  // pixels
  float turn;      // 1 / (1 - cosine of the angle)
};

#endif
