// Definitions for bitmask.kernel.h: no indirect light.
CONST bool kLight = false;
FN Vec3 normal_of(int layer, Int place) { return Vec3(Real(0.0f), Real(0.0f), Real(0.0f)); }
FN Vec3 outgoing_light_of(int layer, Int place) { return Vec3(Real(0.0f), Real(0.0f), Real(0.0f)); }
FN void store_light(Vec3 light) {}
