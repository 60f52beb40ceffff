// Parameters and kernel constants of `ground`. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_GROUND_H
#define UMBRAGE_EFFECTS_GROUND_H

// Values of GroundParams::blend.
const int kGroundBlendLight = 0, kGroundBlendDisplay = 1;

// Each field has one row in the parameter table of ground.cpp.
struct GroundParams {
  float strength;  // of the shadow on the ground: up to 1 a factor; from 1 to 2 an exponent of the light that arrives
  float border;    // percent of the picture's sides over which the shadow fades towards the picture's border
  int blend;       // how the shadow is blended over a background: 0 in linear light, 1 in display values
};

struct GroundConstants {
  float object;                                   // object id of the ground; < 0: none
  float strength;                                 // of the shadow, up to 1
  float excess;                                   // strength above 1
  int display;                                    // 0 or 1: blend in display values
  float middle_x, middle_y, middle_z;             // centre of the ground, view space
  float middle_px, middle_py;                     // centre of the picture, pixels
  float inverse_half_width, inverse_half_height;  // of the picture without guard band, 1 / pixels
  float inverse_border;         // 1 / part of that over which the shadow fades towards the border; 0: no fading
  float inverse_fade_distance;  // 1 / distance from the centre at which the shadow has faded out; 0: no fading
};

#endif
