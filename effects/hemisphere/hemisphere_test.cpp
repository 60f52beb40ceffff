// `hemisphere` against the paper's description, ported literally in double, and against quadrature.
#include "effects/hemisphere/hemisphere.h"
