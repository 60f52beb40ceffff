// Parameters and kernel constants of `bitmask`. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_BITMASK_H
#define UMBRAGE_EFFECTS_BITMASK_H
#include "core/length.h"
#include "kernel/frame_constants.h"

// Each field has one row in the parameter table of bitmask.cpp.
struct BitmaskParams {
  int slices, steps;
  int distribution;  // one of kBitmaskStep...
  Length radius;     // scene units, or percent of the bounding-sphere radius
  int mode;          // one of kBitmaskThick...
  float thickness;   // in radii
  float slope;       // relative to the distance; 0: automatic
  int measure;       // one of kBitmaskExact...
  float falloff;     // fraction of the radius
  int noise;         // one of kBitmaskHilbert...
  int sample_index;  // of accumulation
  int mips;          // 0 or 1
  int border;        // taps outside the picture: 0 left out, 1 open
  int bent;          // 0 or 1
  float bleeding;
  float ambient_bounce;
  int bounces;
  int layers;  // 0: all captured layers
};

// Values of BitmaskParams::distribution, mode, measure and noise; see the table in bitmask.cpp.
const int kBitmaskStep1 = 0, kBitmaskStep15 = 1, kBitmaskStep2 = 2, kBitmaskStep3 = 3;
const int kBitmaskThick = 0, kBitmaskInfinite = 1, kBitmaskLayers = 2;
const int kBitmaskExact = 0, kBitmaskUniform = 1, kBitmaskSectors = 2;
const int kBitmaskHilbert = 0, kBitmaskTile = 1, kBitmaskHash = 2, kBitmaskNone = 3;
const int kBitmaskMaxMips = 5;

struct BitmaskConstants {
  int slices, steps;
  float one_over_steps;
  int distribution;          // as in BitmaskParams
  float turn_cos, turn_sin;  // of the angle from one slice to the next
  float one_over_slices;
  float radius, radius2;   // scene units
  float reach;             // radius in columns at depth 1; at any depth in an orthographic picture
  float step_y, along_y;   // rows per column width, and its inverse; both < 0: rows go down
  int infinite;            // 0 or 1
  float thickness, slope;  // scene units; relative to the distance
  int measure;             // as in BitmaskParams
  float falloff, fade;     // outer fraction of the radius; fade = 1 / (radius falloff), 0 if falloff is 0
  int noise;               // as in BitmaskParams
  float sample_turn, sample_step, sample_bit;  // offsets of the noise by sample index, [0, 1)
  int skip_outside;                            // 0 or 1: taps outside the picture are left out
  int mip_levels;  // number of levels beyond level 0, the picture; a pixel of level l covers 2^l x 2^l pixels
  int mip_rows;    // rows of level 1 in the mip plane; level l begins at row 2 mip_rows (1 - 2^(1 - l))
  // Read by the dispatch `sent`; see HemisphereConstants.
  float bleeding, ambient_bounce, assumed_visibility;
  int layer_count;
  int layer[kLayersRead];  // indices of the layers that are searched, nearest first
  int back[kLayersRead];   // index of the layer with the back sides of layer[i]; -1: none
};

#endif
