// User parameters of `output` and the constants of its kernel. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_OUTPUT_H
#define UMBRAGE_EFFECTS_OUTPUT_H

// Values of OutputParams::metering.
const int kMeteringNone = 0, kMeteringPicture = 1, kMeteringLight = 2;

// Values of OutputParams::transfer.
const int kTransferSrgb = 0, kTransferNone = 1;

// One row of the table in output.cpp per field.
struct OutputParams {
  float exposure;                                  // stops
  int metering;                                    // 0 none, 1 by the picture, 2 by its light; applied by the caller
  float shoulder;                                  // light from which on it is compressed to below 1; 1: off
  int transfer;                                    // 0 srgb, 1 none
  float background_r, background_g, background_b;  // as written to the file
  int transparent;                                 // 0 or 1
  int sky;                                         // 0 or 1: the planes `sky` are the background
};

struct OutputConstants {
  int sky;
  float gain;
  float shoulder, room;  // room: 1 / (1 - shoulder); 0: no compression
  int transfer;
  float background_r, background_g, background_b;  // as written to the file
  float behind_r, behind_g, behind_b;              // the same as linear light
  float background_alpha;
};

#endif
