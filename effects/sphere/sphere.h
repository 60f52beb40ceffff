// User parameters of `sphere` and the constants of its kernel. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_SPHERE_H
#define UMBRAGE_EFFECTS_SPHERE_H
#include "core/length.h"

// One row of the table in sphere.cpp per field.
struct SphereParams {
  int samples;
  Length radius;                // pixels, or percent of the picture's width
  Length reach;                 // scene units, or percent of the bounding-sphere radius; above 0 it replaces `radius`
  int depth;                    // kSphereWindow, kSphereLinear
  float near_depth, far_depth;  // scene units; 0: automatic
  int reflect;                  // kSphereReflect...
  int noise_size;               // pixels; 0: the whole picture
  int shape;                    // 0 sphere, 1 hemisphere
  int sample_z;                 // 0 or 1
  float threshold;              // min fraction of the samples
  int map;                      // 0 quadratic, 1 linear
  int range;                    // kSphereRange...
  float range_factor;           // relative to the radius
  float bias;                   // fraction of the radius
  int border;                   // 0 clamp, 1 skip
  float strength;
};

// Values of SphereParams::depth, reflect and range.
const int kSphereWindow = 0, kSphereLinear = 1;
const int kSphereReflectRandom = 0, kSphereReflectNormal = 1, kSphereReflectNone = 2;
const int kSphereRangeOff = 0, kSphereRangeHard = 1, kSphereRangeSmooth = 2;
const int kSphereMaxSamples = 256;

struct SphereConstants {
  int samples;
  int world_radius;  // 0: radius_px applies, 1: reach applies
  float radius_px;
  float reach;  // scene units
  // Range limit as a factor: for window depth of the radius in pixels, for linear depth of the radius in scene units.
  float limit;
  // 0 or 1: compares linear depth; otherwise window depth = window_one - window_inverse / depth.
  int linear;
  float near_depth, far_depth;
  float window_one, window_inverse;
  int reflect;       // as in SphereParams
  float noise_size;  // pixels; 0: the whole picture
  int hemisphere;    // 0 or 1
  int sample_z;      // 0 or 1
  float threshold;   // min fraction of the samples
  int quadratic;     // 0 or 1
  int range;         // as in SphereParams
  float bias;        // fraction of the radius
  int skip_outside;  // 0 or 1
  float strength;
  float points[3 * kSphereMaxSamples];  // x, y, z of each sample point in the unit sphere, view space
};

#endif
