// For bitmask.kernel.h: the mean open direction is not asked for.
CONST bool kBent = false;
FN void store_bent(Vec3 bent) {}
