// Diagrams 2, 3, 4 and 6 of [Colliander and Törnquist 2015], drawn from the actual sample tables and planes.
#pragma once
#include "apps/figures/studio.h"

namespace umbrage {

/// Draws the diagrams for a camera. Sets the framing and look of the studio.
Result<Figure> bleeding_diagrams(Studio& studio, const Framing& view);

}  // namespace umbrage
