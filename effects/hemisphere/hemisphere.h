// User parameters of `hemisphere` and the constants of its kernels. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_HEMISPHERE_H
#define UMBRAGE_EFFECTS_HEMISPHERE_H
#include "core/length.h"
#include "kernel/frame_constants.h"

// One row of the table in hemisphere.cpp per field.
struct HemisphereParams {
  int samples;
  int shape;      // 0 hemisphere, 1 sphere
  Length radius;  // scene units, or percent of the bounding-sphere radius
  int distribution;
  int seed;
  int noise;        // side of the tile, pixels; 0: the whole picture
  int range;        // kHemisphereRange...
  int range_depth;  // 0 view, 1 window
  float range_factor;
  float near_depth, far_depth;  // scene units; 0: automatic
  float bias;                   // fraction of the radius
  int bias_of;                  // 0 surface, 1 depth
  float weight;
  int border;      // 0 skip, 1 clamp
  int occlusion;   // 0 or 1
  float bleeding;  // factor; 0: off
  int area;        // kHemisphereArea...
  float fragment_area;
  float floor;  // fraction of the radius
  int layers;   // 0: all captured layers
  float ambient_bounce;
  int bounces;
  int tangents;  // 0 or 1
};

// Values of HemisphereParams::distribution, range and area.
const int kHemisphereEven = 0, kHemispherePaper = 1;
const int kHemisphereRangeNone = 0, kHemisphereRangeConstant = 1, kHemisphereRangeLinear = 2;
const int kHemisphereRangeQuadratic = 3, kHemisphereRangeSmoothstep = 4;
const int kHemisphereAreaMeasured = 0, kHemisphereAreaEqual = 1, kHemisphereAreaPaper = 2;
const int kHemisphereMaxSamples = 256;

struct HemisphereConstants {
  int samples;
  float radius;  // scene units
  int even;      // 0: the paper's sample points, 1: ours
  int seed;
  int noise;  // as in HemisphereParams
  float one_over_noise;
  // Distribution `even`: lengths uniform in their logarithm (log) and uniform lengths (even), both in radii.
  float inner, one_over_inner, log_inner;  // minimum length of the log samples
  float one_over_inner2;                   // inverse of the square of that length, scene units
  float log_share;                         // fraction of log samples, divided by the log of their range
  float even_fraction_by_radius;           // fraction of even samples, divided by the radius in scene units
  float min_b2;                            // square of the minimum distance from the pixel to a view ray, scene units
  int range, window;                       // window, 0 or 1: the range limits window depth
  // Limit of a difference in depth; depth at which limits that fall with depth have this value
  float limit, depth_at_limit;
  float near_depth, far_depth;
  float window_one, window_inverse;  // window depth = window_one - window_inverse / depth
  int rises;                         // 0 or 1: an occluder must rise above the surface's plane
  // Scene units: minimum height above the surface's plane; minimum distance in front of the sample
  float min_height, min_nearer;
  float weight;
  int clamp_border;  // 0 or 1
  int occlusion;     // 0 or 1
  float bleeding;
  int area;            // as in HemisphereParams
  float area_factor;   // factor of what a hit represents, besides cosines and lengths
  int above;           // 0 or 1: samples lie above the surface's plane
  float min_distance;  // scene units: minimum of the distance in equation 1
  float ambient_bounce;
  float assumed_visibility;  // assumed visibility of ambient light where it is unknown
  // Layers in which occluders are searched, in this order. Entries of one camera are consecutive.
  int layer_count;
  int layer[kLayersRead];
  int back[kLayersRead];      // layer that shows the back of its surfaces, or -1
  int other[kLayersRead];     // 0 or 1: has another camera than the first layer
  int new_view[kLayersRead];  // 0 or 1: has another camera than the previous entry
  // For the first entry of a camera: index after the last entry of this camera
  int view_end[kLayersRead];
  int orthographic[kLayersRead];
  // Projection of the layer's camera. Pixel coordinates of a view-space position (x, y, z): x scale_x / -z + offset_x
  // for a perspective camera, x scale_x + offset_x otherwise; the rays are as in FrameConstants.
  float scale_x[kLayersRead], offset_x[kLayersRead], scale_y[kLayersRead], offset_y[kLayersRead];
  float ray_scale_x[kLayersRead], ray_offset_x[kLayersRead], ray_scale_y[kLayersRead], ray_offset_y[kLayersRead];
  // First three rows of the rigid transform from the first camera's view space to that of the layer's camera, row by
  // row: three factors and a translation each.
  float move[12 * kLayersRead];
  // Per sample point: x and y perpendicular to the normal, z along it, length, weight.
  float points[5 * kHemisphereMaxSamples];
};

#endif
