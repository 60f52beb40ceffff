// Parameters and kernel constants of `traced`. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_TRACED_H
#define UMBRAGE_EFFECTS_TRACED_H
#include "core/length.h"

// Each field has one row in the parameter table of traced.cpp.
struct TracedParams {
  float rays;      // per pixel on an open surface; below 1, a fraction of the pixels gets one
  int max_rays;    // of a pixel with few neighbours on its surface
  Length radius;   // scene units, or relative to the bounding-sphere radius
  int falloff;     // a Falloff
  int normal;      // kTracedTriangle or kTracedShading
  int filtered;    // 0 or 1
  int bent;        // 0 or 1
  float bleeding;  // factor of indirect light; 0: off
  float ambient_bounce;
  float directional;  // factor of the direction of ambient light; 0: off
  int sample_index;   // number of the picture, if several are averaged
};

// Values of TracedParams::normal.
const int kTracedTriangle = 0, kTracedShading = 1;
const int kTracedMaxRounds = 5;

// The format of the plane `traced_joints`: see joints.kernel.h.
const int kJointPowers = 4;  // weights of the pixels 1, 2, 4 and 8 away
const int kJointBits = 3;
const int kMaxJoint = (1 << kJointBits) - 1;

struct TracedConstants {
  float rays;
  float max_rays;
  int normal;                          // as in TracedParams
  int own_rays;                        // max number of rays of a pixel with all neighbours on its surface
  int first_ray;                       // ray k of a pixel has the index first_ray + k in its sequence,
  int first_further_ray;               // or first_further_ray + k from k = own_rays on
  float dither;                        // what the sample index adds to the dither threshold, [0, 1)
  float distance;                      // max distance of a pixel from another's plane at full weight, pixels
  float turn;                          // 1 / (1 - cos(max angle between normals at full weight))
  int rounds;                          // of the filter
  int power[kTracedMaxRounds];         // taps are 1 << power and 2 << power pixels away, by round
  float deviations[kTracedMaxRounds];  // max difference of two values at full weight, in standard deviations; 0: any
  float near_weight[kTracedMaxRounds];
  float far_weight[kTracedMaxRounds];  // of taps one and two steps away; the pixel itself has weight 1
  int light_only[kTracedMaxRounds];    // 0 or 1: the round leaves the visibility as it is
};

#endif
