// Arithmetic of Vec2 and Vec3 in terms of Real. scalar.h and lanes.h include this file inside their namespace; GLSL has
// its own vectors. There is no include guard, since every SIMD target includes the file once.
inline Vec3 operator+(Vec3 a, Vec3 b) { return Vec3{a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(Vec3 a, Vec3 b) { return Vec3{a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator*(Vec3 a, Vec3 b) { return Vec3{a.x * b.x, a.y * b.y, a.z * b.z}; }
inline Vec3 operator*(Vec3 a, Real b) { return Vec3{a.x * b, a.y * b, a.z * b}; }
inline Vec3 operator-(Vec3 a) { return Vec3{-a.x, -a.y, -a.z}; }
inline Vec2 operator+(Vec2 a, Vec2 b) { return Vec2{a.x + b.x, a.y + b.y}; }
inline Vec2 operator-(Vec2 a, Vec2 b) { return Vec2{a.x - b.x, a.y - b.y}; }
inline Vec2 operator*(Vec2 a, Real b) { return Vec2{a.x * b, a.y * b}; }
inline Real dot(Vec3 a, Vec3 b) { return mad(a.x, b.x, mad(a.y, b.y, a.z * b.z)); }
inline Real dot(Vec2 a, Vec2 b) { return mad(a.x, b.x, a.y * b.y); }
inline Vec3 cross(Vec3 a, Vec3 b) { return Vec3{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline Vec3 select(Bool mask, Vec3 a, Vec3 b) {
  return Vec3{select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}
inline Vec3 lane_value(Vec3 v, Int lane) {
  return Vec3{lane_value(v.x, lane), lane_value(v.y, lane), lane_value(v.z, lane)};
}
