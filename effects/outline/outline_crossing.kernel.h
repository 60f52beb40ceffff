// A crossing of an edge between two pixels, in one number: outline_find and outline_settle write such numbers,
// outline_settle and outline_refine read them.
//
// 0 is none. Else 1 + 2 level + (t + 1/2) / 2: t in [-1/2, 3/2) from the pixel to its neighbour, 1/2 where that is not
// known; level 0 to 64, of which 64 is a line wholly on this pixel's side (it is nearer), 0 wholly on the neighbour's,
// 32 in the middle, where creases alone lie. Added to that is kStep times how clear the edge is, 0 to kClearest; below
// half of it all is negated.

CONST float kLevels = 32.0f;  // of side, to either side of the middle
CONST float kStep = 256.0f;
CONST float kClearest = 7.0f;
CONST float kMiddle = 65.0f;  // side of a line that is nobody's, a crease, in its code

FN Real clear_of(Real v) { return floor(abs(v) * Real(1.0f / kStep)); }
// What is left without how clear it is.
FN Real code_of(Real v) { return mad(clear_of(v), Real(-kStep), abs(v)); }
