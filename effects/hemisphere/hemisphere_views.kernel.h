// The cameras of the layers in which occluders are searched: see the constants that fill_layer_views() writes.

// These are parts of the transform from the first camera's view space to that of the camera of layer i: rotated_to_view
// applies the rotation, rotated_from_view its inverse; view_translation returns the translation.
FN Vec3 rotated_to_view(int i, Vec3 v) {
  return Vec3(dot(Vec3(Real(C.move[12 * i]), Real(C.move[12 * i + 1]), Real(C.move[12 * i + 2])), v),
              dot(Vec3(Real(C.move[12 * i + 4]), Real(C.move[12 * i + 5]), Real(C.move[12 * i + 6])), v),
              dot(Vec3(Real(C.move[12 * i + 8]), Real(C.move[12 * i + 9]), Real(C.move[12 * i + 10])), v));
}
FN Vec3 view_translation(int i) {
  return Vec3(Real(C.move[12 * i + 3]), Real(C.move[12 * i + 7]), Real(C.move[12 * i + 11]));
}
FN Vec3 rotated_from_view(int i, Vec3 v) {
  return Vec3(dot(Vec3(Real(C.move[12 * i]), Real(C.move[12 * i + 4]), Real(C.move[12 * i + 8])), v),
              dot(Vec3(Real(C.move[12 * i + 1]), Real(C.move[12 * i + 5]), Real(C.move[12 * i + 9])), v),
              dot(Vec3(Real(C.move[12 * i + 2]), Real(C.move[12 * i + 6]), Real(C.move[12 * i + 10])), v));
}

// Returns the view depth, for the camera of layer i, of a position in the first camera's view space.
FN Real depth_in_view(int i, Vec3 position) { return -(rotated_to_view(i, position) + view_translation(i)).z; }

// Returns the position at the centre of pixel (x, y) of layer i, in the view space of that layer's camera. x and y are
// integers.
FN Vec3 position_in_view(int i, Real x, Real y, Real depth) {
  Real spread = C.orthographic[i] != 0 ? Real(1.0f) : depth;
  return Vec3(mad(x + 0.5f, Real(C.ray_scale_x[i]), Real(C.ray_offset_x[i])) * spread,
              mad(y + 0.5f, Real(C.ray_scale_y[i]), Real(C.ray_offset_y[i])) * spread, -depth);
}
