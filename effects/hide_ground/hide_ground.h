// What the kernel of `hide_ground` reads. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_HIDE_GROUND_H
#define UMBRAGE_EFFECTS_HIDE_GROUND_H

struct HideGroundConstants {
  float object;  // id of the ground; below 0: there is none
};

#endif
