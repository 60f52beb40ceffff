// Parameters and kernel constants of `composite`. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_COMPOSITE_H
#define UMBRAGE_EFFECTS_COMPOSITE_H

// Each field has one row in the parameter table of composite.cpp.
struct CompositeParams {
  int mode;                          // 0 ambient, 1 subtract, 2 multiply, 3 modulate, 4 occlusion, 5 bleeding, 6 albedo
  float darkness, chroma, contrast;  // factors of mode modulate
  float damping;                     // mode bleeding: luminance of direct light where damping ends; 0: off
  int albedo;                        // albedo for bounced light: 0 linear, 1 in display values
  float tint;                        // 0 to 1; 0: off
  float direct;                      // 0 to 1; 0: off
  float occlusion;                   // factor for 1 - ao
  int parts;                         // 0 or 1: write lit_direct and lit_indirect
};

struct CompositeConstants {
  int mode;
  float darkness, chroma, contrast;
  float damping;
  int display;  // 0 or 1: albedo for bounced light in display values
  float tint;
  float direct;
  float occlusion;
};

#endif
