// What a person sets of `output`, and what its kernel reads. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_OUTPUT_H
#define UMBRAGE_EFFECTS_OUTPUT_H

// One row of the table in output.cpp per field.
struct OutputParams {
  float exposure;                                  // stops
  int transfer;                                    // 0 srgb, 1 none
  float background_r, background_g, background_b;  // as written to the file
  int transparent;                                 // 0 or 1
};

struct OutputConstants {
  float gain;
  int transfer;
  float background_r, background_g, background_b;
  float background_alpha;
};

#endif
