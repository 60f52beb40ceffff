// Constants of a picture that every kernel can read, shared by C++ and GLSL: 4-byte scalars only.
//
// View-space position of the centre of pixel (x, y) at depth d, with X = x + 0.5, Y = y + 0.5:
//   perspective   ((X ray_scale_x + ray_offset_x) d, (Y ray_scale_y + ray_offset_y) d, -d)
//   orthographic  ( X ray_scale_x + ray_offset_x,     Y ray_scale_y + ray_offset_y,    -d)
#ifndef UMBRAGE_MACHINE_FRAME_CONSTANTS_H
#define UMBRAGE_MACHINE_FRAME_CONSTANTS_H
// Max layers of a G-buffer that a kernel can read, the first included.
const int kLayersRead = 8;
// Max planes, inputs and outputs, of one pass.
const int kMaxPlanes = 128;
// The first planes of a pass, which a GPU reads as bound buffers; it reaches the others by address. Passes on one layer
// read fewer. A device that supports fewer bindings cannot be used.
const int kBoundPlanes = 16;

// The value of `ao` where a pixel is still to be computed: above any occlusion or light.
const float kMissing = 2e30f;

struct FrameConstants {
  int width, height;
  int stride;        // floats between rows of a plane
  int orthographic;  // 0 or 1
  int round;         // index of the round, from 0
  int missing;       // 1: only pixels where `ao` is kMissing are computed
  float ray_scale_x, ray_offset_x, ray_scale_y, ray_offset_y;
};

#endif
