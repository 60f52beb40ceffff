// What a person sets of `toon`, and what its kernels read. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_TOON_H
#define UMBRAGE_EFFECTS_TOON_H
const int kToonMostLights = 16;

// Values of ToonParams::mode and albedo.
const int kToonRamp = 0, kToonPaper = 1;
const int kToonTexture = 0, kToonDisplay = 1, kToonClay = 2;

// One row of the table in toon.cpp per field.
struct ToonParams {
  int mode;                            // kToonRamp, kToonPaper
  int bands;                           // ramp: how many there are; paper: per unit of intensity
  float ambient, extra;                // light from everywhere: what occlusion darkens, and what it does not
  int rig;                             // 0 the scene's lights, 1 a head light, 2 a key light
  float shadow;                        // how much of the key light's shadow is applied
  float softness;                      // width of a band's edge, in bands
  float specular;                      // factor on highlights
  float highlight_size;                // factor on a highlight's diameter
  float shadow_r, shadow_g, shadow_b;  // the darkest band
  float light_r, light_g, light_b;     // the brightest band, and highlights
  int albedo;                          // kToonTexture, kToonDisplay, kToonClay
};

struct ToonConstants {
  int mode;
  int albedo;
  int light_count;
  float bands;
  float ambient, extra, shadow, specular;
  float bands_per_intensity;    // from intensity to the ramp's bands
  float inverse_bands;          // paper: what a band is worth
  float least_width, softness;  // of an edge between bands, in bands; both at most 1
  int speck;                    // ramp without softness: how wide and high a speck is at most, pixels; 0: none is
  float sharpness;              // 1 over the square of the highlight's size
  float shadow_r, shadow_g, shadow_b;
  float step_r, step_g, step_b;  // from one band's colour to the next
  float light_r, light_g, light_b;
  // Lights in view space, the key light first. kind: 0 directional (x, y, z towards the light), 1 point (at x, y, z)
  int kind[kToonMostLights];
  float x[kToonMostLights], y[kToonMostLights], z[kToonMostLights];
  float share[kToonMostLights];          // of the key light's strength
  float reach_squared[kToonMostLights];  // of a point light: distance at which its share holds; 0: no falloff
};

#endif
