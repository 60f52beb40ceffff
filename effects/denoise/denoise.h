// What a person sets of `denoise`, and what its kernels read. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_DENOISE_H
#define UMBRAGE_EFFECTS_DENOISE_H

// One row of the table in denoise.cpp per field.
struct DenoiseParams {
  int rounds;
  float occlusion, indirect;  // shares that are filtered
  float distance;             // pixels
  float angle;                // degrees
  int light_rounds;           // 0: as many as `rounds`
  int for_height;             // pixels: of the picture that both are meant for; 0: of any
};

struct DenoiseConstants {
  float near_weight, far_weight;  // of each of the two neighbours one and two steps off
  float occlusion, indirect;      // 0 to 1
  float distance;                 // pixels
  float turn;                     // 1 / (1 - cosine of the angle)
  int rounds, light_rounds;
};

#endif
