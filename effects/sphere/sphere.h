// What a person sets of `sphere`, and what its kernel reads. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_SPHERE_H
#define UMBRAGE_EFFECTS_SPHERE_H
#include "core/length.h"

// One row of the table in sphere.cpp per field.
struct SphereParams {
  int samples;
  Length radius;                // pixels or share of the picture's width
  Length reach;                 // scene units or share of the scene's radius; above 0 it replaces `radius`
  int depth;                    // kSphereWindow, kSphereLinear
  float near_depth, far_depth;  // scene units; 0: automatic
  int reflect;                  // kSphereReflect...
  int noise_size;               // pixels; 0: as large as the picture
  int shape;                    // 0 sphere, 1 hemisphere
  int sample_z;                 // 0 or 1
  float threshold;              // share of the samples
  int map;                      // 0 quadratic, 1 linear
  int range;                    // kSphereRange...
  float range_factor;           // of the radius
  float bias;                   // share of the radius
  int border;                   // 0 clamp, 1 skip
  float strength;
};

// Values of SphereParams::depth, reflect and range.
const int kSphereWindow = 0, kSphereLinear = 1;
const int kSphereReflectRandom = 0, kSphereReflectNormal = 1, kSphereReflectNone = 2;
const int kSphereRangeOff = 0, kSphereRangeHard = 1, kSphereRangeSmooth = 2;
const int kSphereMostSamples = 256;

struct SphereConstants {
  int samples;
  int world_radius;  // 0: radius_px holds, 1: reach holds
  float radius_px;
  float reach;  // scene units
  float limit;  // range limit as a factor: of the radius in pixels for window depth, of that in scene units for linear
  int linear;   // 0 or 1: depth is compared as it is, or as window depth = window_one - window_inverse / depth
  float near_depth, far_depth;
  float window_one, window_inverse;
  int reflect;       // as in SphereParams
  float noise_size;  // pixels; 0: as large as the picture
  int hemisphere;    // 0 or 1
  int sample_z;      // 0 or 1
  float threshold;   // share of the samples
  int quadratic;     // 0 or 1
  int range;         // as in SphereParams
  float bias;        // share of the radius
  int skip_outside;  // 0 or 1
  float strength;
  float points[3 * kSphereMostSamples];  // x, y, z of each sample point in the unit ball, view space
};

#endif
