// Properties of materials that readers of several formats derive from others.
#pragma once
#include "scene/scene.h"

namespace umbrage {

/// Sets the Blinn-Phong highlight of a metalness and a roughness: exponent 2 / roughness^4 - 2, peak F0 * exponent / 8
/// [Karis 2013, "Specular BRDF Reference"]. The albedo must be set.
void set_highlight_of_roughness(float metallic, float roughness, Material& material);

/// Returns whether the texture's alpha is nearly 0 or nearly 1 nearly everywhere, and nearly 0 somewhere.
bool is_cut_out(const Texture& texture);

/// Returns whether the texture has an alpha below 1.
bool has_transparent_texels(const Texture& texture);

}  // namespace umbrage
