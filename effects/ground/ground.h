// What a person sets of `ground`, and what its kernel reads. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_GROUND_H
#define UMBRAGE_EFFECTS_GROUND_H

// Values of GroundParams::blend.
const int kGroundBlendLight = 0, kGroundBlendDisplay = 1;

// One row of the table in ground.cpp per field.
struct GroundParams {
  float strength;  // of the shade on the ground
  int blend;       // what lays the shade over a background: 0 light, 1 values as a display shows them
};

struct GroundConstants {
  float object;  // id of the ground; below 0: there is none
  float strength;
  int display;                         // 0 or 1
  float middle_x, middle_y, middle_z;  // of the ground, in view space
  float inverse_fades;                 // 1 over the distance from there at which shade has faded; 0: it does not
};

#endif
