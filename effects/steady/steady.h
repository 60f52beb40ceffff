// User parameters of `steady` and the constants of its kernels. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_EFFECTS_STEADY_H
#define UMBRAGE_EFFECTS_STEADY_H

// One row of the table in steady.cpp per field.
struct SteadyParams {
  int weight;      // kSteadyEqual or kSteadyRays
  int light;       // 0 or 1: join indirect light, too
  int begin;       // 0 or 1: this is the first frame that is joined
  int motion;      // kMotionOfCamera or kMotionOfPlanes
  float distance;  // max distance from each other's plane at which pixels fit fully, pixels
  float angle;     // max angle between normals at which pixels fit fully, degrees
  float change;    // max change of occlusion with which frames count fully, where planes tell the motion
};

// Values of SteadyParams::weight.
const int kSteadyEqual = 0, kSteadyRays = 1;

// Values of SteadyParams::motion.
const int kMotionOfCamera = 0, kMotionOfPlanes = 1;

// Value of the plane steady_change where a surface point is not in the other frame.
const float kSteadyUnknown = 1e3f;

struct SteadyConstants {
  int begin;         // as in SteadyParams
  int usable;        // 1 if both cameras have the same projection, otherwise 0
  float distance;    // as in SteadyParams
  float turn;        // 1 / (1 - cosine of the angle)
  float less_above;  // 1 / the max change with which frames count fully
  // A point p of this view space is (dot(x, p) + x[3], ...) in that of the other frame.
  float x[4], y[4], z[4];
  // As FrameConstants, of the other frame.
  float ray_scale_x, ray_offset_x, ray_scale_y, ray_offset_y;
};

#endif
