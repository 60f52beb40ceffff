// Occlusion only: reads and writes no light.
IN_LAYERS_REAL(depth)
IN_VECTOR(normal)
OUT_REAL(ao)

CONST bool kLight = false;
FN Vec3 normal_of(int layer, Int place) { return Vec3(Real(0.0f), Real(0.0f), Real(0.0f)); }
FN Vec3 outgoing_light_of(int layer, Int place) { return Vec3(Real(0.0f), Real(0.0f), Real(0.0f)); }
FN void store_light(Vec3 light) {}
#include "effects/ssdo/ssdo.kernel.h"

FN void ssdo_occlusion_pixel(Int px, Int py) { gather(px, py); }
