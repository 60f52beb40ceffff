// What a person sets of `bitmask`, and what its kernels read. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_BITMASK_H
#define UMBRAGE_EFFECTS_BITMASK_H
#include "core/length.h"
#include "kernel/frame_constants.h"

// One row of the table in bitmask.cpp per field.
struct BitmaskParams {
  int slices, steps;
  int distribution;  // kBitmaskStep...
  Length radius;     // scene units or share of the scene's radius
  int mode;          // kBitmaskThick...
  float thickness;   // share of the radius
  float slope;       // share of the distance
  int measure;       // kBitmaskExact...
  float falloff;     // share of the radius
  int noise;         // kBitmaskHilbert...
  int frame;
  int mips;    // 0 or 1
  int border;  // 0 left out, 1 open
  int bent;    // 0 or 1
  float bleeding;
  float ambient_bounce;
  int bounces;
  int layers;  // 0: all there are
};

// Values of BitmaskParams::distribution, mode, measure and noise.
const int kBitmaskStep1 = 0, kBitmaskStep15 = 1, kBitmaskStep2 = 2, kBitmaskStep3 = 3;
const int kBitmaskThick = 0, kBitmaskInfinite = 1, kBitmaskLayers = 2;
const int kBitmaskExact = 0, kBitmaskUniform = 1, kBitmaskSectors = 2;
const int kBitmaskHilbert = 0, kBitmaskTile = 1, kBitmaskHash = 2, kBitmaskNone = 3;
const int kBitmaskMostMips = 5;

struct BitmaskConstants {
  int slices, steps;
  float one_over_steps;
  int distribution;          // as in BitmaskParams
  float turn_cos, turn_sin;  // of the angle from one slice to the next
  float one_over_slices;
  float radius, radius2;   // scene units
  float reach;             // pixels across that the radius is at depth 1, or at any in an orthographic picture
  float step_y, along_y;   // rows that one column's width is, and the inverse; both below 0: rows go down
  int infinite;            // 0 or 1
  float thickness, slope;  // scene units; share of the distance
  int measure;             // as in BitmaskParams
  float falloff, fade;     // share of the radius; where it begins is 1 - falloff: fade = 1 / (radius falloff)
  int noise;               // as in BitmaskParams
  float frame_turn, frame_step, frame_bit;  // what a frame adds to the noise, in [0, 1)
  int skip_outside;                         // 0 or 1
  int mip_levels;  // beyond the picture's own pixels: level l holds one number for 2^l x 2^l of them
  int mip_rows;    // of level 1 in its plane; level l begins at row 2 mip_rows (1 - 2^(1 - l))
  // What pass `sent` reads, as of HemisphereConstants.
  float bleeding, ambient_bounce, openness;
  int layer_count;
  int layer[kLayersRead];
  int back[kLayersRead];
};

#endif
