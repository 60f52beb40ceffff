// Length: a number that is absolute or a share. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_CORE_LENGTH_H
#define UMBRAGE_CORE_LENGTH_H

// An absolute length in the unit of its parameter, or (relative != 0) a share of a whole in percent. The parameter's
// help says of what.
struct Length {
  float value;
  int relative;
};

#endif
