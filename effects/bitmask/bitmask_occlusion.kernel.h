// Occlusion alone, by occluders of one depth layer.
IN_REAL(depth)
IN_VECTOR(normal)
IN_REAL(bitmask_mips)
OUT_REAL(ao)

CONST bool kLayers = false;
FN Real depth_of(int layer, Int place) { return Real(0.0f); }  // there is no other layer
FN Real mip_of(Int place) { return read_bitmask_mips(place); }
CONST bool kLight = false;
FN Vec3 normal_of(int layer, Int place) { return Vec3(Real(0.0f), Real(0.0f), Real(0.0f)); }
FN Vec3 sent_of(int layer, Int place) { return Vec3(Real(0.0f), Real(0.0f), Real(0.0f)); }
FN void store_light(Vec3 light) {}
CONST bool kBent = false;
FN void store_bent(Vec3 bent) {}
#include "effects/bitmask/bitmask.kernel.h"

FN void bitmask_occlusion_pixel(Int px, Int py) { gather(px, py); }
