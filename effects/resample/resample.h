// User parameters of `resample` and the constants of its kernels. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_RESAMPLE_H
#define UMBRAGE_EFFECTS_RESAMPLE_H

// One row of the table in resample.cpp per field.
struct ResampleParams {
  int part;            // kResampleMark or kResampleBorrow
  int occlusion;       // what to borrow: kResampleNothing, kResampleAo or kResampleLight
  int hard_shadows;    // bit k is set: mark the borders of the shadow of light k
  int soft_shadows;    // bit k is set: borrow the shadow of light k
  float distance;      // max distance from each other's plane at which pixels fit fully, pixels
  float angle;         // max angle between normals at which pixels fit fully, degrees
  float crease;        // min angle between the normals of neighbours that is marked, degrees
  float albedo;        // min difference of the square roots of albedo or emission that is marked
  float shadow;        // min difference of a hard shadow that is marked
  float right, below;  // offset of this sample from the first, pixels
};

// Values of ResampleParams::part.
const int kResampleMark = 0, kResampleBorrow = 1;
// Values of ResampleParams::occlusion.
const int kResampleNothing = 0, kResampleAo = 1, kResampleLight = 2;

struct ResampleConstants {
  int hard_shadows;                              // as in ResampleParams
  float distance, albedo, shadow, right, below;  // as in ResampleParams
  float turn;                                    // 1 / (1 - cosine of the angle)
  float crease;                                  // 1 - cosine of the crease angle
};

#endif
