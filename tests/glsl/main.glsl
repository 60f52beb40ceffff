// Stores the visibility of each pixel: visibility_at where there is a surface, 1 elsewhere.
void main() {
  ivec2 here = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(here, ivec2(F.width, F.height)))) return;
  float z = depth_at(here);
  ao[here.y * F.stride + here.x] = isinf(z) ? 1.0 : visibility_at(here, z);
}
