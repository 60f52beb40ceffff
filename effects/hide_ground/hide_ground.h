// Kernel constants of `hide_ground`. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_HIDE_GROUND_H
#define UMBRAGE_EFFECTS_HIDE_GROUND_H

struct HideGroundConstants {
  float object;  // object id of the ground; < 0: there is no ground
};

#endif
