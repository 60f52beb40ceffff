// Copies one pixel in `factor` of a plane, across and down, to the upper left corner of another plane; the remainder is
// 0.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
layout(local_size_x = 8, local_size_y = 8) in;
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer From { float at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer To { float at[]; };
// PickConstants of pipelines.h.
layout(push_constant, scalar) uniform Pushed {
  From from;
  To to;
  int from_width, from_height, from_stride;
  int to_width, to_height, to_stride;
  int factor;
};

void main() {
  ivec2 here = ivec2(gl_GlobalInvocationID.xy);
  if (here.x >= to_width || here.y >= to_height) return;
  ivec2 source = here * factor;
  bool inside = source.x < from_width && source.y < from_height;
  to.at[here.y * to_stride + here.x] = inside ? from.at[source.y * from_stride + source.x] : 0.0f;
}
