// Parameters and kernel constants of `shanmugam`. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_SHANMUGAM_H
#define UMBRAGE_EFFECTS_SHANMUGAM_H
#include "core/length.h"

// Each field has one row in the parameter table of shanmugam.cpp.
struct ShanmugamParams {
  Length radius;       // scene units, or percent of the bounding-sphere radius
  Length near_radius;  // the same
  int near;            // 0 or 1
  int samples;
  int form;      // kShanmugamDisc, kShanmugamSphere
  float behind;  // factor of discs that face away
  float bias;    // a cosine
  int far;       // 0 or 1
  int far_form;  // kShanmugamPatch, kShanmugamExact, kShanmugamPaper
  int occluders;
  int sample_index;
};

const int kShanmugamDisc = 0, kShanmugamSphere = 1;
const int kShanmugamPatch = 0, kShanmugamExact = 1, kShanmugamPaper = 2;

const int kShanmugamMaxOccluders = 256;
// Numbers per occluder, along the axes of the world from the camera, scene units: centre; squared radius; mean normal
// times 4 squared radii; whether it is the last of its object, 0 or 1; of the flat part the area over pi, of the rest
// the radius of its sphere; inverse of twice the near radius, and of twice the radius, or of the patch's diameter if
// that is shorter.
const int kShanmugamOccluderSize = 12;
const int kShanmugamRadius2 = 3, kShanmugamFacing = 4, kShanmugamLast = 7, kShanmugamFlat = 8, kShanmugamRest = 9,
          kShanmugamPerNear = 10, kShanmugamPerFar = 11;

struct ShanmugamConstants {
  int samples;  // 0: no near part
  float one_over_samples;
  float near_radius, near_radius2;  // scene units
  float near_area;                  // pi near_radius^2
  float radius_px;                  // columns of near_radius, at depth 1; at any depth in an orthographic picture
  float rows_per_column;            // rows in the width of a column, < 0: rows go down
  int sphere;                       // 0 or 1
  float behind, bias;
  float turn, step;  // offsets of the noise, fractions
  int far_form;
  float radius;         // scene units
  float world_axes[9];  // x, y, z of each axis, in view space
  int occluders;        // 0: no far part
  float set[kShanmugamOccluderSize * kShanmugamMaxOccluders];
};

#endif
