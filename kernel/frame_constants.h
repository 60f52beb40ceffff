// FrameConstants: the constants of a picture that every kernel can read. Shared by C++ and GLSL: 4-byte scalars only.
//
// The view-space position of the centre of pixel (x, y) at depth d is, with X = x + 0.5 and Y = y + 0.5:
//   perspective   ((X ray_scale_x + ray_offset_x) d, (Y ray_scale_y + ray_offset_y) d, -d)
//   orthographic  ( X ray_scale_x + ray_offset_x,     Y ray_scale_y + ray_offset_y,    -d)
#ifndef UMBRAGE_MACHINE_FRAME_CONSTANTS_H
#define UMBRAGE_MACHINE_FRAME_CONSTANTS_H
// Max number of layers of a G-buffer that a kernel can read, including the first.
const int kLayersRead = 8;
// Max number of planes, inputs and outputs together, of one dispatch.
const int kMaxPlanes = 128;
// Number of a dispatch's planes that a GPU reads as bound buffers; it accesses the others by address. Dispatches on one
// layer read fewer planes than this. A device that supports fewer bindings cannot be used.
const int kBoundPlanes = 16;

// The value of `ao` that marks a pixel as still to be computed: above any occlusion or light.
const float kMissing = 2e30f;

struct FrameConstants {
  int width, height;
  int stride;        // floats from one row of a plane to the next
  int orthographic;  // 0 or 1
  int round;         // index of the round, from 0
  int missing;       // 1: compute only pixels where `ao` is kMissing; 0: all
  float ray_scale_x, ray_offset_x, ray_scale_y, ray_offset_y;
};

#endif
