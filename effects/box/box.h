// What a person sets of `box`, and what its kernels read. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_BOX_H
#define UMBRAGE_EFFECTS_BOX_H

// One row of the table in box.cpp per field.
struct BoxParams {
  int size;        // pixels
  int background;  // 0 skip, 1 mix
  int ao;          // 0 or 1
  int indirect;    // 0 or 1
};

struct BoxConstants {
  int first, last;  // offsets of the window's ends from its pixel
  int skip;         // 0 or 1: background is left out
};

#endif
