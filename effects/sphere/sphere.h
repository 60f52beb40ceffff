// User parameters of `sphere` and the constants of its kernel. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_SPHERE_H
#define UMBRAGE_EFFECTS_SPHERE_H
#include "core/length.h"

// One row of the table in sphere.cpp per field.
struct SphereParams {
  int samples;
  Length radius;                // pixels, or percent of the picture's width
  Length reach;                 // scene units, or percent of the bounding-sphere radius; if > 0, replaces `radius`
  int depth;                    // kSphereWindow or kSphereLinear
  float near_depth, far_depth;  // scene units; 0: automatic
  int reflect;                  // kSphereReflect...
  int noise_size;               // pixels; 0: the whole picture
  int distribution;             // 0 even, 1 corners
  int shape;                    // 0 sphere, 1 hemisphere
  int sample_z;                 // 0 or 1: samples have their own depth
  int projection;               // of samples with their own depth: 0 perspective, 1 parallel
  float softness;               // width of the transition from open to occluded, in radii; 0: a step
  float threshold;              // min fraction of samples that occlude; below it there is no occlusion
  int map;                      // 0 quadratic, 1 linear
  int range;                    // kSphereRange...
  float range_factor;           // end of the range, in radii
  float range_value;            // kSphereRangeBlend: visibility of samples beyond the range
  float bias;                   // min height of an occluder, fraction of the radius
  int border;                   // samples outside the picture: 0 clamp, 1 skip
  float strength;
  float gain, offset;  // of the visibility
};

// Values of SphereParams::depth, reflect and range.
const int kSphereWindow = 0, kSphereLinear = 1;
const int kSphereReflectRandom = 0, kSphereReflectNormal = 1, kSphereReflectNone = 2;
const int kSphereRangeOff = 0, kSphereRangeHard = 1, kSphereRangeSmooth = 2, kSphereRangeBlend = 3;
const int kSphereMaxSamples = 256;

struct SphereConstants {
  int samples;
  int world_radius;  // 0: radius_px is the radius, 1: reach is
  float radius_px;
  float reach;  // scene units
  // Factor from the radius to the range limit. The radius is in pixels for window depth, in scene units for linear
  // depth.
  float limit;
  float softness;  // factor from the same radius to the width of the transition; 0: a step
  // 1: linear depth is compared; 0: window depth, which is window_one - window_inverse / depth.
  int linear;
  float near_depth, far_depth;
  float window_one, window_inverse;
  int reflect;       // as in SphereParams
  float noise_size;  // pixels; 0: the whole picture
  int hemisphere;    // 0 or 1
  int sample_z;      // 0 or 1
  int parallel;      // 0 or 1
  float threshold;   // as in SphereParams
  int quadratic;     // 0 or 1
  int range;         // as in SphereParams
  float beyond;      // occlusion of samples beyond the range
  float bias;        // as in SphereParams
  int skip_outside;  // 0 or 1
  float strength;
  float gain, offset;                   // as in SphereParams
  float points[3 * kSphereMaxSamples];  // x, y, z of each sample point in the unit sphere, view space
};

#endif
