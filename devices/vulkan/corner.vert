// Projects the corners of triangles, to match the rays of rays/camera_rays.h, and the corners of squares that cover
// points.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "devices/vulkan/capture_scene.glsl"

// If the scene has points, triangles have six vertices too, like squares; the last three of a triangle coincide.
layout(constant_id = 1) const bool kPoints = true;
layout(location = 0) flat out int triangle_index;
invariant gl_Position;

const int kSquare[6] = int[](0, 1, 2, 2, 1, 3);  // corners of two triangles
const float kSquareScale = 1.001f;               // scale of a square, so that it covers its point

// Computes the corner of a square that covers the point. Returns false if the camera is inside or very close to a
// sphere.
bool square_corner(Triangle point, vec2 side, out vec3 p) {
  vec3 axis = point.p1;
  float radius = point.p2.x * kSquareScale;
  if (point.kind == kSphere) {
    axis = to_vec3(C.direction);
    if (C.orthographic == 0) {
      // Radius, at the distance of the centre, of the cone from the camera that touches the sphere.
      axis = point.p0 - to_vec3(C.origin);
      float beyond = dot(axis, axis) - radius * radius;
      if (beyond < 0.01f * radius * radius) return false;
      radius *= sqrt(dot(axis, axis) / beyond);
    }
  }
  vec3 right, up;
  disc_axes(axis, right, up);
  p = point.p0 + radius * (side.x * right + side.y * up);
  return true;
}

void main() {
  int corners = kPoints ? 6 : 3, corner = gl_VertexIndex % corners;
  triangle_index = gl_VertexIndex / corners;
  vec3 p = Vectors(table[kTrianglesSlot]).at[4 * triangle_index + (corner < 3 ? corner : 0)].xyz;
  if (kPoints) {
    Triangle point = triangle_at(triangle_index);
    vec2 side = vec2(kSquare[corner] % 2, kSquare[corner] / 2) * 2.0f - 1.0f;
    if (point.kind != kTriangle && !square_corner(point, side, p)) {
      gl_Position = vec4(side, 0.5f, 1.0f);
      return;
    }
  }
  p -= to_vec3(C.origin);
  float x = dot(to_vec3(C.clip_x), p), y = dot(to_vec3(C.clip_y), p);
  if (C.orthographic != 0)
    gl_Position = vec4(x - 1.0f, y - 1.0f, 0.5f, 1.0f);  // peel.frag discards fragments behind the camera
  else
    gl_Position = vec4(x, y, C.nearest, dot(to_vec3(C.clip_w), p));
}
