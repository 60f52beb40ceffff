// User parameters of `normals` and the constants of its kernel. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_NORMALS_H
#define UMBRAGE_EFFECTS_NORMALS_H

// One row of the table in normals.cpp per field.
struct NormalsParams {
  int sides;  // 0: the better of the two neighbours, 1: the mean of both
};

struct NormalsConstants {
  int mean;  // 0 or 1
};

#endif
