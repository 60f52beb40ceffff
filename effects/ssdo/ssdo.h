// Parameters and kernel constants of `ssdo`. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_SSDO_H
#define UMBRAGE_EFFECTS_SSDO_H
#include "core/length.h"
#include "kernel/frame_constants.h"

// Each field has one row in the parameter table of ssdo.cpp.
struct SsdoParams {
  int samples;
  int steps;       // sample points along each direction
  Length radius;   // scene units, or percent of the bounding-sphere radius
  int directions;  // kSsdoCosine, kSsdoUniform or kSsdoPaper
  int lengths;     // kSsdoRoot or kSsdoLinear
  int seed;
  int noise;        // side of the noise tile, pixels; 0: noise does not repeat
  float thickness;  // of surfaces, fraction of the radius; 0: infinite
  float bias;       // fraction of the radius
  int border;       // kSsdoSkip or kSsdoOpen
  float directional;
  int difference;      // 0 or 1: directional light is added as a difference from ambient light
  float bleeding;      // factor; 0: off
  int bounce;          // kSsdoRadiance or kSsdoSender
  float min_distance;  // bounce sender: min distance of a sender, fraction of the radius
  float ambient_bounce;
  int bounces;
  int layers;  // 0: all captured layers
};

// Values of SsdoParams::directions, lengths, border and bounce.
const int kSsdoCosine = 0, kSsdoUniform = 1, kSsdoPaper = 2;
const int kSsdoRoot = 0, kSsdoLinear = 1;
const int kSsdoSkip = 0, kSsdoOpen = 1;
const int kSsdoRadiance = 0, kSsdoSender = 1;
const int kSsdoMaxSamples = 256;
const int kSsdoPointValues = 5;

struct SsdoConstants {
  int samples, steps;
  float one_over_steps;
  float radius;           // scene units
  float stratum;          // width of a direction's stratum: 1 / samples, or 1
  int cosine;             // 0 or 1: directions have a density proportional to the cosine
  int normalized;         // 0 or 1: weights are divided by their sum, not by its expected value
  int root;               // 0 or 1: lengths are R sqrt(t), not R t
  int even, seed, noise;  // for noise_at() in hemisphere_basis.kernel.h
  float one_over_noise;
  float thickness;   // scene units
  float min_height;  // min height of an occluder above the surface's plane, scene units
  int skip_outside;  // 0 or 1: sample points that no camera sees do not count; else they are open
  float directional;
  int difference;  // 0 or 1
  float bleeding;
  int radiance;                              // 0 or 1: kSsdoRadiance
  float min_distance2;                       // square of SsdoParams::min_distance, scene units
  float radius2;                             // square of the radius
  float ambient_bounce, assumed_visibility;  // the dispatch `sent` reads these; see HemisphereConstants
  // As in HemisphereConstants.
  int layer_count;
  int layer[kLayersRead], back[kLayersRead], other[kLayersRead], new_view[kLayersRead], view_end[kLayersRead];
  int orthographic[kLayersRead];
  float scale_x[kLayersRead], offset_x[kLayersRead], scale_y[kLayersRead], offset_y[kLayersRead];
  float ray_scale_x[kLayersRead], ray_offset_x[kLayersRead], ray_scale_y[kLayersRead], ray_offset_y[kLayersRead];
  float move[12 * kLayersRead];
  float sky[27];  // see kernel/sky.kernel.h; view space
  // Per direction: index of its stratum, place in the stratum (0 to 1), cosine and sine of its azimuth, place of its
  // length (0 to 1).
  float points[kSsdoPointValues * kSsdoMaxSamples];
};

#endif
