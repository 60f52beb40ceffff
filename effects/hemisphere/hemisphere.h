// Parameters and kernel constants of `hemisphere`. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_HEMISPHERE_H
#define UMBRAGE_EFFECTS_HEMISPHERE_H
#include "core/length.h"
#include "kernel/frame_constants.h"

// Each field has one row in the parameter table of hemisphere.cpp.
struct HemisphereParams {
  int samples;
  int shape;         // 0 hemisphere, 1 sphere
  Length radius;     // scene units, or percent of the bounding-sphere radius
  int distribution;  // kHemisphereEven or kHemispherePaper
  int seed;
  int noise;        // side of the noise tile, pixels; 0: noise does not repeat
  int range;        // kHemisphereRangeNone to kHemisphereRangeSmoothstep
  int range_depth;  // 0 view, 1 window
  float range_factor;
  float near_depth, far_depth;  // scene units; 0: automatic
  float bias;                   // fraction of the radius
  int bias_of;                  // 0 surface, 1 depth
  float weight;
  int border;           // 0 skip, 1 clamp
  int occlusion;        // 0 or 1
  float bleeding;       // factor; 0: off
  int area;             // kHemisphereAreaMeasured to kHemisphereAreaPaper
  float fragment_area;  // squared radii
  float floor;          // fraction of the radius
  int layers;           // 0: all captured layers
  float ambient_bounce;
  int bounces;
  int tangents;  // 0 or 1: store `tangent`
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
  int even;      // distribution: 0 paper, 1 even
  int seed;
  int noise;  // as in HemisphereParams
  float one_over_noise;
  // Distribution `even`: one part of the samples has lengths uniform in their logarithm (log samples), the other has
  // uniform lengths (even samples).
  float inner, one_over_inner, log_inner;  // min length of log samples, radii; its inverse; its logarithm
  float one_over_inner2;                   // inverse of the square of that length, in scene units
  float log_density;                       // fraction of log samples / ln(1 / inner)
  float even_density;                      // fraction of even samples / radius in scene units
  float min_b2;                            // square of the min distance from the pixel to a view ray, scene units
  int range;                               // as in HemisphereParams
  int window;                              // 0 or 1: the range limits window depth
  float limit;                             // limit of the difference in depth, scene units or window depth
  float depth_at_limit;                    // depth at which the linear and quadratic limits equal `limit`, scene units
  float near_depth, far_depth;             // planes of window depth, scene units
  float window_one, window_inverse;        // window depth = window_one - window_inverse / depth
  int rises;                               // 0 or 1: an occluder must rise above the surface's plane
  float min_height;                        // min height of an occluder above that plane, scene units
  float min_in_front;                      // min distance of an occluder in front of the sample, scene units
  float weight;
  int clamp_border;  // 0 or 1
  int occlusion;     // 0 or 1
  float bleeding;
  int area;            // as in HemisphereParams
  float area_factor;   // constant factor of a hit's weight
  int above;           // 0 or 1: all samples are above the surface's plane
  float min_distance;  // lower bound of the distance in equation 1, scene units
  float ambient_bounce;
  float assumed_visibility;  // assumed visibility of ambient light where it is unknown
  // Layers in which occluders are searched, in this order. Entries of one camera are consecutive.
  int layer_count;
  int layer[kLayersRead];
  int back[kLayersRead];      // layer that shows the back sides of the surfaces in layer[i]; -1: none
  int other[kLayersRead];     // 0 or 1: the camera is not that of the first layer
  int new_view[kLayersRead];  // 0 or 1: the camera is not that of the previous entry
  int view_end[kLayersRead];  // in the first entry of a camera: index after this camera's last entry
  int orthographic[kLayersRead];
  // Projection of the layer's camera. Pixel coordinates of a view-space position (x, y, z): x scale_x / -z + offset_x
  // for a perspective camera, x scale_x + offset_x otherwise; the rays are as in FrameConstants.
  float scale_x[kLayersRead], offset_x[kLayersRead], scale_y[kLayersRead], offset_y[kLayersRead];
  float ray_scale_x[kLayersRead], ray_offset_x[kLayersRead], ray_scale_y[kLayersRead], ray_offset_y[kLayersRead];
  // Transform from the first camera's view space to that of the layer's camera. It is rigid; these are the first three
  // rows of its matrix, row by row: three factors and a translation each.
  float move[12 * kLayersRead];
  // Five values per sample point: x and y perpendicular to the normal, z along it, length, weight.
  float points[5 * kHemisphereMaxSamples];
};

#endif
