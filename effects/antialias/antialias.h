// Parameters and kernel constants of `antialias`. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_ANTIALIAS_H
#define UMBRAGE_EFFECTS_ANTIALIAS_H

// Each field has one row in the parameter table of antialias.cpp.
struct AntialiasParams {
  float threshold;  // of the difference of a channel, in values of the picture
  int search;       // pixels; 0: off
  int beauty;       // 0 or 1: also smooth `beauty`
};

struct AntialiasConstants {
  float threshold;
  int search;
};

#endif
