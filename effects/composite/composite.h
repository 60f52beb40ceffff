// What a person sets of `composite`, and what its kernel reads. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_COMPOSITE_H
#define UMBRAGE_EFFECTS_COMPOSITE_H

// One row of the table in composite.cpp per field.
struct CompositeParams {
  int mode;                          // 0 ambient, 1 subtract, 2 multiply, 3 modulate, 4 occlusion, 5 bleeding
  float darkness, chroma, contrast;  // factors of mode modulate
  float damping;                     // mode bleeding: direct light's luminance; 0: off
  int albedo;                        // of bounced light: 0 as it is, 1 as a display shows it
  float tint;                        // 0 to 1
};

struct CompositeConstants {
  int mode;
  float darkness, chroma, contrast;
  float damping;
  int display;  // 0 or 1
  float tint;
};

#endif
