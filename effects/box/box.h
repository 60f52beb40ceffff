// Parameters and kernel constants of `box`. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_BOX_H
#define UMBRAGE_EFFECTS_BOX_H

// Each field has one row in the parameter table of box.cpp.
struct BoxParams {
  int size;        // side of the window, pixels
  int background;  // 0 skip, 1 mix
  int ao;          // 0 or 1: blur `ao`
  int indirect;    // 0 or 1: blur `indirect`
};

struct BoxConstants {
  int first, last;  // offsets from a pixel to the first and last pixel of its window, in rows and in columns
  int skip;         // 0 or 1: background pixels are left out
};

#endif
