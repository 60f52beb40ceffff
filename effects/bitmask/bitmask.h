// Parameters and kernel constants of `bitmask`. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_BITMASK_H
#define UMBRAGE_EFFECTS_BITMASK_H
#include "core/length.h"
#include "kernel/frame_constants.h"

// Each field has one row in the parameter table of bitmask.cpp.
struct BitmaskParams {
  int slices, steps;
  int distribution;  // kBitmaskStep1 to kBitmaskStep3
  Length radius;     // scene units, or percent of the bounding-sphere radius
  int mode;          // kBitmaskThick, kBitmaskInfinite or kBitmaskLayers
  float thickness;   // in radii
  float slope;       // thickness, relative to the occluder's distance; 0: automatic
  int measure;       // kBitmaskExact, kBitmaskUniform or kBitmaskSectors
  float falloff;     // outer fraction of the radius
  int noise;         // kBitmaskHilbert to kBitmaskNone
  int sample_index;  // number of the picture, if several are averaged
  int mips;          // 0 or 1
  int border;        // taps outside the picture: 0 left out, 1 unoccluded
  int bent;          // 0 or 1
  float bleeding;    // factor of indirect light; 0: off
  float ambient_bounce;
  float directional;  // factor of the direction of ambient light; 0: off
  int bounces;
  int layers;  // 0: all captured layers
};

// Values of BitmaskParams::distribution, mode, measure and noise; see the table in bitmask.cpp.
const int kBitmaskStep1 = 0, kBitmaskStep15 = 1, kBitmaskStep2 = 2, kBitmaskStep3 = 3;
const int kBitmaskThick = 0, kBitmaskInfinite = 1, kBitmaskLayers = 2;
const int kBitmaskExact = 0, kBitmaskUniform = 1, kBitmaskSectors = 2;
const int kBitmaskHilbert = 0, kBitmaskTile = 1, kBitmaskHash = 2, kBitmaskNone = 3;
const int kBitmaskMaxMips = 5;
const int kBitmaskRows = 65, kBitmaskGroups = 8;  // of BitmaskConstants::angles

struct BitmaskConstants {
  int slices, steps;
  float one_over_steps;
  int distribution;          // as in BitmaskParams
  float turn_cos, turn_sin;  // of the angle from one slice to the next
  float one_over_slices;
  float radius, radius2;                       // scene units
  float radius_px;                             // columns, at depth 1; at any depth in an orthographic picture
  float rows_per_column;                       // rows in the width of a column, < 0: rows go down
  float columns_per_row;                       // the inverse of that
  int infinite;                                // 0 or 1
  float thickness, slope;                      // scene units; relative to the occluder's distance
  int measure;                                 // as in BitmaskParams
  float falloff;                               // outer fraction of the radius over which occluders fade out
  float fade;                                  // 1 / (radius falloff); 0 if falloff is 0
  int noise;                                   // as in BitmaskParams
  float sample_turn, sample_step, sample_bit;  // what the sample index adds to the three noise values, [0, 1)
  int skip_outside;                            // 0 or 1: taps outside the picture are left out
  int mip_levels;  // levels after level 0, the picture itself; a pixel of level l covers 2^l x 2^l pixels
  int mip_rows;    // rows of level 1 in the mip plane; level l begins at row 2 mip_rows (1 - 2^(1 - l))
  // The dispatch `sent` reads these; see HemisphereConstants.
  float bleeding, ambient_bounce, assumed_visibility;
  int layer_count;
  int layer[kLayersRead];  // layers that are searched, nearest first
  int back[kLayersRead];   // layer that shows the back sides of the surfaces in layer[i]; -1: none
  float directional;
  // Radiance of ambient light, up to a constant, by its direction (x, y, z): per channel the factors of x, y, z, xx,
  // yy, zz, and half those of xy, yz, zx. View space.
  float sky[27];
  // Per row, for an angle of the normal's projection to the view direction from -90 to 90 degrees, and per group of
  // four bits: mean of cos(t), sin(t), cos(2t), sin(2t) over its directions, t their angle to the view direction.
  float angles[kBitmaskRows * 4 * kBitmaskGroups];
};

#endif
