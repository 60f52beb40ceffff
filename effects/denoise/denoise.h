// Parameters and kernel constants of `denoise`. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_DENOISE_H
#define UMBRAGE_EFFECTS_DENOISE_H

// Each field has one row in the parameter table of denoise.cpp.
struct DenoiseParams {
  int rounds;
  float occlusion, indirect;  // filter strengths, 0 to 1
  float distance;             // pixels
  float angle;                // degrees
  int light_rounds;           // 0: as many as `rounds`
  int for_height;             // picture height that both rounds are meant for, pixels; 0: any
};

struct DenoiseConstants {
  float near_weight, far_weight;  // weight of each neighbour one and two taps away
  float occlusion, indirect;      // 0 to 1
  float distance;                 // pixels
  float turn;                     // 1 / (1 - cos(angle))
  int rounds, light_rounds;
};

#endif
