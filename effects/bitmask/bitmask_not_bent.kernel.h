// Definitions for bitmask.kernel.h: the mean unoccluded direction is not stored.
CONST bool kBent = false;
FN void store_bent(Vec3 bent) {}
