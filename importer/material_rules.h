// Properties of materials that readers of several formats derive from others.
#pragma once
#include "scene/scene.h"

namespace umbrage {

/// Returns whether the texture's alpha is nearly 0 or nearly 1 nearly everywhere, and nearly 0 somewhere.
bool is_cut_out(const Texture& texture);

/// Returns whether the texture has an alpha below 1.
bool has_transparent_texels(const Texture& texture);

}  // namespace umbrage
