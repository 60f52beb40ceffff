// Occlusion, and the mean of the open directions, in view space.
IN_LAYERS_REAL(depth)
IN_VECTOR(normal)
IN_REAL(bitmask_mips)
OUT_REAL(ao)
OUT_VECTOR(bent)

CONST bool kLayers = true;
FN Real depth_of(int layer, Int place) { return read_depth_of(layer, place); }
FN Real mip_of(Int place) { return read_bitmask_mips(place); }
CONST bool kLight = false;
FN Vec3 normal_of(int layer, Int place) { return Vec3(Real(0.0f), Real(0.0f), Real(0.0f)); }
FN Vec3 sent_of(int layer, Int place) { return Vec3(Real(0.0f), Real(0.0f), Real(0.0f)); }
FN void store_light(Vec3 light) {}
CONST bool kBent = true;
#include "effects/bitmask/bitmask.kernel.h"

FN void bitmask_bent_pixel(Int px, Int py) { gather(px, py); }
