// For the filter of visibility alone.
CONST bool kLight = false;
FN Vec3 light_at(int i, int j) { return Vec3(Real(0.0f), Real(0.0f), Real(0.0f)); }
