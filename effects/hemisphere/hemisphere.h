// What a person sets of `hemisphere`, and what its kernels read. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_HEMISPHERE_H
#define UMBRAGE_EFFECTS_HEMISPHERE_H
#include "core/length.h"
#include "kernel/frame_constants.h"

// One row of the table in hemisphere.cpp per field.
struct HemisphereParams {
  int samples;
  int shape;      // 0 hemisphere, 1 sphere
  Length radius;  // scene units or share of the scene's radius
  int distribution;
  int seed;
  int noise;        // side of the tile, pixels; 0: as large as the picture
  int range;        // kHemisphereRange...
  int range_depth;  // 0 view, 1 window
  float range_factor;
  float near_depth, far_depth;  // scene units; 0: automatic
  float bias;                   // share of the radius
  int bias_of;                  // 0 surface, 1 depth
  float weight;
  int border;      // 0 skip, 1 clamp
  int occlusion;   // 0 or 1
  float bleeding;  // factor; 0: off
  int area;        // kHemisphereArea...
  float fragment_area;
  float floor;  // share of the radius
  int layers;   // 0: all there are
  float ambient_bounce;
  int bounces;
  int tangents;  // 0 or 1
};

// Values of HemisphereParams::distribution, range and area.
const int kHemisphereEven = 0, kHemispherePaper = 1;
const int kHemisphereRangeNone = 0, kHemisphereRangeConstant = 1, kHemisphereRangeLinear = 2;
const int kHemisphereRangeQuadratic = 3, kHemisphereRangeSmoothstep = 4;
const int kHemisphereAreaMeasured = 0, kHemisphereAreaEqual = 1, kHemisphereAreaPaper = 2;
const int kHemisphereMostSamples = 256;

struct HemisphereConstants {
  int samples;
  float radius;  // scene units
  int even;      // 0: the paper's sample points, 1: ours
  int seed;
  int noise;  // as in HemisphereParams
  float one_over_noise;
  // Ours: lengths even in their logarithm, and lengths just even, both in radii.
  float inner, one_over_inner, log_inner;  // the shortest of the first
  float one_over_inner2;                   // inverse of its square in scene units
  float log_share;                         // the share of the first among all, over the logarithm of their range
  float even_share_by_radius;              // the share of the second, over the radius in scene units
  float least_b2;                          // square of how near to the pixel a ray of sight passes, at least
  int range, window;                       // window: 0 or 1, whether the range is one of window depth
  float limit, depth_at_limit;  // of a difference in depth; where limits that fall with depth have this value
  float near_depth, far_depth;
  float window_one, window_inverse;  // window depth = window_one - window_inverse / depth
  int rises;                         // 0 or 1: an occluder must rise above the surface's plane
  float least_height, least_nearer;  // scene units: by how much, and by how much it must be before a sample
  float weight;
  int clamp_border;  // 0 or 1
  int occlusion;     // 0 or 1
  float bleeding;
  int area;              // as in HemisphereParams
  float area_factor;     // factor of what a find stands for, besides cosines and lengths
  int above;             // 0 or 1: samples lie above the surface's plane
  float least_distance;  // scene units, of the square in equation 1
  float ambient_bounce;
  float openness;  // guess of the ambient occlusion where none is known
  // Layers in which occluders are sought, in this order.
  int layer_count;
  int layer[kLayersRead];
  int back[kLayersRead];      // the layer that shows the other side of its surfaces, or -1
  int other[kLayersRead];     // 0 or 1: seen by another camera than the first layer
  int new_view[kLayersRead];  // 0 or 1: seen by another camera than the layer before in this list
  int view_end[kLayersRead];  // of the first layer of a camera: the index after its last in this list
  int orthographic[kLayersRead];
  // Of that camera. Pixel coordinates of a view-space position (x, y, z): x scale_x / -z + offset_x for a perspective
  // camera, x scale_x + offset_x otherwise; and the rays as in FrameConstants.
  float scale_x[kLayersRead], offset_x[kLayersRead], scale_y[kLayersRead], offset_y[kLayersRead];
  float ray_scale_x[kLayersRead], ray_offset_x[kLayersRead], ray_scale_y[kLayersRead], ray_offset_y[kLayersRead];
  // Three rows of the rigid movement from the first camera's view space to its own, each three factors and what is
  // added.
  float move[12 * kLayersRead];
  // Of each sample point: x and y across the normal, z along it, its length, what it counts.
  float points[5 * kHemisphereMostSamples];
};

#endif
