// User parameters of `output` and the constants of its kernel. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_OUTPUT_H
#define UMBRAGE_EFFECTS_OUTPUT_H

// Values of OutputParams::metering.
const int kMeteringNone = 0, kMeteringPicture = 1, kMeteringLight = 2;

// Values of OutputParams::tone.
const int kToneNone = 0, kToneNeutral = 1, kToneHue = 2;

// Values of OutputParams::transfer.
const int kTransferSrgb = 0, kTransferNone = 1;

// Values of OutputParams::beauty.
const int kBeautyOff = 0, kBeautyLight = 1, kBeautyDisplay = 2;

// Values of OutputParams::blend.
const int kBlendLight = 0, kBlendDisplay = 1;

// One row of the table in output.cpp per field.
struct OutputParams {
  float exposure;                                  // stops
  int metering;                                    // one of kMetering...; applied by the caller
  int tone;                                        // one of kTone...
  float contrast;                                  // exponent of light relative to `pivot`
  float pivot;                                     // light that contrast does not change
  float shoulder;                                  // light from which on it is compressed to below 1; 1: off
  int transfer;                                    // 0 srgb, 1 none
  float background_r, background_g, background_b;  // as written to the file
  float gradient;                                  // fraction of the background's light that is missing at the top
  int transparent;                                 // 0 or 1
  int sky;                                         // 0 or 1: the planes `sky` are the background
  int dither;                                      // 0 or 1: see OutputConstants::dither
  int beauty;                                      // one of kBeauty...
  int parts;                                       // 0 or 1: write the parts of `beauty`
  int blend;                                       // one of kBlend...: what `shadow_catcher` is a fraction of
};

struct OutputConstants {
  int sky;
  float gain;
  int tone;
  float contrast, pivot;
  float shoulder, room;  // room: 1 / (1 - shoulder); 0: no compression
  int transfer;
  float dither;                                    // amplitude where a background with a gradient is visible; 0: none
  float background_r, background_g, background_b;  // as written to the file
  float behind_r, behind_g, behind_b;              // the same as linear light
  float gradient, one_over_height;                 // see OutputParams; 1 / rows of the whole picture without guard band
  int first_row;  // where the first row of the whole picture is; negative in later strips
  float background_alpha;
  float beauty_behind_r, beauty_behind_g, beauty_behind_b;  // the background, in the values that `beauty` mixes
  int decode;                                               // 0 or 1: these are display values
  int cover_display;                                        // 0 or 1: `shadow_catcher` blends display values
};

#endif
