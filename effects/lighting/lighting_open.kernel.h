// Writes `open_light`: the luminance of an unoccluded white diffuse surface under all lights and ambient light.
// Computes the same as lighting.kernel.h, but without shadows and materials.
IN_REAL(depth)
IN_VECTOR(normal)
OUT_REAL(open_light)

#include "effects/lighting/lighting_ambient.kernel.h"
#include "effects/lighting/lighting_lights.kernel.h"

FN Real luminance_of(Real r, Real g, Real b) { return r * 0.2126f + g * 0.7152f + b * 0.0722f; }  // Rec.709

FN void lighting_open_pixel(Int px, Int py) {
  Real depth = near_depth(0, 0);
  Bool surface = is_finite(depth);
  Vec3 position = view_position(px, py, select(surface, depth, Real(1.0f)));
  Vec3 normal = near_normal(0, 0);
  Vec3 ambient = ambient_at_normal(normal);
  Real sum = luminance_of(ambient.x, ambient.y, ambient.z);
  for (int k = 0; k < C.light_count; ++k) {
    Vec3 light = towards_light(k, position);
    Real falloff = light_falloff(k, position);
    Real lambert = max(dot(normal, light), Real(0.0f)) * C.diffuse;
    sum = sum + falloff * lambert * luminance_of(Real(C.r[k]), Real(C.g[k]), Real(C.b[k]));
  }
  store_open_light(select(surface, finite_or_zero(sum), Real(0.0f)));
}
