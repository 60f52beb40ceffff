// Definitions for bitmask.kernel.h: occluders in the first depth layer only.
IN_REAL(depth)

CONST bool kLayers = false;
FN Real depth_of(int layer, Int place) { return Real(0.0f); }  // no other layer is searched
