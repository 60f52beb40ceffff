// Length: an absolute or relative number. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_CORE_LENGTH_H
#define UMBRAGE_CORE_LENGTH_H

// An absolute length in the unit of its parameter, or (relative != 0) a percentage of the size that the parameter's
// help names.
struct Length {
  float value;
  int relative;
};

#endif
