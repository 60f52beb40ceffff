// User parameters of `toon` and the constants of its kernels. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_TOON_H
#define UMBRAGE_EFFECTS_TOON_H
const int kToonMaxLights = 16;

// Values of ToonParams::mode and albedo.
const int kToonRamp = 0, kToonPaper = 1;
const int kToonTexture = 0, kToonDisplay = 1, kToonClay = 2;

// One row of the table in toon.cpp per field.
struct ToonParams {
  int mode;                            // kToonRamp, kToonPaper
  int steps;                           // ramp: number of tone steps; paper: steps per unit of intensity
  float ambient, extra;                // ambient light: the part that occlusion darkens, and the part that it does not
  int rig;                             // 0 the scene's lights, 1 a head light, 2 a key light
  float shadow;                        // 0 to 1: how much of the key light's shadow is applied
  float softness;                      // width of the edge between tone steps, in steps
  float specular;                      // factor for highlights
  float highlight_size;                // factor for a highlight's diameter
  float shadow_r, shadow_g, shadow_b;  // the darkest tone step
  float light_r, light_g, light_b;     // the brightest tone step, and highlights
  int albedo;                          // kToonTexture, kToonDisplay, kToonClay
};

struct ToonConstants {
  int mode;
  int albedo;
  int light_count;
  float steps;
  float ambient, extra, shadow, specular;
  float steps_per_intensity;  // from intensity to tone steps of the ramp
  float inverse_steps;        // paper: brightness of a tone step
  float min_width, softness;  // of an edge between tone steps, in steps; both at most 1
  int speck;                  // ramp without softness: max width and height of a speck, pixels; 0: specks are kept
  float sharpness;            // 1 over the square of the highlight's size
  float shadow_r, shadow_g, shadow_b;
  float step_r, step_g, step_b;  // difference between the colours of adjacent tone steps
  float light_r, light_g, light_b;
  // Lights in view space, the key light first. kind: 0 directional (x, y, z towards the light), 1 point (at x, y, z)
  int kind[kToonMaxLights];
  float x[kToonMaxLights], y[kToonMaxLights], z[kToonMaxLights];
  float fraction[kToonMaxLights];       // intensity relative to the key light
  float reach_squared[kToonMaxLights];  // of a point light: squared distance at which its share applies; 0: no falloff
};

#endif
