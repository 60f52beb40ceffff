// What convert.comp reads, shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_DEVICES_VULKAN_CONVERT_H
#define UMBRAGE_DEVICES_VULKAN_CONVERT_H

// Texels as an image's copy in a buffer has them, row by row without gaps.
const int kFloat1 = 0, kFloat4 = 1, kHalf4 = 2, kBytes4 = 3, kBytes4Swapped = 4;
// What texels mean.
const int kPlainRole = 0;          // numbers
const int kNormalRole = 1;         // a vector; of bytes, from [0, 1] to [-1, 1]; turned
const int kViewDepthRole = 2;      // distance along the view axis
const int kWindowDepthRole = 3;    // 0 at the near plane, 1 at the far plane
const int kReversedDepthRole = 4;  // the other way round
const int kRayDepthRole = 5;       // distance from the eye along the ray

struct ConvertConstants {
  int width, height, stride;
  int format;
  int srgb;      // 1: bytes hold sRGB
  int to_image;  // 0: from texels to planes
  int role;
  int orthographic;
  float near_depth, far_depth;     // a far plane may be at infinity
  float left, right, bottom, top;  // the window at distance 1, of distance along rays
  float turn[9];                   // rows
};

#endif
