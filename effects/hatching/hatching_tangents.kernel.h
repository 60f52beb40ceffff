// Tangents of a surface along rows and columns of the picture, and directions on it. Included once per kernel.

struct Tangents {
  Vec3 x, y;          // view-space steps to the next pixel to the right and below, on the plane of the pixel
  Real xx, xy, yy;    // their dot products
  Real area;          // of the parallelogram between them
};

CONST float kMinFacing = 0.02f;  // min cosine between normal and ray: tangents are limited to 50 pixel sizes

FN Tangents tangents_of(Vec3 position, Vec3 normal) {
  Real spread = F.orthographic != 0 ? Real(1.0f) : -position.z;
  Vec3 ray = F.orthographic != 0 ? Vec3(Real(0.0f), Real(0.0f), Real(-1.0f)) : position * (Real(1.0f) / spread);
  Real facing = min(dot(normal, ray), -sqrt(dot(ray, ray)) * kMinFacing);
  Vec3 right = Vec3(spread * F.ray_scale_x, Real(0.0f), Real(0.0f));
  Vec3 down = Vec3(Real(0.0f), spread * F.ray_scale_y, Real(0.0f));
  Vec3 x = right - ray * (normal.x * right.x / facing);
  Vec3 y = down - ray * (normal.y * down.y / facing);
  Real xx = dot(x, x);
  Real xy = dot(x, y);
  Real yy = dot(y, y);
  Real area = sqrt(max(xx * yy - xy * xy, xx * yy * 1e-6f));
  return Tangents(x, y, xx, xy, yy, area);
}

// Returns the unit vector, with x >= 0, that has half the angle of the unit vector `doubled`.
FN Vec2 half_angle(Vec2 doubled) {
  Real larger = sqrt(mad(abs(doubled.x), Real(0.5f), Real(0.5f)));
  Real smaller = abs(doubled.y) * 0.5f / larger;
  Bool right = doubled.x >= 0.0f;
  Real y = select(right, smaller, larger);
  return Vec2(select(right, larger, smaller), select(doubled.y < 0.0f, -y, y));
}

// Returns the direction on the picture, as (cos 2a, sin 2a), of a vector d on the surface, from p = d . x, q = d . y.
FN Vec2 on_picture(Tangents t, Real p, Real q) {
  Real right = (t.yy * p - t.xy * q);
  Real down = (t.xx * q - t.xy * p);
  Real most = max(abs(right), abs(down));
  Real scale = select(most > 0.0f, Real(1.0f) / max(most, Real(1e-37f)), Real(0.0f));
  right = right * scale;
  down = down * scale;
  Real squared = Real(1.0f) / max(right * right + down * down, Real(1e-20f));
  return Vec2((right * right - down * down) * squared, right * down * 2.0f * squared);
}

// Returns the direction of the line in which a plane across C.axis meets the surface. Its weight is the sine of the
// angle between the axis and the normal.
FN Vec2 fixed_direction(Tangents t, Vec3 normal) {
  Vec3 along = cross(normal, Vec3(Real(C.axis_x), Real(C.axis_y), Real(C.axis_z)));
  return on_picture(t, dot(along, t.x), dot(along, t.y)) * sqrt(dot(along, along));
}
