// Parameters and kernel constants of `gaussian`. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_GAUSSIAN_H
#define UMBRAGE_EFFECTS_GAUSSIAN_H

// Each field has one row in the parameter table of gaussian.cpp.
struct GaussianParams {
  int rounds;
  int edges;  // 0 or 1: blur along each surface only
};

struct GaussianConstants {
  float side;  // weight of each of the two neighbours: 1/4, or 0 if `rounds` is 0
  int edges;   // 0 or 1
};

#endif
