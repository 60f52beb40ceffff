// User parameters of `upsample` and the constants of its kernels. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_UPSAMPLE_H
#define UMBRAGE_EFFECTS_UPSAMPLE_H

// One row of the table in upsample.cpp per field.
struct UpsampleParams {
  int factor;      // kUpsampleHalf or kUpsampleQuarter
  int indirect;    // 0 or 1: upsample indirect light too
  int leave;       // 0 or 1: let the technique compute pixels that too few reduced pixels fit
  float distance;  // max distance from each other's plane at which pixels fit fully, pixels
  float angle;     // max angle between normals at which pixels fit fully, degrees
};

// Values of UpsampleParams::factor.
const int kUpsampleHalf = 0, kUpsampleQuarter = 1;

struct UpsampleConstants {
  int factor;      // 2 or 4
  int leave;       // as in UpsampleParams
  float distance;  // as in UpsampleParams
  float turn;      // 1 / (1 - cosine of the angle)
};

#endif
