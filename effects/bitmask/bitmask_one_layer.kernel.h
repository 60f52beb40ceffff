// For bitmask.kernel.h: occluders of the first depth layer alone.
IN_REAL(depth)

CONST bool kLayers = false;
FN Real depth_of(int layer, Int place) { return Real(0.0f); }  // there is no other layer
