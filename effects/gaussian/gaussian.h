// What a person sets of `gaussian`, and what its kernels read. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_GAUSSIAN_H
#define UMBRAGE_EFFECTS_GAUSSIAN_H

// One row of the table in gaussian.cpp per field.
struct GaussianParams {
  int rounds;
  int edges;  // 0 or 1
};

struct GaussianConstants {
  float side;  // weight of each of two neighbours, 1/4; 0 where no round was asked for
  int edges;   // 0 or 1
};

#endif
