// User parameters of `relight` and the constants of its kernel. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_RELIGHT_H
#define UMBRAGE_EFFECTS_RELIGHT_H

// Values of RelightParams::source.
const int kRelightEstimate = 0, kRelightPlanes = 1;

// One row of the table in relight.cpp per field.
struct RelightParams {
  int source;        // one of kRelight...: where the ambient part of the light is from
  float fraction;    // estimate: fraction of dark reflected light that is ambient, 0 to 1
  float highlights;  // estimate: luminance at which half of that fraction is ambient; 0: off
};

struct RelightConstants {
  int source;
  float fraction;
  float one_over_highlights;  // 0: off
};

#endif
