// Constants of convert.comp, shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_DEVICES_VULKAN_CONVERT_H
#define UMBRAGE_DEVICES_VULKAN_CONVERT_H

// Texel formats; in the buffer the rows of the image follow each other without gaps.
const int kFloat1 = 0, kFloat4 = 1, kHalf4 = 2, kBytes4 = 3, kBytes4Swapped = 4;
// Meaning of the texels.
const int kPlainRole = 0;          // plain numbers
const int kNormalRole = 1;         // a vector; bytes map from [0, 1] to [-1, 1]; rotated by `rotation`
const int kViewDepthRole = 2;      // view depth
const int kWindowDepthRole = 3;    // window depth: 0 at the near plane, 1 at the far plane
const int kReversedDepthRole = 4;  // window depth: 1 at the near plane, 0 at the far plane
const int kRayDepthRole = 5;       // ray depth

struct ConvertConstants {
  int width, height, stride;
  int format;
  int srgb;      // 1: bytes are sRGB
  int to_image;  // 0: texels to planes; 1: planes to texels
  int role;
  int orthographic;
  float near_depth, far_depth;     // the far plane may be at infinity
  float left, right, bottom, top;  // kRayDepthRole: window at distance 1
  float rotation[9];               // of normals, by rows
};

#endif
