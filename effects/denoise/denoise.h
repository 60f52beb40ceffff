// Parameters and kernel constants of `denoise`. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_DENOISE_H
#define UMBRAGE_EFFECTS_DENOISE_H

// Each field has one row in the parameter table of denoise.cpp.
struct DenoiseParams {
  int rounds;
  float occlusion, indirect;  // filter strengths, 0 to 1
  float distance;             // max distance from a neighbour's plane for full weight, pixels
  float angle;                // max angle between normals for full weight, degrees
  int light_rounds;           // 0: as many as `rounds`
  int for_height;             // picture height that `rounds` and `light_rounds` are meant for, pixels; 0: any
};

struct DenoiseConstants {
  float near_weight, far_weight;  // max weights of a neighbour one tap and two taps away
  float occlusion, indirect;      // 0 to 1
  float distance;                 // as in DenoiseParams
  float turn;                     // 1 / (1 - cos(angle))
  int rounds, light_rounds;
};

#endif
