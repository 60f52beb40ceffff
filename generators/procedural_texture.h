// Procedural textures: stone, tiles, wood, plaster, fabric, leaves. All textures repeat unless noted otherwise. Colours
// are linear Rec.709 here and sRGB in the texture.
#pragma once
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <string>

#include "scene/scene.h"

namespace umbrage::procedural {

/// Makes a texture from a function of the texture coordinate ((0, 0) is the lower left): linear colour and alpha.
Texture paint(std::string name, int width, int height, const std::function<glm::vec4(glm::vec2 uv)>& color);

/// Makes dressed stone in a running bond: columns x rows blocks (rows even), each of its own tone, with mortar joints
/// of width `joint` (fraction of a block's height). Joint 0 is plain stone.
Texture stone_blocks(int size, int columns, int rows, glm::vec3 stone, glm::vec3 mortar, float joint,
                     std::uint32_t seed);

/// Makes a floor of square marble slabs, two by two per repeat, with small diamonds of `inlay` at their corners.
Texture marble_tiles(int size, glm::vec3 light, glm::vec3 dark, glm::vec3 inlay, std::uint32_t seed);

/// Makes plaster or rough stone: mottled, with fine grain; contrast about 0.05 to 0.3.
Texture plaster(int size, glm::vec3 color, float contrast, std::uint32_t seed);

/// Makes floor boards along u, `boards` rows of them, with grain, butt joints and gaps. One board is a plank without
/// gaps.
Texture wood(int size, int boards, glm::vec3 light, glm::vec3 dark, std::uint32_t seed);

/// Makes a damask: an ogee lattice with a flower in each field, `figure` on `ground`, over a fine weave.
Texture damask(int size, glm::vec3 ground, glm::vec3 figure);

/// Makes woven cloth of one colour, threads x threads per repeat.
Texture weave(int size, int threads, glm::vec3 color, float contrast, std::uint32_t seed);

/// Makes stripes along v in the given colours, over a weave.
Texture stripes(int size, std::span<const glm::vec3> colors, std::uint32_t seed);

/// Makes a carpet with borders, a field and a medallion; fills [0, 1]^2 once. The aspect ratio is width over height.
Texture carpet(int width, int height, glm::vec3 field, glm::vec3 border, glm::vec3 figure, std::uint32_t seed);

/// Makes one pointed leaf from (0.5, 0) to (0.5, 1) with veins; alpha 0 around it. Does not repeat.
Texture leaf(int size, glm::vec3 color, glm::vec3 vein);

/// Makes a feathered frond: a midrib with leaflets on either side; alpha 0 between. Does not repeat.
Texture frond(int width, int height, glm::vec3 color, glm::vec3 rib);

/// Makes crossed wrought bars in a diamond lattice; alpha 0 between them.
Texture lattice(int size, int cells, float bar, glm::vec3 color);

/// Makes book spines side by side, `books` of them, with gold bands; fills [0, 1]^2 once: spine k is u in [k, k + 1] /
/// books.
Texture book_spines(int width, int height, int books, std::uint32_t seed);

/// Makes a painted landscape: sky, hills in haze, a field. Does not repeat.
Texture landscape_painting(int width, int height, std::uint32_t seed);

}  // namespace umbrage::procedural
