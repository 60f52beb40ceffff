// Definitions for bitmask.kernel.h: occluders in all depth layers.
IN_LAYERS_REAL(depth)

CONST bool kLayers = true;
FN Real depth_of(int layer, Int place) { return read_depth_of(layer, place); }
