// Planes as sampled images, as in an engine's G-buffer.
layout(set = 0, binding = 1) uniform sampler2D depth_image;
layout(set = 0, binding = 2) uniform sampler2D normal_image;

float depth_at(ivec2 p) { return texelFetch(depth_image, p, 0).x; }
vec3 normal_at(ivec2 p) { return texelFetch(normal_image, p, 0).xyz; }
