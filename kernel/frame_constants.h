// What every kernel may read of the picture, shared by C++ and GLSL: 4-byte scalars only.
//
// View-space position of the centre of pixel (x, y) at depth d, with X = x + 0.5, Y = y + 0.5:
//   perspective   ((X ray_scale_x + ray_offset_x) d, (Y ray_scale_y + ray_offset_y) d, -d)
//   orthographic  ( X ray_scale_x + ray_offset_x,     Y ray_scale_y + ray_offset_y,    -d)
#ifndef UMBRAGE_MACHINE_FRAME_CONSTANTS_H
#define UMBRAGE_MACHINE_FRAME_CONSTANTS_H
// Layers of a G-buffer that a kernel can read, the first included.
const int kLayersRead = 8;
// The most planes, inputs and outputs, of one pass.
const int kMaxPlanes = 128;
// Planes of a pass, the first ones, that a GPU reads as bound buffers; the others it reaches by their addresses. What
// passes of one layer read is fewer; a device that binds fewer than this cannot be used.
const int kBoundPlanes = 16;

// What `ao` holds where a pixel is left to be computed: more than any occlusion or light.
const float kMissing = 2e30f;

struct FrameConstants {
  int width, height;
  int stride;        // floats from one row of a plane to the next
  int orthographic;  // 0 or 1
  int round;         // of an effect whose passes run several times: 0 in the first
  int missing;       // 1: only pixels where `ao` is kMissing are computed
  float ray_scale_x, ray_offset_x, ray_scale_y, ray_offset_y;
};

#endif
