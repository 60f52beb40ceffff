// User parameters of `toon` and the constants of its kernels. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_TOON_H
#define UMBRAGE_EFFECTS_TOON_H
#include "core/length.h"

const int kToonMaxLights = 16;

// Values of ToonParams::mode and albedo.
const int kToonRamp = 0, kToonPaper = 1;
const int kToonTexture = 0, kToonDisplay = 1, kToonClay = 2;

// One row of the table in toon.cpp per field.
struct ToonParams {
  int mode;                            // kToonRamp or kToonPaper
  int steps;                           // ramp: number of tone steps; paper: tone steps per unit of intensity
  float ambient, extra;                // ambient light that occlusion darkens, and that it does not darken
  int rig;                             // 0: the scene's lights, 1: a head light, 2: a key light
  float shadow;                        // 0 to 1: how much of the key light's shadow is applied
  Length smoothness;                   // ramp: how far light is smoothed: pixels, or percent of the height
  float softness;                      // width of the edges between tone steps, in steps
  float specular;                      // factor for highlights
  float highlight_size;                // factor for a highlight's diameter
  float shadow_r, shadow_g, shadow_b;  // the darkest tone step
  float light_r, light_g, light_b;     // the brightest tone step, and highlights
  int albedo;                          // kToonTexture, kToonDisplay, kToonClay
  float occlusion;                     // factor for 1 - ao
};

struct ToonConstants {
  int mode;
  int albedo;
  int light_count;
  float steps;
  float ambient, extra, shadow, specular, occlusion;
  float steps_per_intensity;  // ramp: tone steps per unit of intensity
  float inverse_steps;        // paper: difference in brightness between tone steps
  float min_width, softness;  // min widths of an edge between tone steps, in steps, each at most 1
  int smooth_px, shadow_px;   // distance between neighbours in the first round that smooths light, and shadows
  float sharpness;            // 1 / highlight_size^2
  float shadow_r, shadow_g, shadow_b;
  float step_r, step_g, step_b;  // colour difference between adjacent tone steps
  float light_r, light_g, light_b;
  // Lights in view space, the key light first. kind 0: directional, (x, y, z) points towards the light; kind 1: point
  // light at (x, y, z).
  int kind[kToonMaxLights];
  float x[kToonMaxLights], y[kToonMaxLights], z[kToonMaxLights];
  float fraction[kToonMaxLights];       // intensity relative to the key light
  float reach_squared[kToonMaxLights];  // point lights: squared distance at which `fraction` applies; 0: no falloff
};

#endif
